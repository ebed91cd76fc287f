# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's meshes from arrays, and from those that stand for exact shapes."""

import bpy
import numpy as np


def new_mesh(name, proxy):
    """A Blender mesh from a `ProxyMesh`."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(proxy.vertices.tolist(), [], proxy.faces)
    mesh.polygons.foreach_set("use_smooth", proxy.smooth)
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", proxy.uv.astype("f").reshape(-1))
    mesh.update()
    return mesh


def mesh_of_points(name, points):
    """A mesh of vertices (n, 3) alone."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(points))
    mesh.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
    return mesh


def set_attribute(data, name, data_type, member, values, domain="POINT"):
    """Give `data` an attribute of `values`."""
    attribute = data.attributes.get(name) or data.attributes.new(name, data_type, domain)
    attribute.data.foreach_set(member, np.ascontiguousarray(values, np.float32).ravel())
    return attribute


def new_polygon_mesh(name, size, points, normals=None):
    """A mesh of polygons with `size` (n,) vertices each: points (c, 3) of all one after the other, and their normals
    (c, 3), None for flat faces. Equal points become one vertex."""
    vertices, index = _welded(size, points)
    mesh = mesh_of_points(name, vertices)
    mesh.loops.add(len(index))
    mesh.loops.foreach_set("vertex_index", index.astype(np.int32))
    mesh.polygons.add(len(size))
    mesh.polygons.foreach_set("loop_start", (np.cumsum(size) - size).astype(np.int32))
    mesh.update(calc_edges=True)
    if normals is None:
        mesh.polygons.foreach_set("use_smooth", np.zeros(len(size), bool))
    else:
        attribute = set_attribute(mesh, "custom_normal", "FLOAT_VECTOR", "vector", normals, "CORNER")
        if not mesh.has_custom_normals:  # before Blender 4.5 that name meant nothing
            mesh.attributes.remove(attribute)
            mesh.normals_split_custom_set(normals.astype(np.float32))
    mesh.update()
    return mesh


def _welded(size, points):
    """Vertices (v, 3), and the vertex of each corner (c,). Polygons that repeat a vertex, or that have the vertices of
    an earlier one (its back), keep vertices of their own: Blender's meshes hold no such faces."""
    points = points.astype(np.float32)
    order = np.lexsort(points.T)  # much faster than numpy's unique of rows
    ordered = points[order]
    is_first = np.append(True, (ordered[1:] != ordered[:-1]).any(axis=1))
    vertices, index = ordered[is_first], np.empty(len(points), np.int64)
    index[order] = np.cumsum(is_first) - 1
    apart = np.zeros(len(size), bool)
    first = np.cumsum(size) - size
    for n in np.unique(size):
        rows = np.flatnonzero(size == n)
        used = np.sort(index[first[rows, None] + np.arange(n)], axis=1)
        _, earliest = np.unique(used, axis=0, return_index=True)
        again = np.ones(len(rows), bool)
        again[earliest] = False
        apart[rows] = again | (used[:, 1:] == used[:, :-1]).any(axis=1)
    corners = np.flatnonzero(np.repeat(apart, size))
    vertices = np.concatenate([vertices, points[corners]])
    index[corners] = len(vertices) - len(corners) + np.arange(len(corners))
    return vertices, index
