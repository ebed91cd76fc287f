# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances made by geometry nodes, read whole: their cost does not grow with a loop over copies.

Follows the order in which Blender makes instances (`object_dupli.cc`), so that the persistent ids, and with them
Object Info's Random, come out the same.
"""

from dataclasses import dataclass

import bpy
import numpy as np

from .keys import original_key
from .raw_attributes import values_of
from .visibility import shows_hair

#: Blender makes no instances that are nested deeper.
_DEEPEST = 7
#: The modifiers that give a mesh object more than a mesh.
_MAKERS = {"NODES", "MESH_SEQUENCE_CACHE"}
#: Of each component of a geometry set, in Blender's order: the kind of object that has such data, and the types of
#: object whose own data it is.
_COMPONENTS = {
    "mesh": ("MESH", {"MESH"}),
    "volume": ("VOLUME", {"VOLUME"}),
    "curves": ("CURVES", {"CURVE", "FONT", "CURVES"}),
    "pointcloud": ("POINTCLOUD", {"POINTCLOUD"}),
    "grease_pencil": ("GREASEPENCIL", {"GREASEPENCIL"}),
}
_WITH_GEOMETRY = {*("CURVE", "FONT", "SURFACE", "META"), *("CURVES", "POINTCLOUD", "VOLUME", "GREASEPENCIL")}


class UnknownInstancerError(Exception):
    """Only Blender's iterator knows these instances."""


@dataclass(frozen=True)
class _Level:
    """Where a level of instancing stands, n times.

    `columns` (n, 4, 4) float32: matrices to world, transposed as Blender stores them. `ids`: persistent ids, columns
    (n,) or one number, innermost first. `layers`: (GeometrySet, rows (n,)), innermost first.
    """

    columns: np.ndarray
    ids: tuple = ()
    layers: tuple = ()

    def within(self, number):
        """The same places, one level further in."""
        return _Level(self.columns, (number, *self.ids), self.layers)

    def each(self, columns, ids, geometry_set, rows):
        """For each place the instances of a geometry set: their `columns` (m, 4, 4), `ids` (m,) and `rows` (m,)."""
        count, copies = len(self.columns), len(columns)
        placed = np.matmul(columns, self.columns[:, None]).reshape(-1, 4, 4)
        outer_ids = tuple(values if np.ndim(values) == 0 else np.repeat(values, copies) for values in self.ids)
        layers = tuple((outer, np.repeat(values, copies)) for outer, values in self.layers)
        return _Level(placed, (np.tile(ids, count), *outer_ids), ((geometry_set, np.tile(rows, count)), *layers))

    def moved(self, columns):
        """What stands by one matrix more, transposed (4, 4), in each place."""
        return _Level(np.matmul(columns, self.columns), self.ids, self.layers)


class GeometryWalk:
    """Finds the copies that objects make by their evaluated geometry. `make`: the class of copies; `for_render`: which
    of Blender's two sets of flags counts."""

    def __init__(self, make, for_render):
        self.make, self._for_render = make, for_render
        self._sets = {}  # by object: what is asked for again comes as a copy
        self._references = {}
        self.uids = set()  # of the objects and collections that were met

    def own(self, obj, matrix):
        """The copies, one or none, of an object as it stands there itself by `matrix` (1, 4, 4)."""
        return [self.make(obj, kind, obj.data, matrix) for kind in self.kinds(obj)]

    def made(self, obj, matrix):
        """The copies that an object of the scene makes; UnknownInstancerError where these are not by geometry nodes."""
        root = _Root(self, obj)
        root.recurse(obj, _Level(matrix.transpose(0, 2, 1)), (obj,))
        return root.found

    def is_hidden(self, owner):
        """Whether an object or collection is hidden as such."""
        return owner.hide_render if self._for_render else owner.hide_viewport

    def set_of(self, obj):
        """The GeometrySet of an object, see `geometry_set_of`."""
        key = original_key(obj)
        if key not in self._sets:
            self._sets[key] = geometry_set_of(obj)
        return self._sets[key]

    def references_of(self, geometry_set):
        """What a GeometrySet, which lives as long as this, instances."""
        key = id(geometry_set)
        if key not in self._references:
            self._references[key] = geometry_set, geometry_set.instance_references()
        return self._references[key][1]

    def visible(self, collection):
        """The objects of a collection and its children that are not hidden, each once, in Blender's order."""
        order, visible = [], set()

        def visit(collection, hidden):
            hidden = hidden or self.is_hidden(collection)
            for obj in collection.objects:
                order.append(obj)
                if not hidden and not self.is_hidden(obj):
                    visible.add(obj)
            for child in collection.children:
                visit(child, hidden)

        visit(collection, False)
        return [obj for obj in dict.fromkeys(order) if obj in visible]

    def kinds(self, obj):
        """As what an object shows itself, besides what it makes."""
        if obj.data is None:
            return
        shows = obj.show_instancer_for_render if self._for_render else obj.show_instancer_for_viewport
        hair = len(obj.particle_systems) > 0
        if shows or not (hair or obj.is_instancer or _makes_instances(obj, self.set_of(obj))):
            yield obj.type
        if hair and shows_hair(obj):
            yield "HAIR"


