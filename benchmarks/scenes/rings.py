"""Rings: a pyramid of knots, each of six pentagons that hang in one another."""

import numpy as np

from examples.standard_scenes import add_square, nff_material, standard_scene


def rings(size=7):
    """60 n (n + 1) (2 n + 1) / 6 spheres and cylinders in n layers of 1, 4, 9 ... knots, 8400 by default."""
    lights = [(-3, -7, 12), (10, -4, 6), (-8, 3, 5)]
    scene = standard_scene((0.2, -4.4, 2.2), (0, 0, -0.45), (0, 0, 1), 0.0, lights)
    add_square(scene, 20.0, -1.55, nff_material((1.0, 0.75, 0.33), 0.8))
    centers, scale = _pyramid(size)
    corners = centers[:, None, None] + scale * _knot()
    for color, part in (((0.9, 0.75, 0.5), slice(0, 3)), ((0.5, 0.75, 0.9), slice(3, 6))):
        metal = scene.add_material(nff_material(color, 0.6, 0.4, 10.0))
        base, apex = corners[:, part], np.roll(corners[:, part], 1, axis=2)
        scene.add_spheres(base.reshape(-1, 3), 0.08 * scale, metal)
        scene.add_cylinders(base.reshape(-1, 3), apex.reshape(-1, 3), 0.065 * scale, metal, caps=False)
    return scene


def _pyramid(size):
    """Centers (n, 3) of the knots and the radius of one; a pyramid fills the same space at any size."""
    scale = 1.2 / size
    layers = []
    for layer in range(size):
        row = 2.1 * (np.arange(layer + 1) - layer / 2.0)
        x, y = np.meshgrid(row, row, indexing="ij")
        layers.append(np.stack([x, y, np.full_like(x, 1.6 * ((size - 1) / 2.0 - layer))], axis=-1).reshape(-1, 3))
    return scale * np.concatenate(layers), scale


def _knot():
    """Corners (6, 5, 3) of pentagons of radius 1: each takes every other one of the ten twofold axes of the
    icosahedron in its plane, so that where two planes meet the one has a corner and the other the middle of an edge."""
    angle = np.radians(18.0 + 72.0 * np.arange(5))
    first = np.stack([np.cos(angle), np.sin(angle), np.zeros(5)], axis=-1)
    tilt, around = np.arctan(2.0), np.radians(72.0 * np.arange(5))
    axes = np.stack([np.sin(tilt) * np.cos(around), np.sin(tilt) * np.sin(around), np.full(5, np.cos(tilt))], axis=-1)
    middle = axes + np.array([0.0, 0.0, 1.0])
    middle /= np.linalg.norm(middle, axis=-1, keepdims=True)
    turns = 2.0 * middle[:, :, None] * middle[:, None] - np.eye(3)  # by half a circle, which takes +Z to the axis
    return np.concatenate([first[None], np.einsum("nij,kj->nki", turns, first)])
