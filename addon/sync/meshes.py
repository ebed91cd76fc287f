# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes as arrays, and arrays as triangles. No loop over elements: attributes are read whole."""

from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np

from ..engine.scene import Triangles
from .attributes import of_triangles
from .raw_attributes import are_places, read_corner_vertices, read_positions, read_raw
from .recognise import MeshArrays


def read_mesh(mesh, uv_map=None):
    """The `MeshArrays` of an evaluated Blender mesh; with the uv map called `uv_map`, empty for the active one."""
    faces = len(mesh.polygons)
    offsets = np.empty(faces + 1, np.int32)
    mesh.polygons.foreach_get("loop_start", offsets[:faces])
    offsets[faces] = len(mesh.loops)
    sharp = read_raw(mesh, "sharp_face", "FACE", "BOOLEAN")
    slots = read_raw(mesh, "material_index", "FACE", "INT")
    return MeshArrays(
        positions=read_positions(mesh),
        corner_vertex=read_corner_vertices(mesh),
        face_offset=offsets,
        smooth=np.ones(faces, bool) if sharp is None else ~sharp,
        material=np.zeros(faces, np.int32) if slots is None else slots,
        uv=None if uv_map is None else read_uv(mesh, uv_map),
    )


@contextmanager
def whole_mesh(copies):
    """The evaluated data of `Copies`. Of a mesh in Edit Mode, whose arrays are empty, Blender makes a copy that is
    whole; it is gone with the context."""
    obj, data = copies.obj, copies.data
    if copies.kind != "MESH" or not data.is_editmode or data != obj.data:
        yield data
        return
    try:
        yield obj.to_mesh()
    finally:
        obj.to_mesh_clear()


def read_uv(mesh, name=""):
    """The uv map called `name`, empty for the one active for rendering: (corners, 2) float32, or None where there is
    none. Values that are not finite become 0.
    """
    if not name:
        name = next((layer.name for layer in mesh.uv_layers if layer.active_render), "")
    uv = read_raw(mesh, name, "CORNER", "FLOAT2") if name else None
    return None if uv is None else np.nan_to_num(uv, copy=False, posinf=0.0, neginf=0.0)


def is_closed_mesh(mesh):
    """Whether the faces of an evaluated Blender mesh close around a body: each of their edges has two of them."""
    corners = np.bincount(read_raw(mesh, ".corner_edge", "CORNER", "INT"))
    return bool((corners[corners > 0] == 2).all())  # an edge without a face bounds nothing


@dataclass(frozen=True)
class MeshTriangles:
    """Triangles in object space, or None where the mesh has none, and how many were dropped for vertices that are no
    places."""

    triangles: Triangles | None
    dropped: int = 0


def read_triangles(mesh, slot_count, uv_maps=(), keys=(), wanted=None):
    """The `MeshTriangles` of an evaluated Blender mesh.

    Their material is the slot, as Blender clamps it to `slot_count`. `uv_maps`: the name of the uv map,
    empty for the active one, or None for each slot; empty for no uv at all. `keys`: of the attributes to read.
    `wanted` (faces,) bool: the faces; None for all.
    """
    corners, faces = _triangulation(mesh)
    if wanted is not None:
        corners, faces = corners[wanted[faces]], faces[wanted[faces]]
    if not len(corners):
        return MeshTriangles(None)
    vertices = read_corner_vertices(mesh)[corners]
    positions = read_positions(mesh)
    good = are_places(positions)
    dropped = 0
    if not good.all():
        keep = good[vertices].all(axis=1)
        dropped = int(len(keep) - keep.sum())
        corners, faces, vertices = corners[keep], faces[keep], vertices[keep]
        if not len(corners):
            return MeshTriangles(None, dropped)
    columns = dict(zip(("p0", "p1", "p2"), positions[vertices.T], strict=True))
    columns |= _normals(mesh, corners, faces)
    slots = read_raw(mesh, "material_index", "FACE", "INT")
    material = np.clip(slots[faces], 0, slot_count - 1) if slots is not None else np.zeros(len(faces), np.int32)
    columns |= _uvs(mesh, corners, material, uv_maps)
    attributes = of_triangles(mesh, keys, corners, faces)
    return MeshTriangles(Triangles(material=material, attributes=attributes, **columns), dropped)


def _triangulation(mesh):
    """Corners (n, 3) and face (n,) of each triangle, as Blender triangulates."""
    faces = len(mesh.polygons)
    if faces and len(mesh.loops) == 3 * faces:
        return np.arange(3 * faces, dtype=np.int32).reshape(-1, 3), np.arange(faces, dtype=np.int32)
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    corners, of_face = np.empty(count * 3, np.int32), np.empty(count, np.int32)
    if count:
        mesh.loop_triangles.foreach_get("loops", corners)
        mesh.loop_triangle_polygons.foreach_get("value", of_face)
    return corners.reshape(-1, 3), of_face


def _normals(mesh, corners, faces):
    """Columns n0, n1, n2 of triangles, 0 where the face is flat; nothing where all are. Beside smooth faces a flat one
    that is bent has one normal as a whole, where Cycles has it so: in Blender 5.2, not yet in 5.0."""
    if mesh.normals_domain == "FACE":
        return {}
    normals = np.empty(len(mesh.loops) * 3, np.float32)
    mesh.corner_normals.foreach_get("vector", normals)
    normals = np.nan_to_num(normals.reshape(-1, 3), copy=False)
    of_triangle = normals[corners.T]
    sharp = read_raw(mesh, "sharp_face", "FACE", "BOOLEAN")
    if sharp is not None and not mesh.has_custom_normals and bpy.app.version < (5, 1, 0):
        of_triangle[:, sharp[faces]] = 0.0
    return dict(zip(("n0", "n1", "n2"), of_triangle, strict=True))


def _uvs(mesh, corners, material, uv_maps):
    """Columns uv0, uv1, uv2 (n, 2): for each triangle the uv that its material takes; 0 where it has no map."""
    uv = np.zeros((3, len(corners), 2), np.float32)
    for name in {name for name in uv_maps if name is not None}:
        of_corner = read_uv(mesh, name)
        if of_corner is None:
            continue
        rows = np.array([other == name for other in uv_maps])[material]
        uv[:, rows] = of_corner[corners[rows].T]
    return dict(zip(("uv0", "uv1", "uv2"), uv, strict=True))
