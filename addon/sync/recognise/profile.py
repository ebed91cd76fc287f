"""Which exact shape the rings of a lattice of revolution make: its parts, their materials and uv maps."""

from dataclasses import replace

import numpy as np

from .revolution import NGON, OPEN, Revolution, check_outward, facing
from .shapes import Cone, Cylinder, Disc, MeshArrays, Part, Recognition, Sphere, StaysMesh
from .uv_maps import fit_planar, fit_side, fit_sphere

LEAST_SEGMENTS = 12
LEAST_RINGS = 6
BOTTOM, SIDE, TOP = range(3)


def shape_of(mesh: MeshArrays, lattice: Revolution) -> Recognition:
    """The exact shape of a fitted lattice; StaysMesh where its profile is no known one."""
    if lattice.counts.rings == 1 and not any(lattice.raised):
        return _disc(mesh, lattice)
    if all(lattice.raised):
        return _sphere(mesh, lattice)
    return _cone(mesh, lattice)


def _enough_segments(lattice: Revolution, name: str) -> None:
    n = lattice.counts.segments
    if n < LEAST_SEGMENTS:
        raise StaysMesh(f"{n} sides are too few for a {name} ({LEAST_SEGMENTS} or more)")


def _to_object(lattice: Revolution) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """The basis (3, 3) and origin (3,) from lattice space to the parts', and ``local`` (3, 4) or None."""
    if lattice.similar:
        return lattice.basis, lattice.origin, None
    return np.eye(3), np.zeros(3), np.column_stack([lattice.basis, lattice.origin])


def _sphere(mesh: MeshArrays, lattice: Revolution) -> Recognition:
    """A UV sphere: rings at equal angles from pole to pole. A stretched one maps the unit sphere."""
    m, n = lattice.counts.rings, lattice.counts.segments
    if m == 1:
        raise StaysMesh("two cones joined at their bases are no exact shape")
    theta = np.pi * np.arange(1, m + 1) / (m + 1)
    radius = lattice.radius @ np.sin(theta) / (np.sin(theta) ** 2).sum()
    half = (lattice.tip_z[1] - lattice.tip_z[0]) / 2
    middle = (lattice.tip_z[1] + lattice.tip_z[0]) / 2
    off_radius = np.abs(lattice.radius - radius * np.sin(theta)).max()
    off_height = np.abs(lattice.z - middle + half * np.cos(theta)).max()
    if max(off_radius, off_height) > lattice.tolerance:
        raise StaysMesh("it is a surface of revolution, but its profile is neither a circle nor a straight line")
    _enough_segments(lattice, "sphere")
    if m + 1 < LEAST_RINGS:
        raise StaysMesh(f"{m + 1} rings are too few for a sphere ({LEAST_RINGS} or more)")
    check_outward(mesh, lattice.points, np.array([0.0, 0.0, middle]))
    material = mesh.uniform_material(np.ones(mesh.counts[1], bool), "sphere")
    angle = np.pi * (1 - (lattice.ring + 1) / (m + 1))
    turn = lattice.phase + 2 * np.pi * lattice.meridian / n
    at_pole = (lattice.ring < 0) | (lattice.ring == m)
    around = np.where(at_pole, 0.0, np.sin(angle))  # exactly none at the poles
    direction = np.stack([around * np.cos(turn), around * np.sin(turn), np.cos(angle)], 1)
    uv, turned = fit_sphere(mesh.uv, direction[mesh.corner_vertex])
    centre = lattice.origin + lattice.basis @ np.array([0.0, 0.0, middle])
    name = f"UV sphere, {n} segments, {m + 1} rings"
    if lattice.similar and abs(half - radius) <= lattice.tolerance:
        return sphere_of(name, mesh, (radius + half) / 2, centre, lattice.basis @ turned, None, material, uv)
    stretch = lattice.basis @ np.diag([radius, radius, half])
    return sphere_of(name, mesh, 1.0, centre, turned, stretch, material, uv)


