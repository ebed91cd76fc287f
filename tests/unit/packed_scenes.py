"""Small scenes to be packed."""

import numpy as np

from addon.engine.primitives import Spheres
from addon.engine.scene import Camera, Material, Scene

LIMIT = 16384


def scene_of(*primitives, eye=(0.0, -5.0, 0.0), materials=1, **rest):
    scene = Scene(camera=Camera.look_at(eye, np.add(eye, (0, 1, 0))), materials=[Material()] * materials, **rest)
    for part in primitives:
        scene.add(part)
    return scene


def spheres(count, material=0, offset=0.0, seed=0):
    center = np.random.default_rng(seed).uniform(-1, 1, (count, 3)) + offset
    return Spheres(center=center, radius=np.linspace(0.01, 0.05, count) if count > 1 else [0.5], material=material)
