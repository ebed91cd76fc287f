"""Spheres at random in a box."""

import numpy as np

from examples.standard_scenes import nff_material, standard_scene


def random_box(count=10_000, seed=0):
    """`count` spheres of like size in a cube of side 2, float32, a tenth of it by volume, some of them mirrors."""
    random = np.random.default_rng(seed)
    center = random.random((count, 3), np.float32) * np.float32(2.0) - np.float32(1.0)
    radius = random.uniform(0.2, 0.7, count).astype(np.float32) * np.float32(count ** (-1 / 3))
    scene = standard_scene((2.2, -3.1, 1.7), (0, 0, 0), (0, 0, 1), 0.0, [(5, -10, 20), (-10, -10, 8)])
    matte = scene.add_material(nff_material((0.7, 0.5, 0.3), 1.0))
    mirror = scene.add_material(nff_material((0.8, 0.8, 0.9), 0.5, 0.5, 20.0))
    scene.add_spheres(center, radius, np.where(np.arange(count) % 4 == 0, mirror, matte))
    return scene
