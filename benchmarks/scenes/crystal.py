"""A ball-and-stick crystal: zinc blende, two kinds of atoms, each bonded to four of the other."""

import numpy as np

from examples.standard_scenes import nff_material, standard_scene

_FACES = np.array([(0, 0, 0), (0, 2, 2), (2, 0, 2), (2, 2, 0)])  # of a cell of side 4
_BONDS = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)])


def crystal(size=8):
    """8 n^3 spheres and 16 n^3 - 12 n^2 + 3 n cylinders: bonds that leave the block of n^3 cells are left out."""
    scene = standard_scene((0.9, -1.6, 1.1), (0, 0, 0), (0, 0, 1), 0.0, [(3, -6, 4), (-5, -4, 6)], angle=40.0)
    first, bonded = _atoms(size)
    scale = 1.0 / (4 * size)

    def placed(points):
        return (points - 2 * size + 0.5) * scale

    zinc = scene.add_material(nff_material((0.55, 0.6, 0.7), 0.7, 0.3, 40.0))
    sulfur = scene.add_material(nff_material((0.9, 0.8, 0.2), 0.9, 0.1, 40.0))
    stick = scene.add_material(nff_material((0.6, 0.6, 0.6), 0.9))
    scene.add_spheres(placed(first), 0.55 * scale, zinc)
    scene.add_spheres(placed(first + 1), 0.75 * scale, sulfur)
    scene.add_cylinders(placed(bonded[:, 0]), placed(bonded[:, 1]), 0.2 * scale, stick, caps=False)
    return scene


def _atoms(size):
    """Atoms of the first kind (n, 3) in quarters of a cell, the others stand at (1, 1, 1) from each; and the bonds
    (m, 2, 3) between atoms that are both there."""
    cells = np.stack(np.meshgrid(*[np.arange(size)] * 3, indexing="ij"), axis=-1).reshape(-1, 1, 3)
    first = (4 * cells + _FACES).reshape(-1, 3)
    ends = first[:, None] + _BONDS
    inside = ((ends - 1 >= 0) & (ends - 1 < 4 * size)).all(axis=-1)
    starts = np.broadcast_to(first[:, None], ends.shape)
    return first, np.stack([starts[inside], ends[inside]], axis=1)
