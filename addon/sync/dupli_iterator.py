# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own iterator over all objects and instances, one by one: it knows every instancer, but no attributes."""

from array import array

import numpy as np

from .visibility import shows_hair


class _Group:
    """Copies of one piece of data by one instancer, as they come. `kinds`: as what the object shows."""

    def __init__(self, instance, obj):
        self.obj = instance.instance_object if instance.is_instance else obj
        self.instancer = instance.parent if instance.is_instance else None
        self.data, self.is_own = obj.data, obj.data == self.obj.data
        self.kinds = [obj.type] if instance.show_self else []
        if self.is_own and shows_hair(obj):
            self.kinds.append("HAIR")
        self.rows, self.random_ids = array("f"), array("q")  # 12 numbers a copy: the upper rows of its matrix

    def copies(self, make):
        matrices = np.zeros((len(self.random_ids), 4, 4), np.float32)
        matrices[:, 3, 3] = 1.0
        matrices[:, :3] = np.array(self.rows, np.float32).reshape(-1, 3, 4)
        is_instance = self.instancer is not None
        common = {
            "is_own": self.is_own,
            "instancer": self.instancer,
            "random_ids": np.array(self.random_ids, np.int64).astype(np.uint32) if is_instance else None,
        }
        return [make(self.obj, kind, self.data, matrices, **common) for kind in self.kinds]


def copies_by_iterator(depsgraph, make, shown, takes=None, own_too=False):
    """All copies in a depsgraph, made by `make`. `shown(obj)`: whether an object of the scene is wanted.

    `takes(obj)`: whether the instances that an object makes are wanted; with it those alone are given, with `own_too`
    together with the object itself. None of Blender's instances lives longer than its step, so values are copied.
    """
    groups, wanted = {}, {}
    for instance in depsgraph.object_instances:
        is_instance = instance.is_instance
        if not is_instance and takes is not None and not own_too:
            continue
        obj = instance.object
        root = instance.parent if is_instance else obj
        if root not in wanted:
            wanted[root] = (takes is None or takes(root)) and shown(root)
        if not wanted[root]:
            continue
        data = obj.data
        if data is None:
            continue
        # What an instance gives as its object is a passing copy; these stay where they are as long as the loop runs.
        key = instance.instance_object, data, root
        group = groups.get(key)
        if group is None:
            group = groups[key] = _Group(instance, obj)
        matrix, rows = instance.matrix_world, group.rows
        rows.extend(matrix[0])
        rows.extend(matrix[1])
        rows.extend(matrix[2])
        group.random_ids.append(instance.random_id)
    return [copies for group in groups.values() for copies in group.copies(make)]
