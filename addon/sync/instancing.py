# SPDX-License-Identifier: GPL-3.0-or-later
"""All that stands in a Blender scene, as blocks of copies, by the shortest way that Blender gives.

From 4.5 on instances made by geometry nodes are read whole (`geometry_sets`). What only Blender's iterator knows,
older instancers and all in 4.2, comes one by one (`dupli_iterator`). Both ways give the same scene.
"""

from dataclasses import dataclass

import bpy
import numpy as np

from . import attributes, dupli_iterator
from .compat import has_geometry_sets
from .geometry_sets import GeometryWalk, UnknownInstancerError
from .keys import original_key


@dataclass(eq=False, slots=True)
class Copies:
    """Copies of one piece of data in the world.

    `kind`: the type of object that has such data: MESH, POINTCLOUD, CURVES, LIGHT, ... `obj`: the evaluated object
    whose data it is, or whose geometry nodes made it (then `is_own` is False). `matrices` (n, 4, 4) float32, object to
    world. `instancer`: the object of the scene that makes the copies, None for an object that stands there itself.
    `random_ids` (n,) as Blender has them, or `persistent_ids`, columns (n,) or one number, innermost first, from which
    they come. `layers`: (GeometrySet, rows (n,)) pairs, innermost first: of what instance attributes are read.
    `owner`: keeps `data` alive.
    """

    obj: object
    kind: str
    data: object
    matrices: np.ndarray
    is_own: bool = True
    instancer: object = None
    random_ids: np.ndarray | None = None
    persistent_ids: tuple = ()
    layers: tuple = ()
    owner: object = None

    def __len__(self):
        return len(self.matrices)

    @property
    def root(self):
        """The object of the scene to which the copies belong."""
        return self.instancer or self.obj

    @property
    def are_instances(self):
        """Whether they are more than an object of the scene, or its geometry, where it stands."""
        return self.instancer is not None and (self.obj != self.instancer or len(self) > 1)

    def values(self, keys):
        """The values of attributes by key, (n, 4) float32; what is not there is left out."""
        if not keys:
            return {}
        count = len(self)
        found = attributes.of_object(self.obj, keys, self.matrices, self._ids(), self.instancer)
        found = {key: np.broadcast_to(values, (count, 4)) for key, values in found.items()}
        for geometry_set, rows in reversed(self.layers):
            cloud = geometry_set.instances_pointcloud()
            found |= {key: values[rows] for key, values in attributes.of_instances(cloud, keys).items()}
        return found

    def _ids(self):
        if not self.persistent_ids:
            return self.random_ids
        ids = np.empty((len(self), len(self.persistent_ids)), np.int32)
        for column, values in zip(ids.T, self.persistent_ids, strict=True):
            column[:] = values
        return attributes.instance_random_ids(self.obj.name, self.instancer.name, ids.view(np.uint32))


#: Objects of these types show themselves alone, unless they are instancers or have modifiers of `_MAKERS`.
_PLAIN = {"MESH", "LIGHT", "CAMERA", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE"}
_MAKERS = {"NODES", "PARTICLE_SYSTEM", "MESH_SEQUENCE_CACHE"}


def copies_in(depsgraph, shown=None, iterate_all=False):
    """All `Copies` in a depsgraph, a list.

    `shown(obj)`: whether an object of the scene, and what it makes, is wanted. `iterate_all`: take the slow way, to
    compare.
    """
    shown = shown or (lambda obj: True)
    if iterate_all:
        return dupli_iterator.copies_by_iterator(depsgraph, Copies, shown)
    scene = SceneCopies(depsgraph, shown)
    found = [scene.of(number) for number in range(len(scene.objects))]
    by_iterator = {uid for uid, of_object in zip(scene.uids, found, strict=True) if of_object.by_iterator}
    return [copies for of_object in found for copies in of_object.copies] + scene.others(by_iterator)


@dataclass(frozen=True, slots=True)
class ObjectCopies:
    """The copies of an object and of what it makes. `by_iterator`: what it makes only Blender's iterator tells, before
    Blender 4.5 itself too. `uids`: of all objects and collections that had a part in it."""

    copies: tuple
    by_iterator: bool = False
    uids: frozenset = frozenset()


class SceneCopies:
    """The objects of a `depsgraph`: `objects`, their `uids` and where they are, `matrices` (n, 4, 4) float32."""

    def __init__(self, depsgraph, shown):
        self.depsgraph, self.shown = depsgraph, shown
        self._walk = GeometryWalk(Copies, depsgraph.mode == "RENDER")
        self.objects = list(depsgraph.objects)
        self.uids = [obj.original.session_uid for obj in self.objects]
        matrices = np.empty(len(self.objects) * 16, np.float32)
        depsgraph.objects.foreach_get("matrix_world", matrices)
        self.matrices = np.ascontiguousarray(matrices.reshape(-1, 4, 4).transpose(0, 2, 1))

    def of(self, number):
        """The `ObjectCopies` of an object by its number."""
        obj, matrix = self.objects[number], self.matrices[number : number + 1]
        if not self.shown(obj):
            return ObjectCopies(())
        # Most objects: nothing but a mesh, which needs no further questions.
        if obj.type in _PLAIN and not obj.is_instancer and not any(m.type in _MAKERS for m in obj.modifiers):
            return ObjectCopies((Copies(obj, obj.type, obj.data, matrix),))
        if not has_geometry_sets():
            return ObjectCopies((), by_iterator=True)
        self._walk.uids = set()
        own = self._walk.own(obj, matrix)
        try:
            return ObjectCopies((*own, *self._walk.made(obj, matrix)), uids=frozenset(self._walk.uids))
        except UnknownInstancerError:
            return ObjectCopies(tuple(own), by_iterator=True)

    def has_others(self):
        """Whether there may be instancers that are not in the list: those that do not show themselves."""
        name = "show_instancer_for_render" if self.depsgraph.mode == "RENDER" else "show_instancer_for_viewport"
        shows = np.ones(len(bpy.data.objects), bool)
        bpy.data.objects.foreach_get(name, shows)
        return not shows.all()

    def others(self, by_iterator):
        """What only Blender's iterator tells: the copies of the objects with the uids `by_iterator`, and those of
        instancers that are not in the list."""
        if not by_iterator and not self.has_others():
            return []
        late, listed = [], set(self.uids)

        def takes(obj):
            uid = original_key(obj)
            return uid in by_iterator or (uid not in listed and self._by_iterator(obj, late))

        own_too = not has_geometry_sets()
        found = dupli_iterator.copies_by_iterator(self.depsgraph, Copies, self.shown, takes, own_too)
        return found + late

    def _by_iterator(self, obj, late):
        """Whether the iterator has to give the copies of an instancer; else they are read, to `late`."""
        if not has_geometry_sets():
            return True
        matrix = np.array(obj.matrix_world, np.float32)[None]
        try:
            made = self._walk.made(obj, matrix)
        except UnknownInstancerError:
            return True
        late += made if self.shown(obj) else []
        return False
