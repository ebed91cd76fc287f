# SPDX-License-Identifier: GPL-3.0-or-later
"""The shapes of an NFF file as Blender's objects: exact ones where an object each, clouds and instances where many."""

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Quaternion

from ..engine.primitives import Cones, Cylinders, Spheres
from . import proxy_mesh
from .geometry_nodes import add_cones_modifier, add_points_modifier
from .new_mesh import mesh_of_points, new_mesh, new_polygon_mesh, set_attribute

#: Digits of the ratio of a cone's radii: about those of the file. Cones alike to so many share one mesh.
_RATIO_DIGITS = 5


class Shapes:
    """Makes the objects of an NffFile's shapes in `collection`.

    `materials` (a `Materials`); `most`: of more alike than this, spheres become a point cloud, cylinders and cones
    instances.
    """

    def __init__(self, collection, materials, most):
        self._collection, self._materials, self._most = collection, materials, most
        self._proxies = {}
        self.inside_only = 0

    def add(self, file):
        """All shapes of an NffFile; `inside_only` then counts the ones that are seen from inside only."""
        for _, part in file.scene.shapes.kinds():
            if isinstance(part, Spheres):
                self._add_spheres(part)
            elif isinstance(part, Cylinders):
                self._add_cones(part.base, part.apex, part.radius, part.radius, part.material)
            elif isinstance(part, Cones):
                self._add_cones(part.base, part.apex, part.base_radius, part.apex_radius, part.material)
        for polygons in file.polygons:
            self._add_polygons(polygons)
        bpy.data.batch_remove(self._proxies.values())
        self._proxies.clear()

    def _add_spheres(self, part):
        for material, rows in _groups(np.asarray(part.material)):
            center, radius = np.asarray(part.center)[rows], np.asarray(part.radius)[rows]
            inside = radius < 0.0
            outside = ~inside
            if outside.sum() > self._most:
                cloud = new_point_cloud("Spheres", center[outside], radius[outside], self._materials.of(material))
                self._collection.objects.link(cloud)
            else:
                self._add_copies("Sphere", material, _Places.of_spheres(center[outside], radius[outside]))
            self._add_copies("Sphere", material, _Places.of_spheres(center[inside], -radius[inside]), inside=True)

    def _add_cones(self, base, apex, base_radius, apex_radius, material):
        """Cylinders or cones: their wider end is the lower one of the mesh that they share."""
        swap = np.abs(apex_radius) > np.abs(base_radius)
        foot, tip = (np.where(swap[:, None], a, b) for a, b in ((apex, base), (base, apex)))
        wide, narrow = np.where(swap, apex_radius, base_radius), np.where(swap, base_radius, apex_radius)
        keys = np.stack([material, np.round(narrow / wide, _RATIO_DIGITS), wide < 0.0], axis=1)
        for (index, ratio, inside), rows in _groups(keys):
            places = _Places.along(foot[rows], tip[rows], np.abs(wide[rows]))
            name = "Cylinder" if ratio == 1.0 else "Cone"
            if len(rows) > self._most and not inside:
                self._add_instances(name, ratio, index, places)
            else:
                self._add_copies(name, index, places, ratio, inside=bool(inside))

    def _add_copies(self, name, material, places, ratio=1.0, inside=False):
        """An object for each of `places`, with one mesh for all. `ratio`: a cone's upper radius, where its lower one
        is 1. What is seen from `inside` only, as no exact shape is, stays a mesh."""
        if not len(places):
            return
        mesh = self._proxy(name, ratio, inside).copy()
        mesh.name = name
        mesh.materials.append(self._materials.of(material, one_sided=inside))
        for location, rotation, scale in places:
            obj = bpy.data.objects.new(f"{name} inside" if inside else name, mesh)
            obj.location, obj.rotation_euler, obj.scale = location, Quaternion(rotation).to_euler(), scale
            obj.conic.primitive = "MESH" if inside else name.upper()
            self._collection.objects.link(obj)
        self.inside_only += len(places) * inside

    def _proxy(self, name, ratio, inside):
        """The mesh that stands for a shape, from which those with a material are copied."""
        key = name, ratio, inside
        if key not in self._proxies:
            proxy = proxy_mesh.sphere(1.0) if name == "Sphere" else proxy_mesh.cone(1.0, ratio, 1.0, caps=False)
            self._proxies[key] = new_mesh("proxy", proxy.inverted() if inside else proxy)
        return self._proxies[key]

    def _add_instances(self, name, apex_radius, material, places):
        """One object that instances a cone at `places`."""
        mesh = mesh_of_points(name, places.location)
        set_attribute(mesh, "rotation", "QUATERNION", "value", places.rotation)
        set_attribute(mesh, "scale", "FLOAT_VECTOR", "vector", places.scale)
        mesh.materials.append(self._materials.of(material))
        obj = bpy.data.objects.new(f"{name}s", mesh)
        add_cones_modifier(obj, apex_radius, self._materials.of(material))
        self._collection.objects.link(obj)

    def _add_polygons(self, polygons):
        """A mesh object for each material."""
        name = "Polygons" if polygons.normals is None else "Patches"
        first = np.cumsum(polygons.size) - polygons.size
        for material, rows in _groups(polygons.material):
            size = polygons.size[rows]
            corners = np.repeat(first[rows] - (np.cumsum(size) - size), size) + np.arange(size.sum())
            normals = None if polygons.normals is None else polygons.normals[corners]
            mesh = new_polygon_mesh(name, size, polygons.points[corners], normals)
            mesh.materials.append(self._materials.of(material, one_sided=bool(polygons.one_sided[rows[0]])))
            obj = bpy.data.objects.new(name, mesh)
            obj.conic.primitive = "MESH"  # nothing that looks like a circle is to become one
            self._collection.objects.link(obj)