class _Root:
    """The walk through what one object of the scene makes. `found`: the copies. In the methods `stack` are the objects
    that lead to a place: what is in itself ends there."""

    def __init__(self, walk, root):
        self._walk, self._root = walk, root
        self.found = []

    def recurse(self, obj, level, stack):
        """What an object makes that stands in the places of a level."""
        self._walk.uids.add(original_key(obj))
        if obj.type == "META" and level.ids:
            return
        if self._walk.is_hidden(obj):
            return
        if obj.is_instancer and obj.type == "FONT" and obj.instance_type == "VERTS":
            raise UnknownInstancerError
        geometry_set = self._walk.set_of(obj)
        if _makes_instances(obj, geometry_set):
            self._geometry_set(obj, geometry_set, level, stack, nested=False)
        elif obj.is_instancer:
            raise UnknownInstancerError

    def _geometry_set(self, obj, geometry_set, level, stack, nested):
        number = 0
        for kind, data in components_of(obj, geometry_set, nested):
            self._emit(obj, kind, data, level.within(number), geometry_set)
            number += 1
        cloud = geometry_set.instances_pointcloud()
        if cloud is None:
            return
        if number:
            level = level.within(number)
            if len(level.ids) >= _DEEPEST:
                return
        columns, ids, reference_of = _instances(cloud)
        for reference, rows in _by_reference(self._walk.references_of(geometry_set), reference_of):
            placed = level.each(columns[rows], ids[rows], geometry_set, rows)
            if isinstance(reference, bpy.types.Object):
                self._object(reference, placed, stack)
            elif len(placed.ids) >= _DEEPEST:
                continue
            elif isinstance(reference, bpy.types.Collection):
                self._collection(obj, reference, placed, stack)
            elif reference is not None:
                self._geometry_set(obj, reference, placed, stack, nested=True)

    def _object(self, obj, level, stack):
        """An instanced object, whose number is the innermost of the level's, and what it makes itself."""
        self._instance(obj, level)
        if obj not in stack and len(level.ids) < _DEEPEST:
            self.recurse(obj, level, (*stack, obj))

    def _collection(self, obj, collection, level, stack):
        """A collection that `obj` instances."""
        self._walk.uids.add(original_key(collection))
        offset = np.eye(4, dtype=np.float32)
        offset[3, :3] = -collection.instance_offset
        number = 0
        for child in self._walk.visible(collection):
            if child == obj:
                continue
            placed = level.moved(np.array(child.matrix_world, np.float32).T @ offset)
            self._instance(child, placed.within(number))
            if child not in stack and len(placed.ids) + 1 < _DEEPEST:
                self.recurse(child, placed.within(number + 1), (*stack, child))
            number += 2

    def _instance(self, obj, level):
        """An instanced object itself."""
        self._walk.uids.add(original_key(obj))
        is_original = obj.parent is not None and obj.parent.instance_type in ("VERTS", "FACES")
        if not is_original:  # those are there for their parent to put on its vertices or faces
            for kind in self._walk.kinds(obj):
                self._emit(obj, kind, obj.data, level)

    def _emit(self, obj, kind, data, level, owner=None):
        """Data that is shown in the places of a level. `owner`: the geometry set that it is of, None for an object's
        own."""
        if kind == "META":
            return
        self.found.append(
            self._walk.make(
                obj,
                kind,
                data,
                level.columns.transpose(0, 2, 1),
                is_own=owner is None,
                instancer=self._root,
                persistent_ids=level.ids,
                layers=level.layers,
                owner=owner,
            )
        )


def geometry_set_of(obj):
    """The evaluated geometry of an object as a GeometrySet; None where it has no more than its mesh, or nothing."""
    if obj.type == "MESH":
        if not any(modifier.type in _MAKERS for modifier in obj.modifiers):
            return None
    elif obj.type not in _WITH_GEOMETRY:
        return None
    return obj.evaluated_geometry()


def components_of(obj, geometry_set, nested):
    """(kind, data) of what a geometry set holds besides instances; at the top not the object's own data."""
    for name, (kind, own_types) in _COMPONENTS.items():
        if nested or obj.type not in own_types:
            data = getattr(geometry_set, name)
            if data is not None:
                yield kind, data


def _makes_instances(obj, geometry_set):
    if geometry_set is None:
        return False
    return geometry_set.instances_pointcloud() is not None or any(components_of(obj, geometry_set, False))


def _instances(cloud):
    """Of n instances the transposed matrices (n, 4, 4) float32, ids (n,) and the number of their reference (n,)."""
    transform = cloud.attributes["instance_transform"].data
    count = len(transform)
    columns = np.empty(count * 16, np.float32)
    transform.foreach_get("value", columns)
    references = values_of(cloud.attributes[".reference_index"])
    ids = np.arange(count, dtype=np.int32)
    given = cloud.attributes.get("id")
    if given is not None:
        ids = values_of(given)
        if len(np.unique(ids)) < count:  # Blender gives others instead, at random
            raise UnknownInstancerError
    return columns.reshape(-1, 4, 4), ids, references


def _by_reference(references, reference_of):
    """Yield (reference, its rows) of those that are used."""
    order = np.argsort(reference_of, kind="stable")
    ends = np.searchsorted(reference_of[order], np.arange(len(references) + 1))
    for i, reference in enumerate(references):
        if ends[i] < ends[i + 1]:
            yield reference, order[ends[i] : ends[i + 1]]
