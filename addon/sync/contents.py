# SPDX-License-Identifier: GPL-3.0-or-later
"""What data is drawn as: a `Shape`, or a Geometry of triangles, spheres or strands. Each is read once."""

import weakref
from dataclasses import dataclass, field, replace

from ..engine.scene import Geometry
from ..wording import counted
from .attributes import of_elements, of_primitives, of_texture_space, title_of
from .changes import geometry_of
from .comparing import same_primitives
from .curves import DEFAULT_RADIUS, Read, sampling_of, strands_of_curves, strands_of_edges, strands_of_legacy_curve
from .islands import find_islands
from .keys import data_key, original_key
from .memory import Memory
from .meshes import is_closed_mesh, read_mesh, read_triangles, whole_mesh
from .particle_hair import strands_of_particles
from .points import read_points
from .reports import Reports
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


@dataclass(frozen=True)
class Drawn:
    """The `contents`, a tuple, of copies, and what a report should say after the name of their object: `notes`."""

    contents: tuple
    notes: tuple = ()


class Contents:
    """Reads the contents of one scene, each once. `pixels`: a `PixelSizes`; `memory`: of earlier reads.

    `before`: the geometries that may be replaced by what is read next; what is equal to one of them is the same object.
    """

    def __init__(self, depsgraph, pixels, memory=None):
        self.depsgraph, self.pixels = depsgraph, pixels
        self.memory = memory or Memory(Reports(lambda level, message: None))
        self.settings = depsgraph.scene_eval.conic
        self.recognitions = Recognitions(self.memory)
        self.before = []

    def key(self, copies):
        """What the contents of copies depend on, besides their materials: copies that have it in common are drawn as
        the same."""
        settings = copies.obj.conic
        by_object = original_key(copies.obj) if copies.kind in ("CURVE", "HAIR") else copies.obj.type
        return copies.kind, data_key(copies.data), by_object, settings.primitive, settings.strand_radius

    def of(self, copies, shadings):
        """What copies whose slots have `shadings` are drawn as (`Drawn`)."""
        reading = _Reading(self, copies, shadings)
        self.memory.depend(*reading.tokens)
        contents = reading.contents()
        return Drawn(contents, tuple(dict.fromkeys(reading.notes)))

    def as_before(self, geometry):
        """The Geometry itself, or the one before that it equals; if it has as many primitives it replaces that."""
        counts = None if geometry is None else geometry.counts()
        found = [old for old in self.before if old.counts() == counts]
        like = next((old for old in found if old.name == geometry.name), found[0] if found else None)
        if like is None:
            return geometry
        self.before.remove(like)
        if geometry.name == like.name and same_primitives(geometry, like):
            return like
        geometry.replaces = weakref.ref(like)
        return geometry


