# SPDX-License-Identifier: GPL-3.0-or-later
"""What data is drawn as: a `Shape`, or a Geometry of triangles, spheres or strands. Each is read once."""

from dataclasses import dataclass, field, replace

from ..engine.scene import Geometry
from ..wording import counted
from .attributes import of_elements, of_primitives, of_texture_space, title_of
from .curves import DEFAULT_RADIUS, Read, sampling_of, strands_of_curves, strands_of_edges, strands_of_legacy_curve
from .islands import find_islands
from .keys import data_key, original_key
from .meshes import is_closed_mesh, read_mesh, read_triangles
from .particle_hair import strands_of_particles
from .points import read_points
from .shapes import is_closed_shape
from .strand_values import of_strands
from .taken import Recognitions, taken_as

#: Types whose evaluated geometry comes along as copies of their own, that show nothing, or that Blender draws itself.
SILENT = {
    *("FONT", "META", "SURFACE"),
    *("EMPTY", "CAMERA", "ARMATURE", "LATTICE", "LIGHT_PROBE", "SPEAKER"),
    *("GPENCIL", "GREASEPENCIL"),
}
#: What is drawn as strands.
_STRANDS = {"CURVES", "CURVE", "HAIR"}
#: What else an object can be, as a report calls it.
_NOT_RENDERED = {"VOLUME": "a volume"}


@dataclass(frozen=True)
class Content:
    """What copies of data are drawn as.

    `drawn`: a `Shape` or a Geometry. `kind`: for statistics. `is_closed`: whether it is the whole border of a body, as
    far as its materials ask. `constants`: attributes (4,) by key that are the same all over a shape.
    """

    drawn: object
    kind: str
    is_closed: bool = True
    constants: dict = field(default_factory=dict)


