"""More that swatches are shown on: point clouds, strands, deformed meshes, meshes of several parts and uv maps."""

import bpy
import numpy as np

from tests.blender.building import link, mesh_of

from .shapes import SHAPES


def _with_slot(obj):
    obj.data.materials.append(None)
    return obj


def _points():
    """Balls of different sizes side by side, in a cloud that is turned."""
    data = bpy.data.pointclouds.new("points")
    places = np.array([(x, y, 0.1 * x) for y in (-0.3, 0.0, 0.3) for x in (-0.3, 0.0, 0.3)], np.float32)
    data.resize(len(places))
    data.points.foreach_set("co", places.ravel())
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.linspace(0.1, 0.14, len(places)).astype(np.float32))
    return _with_slot(link(data, "points", rotation_euler=(0.1, 0.2, 0.3)))


def _strands():
    """Straight strands of different lengths side by side."""
    bpy.context.scene.cycles_curves.shape = "THICK"
    data = bpy.data.hair_curves.new("strands")
    count = 5
    data.add_curves([3] * count)
    x = np.linspace(-0.4, 0.4, count)
    length = np.linspace(0.5, 0.9, count)
    places = np.stack(
        [[(a, -0.45, 0.0), (a, -0.2, 0.02), (a, -0.45 + b, 0.05)] for a, b in zip(x, length, strict=True)]
    )
    data.position_data.foreach_set("vector", places.astype(np.float32).ravel())
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.tile(np.float32((0.08, 0.07, 0.05)), count))
    return _with_slot(link(data, "strands", rotation_euler=(0.1, 0.0, 0.0)))


def _grid(corners, name):
    """A mesh of (n, n) points (n, n, 3), with a uv map that is the unit square."""
    n = len(corners)
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.stack([corner, corner + 1, corner + n + 1, corner + n], axis=-1)
    mesh = mesh_of(corners.reshape(-1, 3), faces.tolist(), name)
    uv = np.stack(np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n)), axis=-1).reshape(-1, 2)
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uv[faces].astype(np.float32).ravel())
    return mesh, uv, faces


def _square(n=9):
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, n), np.linspace(-0.5, 0.5, n))
    return np.stack([x, y, 0.2 * x * y], axis=-1)


def _bent():
    """A sheet that a modifier twists."""
    mesh, *_ = _grid(_square(), "bent")
    obj = _with_slot(link(mesh, "bent"))
    modifier = obj.modifiers.new("twist", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.angle, modifier.deform_axis = "TWIST", 0.6, "Z"
    obj.modifiers.new("cast", "CAST").factor = 0.4
    return obj


def _two_maps():
    """A sheet with a second uv map that is turned and bent."""
    mesh, uv, faces = _grid(_square(), "two maps")
    other = np.stack([uv[:, 1] ** 2, 1.5 * uv[:, 0] + 0.2], axis=-1)
    mesh.uv_layers.new(name="other").uv.foreach_set("vector", other[faces].astype(np.float32).ravel())
    return _with_slot(link(mesh, "two maps"))


def _parts():
    """Two sheets in one mesh."""
    places = [(x, y, 0.0) for x in (-0.5, -0.05, 0.05, 0.5) for y in (-0.5, 0.5)]
    return _with_slot(link(mesh_of(places, [(0, 2, 3, 1), (4, 6, 7, 5)], "parts"), "parts"))


SHAPES |= {"points": _points, "strands": _strands, "bent": _bent, "two maps": _two_maps, "parts": _parts}
