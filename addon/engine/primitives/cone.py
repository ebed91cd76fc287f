"""The side of a cone, truncated or not (paper 3.1.9 and 3.2.6); its caps are discs."""

import numpy as np

from ..layout import CONE, CONE_SURFACE
from .base import Column, Primitives, dot, fill, perpendicular_part
from .cylinder import axis_and_length, meridian_u, quadric_hit, segment_bounds
from .disc import IDENTITY_UV


class Cones(Primitives):
    """Cone sides: base (n, 3), apex (n, 3), base_radius (n,), apex_radius (n,), material, meridian, uv_transform,
    planar.

    The radius runs linearly from base to apex; one of the two may be 0. v = 0 at the base, 1 at the apex; `planar`
    (n,) bool replaces the paper's uv by a projection along the axis, as Blender's cone has it: 1/2 + d . e0 / 2R with
    R the larger radius. Two negative radii (or one, with 0) show the inside only.
    """

    kind = "cone"
    attribute_places = 2
    record = CONE
    surface_record = CONE_SURFACE
    columns = (
        Column("base", 3),
        Column("apex", 3),
        Column("base_radius"),
        Column("apex_radius", default=0.0),
        Column("material", default=0, integer=True),
        Column("meridian", 3, default=(1.0, 0.0, 0.0), unit=True),
        Column("uv_transform", 4, default=IDENTITY_UV),
        Column("planar", default=0, integer=True),
    )

    def _check(self):
        self._refuse((self.base_radius == 0.0) & (self.apex_radius == 0.0), "both radii are 0, a cone needs one")
        self._refuse(self.base_radius * self.apex_radius < 0.0, "one radius is negative, the other positive")
        self._refuse((self.base == self.apex).all(axis=-1), "both ends are the same point, a cone needs a length")

    def bounds(self):
        return segment_bounds(self.base, self.apex, np.abs(self.base_radius), np.abs(self.apex_radius))

    def transformed(self, similarity):
        return self._with(
            {
                "base": similarity.points(self.base),
                "apex": similarity.points(self.apex),
                "base_radius": self.base_radius * similarity.scale,
                "apex_radius": self.apex_radius * similarity.scale,
                "meridian": similarity.directions(self.meridian),
            }
        )

    def records(self):
        hit = self.record.zeros(len(self))
        fill(hit, base=self.base, axis=self.apex - self.base)
        fill(hit, base_radius=self.base_radius, apex_radius=self.apex_radius)
        surface = self.surface_record.zeros(len(self))
        axis, _ = axis_and_length(self.base, self.apex)
        meridian = perpendicular_part(self.meridian, axis)
        fill(surface, meridian=meridian, material=self.material, uv_transform=self.uv_transform, planar=self.planar)
        return hit, surface

    def reference_hit(self, origin, direction, t_min=0.0):
        return quadric_hit(self.base, self.apex, self.base_radius, self.apex_radius, origin, direction, t_min)

    def reference_surface(self, point):
        axis, length = axis_and_length(self.base, self.apex)
        r0, r1 = np.abs(self.base_radius), np.abs(self.apex_radius)
        offset = point - self.base
        radial = perpendicular_part(offset, axis)
        normal = radial * length[:, None] - axis * (r1 - r0)[:, None]
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        e0 = perpendicular_part(self.meridian, axis)
        spread = 2.0 * np.maximum(r0, r1)
        flat = np.stack([dot(offset, e0), dot(offset, np.cross(axis, e0))], axis=-1) / spread[:, None] + 0.5
        round_uv = np.stack([meridian_u(radial, axis, self.meridian), dot(offset, axis) / length], axis=-1)
        uv = np.where(self.planar[:, None] != 0, flat, round_uv)
        return normal, uv * self.uv_transform[:, :2] + self.uv_transform[:, 2:]
