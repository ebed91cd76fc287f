# SPDX-License-Identifier: GPL-3.0-or-later
"""What a render takes an object as, in words, for its panel."""

from collections import Counter

import bpy
import numpy as np

from ..engine.errors import SceneError
from ..wording import counted
from .camera import camera_of_render
from .compat import has_geometry_sets
from .contents import Contents
from .geometry_sets import components_of, geometry_set_of
from .instancing import Copies
from .memory import Memory
from .meshes import whole_mesh
from .pixel_sizes import PixelSizes
from .raw_attributes import values_of
from .reports import Reports
from .shading import Shadings
from .taken import Recognitions, materials_of, taken_as
from .visibility import shows_hair

_NOUNS = {"CURVE": "curve", "FONT": "text", "META": "metaball", "SURFACE": "NURBS surface"}
#: Of longer curves the pieces are not counted: a panel must not wait for them.
_COUNT_POINTS = 1 << 16
_NO_FACES = "mesh: it has no faces"


def describe(obj, depsgraph):
    """What a render takes an object as: (kind, reason). `kind` is MESH, SPHERE, CYLINDER, CONE, DISC, PLANE,
    POINT_CLOUD, CURVES, HAIR or INSTANCES, NONE for what is not rendered, or UNKNOWN.

    A panel may ask each time that it is drawn: recognition is repeated only when the mesh has changed.
    """
    evaluated = obj.evaluated_get(depsgraph)
    if not evaluated.is_evaluated:  # it is the object itself where the depsgraph has none
        return "UNKNOWN", "it is hidden in the viewports; show it to see what a render takes it as"
    parts = [_own(evaluated, depsgraph), *_made(evaluated, depsgraph)]
    shown = [part for part in parts if part[0] != "NONE" and part[1] != _NO_FACES] or parts[:1]
    return shown[0][0], "; ".join(reason for _, reason in shown)


def _own(obj, depsgraph):
    """(kind, reason) of an evaluated object without what its geometry nodes or particles make."""
    if obj.type in _NOUNS:
        return _own_made(obj, depsgraph)
    if obj.type == "MESH":
        return _own_mesh(obj, depsgraph)
    if obj.type == "POINTCLOUD":
        return _points(obj.data)
    if obj.type == "CURVES":
        return _strands(Copies(obj, "CURVES", obj.data, _matrix(obj)), depsgraph)
    return "NONE", "not rendered: it is a volume" if obj.type == "VOLUME" else "it is no surface"


def _own_mesh(obj, depsgraph):
    with whole_mesh(Copies(obj, "MESH", obj.data, _matrix(obj))) as mesh:
        return _mesh(obj, mesh, depsgraph)


def _mesh(obj, mesh, depsgraph):
    primitive = obj.conic.primitive
    if not len(mesh.polygons) and primitive != "PLANE":
        if len(mesh.edges) and obj.conic.strand_radius > 0.0:
            return _strands(Copies(obj, "MESH", mesh, _matrix(obj)), depsgraph)
        if primitive not in ("AUTO", "MESH"):
            return "NONE", f"not rendered: the {primitive.lower()} has no faces to take its size from"
        return "MESH", _NO_FACES
    shadings = Shadings(None, _silent())
    slots = tuple(shadings.of(material) for material in materials_of(obj, mesh)) or (shadings.of(None),)
    taken = taken_as(primitive, mesh, slots, depsgraph.scene.conic.recognise, Recognitions(Memory(_silent())))
    return taken.kind, taken.reason


def _own_made(obj, depsgraph):
    """Of a curve, text, metaball or surface, from which Blender makes a mesh, or lines alone."""
    noun, primitive = _NOUNS[obj.type], obj.conic.primitive
    if obj.type != "META" and not _has_faces(obj):  # of a family of metaballs one has the faces of all
        if obj.type == "CURVE" and obj.conic.strand_radius > 0.0:
            return _strands(Copies(obj, "CURVE", obj.data, _matrix(obj)), depsgraph)
        remedy = "a bevel, an extrusion, a filling or a Strand Radius" if noun == "curve" else "an extrusion"
        return "NONE", f"not rendered: this {noun} has no surface; give it {remedy}"
    if primitive in ("AUTO", "MESH"):
        return "MESH", f"mesh: made from a {noun}"
    return primitive, f"{primitive.lower()}: chosen in the object's settings"


def _has_faces(obj):
    mesh = obj.to_mesh()
    has_faces = mesh is not None and len(mesh.polygons) > 0
    obj.to_mesh_clear()
    return has_faces


def _points(cloud):
    return "POINT_CLOUD", f"point cloud: {counted(len(cloud.points), 'sphere')}"


