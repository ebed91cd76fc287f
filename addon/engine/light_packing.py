"""Lights as records: lamps, then the surfaces that glow, and the tree over both where they are many."""

from dataclasses import dataclass

import numpy as np

from . import layout
from .emitters import find_emitters
from .errors import SceneError
from .light import LightKind
from .light_tree import ALL_SIDES, LightBounds, build_light_tree
from .visibility import Visibility

#: So many lights are all asked; more are chosen from.
FEW_LIGHTS = 8
#: In a picture of one sample lamps that together are seen under a small angle, in radians, count as one: none up to the
#: first number of lamps, from the second on those under the angle. A surface amid 1,000 then casts about 100 rays, and
#: what is in no shadow is wrong by the square of the angle.
_CUT_NONE, _CUT_COUNT, _CUT_ANGLE = 48, 1000, 0.35

_AREAS = (LightKind.RECTANGLE, LightKind.ELLIPSE)
#: 1 over the range of cosines in which the edge of a cone without blend grows bright: none.
_SHARP = 1e30
#: Lamps that rays look for, one after the other.
_MOST_SEEN = 64
#: Lights that a surface chooses from many, as in `light_tree_lib.glsl`.
_PICKS = 4
#: In place of an area where rays alone find the light.
_BY_RAYS = 1e30
#: Where suns are in the tree.
_FAR = 1e15
_RAYS = int(Visibility.DIFFUSE | Visibility.GLOSSY | Visibility.TRANSMISSION)


@dataclass(frozen=True)
class PackedLights:
    """`records`: of `layout.LIGHT`, LIGHT_SHAPE and LIGHT_NODE by name. `frame` and `features`: of the shader.
    `varies`: whether some surface glows differently from place to place. `warnings`: sentences. `glow_area` (m,): of
    materials, see `layout.MATERIAL`."""

    records: dict
    frame: dict
    features: set
    varies: bool
    warnings: list
    glow_area: np.ndarray


def pack_all_lights(scene, plan, materials, origin):
    """The `PackedLights` of a scene, relative to an origin (3,); `materials` is the `MaterialTable`."""
    order = sorted(scene.lights, key=lambda light: not _is_seen(light))
    seen = min(sum(map(_is_seen, order)), _MOST_SEEN)
    shared = np.array([light.shadow and not light.receivers and not light.blockers for light in order[:seen]], bool)
    lamps, shapes = pack_lights(order, origin)
    emitters = find_emitters(scene, plan, materials, origin, len(lamps))
    shaped = len(shapes) > 0 or len(emitters) > 0
    nodes = layout.LIGHT_NODE.zeros(0)
    shows = np.array([light.shown_area for light in order] + emitters.area.tolist())
    if len(lamps) + len(emitters) > FEW_LIGHTS:
        shaped = True
        bounds = LightBounds.concatenate([lamp_bounds(order, origin), emitters.bounds])
        nodes = build_light_tree(bounds)
        part = bounds.color.mean(axis=1) / max(bounds.color.mean(axis=1).sum(), 1e-300)
        shows /= np.maximum(_PICKS * part, 1e-30)
    if shaped and not len(shapes):
        shapes = _shapes(order)
    glow_area = np.full(len(materials.materials), _BY_RAYS)
    if shaped:
        shapes["seen_area"][:seen] = np.where(shared, shows[:seen], 0.0)
        glow_area = _shared_area(emitters, shows[len(lamps) :], glow_area)
        emitters.shapes["seen_area"] = np.where(emitters.found < 0, _BY_RAYS, glow_area[emitters.found])
    records = {
        "light": np.concatenate([lamps, emitters.lights]),
        "light_shape": np.concatenate([shapes, emitters.shapes]) if shaped else shapes,
        "light_node": nodes,
    }
    of_lamps = np.flatnonzero(nodes["light"] < len(lamps))
    frame = {
        "light_count": len(lamps),
        "emitter_count": len(emitters),
        "light_node_count": len(nodes),
        "light_cut_end": of_lamps[-1] + 1 if len(of_lamps) else 0,
        "light_cut_angle": _cut_angle(len(lamps)),
        "seen_lamp_count": seen,
    }
    features = {
        "HAS_LIGHT_SHAPES": shaped,
        "HAS_LIGHT_TREE": len(nodes) > 0,
        "HAS_SEEN_LAMPS": seen > 0,
        "HAS_EMITTERS": len(emitters) > 0,
        "HAS_VARYING_EMITTERS": emitters.varies,
        "HAS_LIGHT_VISIBILITY": any(~int(bits) & _RAYS for bits in records["light"]["visibility"]),
        "HAS_LIGHT_LINKING": bool((records["light"]["receivers"] + records["light"]["blockers"]).any()),
        "HAS_VISIBILITY": bool(records["light"]["blockers"].any()),
    }
    used = {name for name, holds in features.items() if holds}
    warnings = list(emitters.warnings)
    if len(order) > seen and _is_seen(order[seen]):
        warnings.append(f"only {seen} of the lights are seen themselves; use surfaces that glow to see more")
    return PackedLights(records, frame, used, emitters.varies, warnings, glow_area)


def _is_seen(light):
    """Whether rays meet a light."""
    rays = Visibility.CAMERA | Visibility.GLOSSY | Visibility.TRANSMISSION
    return light.shown_area > 0.0 and bool(light.visibility & rays)


