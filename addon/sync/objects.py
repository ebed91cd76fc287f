# SPDX-License-Identifier: GPL-3.0-or-later
"""What each object is taken as, and why: an exact shape or its mesh."""

from dataclasses import dataclass
from hashlib import blake2b

import numpy as np

from ..engine.scene import Scene
from .keys import data_key
from .meshes import read_mesh
from .recognise import Recognition, recognise
from .reports import Reports
from .shading import Shadings
from .shapes import Shape, fitted, plane_shape, shape_of


@dataclass(frozen=True)
class Taken:
    """`kind` MESH, SPHERE, CYLINDER, CONE, DISC or PLANE, the reason as a sentence, and the `Shape`, None for a mesh.
    `problem`: the object's own setting asks for what cannot be."""

    kind: str
    reason: str
    shape: Shape | None = None
    problem: bool = False


#: Recognitions by a digest of all that they depend on: copies of a mesh and later syncs have them at once.
_BY_CONTENT = {}
_REMEMBER_AT_MOST = 1 << 14
_REMEMBER_FACES = 1 << 17  # of larger meshes a digest takes longer than a look at their counts


def _recognise_once(arrays):
    """The Recognition of MeshArrays, remembered by their content."""
    if len(arrays.smooth) > _REMEMBER_FACES:
        return recognise(arrays)
    digest = blake2b(digest_size=16)
    for part in (arrays.positions, arrays.corner_vertex, arrays.face_offset, arrays.smooth, arrays.material, arrays.uv):
        digest.update(b"-" if part is None else np.int64(part.size).tobytes() + part.tobytes())
    key = digest.digest()
    if key not in _BY_CONTENT:
        if len(_BY_CONTENT) >= _REMEMBER_AT_MOST:
            _BY_CONTENT.clear()
        _BY_CONTENT[key] = recognise(arrays)
    return _BY_CONTENT[key]


class Recognitions:
    """What the meshes of one sync are recognised as, each read once."""

    def __init__(self):
        self._recognised = {}
        self._shapes = {}

    def of(self, mesh, uv_map):
        """The Recognition of an evaluated mesh, together with one of its uv maps: its name, empty for the active one,
        None where the uv does not matter."""
        key = data_key(mesh), uv_map
        if key not in self._recognised:
            self._recognised[key] = _recognise_once(read_mesh(mesh, uv_map))
        return self._recognised[key]

    def fitted(self, mesh, kind):
        """The Recognition as a shape of `kind` that is inscribed in the mesh's bounding box, None where it has none."""
        key = data_key(mesh), kind, "fitted"
        if key not in self._recognised:
            positions = read_mesh(mesh).positions
            positions = positions[np.isfinite(positions).all(axis=1)]
            self._recognised[key] = fitted(kind, positions) if len(positions) else None
        return self._recognised[key]

    def shape(self, recognition):
        """The `Shape` of a Recognition, the same object each time."""
        if id(recognition) not in self._shapes:
            self._shapes[id(recognition)] = recognition, shape_of(recognition)
        return self._shapes[id(recognition)][1]


def taken_as(primitive, mesh, shadings, recognise_setting, recognitions):
    """What an object is taken as (`Taken`).

    `primitive`: the object's own setting; `recognise_setting`: the scene's ALWAYS, SMOOTH or NEVER; `shadings`: the
    `Shading` of each slot, which says whether its images need the mesh's uv map.
    """
    if primitive == "MESH":
        return Taken("MESH", "mesh: chosen in the object's settings")
    if primitive == "PLANE":
        return Taken("PLANE", "plane without end: chosen in the object's settings", _PLANE)
    if primitive != "AUTO":
        return _chosen(primitive, mesh, recognitions)
    if recognise_setting == "NEVER":
        return Taken("MESH", "mesh: recognition is switched off in the scene's settings")
    recognition = recognitions.of(mesh, _uv_map(shadings))
    if recognition.kind == "MESH":
        return Taken("MESH", recognition.reason)
    if recognise_setting == "SMOOTH" and not recognition.all_smooth:
        return Taken("MESH", "mesh: it is shaded flat, and the scene's settings recognize smooth shapes only")
    conflict = _uv_conflict(recognition, shadings)
    if conflict:
        return Taken("MESH", conflict)
    return Taken(recognition.kind, recognition.reason, recognitions.shape(recognition))


_PLANE = plane_shape()


def _chosen(primitive, mesh, recognitions):
    recognition = recognitions.of(mesh, "")
    if recognition.kind != primitive:
        recognition = recognitions.fitted(mesh, primitive)
    if recognition is None:
        return Taken(
            "MESH", f"mesh: a {primitive.lower()} is chosen, but its bounding box is flat or empty", problem=True
        )
    return Taken(recognition.kind, recognition.reason, recognitions.shape(recognition))


def _uv_map(shadings):
    """The uv map that the images of the materials need; None where they need none."""
    return next((shading.uv.map for shading in shadings if shading.uv is not None), None)


def _uv_conflict(recognition: Recognition, shadings):
    """Why images by uv keep a recognised mesh a mesh, or an empty string."""
    first = _uv_map(shadings)
    for part in recognition.parts:
        shading = shadings[min(part.material, len(shadings) - 1)]
        if shading.uv is None:
            continue
        if not shading.uv.plain:
            return f"mesh: material {shading.name!r} moves the uv map by a Mapping node"
        if shading.uv.map != first or not part.uv.matches:
            return f"mesh: material {shading.name!r} uses the uv map, which is not the {recognition.kind.lower()}'s own"
    return ""


_NOUNS = {"CURVE": "curve", "FONT": "text", "META": "metaball", "SURFACE": "NURBS surface"}


def describe(obj, depsgraph):
    """What a render takes an object as, for its panel: (kind, reason). `kind` is MESH, SPHERE, CYLINDER, CONE, DISC,
    PLANE, or NONE for what is no surface.

    A panel may ask each time that it is drawn: recognition is repeated only when the mesh has changed.
    """
    evaluated = obj.evaluated_get(depsgraph)
    primitive = evaluated.conic.primitive
    if evaluated.type in _NOUNS:
        return _describe_made(evaluated, primitive)
    if evaluated.type != "MESH":
        return "NONE", "it is no surface"
    mesh = evaluated.data
    if not len(mesh.polygons) and primitive not in ("AUTO", "MESH", "PLANE"):
        return "NONE", f"not rendered: the {primitive.lower()} has no faces to take its size from"
    if not len(mesh.polygons) and primitive != "PLANE":
        return "MESH", "mesh: it has no faces"
    shadings = Shadings(Scene(), None, Reports(lambda level, message: None))
    slots = tuple(shadings.of(slot.material) for slot in evaluated.material_slots) or (shadings.of(None),)
    taken = taken_as(primitive, mesh, slots, depsgraph.scene.conic.recognise, Recognitions())
    return taken.kind, taken.reason


def _describe_made(evaluated, primitive):
    """`describe` of an evaluated curve, text, metaball or surface, from which Blender makes a mesh, or lines alone."""
    noun = _NOUNS[evaluated.type]
    if evaluated.type != "META" and not _has_faces(evaluated):  # of a family of metaballs one has the faces of all
        return "NONE", f"not rendered: this {noun} has no surface; give it a bevel, an extrusion or a filling"
    if primitive in ("AUTO", "MESH"):
        return "MESH", f"mesh: made from a {noun}"
    return primitive, f"{primitive.lower()}: chosen in the object's settings"


def _has_faces(evaluated):
    mesh = evaluated.to_mesh()
    has_faces = mesh is not None and len(mesh.polygons) > 0
    evaluated.to_mesh_clear()
    return has_faces
