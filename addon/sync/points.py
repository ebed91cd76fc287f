# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds as spheres."""

from dataclasses import dataclass

import numpy as np

from ..engine.scene import Geometry, Spheres
from .attributes import of_points
from .raw_attributes import FARTHEST, are_places, read_positions, read_raw

#: The radius of points that have none, as in Blender.
DEFAULT_RADIUS = 0.01


@dataclass(frozen=True)
class PointSpheres:
    """The Geometry of a point cloud, None where it has no sphere, and how many points were left out: those whose
    place or radius is not finite, and those whose radius is not above 0."""

    geometry: Geometry | None
    not_finite: int = 0
    without_radius: int = 0


def read_points(cloud, slot_count, keys=()):
    """The `PointSpheres` of an evaluated point cloud; `keys` of the attributes to read. The material of a point is the
    slot, as Blender clamps it to `slot_count`."""
    count = len(cloud.points)
    center = read_positions(cloud)
    radius = read_raw(cloud, "radius", "POINT", "FLOAT")
    radius = np.full(count, DEFAULT_RADIUS, np.float32) if radius is None else radius
    slots = read_raw(cloud, "material_index", "POINT", "INT")
    finite = np.isfinite(radius)
    if count and not np.abs(center).max() <= FARTHEST:  # much faster than row by row
        finite &= are_places(center)
    good = finite & (radius > 0.0)
    not_finite, kept = int(count - finite.sum()), int(good.sum())
    without_radius = count - not_finite - kept
    if not kept:
        return PointSpheres(None, not_finite, without_radius)
    spheres = Spheres(
        center=np.where(good[:, None], center, 0.0) if kept < count else center,
        radius=np.where(good, radius, 1.0) if kept < count else radius,
        material=0 if slots is None or not slots.any() else np.clip(slots, 0, slot_count - 1),
        attributes=of_points(cloud, keys),
    )
    spheres = spheres.take(good) if kept < count else spheres
    return PointSpheres(Geometry(spheres, name=cloud.name), not_finite, without_radius)
