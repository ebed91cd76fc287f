"""Surfaces that glow as lights: a record for each primitive whose material gives off light.

They light surfaces in pictures of more than one sample. Mirrors see them by the rays that meet them; what is rough does
both, and `glow_area` says how much counts of each, so that nothing counts twice.
"""

from dataclasses import dataclass

import numpy as np

from . import layout
from .expression import constant_of
from .light import LightKind
from .light_tree import ALL_SIDES, LightBounds
from .primitives import Cones, Cylinders, Discs, Spheres, Triangles
from .primitives.base import dot, perpendicular_part
from .visibility import Visibility

#: Of more the texture of records would grow out of bounds, and each would light nothing by itself.
_MOST = 1 << 20
_RAYS = int(Visibility.DIFFUSE | Visibility.GLOSSY | Visibility.TRANSMISSION)
_SIDES = {"BOTH": 0, "FRONT": 1, "BACK": -1}
_IDENTITY = np.eye(4)[None]

#: Number in the record of a surface that glows everywhere the same, and of one that does not.
_CONSTANT, _VARIES = 1, 2


@dataclass(frozen=True)
class Emitters:
    """n primitives that glow: records (n,) of `layout.LIGHT` and of `layout.LIGHT_SHAPE`, their `LightBounds`, whether
    one glows differently from place to place. `area` (n,): what each shows on the mean. `found` (n,): the material
    whose light rays and samples share, -1 where rays alone find it."""

    lights: np.ndarray
    shapes: np.ndarray
    bounds: LightBounds
    varies: bool
    warnings: list
    area: np.ndarray
    found: np.ndarray

    def __len__(self):
        return len(self.lights)


@dataclass(frozen=True)
class _Glow:
    """Of materials by number: what they give off (m, 3), 1 where that varies, whether it does, which sides shine."""

    color: np.ndarray
    varies: np.ndarray
    sides: np.ndarray


@dataclass
class _Frames:
    """n primitives of one kind in space: `place` (n, 3), `axes` (n, 3, 3), an axis a row, whose meaning is the kind's,
    `taper` (n,), `sides` (n,) that can be seen, -1, 0 (both) or 1, `material` (n,) int."""

    kind: LightKind
    place: np.ndarray
    axes: np.ndarray
    taper: np.ndarray
    sides: np.ndarray
    material: np.ndarray

    def moved(self, matrices):
        """Once for each of matrices (m, 4, 4): (m n,)."""
        count, linear = len(matrices), np.asarray(matrices[:, :3, :3], np.float64)
        place = np.einsum("mij,nj->mni", linear, self.place) + matrices[:, None, :3, 3]
        axes = np.einsum("mij,nkj->mnki", linear, self.axes)
        mirrored = np.linalg.det(linear) < 0.0
        if self.kind in (LightKind.ELLIPSOID, LightKind.TUBE):  # round about: the other way round
            axes[mirrored, :, :2] = axes[mirrored, :, 1::-1]
        else:
            axes[..., 2, :] = np.cross(axes[..., 0, :], axes[..., 1, :])
            axes[mirrored, :, 2] *= -1.0
        taper, sides, material = (np.tile(x, count) for x in (self.taper, self.sides, self.material))
        return _Frames(self.kind, place.reshape(-1, 3), axes.reshape(-1, 3, 3), taper, sides, material)

    def take(self, rows):
        parts = (self.place, self.axes, self.taper, self.sides, self.material)
        return _Frames(self.kind, *(part[rows] for part in parts))


def find_emitters(scene, plan, materials, origin, first):
    """The `Emitters` of a scene, relative to an origin (3,); they get the numbers of lights from `first` on.
    `materials` is the `MaterialTable`."""
    glow, warnings = _glow(materials.materials), []
    found, count = [], 0
    if glow.color.any():
        for frames, seen in _shining(scene, plan, glow):
            found.append((frames, seen))
            count += len(frames.place)
            if count > _MOST:
                warnings.append(f"more than {_MOST:,} surfaces glow: they are seen but light nothing; use lamps")
                found = []
                break
        if any((glow.color[planes.material] > 0.0).any() for planes in scene.planes):
            warnings.append("an infinite plane that glows is seen but lights nothing; use a mesh or a disc")
    parts = [_packed(frames, seen, glow, origin) for frames, seen in found]
    parts.append((layout.LIGHT.zeros(0), layout.LIGHT_SHAPE.zeros(0), _no_bounds(), np.zeros(0), np.zeros(0, np.int64)))
    lights, shapes, bounds, area, found = zip(*parts, strict=True)
    lights, bounds = np.concatenate(lights), LightBounds.concatenate(bounds)
    bounds.light = np.arange(first, first + len(lights))
    varies = bool((lights["emitter"] == _VARIES).any())
    area, material = np.concatenate(area), np.concatenate(found)
    shared = ~np.isin(material, _found_by_rays(scene, materials.materials))
    return Emitters(lights, np.concatenate(shapes), bounds, varies, warnings, area, np.where(shared, material, -1))


