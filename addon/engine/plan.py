"""What a scene needs of the GPU, known from counts alone, and whether all of it fits.

Nothing large is made here, so that a scene which does not fit is refused before time and memory are spent on it.
"""

import itertools
import weakref
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from . import data_texture, layout, reference
from .errors import SceneError
from .material_packing import attribute_names
from .primitives import BY_KIND, invertible
from .scene import Geometry
from .threads import pieces

_INSTANCE = layout.KINDS.index("instance")
_IDENTITY = np.eye(4)
_EMPTY = Geometry(name="none")
#: Blocks of instances that are checked together, where they are small.
_BLOCKS = 256

#: Geometries of so many primitives are packed one at a time and their trees kept for refits, and only these have shapes
#: outside of their trees: smaller ones are built in no time, many at once.
LARGE = 4096
#: Kinds of which the world's shapes have at most so many stand outside of its tree, where it is large.
_FEW = 4

#: Where planes stand in the directory of attributes, (geometry number, kind number): in world space.
PLANE_ATTRIBUTES = (0, layout.KINDS.index("plane"))


@dataclass
class Plan:
    """What there is. G geometries, K kinds of primitives, both by number.

    `geometries`: those with primitives once each, number 0 is the world's shapes, also where there are none; an empty
    one where a number is free. `placed`: the `Instances` that show something, `placed_numbers` those of their
    geometries. `in_world` (G,) bool: those whose own
    space is the world's, the shapes and what stands there once by the identity. `counts` (G, K) int64: number of
    primitives. `attributes`: an `AttributePlan`.
    """

    geometries: list
    placed: list
    in_world: np.ndarray
    counts: np.ndarray
    attributes: "AttributePlan"

    def __post_init__(self):
        numbers = {id(geometry): number for number, geometry in enumerate(self.geometries)}
        self.placed_numbers = [numbers[id(placed.geometry)] for placed in self.placed]
        self.shapes = int(self.counts[0].sum()) > 0

    @cached_property
    def built(self):
        """Numbers of the geometries that have primitives, hence a tree."""
        return np.flatnonzero(self.counts.sum(axis=1))

    @cached_property
    def largest(self):
        """Number of the geometry with the most primitives; -1 where the upper tree has more leaves."""
        sizes = self.counts.sum(axis=1)
        return int(np.argmax(sizes)) if sizes.max() >= self.leaves else -1

    @cached_property
    def outside(self):
        """(K,) bool: the kinds of which the world's shapes stand in no tree: each ray tests them first. A floor below
        a million spheres would have a leaf's test of triangles beside that of spheres, and vector processors do both
        whenever they do one."""
        counts = self.counts[0]
        return (counts > 0) & (counts <= _FEW) & (counts.sum() >= LARGE)

    @cached_property
    def counts_in_trees(self):
        """(G, K) int64: number of primitives that stand in trees."""
        return np.concatenate([np.where(self.outside, 0, self.counts[:1]), self.counts[1:]])

    def parts(self, number):
        """A geometry's primitives by kind number: those in its tree, those outside of it."""
        outside = self.outside if number == 0 else np.zeros(len(BY_KIND), bool)
        parts = list(self.geometries[number].kinds())
        return tuple({label: part for label, part in parts if outside[label] == out} for out in (False, True))

    @cached_property
    def leaves(self):
        """Leaves of the upper tree: instances, the world's shapes as one of them; 0 where there are no instances."""
        return sum(map(len, self.placed)) + self.shapes if self.placed else 0

    def instance_surface_first(self, first):
        """Where the second records of the instances begin if the first ones do at texel `first`."""
        return data_texture.next_start(first + self.leaves * layout.INSTANCE.texels)

    def instance_texels(self, first):
        """Texels of the instances from texel `first` on."""
        return self.instance_surface_first(first) + self.leaves * layout.INSTANCE_SURFACE.texels - first

    @cached_property
    def top_nodes(self):
        """Nodes of the upper tree, whose leaves hold one instance each."""
        return max(self.leaves - 1, 1) if self.leaves else 0

    @cached_property
    def most_nodes(self):
        """An upper bound of the nodes of all trees."""
        return self.top_nodes + self.most_nodes_of(self.built)

    def most_nodes_of(self, numbers):
        """An upper bound of the nodes of geometries' trees: no leaf of a binary tree is empty."""
        return int(np.maximum(self.counts[numbers].sum(axis=1) - 1, 1).sum())

    def check(self, limit):
        """Raise SceneError where a texture would need more than `limit` texels: what, how many, what to do."""
        for cls, count in zip(BY_KIND, self.counts.sum(axis=0).tolist(), strict=True):
            for record in (cls.record, cls.surface_record):
                most = min(limit, record.texels << reference.INDEX_BITS)
                check_texels(count * record.texels, most, f"{count} {cls.kind}s")
        check_texels(self.instance_texels(0), limit, f"{self.leaves} instances")
        values = sum(self.attributes.texels.values())
        check_texels(values, limit, f"the values of {len(self.attributes.names)} attributes")
        entries = self.attributes.width.size
        check_texels(entries * layout.ATTRIBUTE.texels, limit, f"a directory of {entries} attributes of geometries")
        primitives = int(self.counts.sum())
        check_texels(self.most_nodes * layout.NODE.texels, limit, f"the trees of {primitives + self.leaves} shapes")


def check_texels(texels, limit, what):
    """Raise SceneError where `what` needs more texels than a texture holds."""
    if texels > limit:
        raise SceneError(
            f"the scene is too large for this device: {what} need {texels} texels, a texture here holds {limit}; "
            "render it in parts, with fewer of them, or on a device with larger textures"
        )


