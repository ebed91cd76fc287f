# SPDX-License-Identifier: GPL-3.0-or-later
"""The hair of particle systems as strands, as Cycles takes it: Catmull-Rom curves through Blender's cached paths.

Blender gives one point of one hair a call; 10,000 hairs of 9 points take about a quarter of a second.
"""

from array import array
from dataclasses import dataclass, replace

import numpy as np

from . import strand_values
from .attributes import randoms
from .curve_sampling import CATMULL_ROM, ControlCurves, sample
from .curves import Read


@dataclass(frozen=True)
class ParticleHair:
    """The hair of one particle system: its name, and what was read."""

    name: str
    read: Read


def strands_of_particles(obj, sampling, render, slot_count=1, keys=()):
    """The `ParticleHair` of each particle system of an evaluated object that shows hair as paths, in object space.

    `render`: the final picture, with the steps and children for it, else those of the viewport. `keys` of the
    attributes to read: hairs have but those of Hair Info.
    """
    found, hairs = [], 0
    for modifier in obj.modifiers:
        if modifier.type != "PARTICLE_SYSTEM" or not (modifier.show_render if render else modifier.show_viewport):
            continue
        system = modifier.particle_system
        settings = system.settings
        if settings.type == "HAIR" and settings.render_type == "PATH":
            slot = min(max(settings.material - 1, 0), slot_count - 1)
            points = _paths(obj, system, _numbers(system, settings, render), _point_count(settings, render))
            curves = _curves(points, settings)
            values = strand_values.of_points(keys, curves.points, curves.offsets, curves.radius)
            samples = sample(replace(curves, attributes=values), sampling)
            of_hair = randoms(keys, len(points), hairs)
            of_hair |= strand_values.of_curves(keys, curves.points, curves.offsets)
            of_hair |= strand_values.of_roots(keys, obj.data, points[:, 0])
            read = Read.of(samples, system.name, material=slot, of_polylines=of_hair)
            found.append(ParticleHair(system.name, read))
            hairs += len(points)
    return found


def _curves(points, settings):
    """The `ControlCurves` of hairs with points (hairs, keys, 3)."""
    count, keys = points.shape[:2]
    return ControlCurves(
        points=points.reshape(-1, 3),
        offsets=np.arange(count + 1) * keys,
        radius=_radii(points, settings).reshape(-1),
        kind=np.full(count, CATMULL_ROM),
        cyclic=np.zeros(count, bool),
        resolution=np.full(count, 1),
    )


def _numbers(system, settings, render):
    """The range of Blender's numbers of the hairs that show: the children where there are any, else the parents."""
    parents, children = len(system.particles), len(system.child_particles)
    if not render:
        children = children * settings.display_percentage // 100
    return range(parents if children and settings.child_type != "NONE" else 0, parents + children)


def _point_count(settings, render):
    steps = 2 ** (settings.render_step if render else settings.display_step)
    return steps + 1 + (settings.kink_extra_steps if settings.kink == "SPIRAL" else 0)


def _paths(obj, system, numbers, keys):
    """Points (hairs, keys, 3) float64 in object space."""
    flat, place, steps = array("d"), system.co_hair, range(keys)
    for number in numbers:
        for step in steps:
            flat.extend(place(obj, particle_no=number, step=step))
    world = _with_ends(np.array(flat).reshape(-1, keys, 3))
    # Flattened or not finite, it is placed, or reported, as the object itself.
    matrix = np.nan_to_num(np.array(obj.matrix_world, np.float64), posinf=0.0, neginf=0.0)
    return (world - matrix[:3, 3]) @ np.linalg.pinv(matrix[:3, :3]).T


def _with_ends(points):
    """Points with the last one of a path repeated where Blender gives 0, past the end of a path that has fewer."""
    absent = (points == 0.0).all(axis=2)
    beyond = np.logical_and.accumulate(absent[:, ::-1], axis=1).sum(axis=1)
    last = np.maximum(points.shape[1] - 1 - beyond, 0)
    index = np.minimum(np.arange(points.shape[1]), last[:, None])
    return np.take_along_axis(points, index[..., None], axis=1)


def _radii(points, settings):
    """Radius (hairs, keys) of each point: from root to tip along the length, by the shape's power."""
    sums = np.zeros(points.shape[:2])
    sums[:, 1:] = np.cumsum(np.linalg.norm(np.diff(points, axis=1), axis=2), axis=1)
    total = sums[:, -1:]
    left = 1.0 - sums / np.where(total > 0.0, total, 1.0)
    shape = settings.shape
    if shape < 0.0:
        left = left ** (1.0 + shape)
    elif shape > 0.0:
        left = left ** (1.0 / max(1.0 - shape, 1e-6))
    half = 0.5 * settings.radius_scale
    radius = half * (left * (settings.root_radius - settings.tip_radius) + settings.tip_radius)
    if settings.use_close_tip:
        radius[:, -1] = 0.0
    return radius
