# SPDX-License-Identifier: GPL-3.0-or-later
"""The objects of a depsgraph in two phases: collect all copies by what they are copies of, then place them."""

from dataclasses import dataclass, field

import numpy as np

from ..engine.scene import Geometry, Instance, Spheres
from .keys import data_key, original_key
from .meshes import is_closed_mesh, read_triangles
from .objects import Recognitions, taken_as
from .placement import place_shape, placeable
from .shapes import Shape, is_closed_shape

#: Types whose evaluated geometry comes along as meshes of their own, that show nothing, or that Blender draws itself.
_SILENT = {
    *("CURVE", "FONT", "META", "SURFACE"),
    *("EMPTY", "CAMERA", "ARMATURE", "LATTICE", "LIGHT_PROBE", "SPEAKER"),
    *("GPENCIL", "GREASEPENCIL"),
}
#: What else an object can be, as a report calls it.
_NOT_RENDERED = {"CURVES": "hair curves", "VOLUME": "a volume"}
_VISIBLE_TO = tuple(f"visible_{ray}" for ray in ("camera", "diffuse", "glossy", "transmission", "shadow"))


@dataclass
class _Asset:
    """What stands in the scene once or many times: a `Shape` or a Geometry, with one set of materials."""

    content: object
    materials: tuple
    rows: list = field(default_factory=list)  # 12 numbers a copy: the upper rows of its matrix
    names: list = field(default_factory=list)


