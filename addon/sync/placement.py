# SPDX-License-Identifier: GPL-3.0-or-later
"""Many copies of shapes in the world, without a loop over the copies."""

import numpy as np

from ..engine.primitives import Similarity
from ..engine.scene import Geometry, Instance, Planes

#: Inverse of the condition number up to which a matrix of float32 values can be inverted.
_SINGULAR = 1e-7


class Similarities:
    """Similarity transforms (n,), row by row on primitives of n rows; otherwise as `engine.primitives.Similarity`."""

    def __init__(self, rotation, scale, translation):
        self.rotation, self.scale, self.translation = rotation, scale, translation

    @classmethod
    def of(cls, matrices):
        """From matrices (n, 4, 4) that are known to keep shapes."""
        linear = matrices[:, :3, :3]
        scale = np.cbrt(np.linalg.det(linear))
        return cls(linear / scale[:, None, None], scale, matrices[:, :3, 3])

    def repeated(self, count):
        """Each transform `count` times in a row."""
        return Similarities(*(np.repeat(a, count, axis=0) for a in (self.rotation, self.scale, self.translation)))

    def points(self, points):
        return self.directions(points) * self.scale[:, None] + self.translation

    def directions(self, directions):
        return np.einsum("nij,nj->ni", self.rotation, directions)


def invertible(matrices):
    """Which of matrices (n, 4, 4) can be inverted: (n,) bool; those that are not finite cannot."""
    finite = np.isfinite(matrices).all(axis=(1, 2))
    x, y, z = np.moveaxis(np.where(finite[:, None, None], matrices, 0.0)[:, :3, :3], 2, 0)
    adjugate = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=1)
    determinant = np.einsum("ni,ni->n", x, adjugate[:, 0])
    size = np.sqrt((x * x + y * y + z * z).sum(axis=1) * (adjugate * adjugate).sum(axis=(1, 2)))
    return np.abs(determinant) > _SINGULAR * size  # the inverse is the adjugate over the determinant


def keeps_shapes(matrices):
    """Which of invertible matrices (n, 4, 4) are similarities, as `Similarity.of` decides: (n,) bool."""
    linear = matrices[:, :3, :3]
    gram = np.swapaxes(linear, 1, 2) @ linear
    squared = np.trace(gram, axis1=1, axis2=2) / 3.0
    deviation = np.abs(gram - squared[:, None, None] * np.eye(3)).max(axis=(1, 2))
    return (deviation <= 2.0 * Similarity.TOLERANCE * squared) & (np.linalg.det(linear) > 0.0)


def place_shape(scene, shape, matrices, materials, name):
    """Put copies of a `Shape` into the engine scene: `matrices` (n, 4, 4) object to world, the material of each slot.

    Copies that keep their form become primitives in world space; the others, stretched, instances.
    """
    world = matrices @ shape.local
    if isinstance(shape.primitives[0], Planes):
        scene.add(planes_at(shape.primitives[0], world, materials))
        return
    kept = keeps_shapes(world)
    if kept.any():
        moves = Similarities.of(world[kept])
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
    normal *= np.sign(np.einsum("ni,ni->n", normal, matrices[:, :3, 2]))[:, None]  # mirrored: still the side of Z
    return Planes(
        point=matrices[:, :3, 3],
        normal=normal,
        material=np.full(len(matrices), _materials(materials, plane.material)[0]),
        meridian=x,
        tile=np.linalg.norm(x, axis=1),
    )