class _Reading:
    """The contents of one lot of copies, read for a `Contents`, `owner`. `tokens`: of what they are made from. `notes`:
    what there is to report."""

    def __init__(self, owner, copies, shadings):
        self._owner, self._memory, self._settings = owner, owner.memory, owner.settings
        self._copies, self._obj, self._data = copies, copies.obj, copies.data
        self._data_key = data_key(copies.data)
        self._shadings, self._slots = shadings, len(shadings)
        self._keys = of_primitives({key for shading in shadings for key in shading.attributes})
        self.tokens = geometry_of(original_key(copies.data)), geometry_of(original_key(copies.obj))
        self.notes = []

    def contents(self):
        """`Content`s, a tuple."""
        kind, keys = self._copies.kind, self._keys
        readers = {
            "MESH": self._mesh,
            "POINTCLOUD": self._points,
            "CURVES": self._curves,
            "CURVE": self._legacy_curve,
            "HAIR": self._hair,
        }
        if kind not in readers:
            what = _NOT_RENDERED.get(kind, kind.lower())
            self.notes.append(f" is not rendered: it is {what}")
            return ()
        with whole_mesh(self._copies) as self._data:
            found = tuple(readers[kind]())
            constants = of_texture_space(self._data, keys) if found else {}
        if kind in _STRANDS:
            constants |= of_strands(keys, is_particle_hair=kind == "HAIR")
        if not constants:
            return found
        return tuple(replace(content, constants=constants | content.constants) for content in found)

    def _mesh(self):
        obj, mesh = self._obj, self._data
        if len(mesh.edges) and obj.conic.strand_radius > 0.0:
            yield from self._edges()
        primitive = obj.conic.primitive
        if not len(mesh.polygons) and primitive != "PLANE":
            if primitive not in ("AUTO", "MESH") and not len(mesh.edges):
                self.notes.append(f" is not rendered: its {primitive.lower()} has no faces to take its size from")
            return
        taken = taken_as(primitive, mesh, self._shadings, self._settings.recognise, self._owner.recognitions)
        if taken.problem:
            self.notes.append(f": rendered as a {taken.reason}")
        if taken.shape is not None:
            self._report_lost(taken)
            constants = {key: value for key, value in taken.constants.items() if value is not None}
            yield Content(taken.shape, taken.kind.lower(), is_closed_shape(taken.shape), constants)
            return
        geometry = self._triangles(taken.islands)
        if geometry is not None:
            matters = any(shading.transmits for shading in self._shadings)
            yield Content(geometry, "mesh", not matters or self._is_closed(mesh))

    def _report_lost(self, taken):
        """Name what a shape that was chosen by hand cannot show."""
        for key, value in taken.constants.items():
            if value is None:
                self.notes.append(f": on an exact shape {title_of(key)} is not rendered")

    def _is_closed(self, mesh):
        def read(_):
            self._memory.depend(*self.tokens)
            return is_closed_mesh(mesh)

        return self._memory.get(("closed", self._data_key), read)

    def _triangles(self, islands):
        """The Geometry of a mesh, shared by all objects that have the mesh and its uv needs in common."""
        mesh, maps = self._data, tuple(shading.uv_map for shading in self._shadings)
        maps = maps if any(name is not None for name in maps) else ()

        def read(note):
            found = self._islands(mesh) if islands and not maps else None
            read = read_triangles(mesh, self._slots, maps, self._keys, None if found is None else found.rest)
            if read.dropped:
                dropped, verb = counted(read.dropped, "triangle"), "is" if read.dropped == 1 else "are"
                note(f": {dropped} with vertices that are not finite or beyond 1e18 m {verb} not rendered")
            parts = [*(found.primitives if found else ()), *([read.triangles] if read.triangles is not None else [])]
            return Geometry(*parts, name=self._copies.data.name) if parts else None

        smooth_only = islands and self._settings.recognise == "SMOOTH"
        return self._geometry(("triangles", self._data_key, self._slots, maps, self._keys, islands, smooth_only), read)

    def _islands(self, mesh):
        values = {key: (read, domain) for key, read, domain in of_elements(mesh, self._keys) if domain != "EDGE"}
        return find_islands(read_mesh(mesh), values, smooth_only=self._settings.recognise == "SMOOTH")

    def _points(self):
        cloud = self._data

        def read(note):
            found = read_points(cloud, self._slots, self._keys)
            if found.not_finite:
                note(f" has {counted(found.not_finite, 'point')} not finite or beyond 1e18 m, not rendered")
            if found.without_radius:
                note(f" has {counted(found.without_radius, 'point')} without a radius above 0, not rendered")
            return found.geometry

        return self._once(("points", self._data_key, self._slots, self._keys), read, "point cloud")

    def _curves(self):
        curves, radius = self._data, 1.0
        if self._obj.type != "CURVES":  # Blender renders those of hair alone
            radius = self._obj.conic.strand_radius
            if "radius" not in curves.attributes:
                radius /= DEFAULT_RADIUS
        if not radius > 0.0:
            return ()
        return self._strands(
            (self._data_key, self._slots, self._keys, radius),
            lambda sampling: strands_of_curves(curves, sampling, self._slots, self._keys, radius),
        )

    def _legacy_curve(self):
        obj = self._obj
        if not self._copies.is_own:
            self.notes.append(" makes curves by geometry nodes, which are rendered from Blender 4.5 on")
            return ()
        radius = obj.conic.strand_radius
        if not radius > 0.0:
            return ()
        return self._strands(
            (original_key(obj), data_key(obj.data), radius, self._slots, self._keys),
            lambda sampling: strands_of_legacy_curve(
                obj, radius, sampling, self._owner.depsgraph, self._slots, self._keys
            ),
        )

    def _edges(self):
        mesh, radius = self._data, self._obj.conic.strand_radius
        return self._strands(
            (self._data_key, self._keys, radius), lambda sampling: strands_of_edges(mesh, radius, self._keys)
        )

    def _hair(self):
        obj, sampling = self._obj, self._sampling()
        render = self._owner.depsgraph.mode == "RENDER"
        for number, system in enumerate(strands_of_particles(obj, sampling, render, self._slots, self._keys)):
            key = original_key(obj), "hair", self._slots, self._keys, number
            yield from self._strands(key, lambda _, system=system: system.read)

    def _strands(self, key, read):
        """The content of strands, by `read(sampling)`."""
        sampling = self._sampling()

        def geometry(note):
            found: Read = read(sampling)
            if found.dropped:
                verb = "is" if found.dropped == 1 else "are"
                strands = counted(found.dropped, "strand")
                note(f" has places or radii that are not finite: {strands} {verb} not rendered")
            for warning in found.warnings:
                note(f": {warning}")
            return found.geometry

        return self._once((*key, "strands", sampling), geometry, "curves")

    def _sampling(self):
        return sampling_of(self._settings, self._owner.pixels.of(self._copies))

    def _once(self, key, read, kind):
        geometry = self._geometry(key, read)
        return () if geometry is None else (Content(geometry, kind),)

    def _geometry(self, key, read):
        """What `read(note)` gives, a Geometry or None, read once for a key; `note` takes what there is to report."""

        def made(_):
            notes = []
            self._memory.depend(*self.tokens)
            return self._owner.as_before(read(notes.append)), notes

        geometry, notes = self._memory.get(("geometry", *key), made)
        self.notes += notes
        return geometry