def sphere_of(name, mesh, radius, centre, frame, stretch, material, uv) -> Recognition:
    """A sphere, or with stretch (3, 3) the ellipsoid that it makes of the unit sphere with that frame."""
    smooth = bool(mesh.smooth.all())
    if stretch is None:
        part = Sphere(material, uv, centre, float(radius), frame)
        return Recognition("SPHERE", name, (part,), None, smooth)
    part = Sphere(material, uv, np.zeros(3), 1.0, frame)
    return Recognition("SPHERE", f"{name}, stretched", (part,), np.column_stack([stretch, centre]), smooth)


def _disc(mesh: MeshArrays, lattice: Revolution) -> Recognition:
    """A filled circle."""
    if sum(end != OPEN for end in lattice.ends) != 1:
        raise StaysMesh("a disc with two sides is no exact shape")
    _enough_segments(lattice, "disc")
    side = facing(mesh, lattice.points, None)
    if not ((side > 0).all() or (side < 0).all()):
        raise StaysMesh("its normals point to both sides (Mesh > Normals > Recalculate Outside)")
    faces = np.ones(mesh.counts[1], bool)
    part = _cap(mesh, lattice, faces, float(np.sign(side[0])), float(lattice.z[0]), float(lattice.radius[0]), "disc")
    fill = "one n-gon" if NGON in lattice.ends else "a triangle fan"
    reason = f"circle, {lattice.counts.segments} vertices, filled with {fill}"
    return Recognition("DISC", _stretched(reason, lattice), (part,), _to_object(lattice)[2], bool(mesh.smooth.all()))


def _cone(mesh: MeshArrays, lattice: Revolution) -> Recognition:
    """A cylinder or a cone, with the caps that it has: rings whose radius is linear in the height."""
    z, radius = lattice.z, lattice.radius
    if lattice.raised[1]:
        z, radius = np.append(z, lattice.tip_z[1]), np.append(radius, 0.0)
    if lattice.raised[0]:  # only a sphere is not turned to stand on its base
        raise StaysMesh("it is no sphere, cylinder or cone")
    length, base, apex = z[-1] - z[0], radius[0], radius[-1]
    line = base + (apex - base) * (z - z[0]) / length
    if np.abs(line - radius).max() > lattice.tolerance:
        raise StaysMesh("it is a surface of revolution, but its profile is neither a circle nor a straight line")
    straight = abs(apex - base) <= lattice.tolerance
    name = "cylinder" if straight else "cone"
    _enough_segments(lattice, name)
    check_outward(mesh, lattice.points, np.array([0.0, 0.0, (z[0] + z[-1]) / 2]))
    region = _regions(mesh, lattice)
    parts: list[Part] = [_side(mesh, lattice, region == SIDE, name, z, base, apex)]
    for place, sign, height, size in ((BOTTOM, -1.0, z[0], base), (TOP, 1.0, z[-1], apex)):
        if (region == place).any():
            parts.append(_cap(mesh, lattice, region == place, sign, float(height), float(size), "cap"))
    smooth = bool(mesh.smooth[region == SIDE].all())
    kind = "CYLINDER" if straight else "CONE"
    return Recognition(kind, _cone_reason(lattice, name, len(parts) - 1), tuple(parts), _to_object(lattice)[2], smooth)


def _cone_reason(lattice: Revolution, name: str, caps: int) -> str:
    truncated = "truncated " if name == "cone" and not lattice.raised[1] else ""
    ends = ("open", "1 cap", "2 caps")[caps]
    return _stretched(f"{truncated}{name}, {lattice.counts.segments} sides, {ends}", lattice)


def _stretched(reason: str, lattice: Revolution) -> str:
    return reason if lattice.similar else f"{reason}, stretched"


