# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of Blender's data as they are: read whole, in numbers of their own type."""

import numpy as np

#: Of each of Blender's data types: where its values are, their dtype, how many.
TYPES = {
    "FLOAT": ("value", np.float32, 1),
    "INT": ("value", np.int32, 1),
    "INT8": ("value", np.int8, 1),
    "BOOLEAN": ("value", bool, 1),
    "FLOAT2": ("vector", np.float32, 2),
    "FLOAT_VECTOR": ("vector", np.float32, 3),
    "FLOAT_COLOR": ("color", np.float32, 4),
    "BYTE_COLOR": ("color", np.float32, 4),
    "QUATERNION": ("value", np.float32, 4),
    "FLOAT4": ("vector", np.float32, 4),
    "INT32_2D": ("value", np.int32, 2),
}


#: Beyond it squares of lengths leave the range of float32, and nothing is drawn.
FARTHEST = 1e18


def are_places(positions):
    """(n,) bool: whether points (n, 3) are finite, and not farther than what can be drawn."""
    return (np.abs(positions) <= FARTHEST).all(axis=1)


def values_of(attribute):
    """The values of an attribute, (n,), or (n, width) where they have several numbers."""
    member, dtype, width = TYPES[attribute.data_type]
    values = np.empty(len(attribute.data) * width, dtype)
    if len(values):
        attribute.data.foreach_get(member, values)
    return values.reshape(-1, width) if width > 1 else values


def read_raw(data, name, domain, data_type):
    """The values of the attribute `name` of evaluated data; None where it is absent, of another domain or type."""
    attribute = data.attributes.get(name)
    if attribute is None or attribute.domain != domain or attribute.data_type != data_type:
        return None
    return values_of(attribute)


def read_positions(data):
    """The points (n, 3) float32 of a mesh, point cloud or curves."""
    found = read_raw(data, "position", "POINT", "FLOAT_VECTOR")
    return np.empty((0, 3), np.float32) if found is None else found


def read_corner_vertices(mesh):
    """The vertex (n,) int32 of each corner of a mesh."""
    found = read_raw(mesh, ".corner_vert", "CORNER", "INT")
    return np.empty(0, np.int32) if found is None else found
