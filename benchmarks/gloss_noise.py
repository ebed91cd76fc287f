"""What it saves that rough surfaces both ask the world, lamps and what glows for light and look for them by rays.

    python benchmarks/gloss_noise.py [--samples 16]

Balls of a material on a floor of it; for each light how many times more samples rays alone, or lamps asked alone,
would take for the mean error of a pixel that both together leave, and by how much that takes longer.
"""

import argparse
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from unittest import mock

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from addon.engine import Camera, Image, Light, Material, Scene, Settings, World, light_packing, render, scene_program
from addon.engine.devices.headless import HeadlessDevice
from benchmarks.world_light_noise import SIDE, panorama

SIZE = 64, 48
PLACE = (-4.0, -3.0, 5.0)  # of what lights the scene, out of the picture
AREA = Light.area(PLACE, (3, 0, 0), (0, 3, 0), 300.0, direction=(0.6, 0.3, -1))
MATERIALS = {
    "metal 0.15": Material.metal((0.9, 0.7, 0.5), roughness=0.15),
    "metal 0.4": Material.metal((0.9, 0.7, 0.5), roughness=0.4),
    "metal 0.8": Material.metal((0.9, 0.7, 0.5), roughness=0.8),
    "coat 0.1 on diffuse": Material(diffuse=0.6, coat=1.0, coat_roughness=0.1),
    "glass 0.3": Material.glass(roughness=0.3),
}


def with_world(scene, pixels):
    scene.world = World((1.0, 1.0, 1.0), image=scene.add_image(Image(pixels)), lights=True, detail=SIDE)


def with_bulb(scene, radius):
    scene.materials.append(Material(diffuse=0.0, glow=20.0 / radius**2))
    scene.add_spheres(PLACE, radius, 1)


LIGHTS = {
    "sky with a large sun": lambda scene: with_world(scene, panorama(0.3, 2e3, 8)),
    "studio": lambda scene: with_world(scene, panorama(0.1, 30.0, 60)),
    "bulb of radius 0.1": lambda scene: with_bulb(scene, 0.1),
    "ball of radius 0.8": lambda scene: with_bulb(scene, 0.8),
    "area lamp of 3 x 3": lambda scene: scene.add_light(AREA),
    "point lamp of 0.1": lambda scene: scene.add_light(Light.point(PLACE, 300.0, radius=0.1)),
}


def scene_of(material, light):
    scene = Scene(materials=[material])
    scene.camera = Camera.look_at((0, -9, 4), (0, 0, 0.6), angle=35)
    scene.add_discs((0, 0, -1), (0, 0, 1), 6.0)
    scene.add_spheres(np.random.default_rng(7).normal(size=(12, 3)), np.full(12, 0.5))
    light(scene)
    return scene


@contextmanager
def one_way():
    """The world and what glows are found by rays alone, lamps are asked alone."""
    with (
        mock.patch.object(scene_program, "_gloss_asks_world", lambda packed: False),
        mock.patch.object(light_packing, "_shared_area", lambda emitters, shows, area: area),
        mock.patch.object(light_packing, "_is_seen", lambda light: False),
    ):
        yield


def measured(device, scene, samples):
    """The picture and the processor's seconds that it took, programs apart."""
    settings = Settings(samples=samples, max_depth=4)
    render(scene, 8, 8, settings, device=device)
    started = time.process_time()
    picture = render(scene, *SIZE, settings, device=device).pixels[..., :3].astype(np.float64)
    return picture, time.process_time() - started


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=16)
    samples = parser.parse_args().samples
    device = HeadlessDevice()
    print(f"{'light':22}{'material':22}{'samples':>10}{'time':>8}")
    for light_name, light in LIGHTS.items():
        for name, material in MATERIALS.items():
            scene = scene_of(material, light)
            truth, _ = measured(device, scene, 32 * samples)
            both, seconds = measured(device, scene, samples)
            with one_way():
                before, seconds_before = measured(device, scene, samples)
            ratio = (np.abs(before - truth).mean() / np.abs(both - truth).mean()) ** 2
            print(f"{light_name:22}{name:22}{ratio:9.1f}x{seconds / seconds_before:8.2f}", flush=True)


if __name__ == "__main__":
    main()