def check_matrices(scene, before):
    """Raise SceneError where the camera or an instance has a matrix that is not finite or cannot be inverted, or the
    camera's window is empty. Those of the `Residency` before are known to be right."""
    camera = np.asarray(scene.camera.matrix, np.float64)
    if not invertible(camera[None])[0]:
        raise SceneError("the camera's matrix is not finite or not one of three axes of length 1")
    left, right, bottom, top = scene.camera.window
    if not np.isfinite(scene.camera.window).all() or left == right or bottom == top:
        raise SceneError(f"the camera's window {tuple(scene.camera.window)} has no width or no height")
    known = {id(placed()) for placed in before.instances.placed} if before.instances else ()
    new = [placed for placed in scene.instances if id(placed) not in known]
    for start in range(0, len(new), _BLOCKS):
        blocks = new[start : start + _BLOCKS]
        if max(map(len, blocks)) < _BLOCKS and invertible(np.concatenate([placed.matrices for placed in blocks])).all():
            continue
        for placed in blocks:
            if not all(invertible(placed.matrices[rows]).all() for rows in pieces(len(placed))):
                raise SceneError(
                    f"instance {placed.name!r} has a scale of 0, axes in one plane or a matrix that is not finite"
                )


@dataclass
class AttributePlan:
    """The attributes that materials name. N names, G geometries and the instances, K kinds, all by number.

    `width` (N, G + 1, K) int64: texels that each primitive has. `texels`: of all of them by (name, geometry number,
    kind number), the instances stand at geometry G; what lacks the attribute is left out.
    """

    names: tuple
    width: np.ndarray
    texels: dict

    def number(self, name):
        """Number of an attribute."""
        return self.names.index(name)

    @property
    def instances(self):
        """Names of those that instances have."""
        return tuple(name for name, geometry, _ in self.texels if geometry == self.width.shape[1] - 1)

    def directory(self, first, bases):
        """Records of `layout.ATTRIBUTE`; `first`: texel by the keys of `texels`, `bases` (G, K) int64: index of the
        first primitive of each geometry among the records of its kind."""
        base, start = np.zeros(self.width.shape, np.int64), np.zeros(self.width.shape, np.int64)
        base[:, : len(bases), : bases.shape[1]] = bases
        for name, *place in self.texels:
            start[self.number(name), *place] = first[name, *place]
        directory = layout.ATTRIBUTE.zeros(start.size)
        directory["first"], directory["first_high"] = reference.split_index(start.ravel())
        directory["base"], directory["base_high"] = reference.split_index(np.where(self.width, base, 0).ravel())
        directory["width"] = self.width.ravel()
        return directory


def make_plan(scene, numbers=None):
    """The `Plan` of a scene. `numbers`: see `Residency.numbers`."""
    placed = [p for p in scene.instances if len(p) and len(p.geometry)]
    geometries = _numbered(scene.shapes, list({id(p.geometry): p.geometry for p in placed}.values()), numbers or {})
    counts = np.zeros((len(geometries), len(BY_KIND)), np.int64)
    sizes = [(number, label, len(part)) for number, g in enumerate(geometries) for label, part in g.parts]
    if sizes:
        rows, labels, lengths = zip(*sizes, strict=True)
        counts[rows, labels] = lengths
    plan = Plan(geometries, placed, np.arange(len(geometries)) == 0, counts, None)
    for p, number in zip(placed, plan.placed_numbers, strict=True):
        if len(p) == 1 and (p.matrices[0] == _IDENTITY).all():
            plan.in_world[number] = True
    plan.attributes = _plan_attributes(scene, plan)
    return plan


def _numbered(shapes, others, numbers):
    """Geometries by number: those that have one keep it, the others take what is free."""
    found = {0: shapes} | {number: g for g in others if (number := numbers.get(id(weakref.ref(g)), 0))}
    free = (number for number in itertools.count(1) if number not in found)
    kept = set(map(id, found.values()))
    found |= {number: g for g, number in zip((g for g in others if id(g) not in kept), free, strict=False)}
    return [found.get(number, _EMPTY) for number in range(max(found) + 1)]


def _plan_attributes(scene, plan):
    names = attribute_names(scene)
    width = np.zeros((len(names), len(plan.geometries) + 1, len(layout.KINDS)), np.int64)
    rows = np.zeros(width.shape, np.int64)
    if not names:
        return AttributePlan(names, width, {})
    for place, primitives in _parts_with_attributes(scene, plan):
        for number, name in enumerate(names):
            values = primitives.attributes.get(name)
            if values is not None:
                rows[number, *place], width[number, *place] = values.shape[:2]
    for number, name in enumerate(names):
        if any(name in p.attributes for p in plan.placed):
            width[number, -1, _INSTANCE], rows[number, -1, _INSTANCE] = 1, plan.leaves
    texels = {(names[n], g, k): int(rows[n, g, k] * width[n, g, k]) for n, g, k in np.argwhere(width).tolist()}
    return AttributePlan(names, width, texels)


def _parts_with_attributes(scene, plan):
    """((geometry number, kind number), primitives) for all that can have attributes of its own."""
    for number, geometry in enumerate(plan.geometries):
        for label, part in geometry.kinds():
            if part.attributes:
                yield (number, label), part
    planes = scene.joined_planes()
    if planes is not None and planes.attributes:
        yield PLANE_ATTRIBUTES, planes
