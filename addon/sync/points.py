# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds as spheres."""

from dataclasses import dataclass

import numpy as np

from ..engine.scene import Geometry, Spheres
from .attributes import of_points

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
    center = _read(cloud, "position", "FLOAT_VECTOR", "vector", np.empty((count, 3), np.float32))
    radius = _read(cloud, "radius", "FLOAT", "value", np.full(count, DEFAULT_RADIUS, np.float32))
    slots = _read(cloud, "material_index", "INT", "value", np.zeros(count, np.int32))
    finite = np.isfinite(radius) & np.isfinite(center).all(axis=1)
    good = finite & (radius > 0.0)
    not_finite, kept = int(count - finite.sum()), int(good.sum())
    without_radius = count - not_finite - kept
    if not kept:
        return PointSpheres(None, not_finite, without_radius)
    spheres = Spheres(
        center=np.where(good[:, None], center, 0.0) if kept < count else center,
        radius=np.where(good, radius, 1.0) if kept < count else radius,
        material=np.clip(slots, 0, slot_count - 1) if slots.any() else 0,
        attributes=of_points(cloud, keys),
    )
    spheres = spheres.take(good) if kept < count else spheres
    return PointSpheres(Geometry(spheres, name=cloud.name), not_finite, without_radius)


def _read(cloud, name, data_type, member, values):
    """Fill `values` with a point cloud's attribute, if it has it."""
    attribute = cloud.attributes.get(name)
    if attribute is not None and attribute.data_type == data_type and len(attribute.data) == len(values):
        attribute.data.foreach_get(member, values.reshape(-1))
    return values
