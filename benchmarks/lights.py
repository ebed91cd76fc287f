"""Many lights: what 1,000 cost beside 10, and how near the picture is: `python -m benchmarks.lights [--size 128]`.

A floor with balls under lights that hang all over it, as bright together whatever their number. For one sample, where
those far off count as one, and for some samples, where lights are chosen by chance. Printed are seconds of tracing,
shadow rays a hit, the seconds of the loop over all lights, and the median, the 99th percentile and the mean of the
difference from it, noise included.
"""

import argparse
from contextlib import contextmanager

import numpy as np

from addon.engine import Camera, Light, Material, Scene, Session, Settings, World, light_packing
from addon.engine.devices.headless import HeadlessDevice


def hall(count, seed=0):
    """A floor of 20 x 20 with balls under `count` lights, some of which are spots or areas."""
    rng = np.random.default_rng(seed)
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material(diffuse=0.8)])
    scene.camera = Camera.look_at((0.0, -16.0, 9.0), (0.0, 0.0, 0.0))
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    scene.add_spheres(np.column_stack([rng.uniform(-8.0, 8.0, (60, 2)), np.full(60, 0.5)]), 0.5)
    places = np.column_stack([rng.uniform(-10.0, 10.0, (count, 2)), rng.uniform(1.5, 4.0, count)])
    for number, place in enumerate(places):
        scene.add_light(_light(number % 4, place, 4000.0 / count, rng))
    return scene


def _light(kind, place, watts, rng):
    color = rng.uniform(0.3, 1.0, 3)
    if kind == 0:
        return Light.spot(place, rng.normal(size=3) - [0.0, 0.0, 1.5], watts, 1.2, 0.3, color)
    if kind == 1:
        return Light.area(place, (0.3, 0.0, 0.0), (0.0, -0.3, 0.0), watts, color)
    return Light.point(place, watts, color, radius=0.05 * (kind - 2))


@contextmanager
def asking(few):
    """So many lights are all asked."""
    before, light_packing.FEW_LIGHTS = light_packing.FEW_LIGHTS, few
    yield
    light_packing.FEW_LIGHTS = before


def drawn(scene, size, samples, device):
    """(pixels, seconds of tracing, shadow rays a hit)."""
    session = Session(device)
    session.load(scene, Settings(samples=samples, count_rays=True))
    session.start(size, size)
    while session.step(60.0):
        pass
    statistics, pixels = session.statistics(), session.pixels()[..., :3]
    session.free()
    return pixels, statistics["seconds"]["trace"], statistics["rays"]["shadow"] / statistics["rays"]["eye_hit"]


def measure(count, size, samples, device):
    scene = hall(count)
    pixels, seconds, rays = drawn(scene, size, samples, device)
    with asking(1 << 30):
        truth, all_seconds, _ = drawn(scene, size, samples, device)
    error = np.abs(pixels - truth).sum(axis=-1) / np.maximum(truth.sum(axis=-1), 1e-3)
    print(
        f"{count:7} {samples:8} {seconds:8.2f} {rays:8.1f} {all_seconds:8.2f} {np.median(error):9.2%} "
        f"{np.quantile(error, 0.99):9.2%} {pixels.mean() / truth.mean():9.4f}",
        flush=True,
    )
    return seconds


def main():
    parser = argparse.ArgumentParser(prog="python -m benchmarks.lights", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--counts", type=int, nargs="+", default=[10, 100, 1000])
    parser.add_argument("--size", type=int, default=128)
    parser.add_argument("--samples", type=int, nargs="+", default=[1, 16])
    arguments = parser.parse_args()
    device = HeadlessDevice()
    print(f"{device.name}, {arguments.size} x {arguments.size}")
    print(f"{'lights':>7} {'samples':>8} {'s':>8} {'rays/hit':>8} {'all: s':>8} {'median':>9} {'99%':>9} {'mean':>9}")
    for samples in arguments.samples:
        seconds = [measure(count, arguments.size, samples, device) for count in arguments.counts]
        print(f"{arguments.counts[-1]} lights cost {seconds[-1] / seconds[0]:.1f} times {arguments.counts[0]}")


if __name__ == "__main__":
    main()