def _found_by_rays(scene, materials):
    """Numbers of materials of which not all that is seen to glow is a light."""
    partly = [number for number, material in enumerate(materials) if material.emission != "BOTH"]
    return np.concatenate([partly, *(np.unique(planes.material) for planes in scene.planes)])


def _glow(materials):
    color, varies = np.zeros((len(materials), 3)), np.zeros(len(materials), bool)
    for number, material in enumerate(materials):
        if material.emission == "NONE":
            continue
        glow = constant_of(material.glow)
        varies[number] = glow is None
        color[number] = 1.0 if glow is None else glow
    sides = np.array([_SIDES.get(m.emission, 0) for m in materials])
    culled = np.array([m.cull_back for m in materials])
    color[culled & (sides < 0)] = 0.0
    return _Glow(np.maximum(color, 0.0), varies, np.where(culled, 1, sides))


def _shining(scene, plan, glow):
    """The `_Frames` in world space of all primitives that glow, by kind and instances, and the rays that see them."""
    blocks = [(scene.shapes, _IDENTITY, None, Visibility.ALL)]
    blocks += [(p.geometry, p.matrices, p.materials, p.visibility) for p in plan.placed]
    for geometry, matrices, slots, visibility in blocks:
        seen = int(visibility) & _RAYS
        if not seen:
            continue
        of_slot = np.arange(len(glow.color)) if slots is None else np.asarray(slots)
        for _, part in geometry.kinds():
            material = of_slot[part.material]
            rows = (glow.color[material] > 0.0).any(axis=1)
            if rows.any():
                yield _FRAMES[type(part)](part.take(rows), material[rows]).moved(matrices), seen


# Frames of each kind in the space of its geometry.


def _spheres(part, material):
    axes = np.abs(part.radius)[:, None, None] * np.eye(3)
    sides = np.where(part.radius < 0.0, -1, 0)
    return _Frames(LightKind.ELLIPSOID, np.asarray(part.center, np.float64), axes, np.zeros(len(part)), sides, material)


def _tubes(part, material, base, apex, base_radius, apex_radius):
    inside = np.asarray(base_radius) + apex_radius < 0.0
    base_radius, apex_radius = np.abs(base_radius), np.abs(apex_radius)
    turned = (apex_radius > base_radius)[:, None]  # the wider end first
    base, apex = np.where(turned, apex, base).astype(np.float64), np.where(turned, base, apex)
    wide, narrow = np.maximum(base_radius, apex_radius), np.minimum(base_radius, apex_radius)
    along = apex - base
    unit = along / np.linalg.norm(along, axis=1, keepdims=True)
    x = perpendicular_part(np.broadcast_to((1.0, 0.0, 0.0), unit.shape), unit)
    axes = np.stack([wide[:, None] * x, wide[:, None] * np.cross(unit, x), along], axis=1)
    return _Frames(LightKind.TUBE, base, axes, narrow / wide, np.where(inside, -1, 0), material)


def _cylinders(part, material):
    return _tubes(part, material, part.base, part.apex, part.radius, part.radius)


def _cones(part, material):
    return _tubes(part, material, part.base, part.apex, part.base_radius, part.apex_radius)


def _discs(part, material):
    x = perpendicular_part(np.broadcast_to((1.0, 0.0, 0.0), part.normal.shape), part.normal)
    radius = np.asarray(part.radius)[:, None]
    axes = np.stack([radius * x, radius * np.cross(part.normal, x), part.normal], axis=1)
    none = np.zeros(len(part))
    return _Frames(LightKind.ELLIPSE, np.asarray(part.center, np.float64), axes, none, none.astype(int), material)


def _triangles(part, material):
    p0 = np.asarray(part.p0, np.float64)
    first, second = part.p1 - p0, part.p2 - p0
    axes = np.stack([first, second, np.cross(first, second)], axis=1)
    whole = np.linalg.norm(axes[:, 2], axis=1) > 0.0
    frames = _Frames(LightKind.TRIANGLE, p0, axes, np.zeros(len(part)), np.where(part.one_sided, 1, 0), material)
    return frames.take(whole)


_FRAMES = {Spheres: _spheres, Cylinders: _cylinders, Cones: _cones, Discs: _discs, Triangles: _triangles}


# Records.


