"""Closed rooms, where no ray leaves: one full of glass, one of mirrors."""

import numpy as np

from examples.standard_scenes import nff_material, standard_scene

_CORNERS = np.stack(np.meshgrid(*[(-1.0, 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
_WALLS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]  # -x +x -y +y -z +z


def glass_room(size=5):
    """n^3 glass spheres in a matte room of 12 triangles, 125 by default: nearly each hit sends two rays on."""
    scene = _room([nff_material(color, 1.0) for color in ((0.8, 0.3, 0.2), (0.2, 0.6, 0.3), (0.8, 0.8, 0.75))])
    glass = scene.add_material(nff_material((1.0, 1.0, 1.0), 0.0, 0.1, 100.0, 0.9, 1.5))
    scene.add_spheres(_grid(size), 0.36 * 1.4 / size, glass)
    return scene


def mirror_room(size=5):
    """n^3 matte spheres in a room of six mirrors, 125 by default: each ray goes on until the depth is reached."""
    scene = _room([nff_material(color, 0.2, 0.8) for color in ((0.9, 0.7, 0.6), (0.6, 0.8, 0.7), (0.8, 0.8, 0.8))])
    matte = scene.add_material(nff_material((0.8, 0.6, 0.3), 1.0))
    scene.add_spheres(_grid(size), 0.3 * 1.4 / size, matte)
    return scene


def _room(walls):
    """A cube of side 2 seen from within; a wall material for each axis."""
    scene = standard_scene(
        (-0.2, -0.95, 0.15), (0, 0.5, 0), (0, 0, 1), 0.0, [(0.1, -0.85, 0.85), (-0.8, 0.1, 0.9)], 75.0
    )
    corners = _CORNERS[np.array(_WALLS)]
    for axis, wall in enumerate(walls):
        a, b, c, d = np.moveaxis(corners[2 * axis : 2 * axis + 2], 1, 0)
        index = scene.add_material(wall)
        scene.add_triangles(np.concatenate([a, a]), np.concatenate([b, c]), np.concatenate([c, d]), index)
    return scene


def _grid(size):
    row = 1.4 * ((np.arange(size) + 0.5) / size - 0.5)
    return np.stack(np.meshgrid(row, row + 0.25, row, indexing="ij"), axis=-1).reshape(-1, 3)
