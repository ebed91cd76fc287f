# SPDX-License-Identifier: GPL-3.0-or-later
"""What a mesh is taken as, and why: an exact shape or its triangles."""

from dataclasses import dataclass, field
from hashlib import blake2b

import numpy as np

from .attributes import of_mesh, of_primitives, title_of
from .changes import geometry_of
from .keys import data_key, original_key
from .meshes import read_mesh
from .recognise import Recognition, recognise
from .shapes import Shape, fitted, plane_shape, shape_of


@dataclass(frozen=True)
class Taken:
    """`kind` MESH, SPHERE, CYLINDER, CONE, DISC or PLANE, the reason as a sentence, and the `Shape`, None for a mesh.
    `problem`: the object's own setting asks for what cannot be. `constants`: the attributes of a shape that are the
    same all over it, (4,) by key; None where one is not. `islands`: whether parts of the mesh may be exact shapes."""

    kind: str
    reason: str
    shape: Shape | None = None
    problem: bool = False
    constants: dict = field(default_factory=dict)
    islands: bool = False


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
    """What meshes are recognised as, each read once; `memory`: of earlier reads."""

    def __init__(self, memory):
        self._memory = memory

    def of(self, mesh, uv_map):
        """The Recognition of an evaluated mesh, together with one of its uv maps: its name, empty for the active one,
        None where the uv does not matter."""
        key = "recognised", data_key(mesh), uv_map

        def read(_):
            self._memory.depend(geometry_of(original_key(mesh)))
            return _recognise_once(read_mesh(mesh, uv_map))

        return self._memory.get(key, read)

    def fitted(self, mesh, kind):
        """The Recognition as a shape of `kind` that is inscribed in the mesh's bounding box, None where it has none."""

        def made(_):
            self._memory.depend(geometry_of(original_key(mesh)))
            positions = read_mesh(mesh).positions
            positions = positions[np.isfinite(positions).all(axis=1)]
            return fitted(kind, positions) if len(positions) else None

        return self._memory.get(("fitted", data_key(mesh), kind), made)

    def shape(self, recognition):
        """The `Shape` of a Recognition, the same object each time."""
        key = "shape", id(recognition)  # which is no other's: it is kept along
        return self._memory.get(key, lambda _: (recognition, shape_of(recognition)))[1]


def taken_as(primitive, mesh, shadings, recognise_setting, recognitions):
    """What an object is taken as (`Taken`).

    `primitive`: the object's own setting; `recognise_setting`: the scene's ALWAYS, SMOOTH or NEVER; `shadings`: the
    `Shading` of each slot, which says whether its images need the mesh's uv map.
    """
    if primitive == "MESH":
        return Taken("MESH", "mesh: chosen in the object's settings")
    if primitive == "PLANE":
        reason = "plane without end: chosen in the object's settings"
        return Taken("PLANE", reason, _PLANE, constants=_constants(mesh, shadings))
    if primitive != "AUTO":
        return _chosen(primitive, mesh, shadings, recognitions)
    if recognise_setting == "NEVER":
        return Taken("MESH", "mesh: recognition is switched off in the scene's settings")
    recognition = recognitions.of(mesh, _uv_map(shadings))
    if recognition.kind == "MESH":
        return Taken("MESH", recognition.reason, islands=True)
    if recognise_setting == "SMOOTH" and not recognition.all_smooth:
        return Taken("MESH", "mesh: it is shaded flat, and the scene's settings recognize smooth shapes only")
    conflict = _uv_conflict(recognition, shadings)
    if conflict:
        return Taken("MESH", conflict)
    constants = _constants(mesh, shadings)
    varying = next((key for key, value in constants.items() if value is None), None)
    if varying is not None:
        return Taken("MESH", f"mesh: a material uses {title_of(varying)}")
    return Taken(recognition.kind, recognition.reason, recognitions.shape(recognition), constants=constants)


_PLANE = plane_shape()


def _constants(mesh, shadings):
    """The attributes of the materials that are the same all over a mesh, (4,) by key; None where one is not."""
    return of_mesh(mesh, of_primitives({key for shading in shadings for key in shading.attributes}))


def _chosen(primitive, mesh, shadings, recognitions):
    recognition = recognitions.of(mesh, "")
    if recognition.kind != primitive:
        recognition = recognitions.fitted(mesh, primitive)
    if recognition is None:
        return Taken(
            "MESH", f"mesh: a {primitive.lower()} is chosen, but its bounding box is flat or empty", problem=True
        )
    shape = recognitions.shape(recognition)
    return Taken(recognition.kind, recognition.reason, shape, constants=_constants(mesh, shadings))


def _uv_map(shadings):
    """The uv map that the materials take; None where they need none."""
    return next((shading.uv_map for shading in shadings if shading.uv_map is not None), None)


def _uv_conflict(recognition: Recognition, shadings):
    """Why a material's uv keeps a recognised mesh a mesh, or an empty string."""
    first = _uv_map(shadings)
    for part in recognition.parts:
        shading = shadings[min(part.material, len(shadings) - 1)]
        if shading.uv_map is not None and (shading.uv_map != first or not part.uv.matches):
            return f"mesh: material {shading.name!r} uses the uv map, which is not the {recognition.kind.lower()}'s own"
    return ""


def materials_of(obj, data, is_own=True):
    """The Blender material of each slot of an evaluated object's data, or of what its geometry nodes made (`is_own`
    False); None in an empty slot. Slots that are linked to the object have their material there."""
    if is_own:
        return [slot.material for slot in obj.material_slots]
    made = list(data.materials)
    # Evaluated, an empty slot of the object would give the material of its own data instead.
    of_object = [
        slot.material if original.link == "OBJECT" and original.material is not None else None
        for slot, original in zip(obj.material_slots, obj.original.material_slots, strict=False)
    ]
    count = max(len(made), len(of_object))
    made += [None] * (count - len(made))
    return [own or other for own, other in zip(of_object + [None] * (count - len(of_object)), made, strict=True)]