def _groups(keys):
    """Yield (key, rows) for each value of `keys` (n,) or (n, k), rows in their order."""
    unique, inverse = np.unique(keys, axis=0, return_inverse=True)
    inverse = inverse.reshape(-1)
    order = np.argsort(inverse, kind="stable")
    ends = np.cumsum(np.bincount(inverse, minlength=len(unique)))
    yield from zip(unique.tolist(), np.split(order, ends[:-1]), strict=True)


@dataclass(frozen=True)
class _Places:
    """Where copies of a mesh stand: location (n, 3), rotation (n, 4) quaternions w x y z, scale (n, 3)."""

    location: np.ndarray
    rotation: np.ndarray
    scale: np.ndarray

    def __len__(self):
        return len(self.location)

    @classmethod
    def of_spheres(cls, center, radius):
        """Those of the unit sphere."""
        count = len(center)
        return cls(center, np.tile((1.0, 0.0, 0.0, 0.0), (count, 1)), np.repeat(radius, 3).reshape(-1, 3))

    @classmethod
    def along(cls, foot, tip, radius):
        """Those of a shape of radius 1 about the Z axis from -1/2 to 1/2, so that it reaches from foot to tip."""
        axis = tip - foot
        length = np.linalg.norm(axis, axis=1)
        return cls((foot + tip) / 2.0, _turn_from_z(axis / length[:, None]), np.stack([radius, radius, length], axis=1))

    def __iter__(self):
        """Location, rotation and scale of each, as lists."""
        return zip(self.location.tolist(), self.rotation.tolist(), self.scale.tolist(), strict=True)


def _turn_from_z(direction):
    """The quaternions (n, 4), w x y z, of the smallest turns that take +Z to the unit vectors (n, 3)."""
    x, y, z = direction.T
    across = np.hypot(x, y)
    half_cos = np.sqrt(np.where(z < 0.0, across**2 / np.where(z < 0.0, 1.0 - z, 1.0), 1.0 + z) / 2.0)
    half_sin = np.sqrt(np.where(z > 0.0, across**2 / np.where(z > 0.0, 1.0 + z, 1.0), 1.0 - z) / 2.0)
    flat = across == 0.0
    safe = np.where(flat, 1.0, across)
    return np.stack([half_cos, half_sin * np.where(flat, 1.0, -y / safe), half_sin * x / safe, 0.0 * z], axis=1)


def new_point_cloud(name, center, radius, material):
    """An object of spheres, center (n, 3) and radius (n,): a point cloud, or where Python cannot size one
    a mesh whose modifier makes one."""
    if "resize" in bpy.types.PointCloud.bl_rna.functions:
        cloud = bpy.data.pointclouds.new(name)
        cloud.resize(len(center))
        cloud.attributes["position"].data.foreach_set("vector", center.astype(np.float32).ravel())
    else:
        cloud = mesh_of_points(name, center)
    set_attribute(cloud, "radius", "FLOAT", "value", radius)
    cloud.materials.append(material)
    obj = bpy.data.objects.new(name, cloud)
    if obj.type == "MESH":
        add_points_modifier(obj, material)
    return obj
