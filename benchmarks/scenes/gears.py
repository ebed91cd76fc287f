"""Gears: a cube of meshing toothed wheels of clear glass of little refraction."""

import numpy as np

from examples.standard_scenes import add_square, nff_material, standard_scene

TEETH = 36
TRIANGLES = 16 * TEETH  # of a gear: four quadrilaterals a tooth at the rim, two faces of 4 TEETH corners and a center


def gears(size=4):
    """n^3 gears of 576 triangles over a square, 36,866 triangles by default."""
    lights = [(-10, -10, 10), (10, -8, 12), (0, -12, 3), (-4, 8, 10), (6, 6, 8)]
    scene = standard_scene((-1.1, -2.4, 1.6), (0, 0, -0.05), (0, 0, 1), 0.0, lights)
    add_square(scene, 12.0, -1.0, nff_material((1.0, 0.75, 0.33), 0.8))
    pitch = 1.0 / size  # the distance of two axes; a tooth reaches past the half of it
    place = np.stack(np.meshgrid(*[np.arange(size)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    turn = np.where(place[:, :2].sum(axis=1) % 2, np.pi / TEETH, 0.0)
    center = 1.5 * pitch * (place - (size - 1) / 2.0)
    faces = _turned(1.5 * pitch * _gear(), turn) + center[:, None, None]
    for shade in range(4):
        color = np.array([(0.9, 0.9, 0.9), (0.9, 0.6, 0.6), (0.6, 0.9, 0.6), (0.6, 0.6, 0.9)][shade])
        glass = nff_material(color, 0.0, 0.1, 20.0, 0.8, 1.1)
        chosen = faces[place.sum(axis=1) % 4 == shade].reshape(-1, 3, 3)
        if len(chosen):
            scene.add_triangles(*np.moveaxis(chosen, 1, 0), scene.add_material(glass))
    return scene


def _gear():
    """Triangles (TRIANGLES, 3, 3) of a wheel of pitch radius 1/2 about Z, their front outside."""
    tooth = 2.0 * np.pi / TEETH
    angle = (np.arange(TEETH)[:, None] * tooth + np.array([-0.34, -0.2, 0.2, 0.34]) * tooth).ravel()
    radius = np.tile([0.465, 0.53, 0.53, 0.465], TEETH)
    rim = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(len(angle), 0.15)], axis=-1)
    after = np.roll(rim, -1, axis=0)
    below = rim * (1.0, 1.0, -1.0), after * (1.0, 1.0, -1.0)
    top, bottom = np.broadcast_to((0.0, 0.0, 0.15), rim.shape), np.broadcast_to((0.0, 0.0, -0.15), rim.shape)
    corners = [(top, rim, after), (bottom, below[1], below[0]), (below[0], below[1], after), (below[0], after, rim)]
    return np.stack([np.stack(corner, axis=1) for corner in corners]).reshape(-1, 3, 3)


def _turned(faces, angle):
    """Triangles (n, k, 3, 3): those of `faces` (k, 3, 3) turned about Z by each angle (n,)."""
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    turns = np.stack([c, -s, zero, s, c, zero, zero, zero, zero + 1.0], axis=-1).reshape(-1, 3, 3)
    return np.einsum("nij,kcj->nkci", turns, faces)
