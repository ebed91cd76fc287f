# SPDX-License-Identifier: GPL-3.0-or-later
"""Many copies of shapes and geometries in the world, without a loop over the copies."""

import weakref
from dataclasses import dataclass, field

import numpy as np

from ..engine.primitives import AxialStretch, Similarity, invertible, keeps_round, keeps_shapes, thickened
from ..engine.scene import Geometry, Instances, Planes, Visibility
from .comparing import same_rows, same_values
from .shapes import Shape

#: From so many copies on shapes are a geometry of their own, which nothing else that moves touches.
MANY = 256


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


@dataclass(frozen=True)
class Placed:
    """What a `Stand` is in an engine scene: rows of primitives `in_world`, which others join there, `instances` and
    `planes`. `stretched`: the geometry of shapes that do not keep their form."""

    visibility: Visibility
    in_world: tuple = ()
    instances: tuple = ()
    planes: tuple = ()
    stretched: Geometry | None = None


def place(stand, previous=None):
    """What a `Stand` is (`Placed`), whose matrices are those of `placed_matrices`, good ones alone: primitives of the
    world where they keep their form, else instances. `previous`: what it was before."""
    if is_plane(stand.drawn):
        return Placed(stand.visibility, planes=(planes_at(stand),))
    if not isinstance(stand.drawn, Shape):
        return Placed(stand.visibility, instances=(_instances(stand, stand.drawn),))
    axis = stand.drawn.axis
    kept = keeps_shapes(stand.matrices) if axis is None else keeps_round(stand.matrices, axis)
    rows, instances, stretched = (), (), None
    if kept.any():
        whole = stand.take(kept)
        moves = Similarity.of(whole.matrices) if axis is None else AxialStretch.of(whole.matrices, axis)
        rows = tuple(_copies(part, moves, whole) for part in stand.drawn.primitives)
        if previous is not None and _same(rows, previous.in_world):
            rows = previous.in_world
        if len(whole.matrices) >= MANY:
            instances, rows = (_in_world(Geometry(*rows, name=stand.name), stand.visibility),), ()
            if previous is not None and previous.instances:
                _replace(instances[0].geometry, previous.instances[0].geometry)
    if not kept.all():
        stretched = previous.stretched if previous is not None else None
        stretched = stretched or Geometry(*stand.drawn.primitives)
        stretched.name = stand.name
        instances += (_instances(stand.take(~kept), stretched),)
    return Placed(stand.visibility, rows, instances, stretched=stretched)


def _same(rows, others):
    """Whether tuples of primitives are equal, kind by kind."""
    if [(type(part), len(part)) for part in rows] != [(type(part), len(part)) for part in others]:
        return False
    return all(map(same_rows, rows, others))


def _in_world(geometry, visibility):
    """A geometry whose places are those of the world, and its materials those of the scene."""
    return Instances(geometry, np.eye(4), None, geometry.name, visibility=visibility)


def _replace(geometry, before):
    if geometry.counts() == before.counts():
        geometry.replaces = weakref.ref(before)


class World:
    """The primitives of the world that rays of a visibility see, of all that was placed: one Geometry.

    `pieces`: the rows of each that was placed, a tuple each. `instances`: the geometry as such, since the world's own
    geometry is seen by all.
    """

    def __init__(self, pieces, visibility, previous=None):
        self._pieces = pieces
        geometry = None if previous is None else previous.patched(pieces)
        if geometry is None:
            geometry = Geometry(*(part for piece in pieces for part in piece), name="world")
            if previous is not None:
                _replace(geometry, previous.geometry)
        self.geometry = geometry
        self.instances = _in_world(geometry, visibility)

    def patched(self, pieces):
        """A Geometry of other pieces, where rows stand in the same places of it; None where they do not."""
        changes = {}
        if len(pieces) != len(self._pieces):
            return None
        firsts = {}
        for old, new in zip(self._pieces, pieces, strict=True):
            if old is not new and len(old) != len(new):
                return None
            for was, part in zip(old, new, strict=True):
                first = firsts.get(type(was), 0)
                firsts[type(was)] = first + len(was)
                if part is not was:
                    if not _alike(part, was):
                        return None
                    changes.setdefault(type(part), []).append((first, part))
        geometry = Geometry(
            *(_with_rows(part, changes.get(type(part), ())) for _, part in self.geometry.kinds()), name="world"
        )
        geometry.replaces = weakref.ref(self.geometry)
        return geometry


def _arrays(part):
    """The arrays of primitives by name, those of attributes by (name,)."""
    columns = {column.name: getattr(part, column.name) for column in part.columns}
    return columns | {(name,): values for name, values in part.attributes.items()}


def _alike(part, other):
    """Whether rows can take the place of others."""
    if type(part) is not type(other) or len(part) != len(other) or part.attributes.keys() != other.attributes.keys():
        return False
    others = _arrays(other)
    return all(a.dtype == others[name].dtype and a.shape == others[name].shape for name, a in _arrays(part).items())


def _with_rows(part, changes):
    """Primitives with other rows in some places: `changes`, (first row, primitives) each."""
    if not changes:
        return part
    arrays = _arrays(part)
    for first, rows in changes:
        for name, values in _arrays(rows).items():
            place = slice(first, first + len(rows))
            if not same_values(arrays[name][place], values):
                if not arrays[name].flags.owndata or arrays[name] is _arrays(part)[name]:
                    arrays[name] = np.array(arrays[name])
                arrays[name][place] = values
    attributes = {name[0]: values for name, values in arrays.items() if isinstance(name, tuple)}
    columns = {name: values for name, values in arrays.items() if not isinstance(name, tuple)}
    return part._with(columns | {"attributes": attributes})


def _instances(stand, geometry):
    return Instances(
        geometry,
        stand.matrices,
        stand.materials,
        stand.name,
        visibility=stand.visibility,
        attributes=stand.attributes,
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