class Contents:
    """Reads the contents of one scene, each once. `pixels`: a `PixelSizes`."""

    def __init__(self, depsgraph, pixels, reports):
        self._depsgraph, self._pixels, self._reports = depsgraph, pixels, reports
        self._settings = depsgraph.scene_eval.conic
        self._recognitions = Recognitions()
        self._geometries = {}
        self._closed = {}

    def key(self, copies):
        """What the contents of copies depend on, besides their materials: copies that have it in common are drawn as
        the same."""
        settings = copies.obj.conic
        by_object = original_key(copies.obj) if copies.kind in ("CURVE", "HAIR") else copies.obj.type
        return copies.kind, data_key(copies.data), by_object, settings.primitive, settings.strand_radius

    def of(self, copies, shadings):
        """The contents, a tuple, of copies whose slots have `shadings`; what is not rendered is reported."""
        readers = {
            "MESH": self._mesh,
            "POINTCLOUD": self._points,
            "CURVES": self._curves,
            "CURVE": self._legacy_curve,
            "HAIR": self._hair,
        }
        if copies.kind not in readers:
            what = _NOT_RENDERED.get(copies.kind, copies.kind.lower())
            self._warn(copies, f"is not rendered: it is {what}")
            return ()
        keys = of_primitives({key for shading in shadings for key in shading.attributes})
        found = tuple(readers[copies.kind](copies, shadings, keys))
        constants = of_texture_space(copies.data, keys) if found else {}
        if copies.kind in _STRANDS:
            constants |= of_strands(keys, is_particle_hair=copies.kind == "HAIR")
        if not constants:
            return found
        return tuple(replace(content, constants=constants | content.constants) for content in found)

    def _warn(self, copies, what):
        self._reports.warn(f"object {copies.obj.name!r} {what}")

    def _mesh(self, copies, shadings, keys):
        obj, mesh = copies.obj, copies.data
        if len(mesh.edges) and obj.conic.strand_radius > 0.0:
            yield from self._edges(copies, keys)
        primitive = obj.conic.primitive
        if not len(mesh.polygons) and primitive != "PLANE":
            if primitive not in ("AUTO", "MESH") and not len(mesh.edges):
                self._warn(copies, f"is not rendered: its {primitive.lower()} has no faces to take its size from")
            return
        taken = taken_as(primitive, mesh, shadings, self._settings.recognise, self._recognitions)
        if taken.problem:
            self._reports.warn(f"object {obj.name!r}: rendered as a {taken.reason}")
        if taken.shape is not None:
            self._report_lost(obj, taken)
            constants = {key: value for key, value in taken.constants.items() if value is not None}
            yield Content(taken.shape, taken.kind.lower(), is_closed_shape(taken.shape), constants)
            return
        geometry = self._triangles(copies, shadings, keys, taken.islands)
        if geometry is not None:
            matters = any(shading.transmits for shading in shadings)
            yield Content(geometry, "mesh", not matters or self._is_closed(mesh))

    def _report_lost(self, obj, taken):
        """Name what a shape that was chosen by hand cannot show."""
        for key, value in taken.constants.items():
            if value is None:
                self._reports.warn(f"object {obj.name!r}: on an exact shape {title_of(key)} is not rendered")

    def _is_closed(self, mesh):
        key = data_key(mesh)
        if key not in self._closed:
            self._closed[key] = is_closed_mesh(mesh)
        return self._closed[key]

    def _triangles(self, copies, shadings, keys, islands):
        """The Geometry of a mesh, shared by all objects that have the mesh and its uv needs in common."""
        mesh, maps = copies.data, tuple(shading.uv_map for shading in shadings)
        maps = maps if any(name is not None for name in maps) else ()
        key = data_key(mesh), len(shadings), maps, keys, islands
        if key not in self._geometries:
            found = self._islands(mesh, keys) if islands and not maps else None
            read = read_triangles(mesh, len(shadings), maps, keys, None if found is None else found.rest)
            if read.dropped:
                dropped, verb = counted(read.dropped, "triangle"), "is" if read.dropped == 1 else "are"
                self._reports.warn(
                    f"object {copies.obj.name!r}: {dropped} with NaN or infinite vertices {verb} not rendered"
                )
            parts = [*(found.primitives if found else ()), *([read.triangles] if read.triangles is not None else [])]
            self._geometries[key] = Geometry(*parts, name=mesh.name) if parts else None
        return self._geometries[key]

    def _islands(self, mesh, keys):
        values = {key: (read, domain) for key, read, domain in of_elements(mesh, keys) if domain != "EDGE"}
        return find_islands(read_mesh(mesh), values, smooth_only=self._settings.recognise == "SMOOTH")

    def _points(self, copies, shadings, keys):
        cloud = copies.data

        def read():
            found = read_points(cloud, len(shadings), keys)
            if found.not_finite:
                self._warn(
                    copies, f"has {counted(found.not_finite, 'point')} not finite in place or radius, not rendered"
                )
            if found.without_radius:
                self._warn(
                    copies, f"has {counted(found.without_radius, 'point')} without a radius above 0, not rendered"
                )
            return found.geometry

        return self._once((data_key(cloud), len(shadings), keys), read, "point cloud")

    def _curves(self, copies, shadings, keys):
        curves, radius = copies.data, 1.0
        if copies.obj.type != "CURVES":  # Blender renders those of hair alone
            radius = copies.obj.conic.strand_radius
            if "radius" not in curves.attributes:
                radius /= DEFAULT_RADIUS
        if not radius > 0.0:
            return ()
        return self._strands(
            copies,
            (data_key(curves), len(shadings), keys, radius),
            lambda sampling: strands_of_curves(curves, sampling, len(shadings), keys, radius),
        )

    def _legacy_curve(self, copies, shadings, keys):
        obj = copies.obj
        if not copies.is_own:
            self._warn(copies, "makes curves by geometry nodes, which are rendered from Blender 4.5 on")
            return ()
        radius = obj.conic.strand_radius
        if not radius > 0.0:
            return ()
        return self._strands(
            copies,
            (original_key(obj), len(shadings), keys),
            lambda sampling: strands_of_legacy_curve(obj, radius, sampling, self._depsgraph, len(shadings), keys),
        )

    def _edges(self, copies, keys):
        mesh, radius = copies.data, copies.obj.conic.strand_radius
        return self._strands(
            copies, (data_key(mesh), keys, radius), lambda sampling: strands_of_edges(mesh, radius, keys)
        )

    def _hair(self, copies, shadings, keys):
        obj = copies.obj
        key = original_key(obj), "hair", len(shadings), keys
        if key not in self._geometries:
            sampling = sampling_of(self._settings, self._pixels.of(copies))
            render = self._depsgraph.mode == "RENDER"
            self._geometries[key] = strands_of_particles(obj, sampling, render, len(shadings), keys)
        for system in self._geometries[key]:
            yield from self._strands(copies, (*key, system.name), lambda sampling, system=system: system.read)

    def _strands(self, copies, key, read):
        """The content of strands, by `read(sampling)`."""

        def geometry():
            found: Read = read(sampling_of(self._settings, self._pixels.of(copies)))
            if found.dropped:
                verb = "is" if found.dropped == 1 else "are"
                strands = counted(found.dropped, "strand")
                self._warn(copies, f"has places or radii that are not finite: {strands} {verb} not rendered")
            for warning in found.warnings:
                self._reports.warn(f"object {copies.obj.name!r}: {warning}")
            return found.geometry

        return self._once((*key, "strands"), geometry, "curves")

    def _once(self, key, read, kind):
        if key not in self._geometries:
            self._geometries[key] = read()
        geometry = self._geometries[key]
        return () if geometry is None else (Content(geometry, kind),)
