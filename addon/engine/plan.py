"""What a scene needs of the GPU, known from counts alone: which records lie where, and whether all of them fit.

Nothing large is made here, so that a scene which does not fit is refused before time and memory are spent on it.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from . import layout
from .errors import SceneError
from .material_packing import attribute_names
from .primitives import BY_KIND

_INSTANCE = layout.KINDS.index("instance")
_IDENTITY = np.eye(4)

#: Where planes stand in the directory of attributes, (geometry number, kind number): in world space.
PLANE_ATTRIBUTES = (0, layout.KINDS.index("plane"))


@dataclass
class Plan:
    """Where records lie. G geometries, K kinds of primitives, both by number.

    `geometries`: those with primitives once each, number 0 is the world's shapes, also where there are none. `placed`:
    the `Instances` that show something. `in_world` (G,) bool: those whose own space is the world's, the shapes and what
    stands there once by the identity. `counts`, `bases` (G, K) int64: number of primitives, index of the first among
    the records of its kind. `attributes`: an `AttributePlan`.
    """

    geometries: list
    placed: list
    in_world: np.ndarray
    counts: np.ndarray
    bases: np.ndarray
    attributes: "AttributePlan"

    def number(self, geometry):
        return self._numbers[id(geometry)]

    def __post_init__(self):
        self._numbers = {id(geometry): number for number, geometry in enumerate(self.geometries)}
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
    def leaves(self):
        """Leaves of the upper tree: instances, the world's shapes as one of them; 0 where there are no instances."""
        return sum(map(len, self.placed)) + self.shapes if self.placed else 0

    @cached_property
    def instance_surface_first(self):
        """Where the second record of the instances begins in their texture."""
        return layout.next_start(self.leaves * layout.INSTANCE.texels)

    @cached_property
    def instance_texels(self):
        return self.instance_surface_first + self.leaves * layout.INSTANCE_SURFACE.texels

    @cached_property
    def top_nodes(self):
        """Nodes of the upper tree, whose leaves hold one instance each."""
        return max(self.leaves - 1, 1) if self.leaves else 0

    @cached_property
    def most_nodes(self):
        """An upper bound of the nodes of all trees: no leaf of a binary tree is empty."""
        sizes = self.counts.sum(axis=1)
        return self.top_nodes + int(np.maximum(sizes[sizes > 0] - 1, 1).sum())

    def check(self, limit):
        """Raise SceneError where a texture would need more than `limit` texels: what, how many, what to do."""
        for cls, count in zip(BY_KIND, self.counts.sum(axis=0).tolist(), strict=True):
            for record in (cls.record, cls.surface_record):
                check_texels(count * record.texels, limit, f"{count} {cls.kind}s")
        check_texels(self.instance_texels, limit, f"{self.leaves} instances")
        check_texels(self.attributes.texels, limit, f"the values of {len(self.attributes.names)} attributes")
        entries = len(self.attributes.directory)
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


@dataclass
class AttributePlan:
    """The attributes that materials name, and where their values lie.

    `names`: by number. `directory` (names * (G + 1) * KIND_COUNT,) of `layout.ATTRIBUTE`, see there. `first`: first
    texel by (name, geometry number, kind number); the instances stand at geometry G. `texels`: how many in all.
    """

    names: tuple
    directory: np.ndarray
    first: dict
    texels: int

    def number(self, name):
        """Number of an attribute."""
        return self.names.index(name)


def make_plan(scene):
    """The `Plan` of a scene."""
    placed = [p for p in scene.instances if len(p) and len(p.geometry)]
    geometries = list({id(g): g for g in (scene.shapes, *(p.geometry for p in placed))}.values())
    counts = np.zeros((len(geometries), len(BY_KIND)), np.int64)
    for row, geometry in zip(counts, geometries, strict=True):
        for label, part in geometry.kinds():
            row[label] = len(part)
    bases = np.cumsum(counts, axis=0) - counts
    plan = Plan(geometries, placed, np.arange(len(geometries)) == 0, counts, bases, None)
    for p in placed:
        plan.in_world[plan.number(p.geometry)] |= len(p) == 1 and np.array_equal(p.matrices[0], _IDENTITY)
    plan.attributes = _plan_attributes(scene, plan)
    return plan


def _plan_attributes(scene, plan):
    names = attribute_names(scene)
    shape = (len(names), len(plan.geometries) + 1, len(layout.KINDS))
    width, base, texels = (np.zeros(shape, np.int64) for _ in range(3))
    for place, primitives in _parts_with_attributes(scene, plan):
        base[:, *place] = plan.bases[place] if place[1] < len(BY_KIND) else 0
        for number, name in enumerate(names):
            values = primitives.attributes.get(name)
            if values is not None:
                width[number, *place], texels[number, *place] = values.shape[1], values.shape[0] * values.shape[1]
    for number, name in enumerate(names):
        if any(name in p.attributes for p in plan.placed):
            width[number, -1, _INSTANCE], texels[number, -1, _INSTANCE] = 1, plan.leaves
    first = (np.cumsum(texels) - texels.ravel()).reshape(shape)
    directory = layout.ATTRIBUTE.zeros(width.size)
    directory["first"], directory["first_high"] = layout.split_index(first.ravel())
    directory["base"], directory["base_high"] = layout.split_index(base.ravel())
    directory["width"] = width.ravel()
    places = {(names[n], g, k): int(first[n, g, k]) for n, g, k in np.argwhere(width).tolist()}
    return AttributePlan(names, directory, places, int(texels.sum()))


def _parts_with_attributes(scene, plan):
    """((geometry number, kind number), primitives) for all that can have attributes of its own."""
    for number, geometry in enumerate(plan.geometries):
        for label, part in geometry.kinds():
            if part.attributes:
                yield (number, label), part
    planes = scene.joined_planes()
    if planes is not None and planes.attributes:
        yield PLANE_ATTRIBUTES, planes
