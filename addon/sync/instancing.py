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


@dataclass(eq=False)
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


def copies_in(depsgraph, shown=None, iterate_all=False):
    """All `Copies` in a depsgraph, a list.

    `shown(obj)`: whether an object of the scene, and what it makes, is wanted. `iterate_all`: take the slow way, to
    compare.
    """
    shown = shown or (lambda obj: True)
    if iterate_all or not has_geometry_sets():
        return dupli_iterator.copies_by_iterator(depsgraph, Copies, shown)
    return _Scene(depsgraph, shown).copies()


class _Scene:
    """The objects of a depsgraph, read by geometry sets, with the iterator for instancers of the older kinds."""

    def __init__(self, depsgraph, shown):
        self._depsgraph, self._shown = depsgraph, shown
        self._walk = GeometryWalk(Copies, depsgraph.mode == "RENDER")
        self._read = {}  # by uid of an instancer: whether the iterator has to give its copies

    def copies(self):
        found = []
        objects = list(self._depsgraph.objects)
        matrices = np.empty(len(objects) * 16, np.float32)
        self._depsgraph.objects.foreach_get("matrix_world", matrices)
        matrices = np.ascontiguousarray(matrices.reshape(-1, 4, 4).transpose(0, 2, 1))
        for i, obj in enumerate(objects):
            if self._shown(obj):
                matrix = matrices[i : i + 1]
                # Most objects: nothing but a mesh, which needs no further questions.
                if obj.type == "MESH" and not len(obj.modifiers) and not obj.is_instancer:
                    found.append(Copies(obj, "MESH", obj.data, matrix))
                else:
                    found += self._object(obj, matrix)
            else:
                self._read[original_key(obj)] = False
        if self._needs_iterator():
            late = []
            found += dupli_iterator.copies_by_iterator(
                self._depsgraph, Copies, self._shown, lambda obj: self._by_iterator(obj, late)
            )
            found += late
        return found

    def _object(self, obj, matrix):
        """The copies of an object and of what it makes; without the latter where only the iterator knows them."""
        own, made = self._walk.own(obj, matrix), []
        try:
            made = self._walk.made(obj, matrix)
            self._read[original_key(obj)] = False
        except UnknownInstancerError:
            self._read[original_key(obj)] = True
        return own + made

    def _needs_iterator(self):
        """Whether there may be instances that are not read yet. An instancer that does not show itself stands in no
        list of objects."""
        if any(self._read.values()):
            return True
        name = "show_instancer_for_render" if self._depsgraph.mode == "RENDER" else "show_instancer_for_viewport"
        shows = np.ones(len(bpy.data.objects), bool)
        bpy.data.objects.foreach_get(name, shows)
        return not shows.all()

    def _by_iterator(self, obj, late):
        """Whether the iterator has to give the copies of an instancer; one met for the first time is read, to `late`,
        if that is possible."""
        uid = original_key(obj)
        if uid not in self._read:
            matrix = np.array(obj.matrix_world, np.float32)[None]
            try:
                made = self._walk.made(obj, matrix)
                self._read[uid] = False
                late += made if self._shown(obj) else []
            except UnknownInstancerError:
                self._read[uid] = True
        return self._read[uid]