def _regions(mesh: MeshArrays, lattice: Revolution) -> np.ndarray:
    """(f,) int: whether a face belongs to the bottom cap, the side or the top cap."""
    first, last = mesh.face_offset[:-1], lattice.counts.rings - 1
    ring = lattice.ring[mesh.corner_vertex]
    lowest, highest = np.minimum.reduceat(ring, first), np.maximum.reduceat(ring, first)
    region = np.full(mesh.counts[1], SIDE)
    region[(highest == 0) & (lowest <= 0)] = BOTTOM
    if not lattice.raised[1]:
        region[lowest == last] = TOP
    return region


def _side(mesh: MeshArrays, lattice: Revolution, faces: np.ndarray, name: str, z, base, apex) -> Cylinder | Cone:
    """The side of a cylinder or cone; its theta starts where the uv map's u does."""
    n, corners = lattice.counts.segments, faces[mesh.corner_face]
    vertex = mesh.corner_vertex[corners]
    tip = lattice.ring[vertex] == lattice.counts.rings
    height = np.append(z, z[-1])[lattice.ring[vertex]] - z[0]
    length = float(z[-1] - z[0])
    uv = None if mesh.uv is None else mesh.uv[corners].astype(np.float64)
    cell, step = _cells(lattice.meridian[vertex], tip, mesh.face_size[faces], n)
    uv_map, seam = fit_side(uv, cell, step, height / length, tip, n)
    angle = lattice.phase + 2 * np.pi * seam / n
    if name == "cone" and not uv_map.matches:
        xy = _spokes(lattice, vertex)
        uv_map, planar_angle = fit_planar(uv, xy, max(base, apex))
        uv_map = replace(uv_map, planar=uv_map.matches)
        angle = planar_angle if uv_map.matches else angle
    basis, origin, _ = _to_object(lattice)
    foot, axis = origin + basis[:, 2] * z[0], basis[:, 2].copy()
    e0 = basis @ np.array([np.cos(angle), np.sin(angle), 0.0])
    material = mesh.uniform_material(faces, "side")
    if name == "cylinder":
        return Cylinder(material, uv_map, foot, axis, length, float(lattice.radius.mean()), e0)
    return Cone(material, uv_map, foot, axis, length, float(base), float(apex), e0)


def _cells(meridian: np.ndarray, tip: np.ndarray, size: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """The meridian where each corner's face begins, and the corner's step (0 or 1) from there; size (f,)."""
    first = np.concatenate([[0], np.cumsum(size)[:-1]])
    lowest = np.repeat(np.minimum.reduceat(np.where(tip, n, meridian), first), size)
    highest = np.repeat(np.maximum.reduceat(np.where(tip, -1, meridian), first), size)
    cell = np.where(highest - lowest > 1, highest, lowest)
    return cell, (meridian - cell) % n


def _spokes(lattice: Revolution, vertex: np.ndarray) -> np.ndarray:
    """(k, 2): the exact places of vertices (k,) int seen along the axis, in lattice space."""
    m, n = lattice.counts.rings, lattice.counts.segments
    ring = lattice.ring[vertex]
    radius = np.where((ring < 0) | (ring == m), 0.0, lattice.radius[np.clip(ring, 0, m - 1)])
    angle = lattice.phase + 2 * np.pi * lattice.meridian[vertex] / n
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], 1)


def _cap(mesh: MeshArrays, lattice: Revolution, faces: np.ndarray, sign: float, z: float, radius: float, name: str):
    """The disc of a cap at height z whose normal is sign times the axis."""
    corners = faces[mesh.corner_face]
    mirror = np.array([1.0, sign])  # normal x e0 turns the other way under the body
    xy = _spokes(lattice, mesh.corner_vertex[corners]) * mirror
    uv, angle = fit_planar(None if mesh.uv is None else mesh.uv[corners].astype(np.float64), xy, radius)
    basis, origin, _ = _to_object(lattice)
    e0 = basis @ np.array([np.cos(angle), sign * np.sin(angle), 0.0])
    material = mesh.uniform_material(faces, name)
    return Disc(material, uv, origin + basis[:, 2] * z, sign * basis[:, 2], radius, e0)
