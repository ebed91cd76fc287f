"""What lies where in the textures, known by the identity of what it was made from. It outlives a scene: the next one
finds there what it shares with this one.

Nothing here keeps a scene alive, and nothing that is taken ever moves. Packing works on a copy, and what is no longer
needed is given back when it is done: until the next scene is packed, the one before can be drawn.
"""

import itertools
import weakref
from dataclasses import dataclass, field

import numpy as np

from . import bvh, data_texture, layout, reference
from .arena import Arena
from .primitives import BY_KIND


@dataclass(frozen=True)
class BuiltTree:
    """What is left of a tree when it has been packed. `bounds` (2, 3) of everything, `root` the index of its node;
    `sah_cost` 0 where it was not asked for. `is_grid`: it is a grid in the room of so many nodes."""

    bounds: np.ndarray
    root: int
    nodes: int
    depth: int
    sah_cost: float
    is_grid: bool = False

    @property
    def reference(self):
        """What leads there, to be split by `reference.split_index`."""
        leaf = int(reference.pack_leaf(layout.GRID_KIND, 1, 0)) if self.is_grid else 0
        return self.root + (leaf << reference.LOW_BITS)


@dataclass(frozen=True)
class KeptTree:
    """Of a tree what a refit needs: its form, and its `sah_cost` when it was built."""

    form: bvh.Form
    sah_cost: float


@dataclass
class Resident:
    """A geometry whose records lie in the textures.

    `token`: the one that it had. `moved`: the origin as bytes that these were moved by, empty for none.
    `bases`, `counts` (K,): first record and number of each kind. `attributes`: (first texel, texels) by name and kind
    number. `kept`: None where a tree is not worth it. `quick`: whether the tree was built quickly, for the time being.
    """

    geometry: weakref.ref
    token: object
    moved: bytes
    bases: np.ndarray
    counts: np.ndarray
    tree: BuiltTree
    attributes: dict
    kept: KeptTree | None = None
    quick: bool = False

    def is_of(self, geometry, moved):
        """Whether this is what the records of a geometry are."""
        return self.moved == moved and self.token is geometry.token


@dataclass
class ResidentInstances:
    """The records of all instances and the tree over them. `key`: what they were made from; `placed`: weak references
    to the `Instances`. `first`, `rows`: of their texture. `attributes`: (first texel, texels) by name. `quick`: as of a
    `Resident`."""

    key: tuple
    placed: tuple
    first: int
    rows: int
    tree: BuiltTree
    attributes: dict
    kept: KeptTree | None
    quick: bool = False

    def is_of(self, placed, key):
        """Whether these are the records of `Instances`."""
        return self.key == key and is_same(self.placed, placed)


@dataclass
class ResidentPlanes:
    """The attributes of planes: (first texel, texels) by name. `planes`: weak references."""

    planes: tuple
    attributes: dict


@dataclass(eq=False)
class ResidentImage:
    """An image: its record, its texels, and a number that no other image ever has."""

    image: weakref.ref
    record: np.ndarray
    first: int
    texels: int
    serial: int = field(default_factory=itertools.count().__next__)


@dataclass
class Upload:
    """Texels (height, width, 4) of which the first `count` go to texel `first` and on of a data texture. `anew`:
    nothing that is there is needed any more."""

    first: int
    texels: np.ndarray
    count: int
    anew: bool = False


class Residency:
    """All that is resident. `arenas`: records of a kind of primitives, nodes, rows of instances, texels of attributes
    and of images. `geometries`: by number. `reduced`: warnings of images that were too large as they are. `origin`:
    what positions are relative to. `stack_size`: of a traversal."""

    def __init__(self):
        self.arenas = {name: Arena() for name in (*layout.KINDS[: len(BY_KIND)], "node", "row", "attribute", "image")}
        self.geometries, self.images, self.reduced = {}, (), ()
        self.instances, self.planes = None, ResidentPlanes((), {})
        self.origin, self.stack_size = None, 0

    def copy(self):
        """One that changes independently."""
        new = Residency()
        new.__dict__.update(self.__dict__)
        new.arenas = {name: arena.copy() for name, arena in self.arenas.items()}
        new.geometries = dict(self.geometries)
        return new

    @property
    def quick(self):
        """The `Resident`s and `ResidentInstances` whose trees were built quickly, for the time being."""
        return [resident for resident in (*self.geometries.values(), self.instances) if resident and resident.quick]

    @property
    def numbers(self):
        """Numbers of the geometries by the identity of the weak reference to each: there is only one to a thing, and it
        stays the same when the thing is gone."""
        return {id(resident.geometry): number for number, resident in self.geometries.items()}

    def drop_geometry(self, resident):
        """Give back where a geometry lies."""
        for cls, base, count in zip(BY_KIND, resident.bases.tolist(), resident.counts.tolist(), strict=True):
            self.arenas[cls.kind].give_back(base, count)
        self.arenas["node"].give_back(resident.tree.root, resident.tree.nodes)
        self.drop_attributes(resident)

    def drop_instances(self, resident):
        self.arenas["row"].give_back(resident.first, resident.rows)
        self.arenas["node"].give_back(resident.tree.root, resident.tree.nodes)
        self.drop_attributes(resident)

    def drop_attributes(self, resident):
        for first, texels in resident.attributes.values():
            self.arenas["attribute"].give_back(first, texels)

    def unused_textures(self):
        """Names of the textures in which nothing lies."""
        names = {cls.kind: (cls.record.texture, cls.surface_record.texture) for cls in BY_KIND}
        names |= {"node": ("nodes",), "row": ("instances",), "attribute": ("attributes",), "image": ("images",)}
        return [name for arena, arena_names in names.items() if not self.arenas[arena].end for name in arena_names]

    def fits(self, limit):
        """Whether all lies within the first `limit` texels of its texture, and where references can lead."""
        ends = {name: arena.end for name, arena in self.arenas.items()}
        texels = {cls.kind: max(cls.record.texels, cls.surface_record.texels) for cls in BY_KIND}
        texels |= {"node": layout.NODE.texels}
        if any(ends[name] > 1 << reference.INDEX_BITS for name in texels):
            return False
        texels |= {"row": data_texture.WIDTH}
        return all(end * texels.get(name, 1) <= max(limit, data_texture.WIDTH) for name, end in ends.items())


def is_same(references, things):
    """Whether weak references are to these very things, in this order."""
    return len(references) == len(things) and all(r() is t for r, t in zip(references, things, strict=True))


def references(things):
    return tuple(map(weakref.ref, things))
