# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair, curves and wires of Blender as strands of the engine, in the space of their object.

What calls this, and with what:

    sampling_of(scene.conic, pixel)       how fine; `pixel`: length in the object's space that a pixel spans where it
                                          is nearest to the camera
    strands_of_curves(curves, ...)        data of CURVES objects, and what geometry nodes make on any object
    strands_of_legacy_curve(obj, ...)     a CURVE object without faces
    strands_of_edges(mesh, ...)           the edges of a mesh that have no face
    strands_of_particles(obj, ...)        particle hair, a geometry a particle system: in particle_hair.py

Each gives a `Read`. Materials are the slots of the object. `keys` are those of attributes.py.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..engine import strands
from ..engine.scene import Geometry
from . import strand_values
from .attributes import of_curves, parts_of, read_attribute
from .compat import has_geometry_sets
from .curve_sampling import BEZIER, CATMULL_ROM, NURBS, POLY, ControlCurves, Sampling, offsets_of, sample
from .raw_attributes import read_positions, read_raw

#: Radius of curves that say none, as in Cycles.
DEFAULT_RADIUS = 0.005
_COARSER = "the camera is so near that its strands are cut coarser than the tolerance asks for"
_SPLINE_KINDS = {"POLY": POLY, "BEZIER": BEZIER, "NURBS": NURBS}


@dataclass(frozen=True)
class Read:
    """Strands, None where there is nothing to see; how many were left out for places or radii that are not finite; and
    what else a report should say, after the name of the object."""

    geometry: Geometry | None = None
    dropped: int = 0
    warnings: tuple = ()

    @classmethod
    def of(cls, samples, name, **settings):
        """Of the `Samples` of curves; `settings` are what else `Polylines` have."""
        made = strands.strands(
            strands.Polylines(
                samples.points,
                samples.offsets,
                samples.radius,
                samples.cyclic,
                attributes=samples.attributes,
                **settings,
            )
        )
        return cls(made.geometry(name), made.dropped, (_COARSER,) if samples.coarser else ())


def sampling_of(settings, pixel):
    """The `Sampling` that `scene.conic` asks for; `pixel` is the length of a pixel in the object's space."""
    if settings.curve_sampling == "FIXED":
        return Sampling(steps=settings.curve_steps)
    return Sampling(tolerance=settings.curve_tolerance * pixel)


def strands_of_curves(curves, sampling, slot_count=1, keys=(), radius=1.0, default_radius=DEFAULT_RADIUS):
    """The `Read` of evaluated `Curves`; `radius` multiplies that of their points, `default_radius` where they have
    none."""
    control = _control_curves(curves, keys, default_radius=default_radius)
    return _read(control, curves.name, sampling, slot_count, radius)


def strands_of_legacy_curve(obj, radius, sampling, depsgraph, slot_count=1, keys=()):
    """The `Read` of an evaluated CURVE object whose curves have neither bevel nor fill; empty where they have, since
    its faces come as a mesh. `radius` multiplies that of their points."""
    if not has_geometry_sets():
        return _strands_of_splines(obj, radius, sampling, depsgraph, slot_count)
    geometry = obj.evaluated_geometry()  # owns the curves
    curves = geometry.curves
    if curves is None:
        return Read()
    slots = np.zeros(len(obj.data.splines), np.int32)  # Blender leaves them behind when it makes its new curves
    obj.data.splines.foreach_get("material_index", slots)
    default = slots if len(slots) == len(curves.curves) else 0
    return _read(_control_curves(curves, keys, default), curves.name, sampling, slot_count, radius)


def strands_of_edges(mesh, radius, keys=()):
    """The `Read` of those edges of an evaluated mesh that have no face, `radius` thick."""
    count = len(mesh.edges)
    if not count:
        return Read()
    ends = read_raw(mesh, ".edge_verts", "EDGE", "INT32_2D")
    if len(mesh.loops):
        loose = np.ones(count, bool)
        loose[read_raw(mesh, ".corner_edge", "CORNER", "INT")] = False
        ends = ends[loose]
    points = read_positions(mesh)
    attributes = {}
    for key in keys:
        source, name, output = parts_of(key)
        read = read_attribute(mesh, name, output) if source == "geometry" else None
        if read is not None and read[1] == "POINT":
            attributes[key] = read[0]
    made = strands.edges(points, ends, radius, attributes=attributes)
    return Read(made.geometry(mesh.name), made.dropped)


def _read(control, name, sampling, slot_count, scale):
    """The `Read` of (`ControlCurves`, slot of each, attributes of each by key) or None."""
    if control is None:
        return Read()
    curves, slots, of_curve = control
    curves = replace(curves, radius=curves.radius * scale)
    return Read.of(sample(curves, sampling), name, material=np.clip(slots, 0, slot_count - 1), of_polylines=of_curve)