def _packed(frames, seen, glow, origin):
    """(lights, shapes, bounds, area, material) of `_Frames` that the rays `seen` see."""
    frames = frames.take(frames.sides * glow.sides[frames.material] >= 0)  # else what shines is not seen
    sides = np.where(frames.sides != 0, frames.sides, glow.sides[frames.material])
    color = glow.color[frames.material]
    ball = _ball_radius(frames, sides)
    center, radius, shown = _MEASURES[frames.kind](frames)
    radius, shown = np.where(ball > 0.0, ball, radius), np.where(ball > 0.0, ball**2, shown)
    flat = frames.kind in (LightKind.ELLIPSE, LightKind.TRIANGLE)

    lights, shapes = layout.LIGHT.zeros(len(sides)), layout.LIGHT_SHAPE.zeros(len(sides))
    lights["position"], lights["sides"] = frames.place - origin, sides
    lights["kind"] = np.where(ball > 0.0, int(LightKind.POINT), int(frames.kind))
    lights["color"] = np.where(flat | (ball > 0.0), shown, 1.0 / np.pi)[:, None] * color
    lights["visibility"] = seen | Visibility.SHADOW
    lights["emitter"] = np.where(glow.varies[frames.material], _VARIES, _CONSTANT)
    normal = frames.axes[:, 2] / np.linalg.norm(frames.axes[:, 2], axis=1, keepdims=True)
    shapes["axis_x"], shapes["axis_y"] = frames.axes[:, 0], frames.axes[:, 1]
    shapes["axis_z"] = normal if flat else frames.axes[:, 2]
    shapes["radius"], shapes["falls_off"], shapes["taper"] = ball, 1.0, frames.taper

    one_sided = flat & (sides != 0)
    bounds = _no_bounds(len(sides))
    bounds.center, bounds.radius, bounds.color = center - origin, radius, shown[:, None] * color
    bounds.axis = normal * np.where(sides < 0, -1.0, 1.0)[:, None]
    bounds.cos_axis, bounds.cos_reach = np.where(one_sided, 1.0, ALL_SIDES), np.where(one_sided, 0.0, -1.0)
    bounds.group[:, 0], bounds.group[:, 3], bounds.group[:, 5] = 1, one_sided, seen
    return lights, shapes, bounds, np.pi * shown, frames.material


def _ball_radius(frames, sides):
    """Radius (n,) of what is a round ball seen from outside, else 0."""
    if frames.kind != LightKind.ELLIPSOID:
        return np.zeros(len(sides))
    x, y, z = np.moveaxis(frames.axes, 1, 0)
    lengths = np.linalg.norm(frames.axes, axis=2)
    size = lengths.max(axis=1)
    askew = np.abs(np.stack([dot(x, y), dot(y, z), dot(z, x)])).max(axis=0)
    even = (np.ptp(lengths, axis=1) < 1e-5 * size) & (askew < 1e-5 * size**2)
    return np.where(even & (sides >= 0), size, 0.0)


# Center (n, 3) and radius (n,) of a sphere around each, and the area (n,) that it shows on the mean, over pi.


def _ellipsoid_measure(frames):
    x, y, z = np.moveaxis(frames.axes, 1, 0)
    faces = np.linalg.norm(np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)]), axis=2)
    return frames.place, np.linalg.norm(frames.axes, axis=(1, 2)), faces.mean(axis=0)


def _tube_measure(frames):
    lengths = np.linalg.norm(frames.axes, axis=2)
    radius = lengths[:, 2] / 2.0 + np.hypot(lengths[:, 0], lengths[:, 1])
    shown = (1.0 + frames.taper) * lengths[:, 2] * lengths[:, :2].max(axis=1) / np.pi
    return frames.place + frames.axes[:, 2] / 2.0, radius, shown


def _disc_measure(frames):
    area = np.pi * np.linalg.norm(np.cross(frames.axes[:, 0], frames.axes[:, 1]), axis=1)
    return frames.place, np.linalg.norm(frames.axes[:, :2], axis=(1, 2)), area / np.pi


def _triangle_measure(frames):
    corners = np.stack([np.zeros_like(frames.place), frames.axes[:, 0], frames.axes[:, 1]], axis=1)
    center = corners.mean(axis=1)
    area = np.linalg.norm(np.cross(corners[:, 1], corners[:, 2]), axis=1) / 2.0
    return frames.place + center, np.linalg.norm(corners - center[:, None], axis=2).max(axis=1), area / np.pi


_MEASURES = {
    LightKind.ELLIPSOID: _ellipsoid_measure,
    LightKind.TUBE: _tube_measure,
    LightKind.ELLIPSE: _disc_measure,
    LightKind.TRIANGLE: _triangle_measure,
}


def _no_bounds(count=0):
    """`LightBounds` of lights that fall off, to be filled in."""
    vectors, numbers = np.zeros((count, 3)), np.zeros(count)
    return LightBounds(
        center=vectors,
        radius=numbers,
        axis=vectors,
        cos_axis=numbers,
        cos_reach=numbers,
        color=vectors,
        falls_off=np.ones(count),
        light=np.zeros(count, np.int64),
        group=np.zeros((count, 8), np.int64),
    )
