# SPDX-License-Identifier: GPL-3.0-or-later
"""Many copies of shapes in the world, without a loop over the copies."""

import numpy as np

from ..engine.primitives import Similarity, invertible, keeps_shapes
from ..engine.scene import Geometry, Instance, Planes
from .shapes import Shape


def placeable(content, matrices):
    """Where copies of a `Shape` or Geometry can stand, of matrices (n, 4, 4) object to world: (n,) bool.

    An infinite plane needs its X and Y axes only.
    """
    finite = np.isfinite(matrices).all(axis=(1, 2))
    world = np.where(finite[:, None, None], matrices, 0.0)
    if isinstance(content, Shape):
        world = world @ content.local
    if is_plane(content):
        world[:, :3, 2] = np.cross(world[:, :3, 0], world[:, :3, 1])
    return finite & invertible(world)


def is_plane(content):
    """Whether a `Shape` or Geometry is the infinite plane."""
    return isinstance(content, Shape) and isinstance(content.primitives[0], Planes)


def place_shape(scene, shape, matrices, materials, name):
    """Put copies of a `Shape` into the engine scene: `matrices` (n, 4, 4) object to world, the material of each slot.

    Copies that keep their form become primitives in world space; the others, stretched, instances.
    """
    world = matrices @ shape.local
    if is_plane(shape):
        scene.add(planes_at(shape.primitives[0], world, materials))
        return
    kept = keeps_shapes(world)
    if kept.any():
        moves = Similarity.of(world[kept])
        for part in shape.primitives:
            scene.add(_copies(part, moves, materials))
    if not kept.all():
        geometry = Geometry(*shape.primitives, name=name)
        scene.instances.extend(Instance(geometry, matrix, tuple(materials), name) for matrix in world[~kept])


def _copies(part, moves, materials):
    """Rows of `part` once for each of `moves`, with the scene's materials in place of slots."""
    count = len(part)
    rows = part.take(np.tile(np.arange(count), len(moves.scale))).transformed(moves.repeated(count))
    rows.material = _materials(materials, rows.material)
    return rows


def _materials(materials, slots):
    return np.asarray(materials, np.int32)[np.clip(slots, 0, len(materials) - 1)]


def planes_at(plane, matrices, materials):
    """The infinite plane (one row, through the origin, normal Z) under matrices (n, 4, 4), stretched ones too."""
    x, y = matrices[:, :3, 0], matrices[:, :3, 1]
    normal = np.cross(x, y)
    # Mirrored: still the side of Z, where that is not scaled to zero.
    normal *= np.where(np.einsum("ni,ni->n", normal, matrices[:, :3, 2]) < 0.0, -1.0, 1.0)[:, None]
    return Planes(
        point=matrices[:, :3, 3],
        normal=normal,
        material=np.full(len(matrices), _materials(materials, plane.material)[0]),
        meridian=x,
        tile=np.linalg.norm(x, axis=1),
    )