class ObjectSync:
    """Collects the objects of a depsgraph, then places them in the engine scene."""

    def __init__(self, scene, shadings, lights, reports, recognise_setting, view_layer):
        self._scene, self._shadings, self._lights, self._reports = scene, shadings, lights, reports
        self._recognise, self._view_layer = recognise_setting, view_layer
        self._override = view_layer.material_override
        self._recognitions = Recognitions()
        self._assets = {}
        self._of_object = {}
        self._geometries = {}
        self._closed = {}

    def collect(self, depsgraph):
        """Go once through all objects and instances; none of them lives longer than its step, so values are copied."""
        for instance in depsgraph.object_instances:
            if not instance.show_self:
                continue
            obj = instance.object
            kind = obj.type
            if kind in _SILENT:
                continue
            if kind == "LIGHT":
                self._lights.add(obj, np.array(instance.matrix_world, np.float64))
                continue
            asset = self._asset_of(obj, kind)
            if asset is not None:
                matrix = instance.matrix_world
                for row in range(3):
                    asset.rows.extend(matrix[row])
                asset.names.append(obj.name)

    def place(self):
        """Put every copy into the scene; those that cannot be, scaled to zero or nowhere, are reported."""
        for asset in self._assets.values():
            matrices = np.zeros((len(asset.names), 4, 4))
            matrices[:, 3, 3] = 1.0
            matrices[:, :3] = np.reshape(asset.rows, (-1, 3, 4))
            good = placeable(asset.content, matrices)
            for i in np.flatnonzero(~good):
                finite = np.isfinite(matrices[i]).all()
                why = "is scaled to zero along an axis" if finite else "has a place or a scale that is not finite"
                self._reports.warn(f"object {asset.names[i]!r} {why} and is not rendered")
            if good.any():
                self._place(asset, matrices[good], asset.names[int(np.argmax(good))])

    def _place(self, asset, matrices, name):
        if isinstance(asset.content, Geometry):
            self._scene.instances.extend(Instance(asset.content, m, asset.materials, name) for m in matrices)
        else:
            place_shape(self._scene, asset.content, matrices, asset.materials, name)

    def _asset_of(self, obj, kind):
        """The asset of which an object is a copy; None, reported, where it shows nothing."""
        key = original_key(obj), data_key(obj.data)
        if key not in self._of_object:
            self._of_object[key] = self._read(obj, kind)
        return self._of_object[key]

    def _read(self, obj, kind):
        shadings = self._shadings_of(obj)
        self._report_flags(obj)
        self._report_hair(obj)
        if kind == "MESH":
            content = self._mesh_content(obj, shadings)
        elif kind == "POINTCLOUD":
            content = self._points(obj)
        else:
            self._reports.warn(f"object {obj.name!r} is not rendered: it is {_NOT_RENDERED.get(kind, kind.lower())}")
            content = None
        if content is None:
            return None
        if any(shading.transmits for shading in shadings) and not self._is_closed(content, obj):
            shadings = [self._shadings.of_sheet(shading) for shading in shadings]
        materials = tuple(shading.index for shading in shadings)
        return self._assets.setdefault((id(content), materials), _Asset(content, materials))

    def _is_closed(self, content, obj):
        """Whether an object's surface is the whole border of a body."""
        if isinstance(content, Shape):
            return is_closed_shape(content)
        if obj.type != "MESH":
            return True  # the spheres of a point cloud
        key = data_key(obj.data)
        if key not in self._closed:
            self._closed[key] = is_closed_mesh(obj.data)
        return self._closed[key]

    def _report_flags(self, obj):
        """Name the settings of visibility that are not rendered."""
        if not all(getattr(obj, name) for name in _VISIBLE_TO):
            self._reports.warn(f"object {obj.name!r}: its ray visibility is not rendered, all rays see it")
        flags = {
            "is not rendered as a holdout": obj.is_holdout or obj.original.holdout_get(view_layer=self._view_layer),
            "is not rendered as a shadow catcher": obj.is_shadow_catcher,
            "is indirect only, which is not rendered: the camera sees it": obj.original.indirect_only_get(
                view_layer=self._view_layer
            ),
        }
        for flag, is_set in flags.items():
            if is_set:
                self._reports.warn(f"object {obj.name!r}: it {flag}")

    def _report_hair(self, obj):
        for system in obj.particle_systems:
            if system.settings.type == "HAIR" and system.settings.render_type == "PATH":
                self._reports.warn(f"object {obj.name!r}: the hair of {system.name!r} is not rendered")

    def _shadings_of(self, obj):
        """The `Shading` of each of the object's slots, at least one."""
        if self._override is not None:
            return (self._shadings.of(self._override),)
        return tuple(self._shadings.of(slot.material) for slot in obj.material_slots) or (self._shadings.of(None),)

    def _mesh_content(self, obj, shadings):
        mesh, primitive = obj.data, obj.conic.primitive
        if not len(mesh.polygons) and primitive != "PLANE":
            if primitive not in ("AUTO", "MESH"):
                shape = primitive.lower()
                self._reports.warn(
                    f"object {obj.name!r} is not rendered: its {shape} has no faces to take its size from"
                )
            return None
        taken = taken_as(primitive, mesh, shadings, self._recognise, self._recognitions)
        if taken.problem:
            self._reports.warn(f"object {obj.name!r}: rendered as a {taken.reason}")
        if taken.shape is None:
            return self._triangles(obj, mesh, shadings)
        for shading in shadings:
            if shading.uv is not None and not shading.uv.plain:
                what = f"the Mapping node of material {shading.name!r}"
                self._reports.warn(f"object {obj.name!r}: {what} is not rendered on an exact shape")
        return taken.shape

    def _triangles(self, obj, mesh, shadings):
        """The Geometry of a mesh, shared by all objects that have the mesh and its uv needs in common."""
        sources = tuple(shading.uv for shading in shadings)
        key = data_key(mesh), len(shadings), sources if any(sources) else ()
        if key not in self._geometries:
            read = read_triangles(mesh, len(shadings), key[2])
            if read.dropped:
                dropped, verb = ("1 triangle", "is") if read.dropped == 1 else (f"{read.dropped} triangles", "are")
                self._reports.warn(f"object {obj.name!r}: {dropped} with NaN or infinite vertices {verb} not rendered")
            self._geometries[key] = None if read.triangles is None else Geometry(read.triangles, name=mesh.name)
        return self._geometries[key]

    def _points(self, obj):
        """A point cloud as a Geometry of spheres; points whose place or radius is no number or 0 are left out."""
        key = data_key(obj.data)
        if key not in self._geometries:
            self._geometries[key] = _spheres(obj.data)
        return self._geometries[key]


def _spheres(cloud):
    count = len(cloud.points)
    if not count:
        return None
    center, radius = np.empty(count * 3, np.float32), np.full(count, 0.01, np.float32)  # Blender's own default
    cloud.attributes["position"].data.foreach_get("vector", center)
    if "radius" in cloud.attributes:
        cloud.attributes["radius"].data.foreach_get("value", radius)
    center = center.reshape(-1, 3)
    good = np.isfinite(center).all(axis=1) & np.isfinite(radius) & (radius > 0.0)
    return Geometry(Spheres(center=center[good], radius=radius[good]), name=cloud.name) if good.any() else None
