"""How much noise the choice of bright directions saves: equal samples, against directions by the cosine alone.

    python benchmarks/world_light_noise.py [--samples 16]

A floor under balls in three worlds; for each the standard error of a pixel at equal samples, relative to its light, and
the ratio of variances, which is how many times more samples the cosine alone would take.
"""

import argparse
import sys
from pathlib import Path
from unittest import mock

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from addon.engine import Camera, Image, Material, Scene, Settings, World, render, world_light
from addon.engine.devices.headless import HeadlessDevice

SIDE = 1024


def panorama(sky, sun, size):
    """A sky that is brighter above, with a sun of `size` texels a side."""
    pixels = np.ones((SIDE // 2, SIDE, 3), np.float32) * np.linspace(0.1, 1.0, SIDE // 2)[:, None, None] * sky
    pixels[400 : 400 + size, 500 : 500 + size] = sun
    return pixels


WORLDS = {
    "white": panorama(0.0, 0.0, 1) + 1.0,
    "cloudy sky": panorama(0.8, 3.0, 60),
    "sun of half a degree": panorama(0.3, 3e4, 2),
}


def scene_under(pixels):
    scene = Scene(materials=[Material(diffuse=0.8)])
    scene.camera = Camera.look_at((0, -9, 4), (0, 0, 0.6), angle=35)
    scene.add_plane((0, 0, -1), (0, 0, 1))
    scene.add_spheres(np.random.default_rng(7).normal(size=(20, 3)), np.full(20, 0.5))
    scene.world = World((1.0, 1.0, 1.0), image=scene.add_image(Image(pixels)), lights=True, detail=SIDE)
    return scene


def noise(device, pixels, samples, truth, share):
    """Root of the mean square error over light; `share`: of directions by the cosine, None for the engine's choice."""
    frozen = mock.patch.object(world_light, "_COSINE_SHARES", (share,)) if share else mock.MagicMock()
    with frozen:
        picture = render(scene_under(pixels), 96, 72, Settings(samples=samples), device=device).pixels[..., :3]
    inside = np.all(np.abs(truth) < 4.0 * np.median(truth), axis=-1)
    return float(np.sqrt(np.mean((picture - truth)[inside] ** 2)) / truth[inside].mean())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=16)
    samples = parser.parse_args().samples
    device = HeadlessDevice()
    print(f"{'world':24}{'chosen':>10}{'cosine':>10}{'variance':>12}")
    for name, pixels in WORLDS.items():
        truth = render(scene_under(pixels), 96, 72, Settings(samples=64 * samples), device=device).pixels[..., :3]
        chosen, cosine = (noise(device, pixels, samples, truth, share) for share in (None, 1.0))
        print(f"{name:24}{chosen:10.2%}{cosine:10.2%}{(cosine / chosen) ** 2:11.1f}x")


if __name__ == "__main__":
    main()