def _strands(copies, depsgraph):
    """Of hair, curves without bevel and edges without faces: how many, and of which pieces they are made."""
    data, noun = copies.data, "edge" if copies.kind == "MESH" else "strand"
    lines = len(data.edges) if copies.kind == "MESH" else len(data.splines if copies.kind == "CURVE" else data.curves)
    if copies.kind == "CURVE":
        points = sum(len(spline.bezier_points) + len(spline.points) for spline in data.splines)
    else:
        points = len(data.vertices if copies.kind == "MESH" else data.points)
    text = counted(lines, noun)
    pieces = _pieces(copies, depsgraph) if points <= _COUNT_POINTS else None
    if pieces is None:
        return "CURVES", text
    if not pieces:
        return "NONE", f"not rendered: {text}, without a radius above 0"
    return "CURVES", f"{text}: {', '.join(counted(count, kind) for kind, count in sorted(pieces.items()))}"


def _pieces(copies, depsgraph):
    """The number of primitives by kind of strands as the camera sees them; None where there is no camera."""
    render = depsgraph.scene.render
    try:
        camera = camera_of_render(None, depsgraph, render.resolution_x, render.resolution_y, reports=_silent())
    except SceneError:
        return None
    contents = Contents(depsgraph, PixelSizes([(camera, render.resolution_y)], [copies]))
    found = Counter()
    for content in contents.of(copies, (Shadings(None, _silent()).of(None),)).contents:
        found.update({part.kind: len(part) for _, part in content.drawn.kinds()})
    return found


def _made(obj, depsgraph):
    """Yield (kind, reason) of what an evaluated object makes besides itself."""
    if shows_hair(obj):
        names = ", ".join(repr(s.name) for s in obj.particle_systems if s.settings.type == "HAIR")
        yield "HAIR", f"hair of {names}"
    geometry_set = geometry_set_of(obj) if has_geometry_sets() else None
    if geometry_set is not None:
        yield from _components(obj, geometry_set, depsgraph)
        copies = _instances(geometry_set)
        if copies:
            yield "INSTANCES", f"instances {copies}"
            return
    if obj.is_instancer:
        yield from _older_instances(obj)


def _components(obj, geometry_set, depsgraph):
    for kind, data in components_of(obj, geometry_set, False):
        if kind == "POINTCLOUD":
            yield _points(data)
        elif kind == "CURVES":
            yield _strands(Copies(obj, kind, data, _matrix(obj), is_own=False), depsgraph)
        elif kind == "VOLUME":
            yield "NONE", "its volume is not rendered"


def _instances(geometry_set):
    """`7 copies of 'leaf' and 2 of collection 'twigs'` of instances made by geometry nodes; empty without any."""
    cloud = geometry_set.instances_pointcloud()
    if cloud is None:
        return ""
    references = geometry_set.instance_references()
    of_instance = values_of(cloud.attributes[".reference_index"])
    counts = np.bincount(of_instance, minlength=len(references))
    found = Counter()
    for reference, count in zip(references, counts, strict=True):
        found[_name(reference)] += int(count)
    first, *others = [(f"{count:,}", name) for name, count in found.most_common() if count]
    noun = "copy" if first[0] == "1" else "copies"
    named = [f"{first[0]} {noun} of {first[1]}", *(f"{count} of {name}" for count, name in others[:2])]
    return " and ".join([*named, *([f"{len(others) - 2:,} others"] if len(others) > 2 else [])])


def _name(reference):
    if isinstance(reference, bpy.types.Object):
        return repr(reference.name)
    if isinstance(reference, bpy.types.Collection):
        return f"collection {reference.name!r}"
    return repr(reference.name) if getattr(reference, "name", "") else "what its geometry nodes make"


def _older_instances(obj):
    for system in obj.particle_systems:
        settings = system.settings
        of = settings.instance_object if settings.render_type == "OBJECT" else settings.instance_collection
        if settings.render_type in ("OBJECT", "COLLECTION") and of is not None:
            yield "INSTANCES", f"instances {of.name!r} on {counted(len(system.particles), 'particle')}"
    if obj.instance_type == "COLLECTION" and obj.instance_collection is not None:
        yield "INSTANCES", f"instances the collection {obj.instance_collection.name!r}"
    elif obj.instance_type in ("VERTS", "FACES") and obj.type == "MESH":
        on = {"VERTS": (obj.data.vertices, "vertex"), "FACES": (obj.data.polygons, "face")}[obj.instance_type]
        yield "INSTANCES", f"instances its children on {counted(len(on[0]), on[1])}"


def _matrix(obj):
    return np.array(obj.matrix_world, np.float32)[None]


def _silent():
    return Reports(lambda level, message: None)
