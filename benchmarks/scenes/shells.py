"""Shells: snails of overlapping spheres whose distance and size grow by the same share from each to the next."""

import numpy as np

from examples.standard_scenes import add_square, nff_material, standard_scene

SPHERES = 480  # of one shell
TURNS = 6.0
GROWTH = 1.75  # from turn to turn


def shells(size=3):
    """480 n^2 spheres in n^2 shells on a square, 4320 by default."""
    scene = standard_scene((0.4, -3.0, 2.3), (0, 0, -0.1), (0, 0, 1), 0.0, [(4, -3, 8), (-6, -6, 5)])
    add_square(scene, 12.0, -0.5, nff_material((0.8, 0.7, 0.5), 0.9))
    row = (np.arange(size) - (size - 1) / 2.0) / size
    place = np.stack(np.meshgrid(row, row, indexing="ij"), axis=-1).reshape(-1, 2)
    center, radius = _shell()
    facing = 2.4 * np.arange(len(place))  # no two alike
    turn = np.stack([np.cos(facing), -np.sin(facing), np.sin(facing), np.cos(facing)], axis=-1).reshape(-1, 2, 2)
    flat = np.einsum("nij,kj->nki", turn, center[:, :2]) / size + 2.2 * place[:, None]
    height = np.broadcast_to(center[:, 2] / size - 0.5, flat.shape[:2])
    pearl = scene.add_material(nff_material((0.9, 0.8, 0.75), 0.8, 0.2, 30.0))
    points = np.concatenate([flat, height[..., None]], axis=-1).reshape(-1, 3)
    scene.add_spheres(points, np.tile(radius / size, len(place)), pearl)
    return scene


def _shell():
    """Centers (SPHERES, 3) and radii of a helix on a cone about Z, over z = 0; its outermost turn has radius 0.7."""
    turn = np.linspace(0.0, TURNS, SPHERES)
    scale = GROWTH ** (turn - TURNS)
    angle = 2.0 * np.pi * turn
    radius = 0.28 * scale
    center = np.stack([0.7 * scale * np.cos(angle), 0.7 * scale * np.sin(angle), 1.1 * (1.0 - scale) + 0.28], axis=-1)
    return center, radius