def _control_curves(curves, keys, default_slot=0, default_radius=1.0):
    """`ControlCurves` of a Blender `Curves`, the material slot of each curve, and the attributes by key that have a
    value a curve; None where there are no curves."""
    count, points = len(curves.curves), len(curves.points)
    if not count:
        return None
    offsets = np.empty(count + 1, np.int32)
    curves.curve_offset_data.foreach_get("value", offsets)
    attributes = of_curves(curves, keys)

    def of_point(name, kind, default):
        return _values(curves, name, "POINT", kind, points, default)

    def of_curve(name, kind, default):
        return _values(curves, name, "CURVE", kind, count, default)

    left, right = (read_raw(curves, f"handle_{side}", "POINT", "FLOAT_VECTOR") for side in ("left", "right"))
    positions = read_positions(curves).astype(np.float64)
    radius = of_point("radius", "FLOAT", default_radius).astype(np.float64)
    control = ControlCurves(
        points=positions,
        offsets=offsets.astype(np.int64),
        radius=radius,
        kind=of_curve("curve_type", "INT8", CATMULL_ROM),
        cyclic=of_curve("cyclic", "BOOLEAN", False),
        handles=None if left is None or right is None else np.stack([left, right], axis=1).astype(np.float64),
        weight=of_point("nurbs_weight", "FLOAT", 1.0).astype(np.float64),
        order=of_curve("nurbs_order", "INT8", 4).astype(np.int64),
        knots_mode=of_curve("knots_mode", "INT8", 0).astype(np.int64),
        resolution=of_curve("resolution", "INT", 12),
        attributes={key: values for key, (values, domain) in attributes.items() if domain == "POINT"}
        | strand_values.of_points(keys, positions, offsets, radius),
    )
    by_curve = {key: values for key, (values, domain) in attributes.items() if domain == "CURVE"}
    by_curve |= strand_values.of_curves(keys, positions, offsets)
    return control, of_curve("material_index", "INT", default_slot), by_curve


def _values(data, name, domain, kind, count, default):
    """A built-in attribute, (count,); the default for all where there is none."""
    found = read_raw(data, name, domain, kind)
    return np.full(count, default) if found is None else found


def _strands_of_splines(obj, radius, sampling, depsgraph, slot_count):
    """`strands_of_legacy_curve` before Blender 4.5, where what modifiers make of curves cannot be read."""
    has_faces = len(obj.to_mesh().polygons) > 0
    obj.to_mesh_clear()
    if has_faces:
        return Read()
    curve = obj.to_curve(depsgraph, apply_modifiers=True)
    splines = [spline for spline in curve.splines if spline.type in _SPLINE_KINDS]
    parts = [_spline_arrays(spline) for spline in splines]
    slots = np.array([spline.material_index for spline in splines], np.int32)
    obj.to_curve_clear()
    if not parts:
        return Read()
    control = _joined_splines(parts)
    read = _read((control, slots, {}), obj.data.name, sampling, slot_count, radius)
    if any(modifier.show_render and not getattr(modifier, "use_apply_on_spline", False) for modifier in obj.modifiers):
        return replace(read, warnings=(*read.warnings, "its modifiers change its strands only from Blender 4.5 on"))
    return read


def _spline_arrays(spline):
    """Of a spline: points (n, 3), radius (n,), weight (n,), handles (n, 2, 3), and (kind, cyclic, order, knots mode,
    resolution)."""
    bezier = spline.type == "BEZIER"
    points = spline.bezier_points if bezier else spline.points
    count = len(points)
    place, radius = np.empty((count, 3 if bezier else 4), np.float32), np.empty(count, np.float32)
    points.foreach_get("co", place.reshape(-1))
    points.foreach_get("radius", radius)
    handles = np.zeros((2, count, 3), np.float32)
    if bezier:
        points.foreach_get("handle_left", handles[0].reshape(-1))
        points.foreach_get("handle_right", handles[1].reshape(-1))
    knots_mode = int(spline.use_endpoint_u) + 2 * int(spline.use_bezier_u)
    numbers = (_SPLINE_KINDS[spline.type], spline.use_cyclic_u, spline.order_u, knots_mode, spline.resolution_u)
    weight = np.ones(count) if bezier else place[:, 3]
    return place[:, :3], radius, weight, np.moveaxis(handles, 0, 1), numbers


def _joined_splines(parts):
    points, radius, weight, handles, numbers = zip(*parts, strict=True)
    kind, cyclic, order, knots_mode, resolution = np.array(numbers, np.int64).T
    return ControlCurves(
        points=np.concatenate(points).astype(np.float64),
        offsets=offsets_of(np.array([len(part) for part in points])),
        radius=np.concatenate(radius).astype(np.float64),
        kind=kind,
        cyclic=cyclic.astype(bool),
        handles=np.concatenate(handles).astype(np.float64),
        weight=np.concatenate(weight).astype(np.float64),
        order=order,
        knots_mode=knots_mode,
        resolution=resolution,
    )