def _shared_area(emitters, shows, glow_area):
    """Areas (m,) of materials: the mean of their primitives', of which all rays and samples know."""
    shared = emitters.found >= 0
    count = np.bincount(emitters.found[shared], minlength=len(glow_area))
    total = np.bincount(emitters.found[shared], shows[shared], minlength=len(glow_area))
    return np.where(count > 0, total / np.maximum(count, 1), glow_area)


def _cut_angle(lamps):
    """The angle for a number of lamps; -1: none is left out."""
    if lamps <= _CUT_NONE:
        return -1.0
    return _CUT_ANGLE * min(np.log(lamps / _CUT_NONE) / np.log(_CUT_COUNT / _CUT_NONE), 1.0)


def pack_lights(lights, origin):
    """Records of `layout.LIGHT`, relative to an origin (3,), and of `layout.LIGHT_SHAPE`: of all lights where one has a
    shape, else none. Raises SceneError for lights that are not finite."""
    records = layout.LIGHT.zeros(len(lights))
    for record, light in zip(records, lights, strict=True):
        offset = 0.0 if light.kind == LightKind.SUN else origin
        record["position"] = np.subtract(light.position, offset)
        record["kind"], record["color"], record["visibility"] = light.kind, light.color, light.rays
        record["receivers"], record["blockers"] = light.receivers, light.blockers
        record["sides"] = light.kind in _AREAS
    shapes = _shapes(lights) if any(light.shaped for light in lights) else layout.LIGHT_SHAPE.zeros(0)
    for array in (records, shapes):
        if not np.isfinite(array.view(np.float32)).all():
            raise SceneError("a light has a position, a color or a shape that is not finite")
    return records, shapes


def _shapes(lights):
    shapes = layout.LIGHT_SHAPE.zeros(len(lights))
    for record, light in zip(shapes, lights, strict=True):
        record["axis_x"], record["axis_y"], record["axis_z"] = light.axes
        record["radius"], record["soft"], record["falls_off"] = light.radius, light.soft, light.falls_off
        if light.kind == LightKind.SPOT:
            edge = np.cos(light.angle / 2.0)
            record["edge"], record["slope"] = edge, 1.0 / max((1.0 - edge) * light.blend, 1.0 / _SHARP)
        if light.kind in _AREAS:
            record["spread"] = 1.0 / np.tan(light.angle / 2.0) if light.angle < np.pi else 0.0
    return shapes


def lamp_bounds(lights, origin):
    """`LightBounds` of lamps, relative to an origin (3,)."""
    rows = [_bounds(light, origin) for light in lights]
    center, radius, axis, cos_axis, cos_reach = zip(*rows, strict=True) if rows else ([],) * 5
    falls_off = [light.falls_off and light.kind not in (LightKind.CONSTANT, LightKind.SUN) for light in lights]
    group = [
        (0, light.kind == LightKind.SUN, falls, light.kind in _AREAS, light.kind == LightKind.SPOT, *_links(light))
        for light, falls in zip(lights, falls_off, strict=True)
    ]
    return LightBounds(
        np.array(center, np.float64).reshape(-1, 3),
        np.array(radius, np.float64),
        np.array(axis, np.float64).reshape(-1, 3),
        np.array(cos_axis, np.float64),
        np.array(cos_reach, np.float64),
        np.array([light.color for light in lights], np.float64).reshape(-1, 3),
        np.array(falls_off, np.float64),
        np.arange(len(lights)),
        np.array(group, np.int64).reshape(-1, 8),
    )


def _links(light):
    return int(light.rays), int(light.receivers), int(light.blockers)


def _bounds(light, origin):
    """(center, radius, axis, cos_axis, cos_reach) of a lamp, see `LightBounds`."""
    if light.kind == LightKind.SUN:
        towards = np.asarray(light.position, np.float64)
        return _FAR * towards, 2.0 * _FAR * np.sin(light.radius / 2.0), -towards, ALL_SIDES, -1.0
    center, axes = np.subtract(light.position, origin), np.array(light.axes, np.float64)
    if light.kind == LightKind.SPOT:
        return center, light.radius, *_spot_cone(axes, light.angle / 2.0)
    if light.kind in _AREAS:
        sides = np.linalg.norm(axes[:2], axis=1)
        radius = sides.max() if light.kind == LightKind.ELLIPSE else np.linalg.norm(sides)
        reach = np.linalg.norm(axes[:2].sum(axis=0)), np.linalg.norm(axes[0] - axes[1])  # askew
        return center, max(radius, *reach), axes[2], 1.0, np.cos(light.angle / 2.0)
    return center, light.radius, (0.0, 0.0, 1.0), ALL_SIDES, -1.0


def _spot_cone(axes, half, rays=64):
    """(axis, cos_axis, cos_reach) of a spot whose cone is round, of `half` its angle, under the matrix `axes`."""
    to_world = np.linalg.inv(axes)
    around = np.linspace(0.0, 2.0 * np.pi, rays, endpoint=False)
    edge = np.stack([np.sin(half) * np.cos(around), np.sin(half) * np.sin(around), np.full(rays, np.cos(half))])
    axis, edge = to_world[:, 2] / np.linalg.norm(to_world[:, 2]), to_world @ edge
    cosine = (axis @ edge / np.linalg.norm(edge, axis=0)).min()
    if cosine < 1e-6:  # a half space or what is stretched to nearly one
        return axis, 1.0, min(cosine, 0.0) - 1e-3
    return axis, 1.0, np.cos(min(1.01 * np.arccos(min(cosine, 1.0)) + 1e-3, np.pi))
