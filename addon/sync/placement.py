# SPDX-License-Identifier: GPL-3.0-or-later
"""Many copies of shapes and geometries in the world, without a loop over the copies."""

from dataclasses import dataclass, field

import numpy as np

from ..engine.primitives import AxialStretch, Similarity, invertible, keeps_round, keeps_shapes, thickened
from ..engine.scene import Geometry, Instances, Planes, Visibility
from .shapes import Shape


@dataclass
class Stand:
    """Copies of a `Shape` or Geometry that have slots and visibility in common.

    `materials`: the scene's material of each slot. `matrices` (n, 4, 4), object to world. `attributes`: (n, 4) by key.
    """

    drawn: object
    materials: tuple
    visibility: Visibility
    name: str
    matrices: np.ndarray
    attributes: dict = field(default_factory=dict)

    def take(self, rows):
        """Those of `rows` (n,) bool."""
        if rows.all():
            return self
        attributes = {key: values[rows] for key, values in self.attributes.items()}
        return Stand(self.drawn, self.materials, self.visibility, self.name, self.matrices[rows], attributes)


def placed_matrices(drawn, matrices):
    """Where copies of a `Shape` or Geometry stand, of matrices (n, 4, 4) object to world, and which can: (n,) bool.

    What is flattened along one axis gets a trace of thickness. An infinite plane needs its X and Y axes only.
    """
    if is_plane(drawn):
        finite = np.isfinite(matrices).all(axis=(1, 2))
        world = np.where(finite[:, None, None], matrices, 0.0).astype(np.float64)
        world[:, :3, 2] = np.cross(world[:, :3, 0], world[:, :3, 1])
        return matrices, finite & invertible(world)
    local = drawn.local if isinstance(drawn, Shape) else None
    whole = local is None or (local == np.eye(4)).all()
    with np.errstate(invalid="ignore"):
        world = matrices if whole else matrices @ local
    good = invertible(world)
    if not good.all():
        world = thickened(world)
        good = invertible(world)
    return world, good


def is_plane(drawn):
    """Whether a `Shape` or Geometry is the infinite plane."""
    return isinstance(drawn, Shape) and isinstance(drawn.primitives[0], Planes)


class Placement:
    """Puts copies into an engine scene: as primitives of the world where they keep their form, else as instances.

    What not all rays see stands in a geometry a visibility, since the world's own is seen by all.
    """

    def __init__(self, scene):
        self._scene = scene
        self._worlds = {}

    def place(self, stand):
        """Place a `Stand` whose matrices are those of `placed_matrices`, good ones alone."""
        if is_plane(stand.drawn):
            self._scene.add(planes_at(stand))
        elif isinstance(stand.drawn, Shape):
            self._shapes(stand)
        else:
            self._instances(stand, stand.drawn)

    def finish(self):
        """Add the geometries of what not all rays see."""
        for visibility, world in self._worlds.items():
            self._scene.instances.append(Instances(world, np.eye(4), None, world.name, visibility=visibility))
        self._worlds = {}

    def _shapes(self, stand):
        axis = stand.drawn.axis
        kept = keeps_shapes(stand.matrices) if axis is None else keeps_round(stand.matrices, axis)
        if kept.any():
            world, whole = self._world(stand.visibility), stand.take(kept)
            moves = Similarity.of(whole.matrices) if axis is None else AxialStretch.of(whole.matrices, axis)
            for part in stand.drawn.primitives:
                world.add(_copies(part, moves, whole))
        if not kept.all():
            self._instances(stand.take(~kept), Geometry(*stand.drawn.primitives, name=stand.name))

    def _world(self, visibility):
        if visibility == Visibility.ALL:
            return self._scene.shapes
        if visibility not in self._worlds:
            self._worlds[visibility] = Geometry(name="world")
        return self._worlds[visibility]

    def _instances(self, stand, geometry):
        self._scene.instances.append(
            Instances(
                geometry,
                stand.matrices,
                stand.materials,
                stand.name,
                visibility=stand.visibility,
                attributes=stand.attributes,
            )
        )


def _copies(part, moves, stand):
    """Rows of `part` once for each of `moves`, with the scene's materials in place of slots."""
    count = len(part)
    if count > 1:
        moves = moves.repeated(count)
    rows = part.take(np.tile(np.arange(count), len(stand.matrices))).transformed(moves)
    rows.material = _materials(stand.materials, rows.material)
    rows.attributes = rows.attributes | {
        key: np.repeat(values, count, axis=0)[:, None] for key, values in stand.attributes.items()
    }
    return rows


def _materials(materials, slots):
    if len(materials) == 1:
        return np.broadcast_to(np.int32(materials[0]), slots.shape)
    return np.asarray(materials, np.int32)[np.clip(slots, 0, len(materials) - 1)]


def planes_at(stand):
    """The infinite plane (one row, through the origin, normal Z) in each place of a `Stand`, stretched ones too."""
    (plane,) = stand.drawn.primitives
    x, y, z = (stand.matrices[:, :3, column].astype(np.float64) for column in range(3))
    normal = np.cross(x, y)
    # Mirrored: still the side of Z, where that is not scaled to zero.
    normal *= np.where(np.einsum("ni,ni->n", normal, z) < 0.0, -1.0, 1.0)[:, None]
    return Planes(
        point=stand.matrices[:, :3, 3],
        normal=normal,
        material=np.full(len(normal), _materials(stand.materials, plane.material)[0]),
        meridian=x,
        tile=np.linalg.norm(x, axis=1),
        visibility=np.full(len(normal), int(stand.visibility)),
        attributes=stand.attributes,
    )
