"""The disc (paper 3.1.7 and 3.2.4)."""

import numpy as np

from ..layout import DISC, DISC_SURFACE
from .base import Column, Primitives, dot, fill, perpendicular_part

IDENTITY_UV = (1.0, 1.0, 0.0, 0.0)


class Discs(Primitives):
    """Discs: center (n, 3), normal (n, 3), radius (n,), material (n,) int, meridian (n, 3), uv_transform (n, 4).

    `uv_transform` (su, sv, ou, ov) maps the paper's uv to (su * u + ou, sv * v + ov), for discs that stand for a part
    of a mesh with a uv map of its own.
    """

    kind = "disc"
    record = DISC
    surface_record = DISC_SURFACE
    columns = (
        Column("center", 3),
        Column("normal", 3, unit=True),
        Column("radius"),
        Column("material", default=0, integer=True),
        Column("meridian", 3, default=(1.0, 0.0, 0.0), unit=True),
        Column("uv_transform", 4, default=IDENTITY_UV),
    )

    def _check(self):
        self._refuse(self.radius <= 0.0, "the radius must be positive")

    def bounds(self):
        # The extent of a circle along an axis is R times the sine of the angle between the axis and the normal.
        extent = self.radius[:, None] * np.sqrt(np.maximum(1.0 - self.normal**2, 0.0))
        return self.center - extent, self.center + extent

    def transformed(self, similarity):
        return self._with(
            {
                "center": similarity.points(self.center),
                "normal": similarity.directions(self.normal),
                "radius": self.radius * similarity.scale,
                "meridian": similarity.directions(self.meridian),
            }
        )

    def records(self):
        hit = self.record.zeros(len(self))
        fill(hit, center=self.center, radius=self.radius, normal=self.normal)
        surface = self.surface_record.zeros(len(self))
        meridian = perpendicular_part(self.meridian, self.normal)
        fill(surface, meridian=meridian, material=self.material, uv_transform=self.uv_transform)
        return hit, surface

    def reference_hit(self, origin, direction, t_min=0.0):
        facing = dot(self.normal, direction)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = dot(self.normal, self.center - origin) / facing
            offset = origin + t[:, None] * direction - self.center
            inside = dot(offset, offset) <= self.radius.astype(np.float64) ** 2
        return np.where((facing != 0.0) & (t > t_min) & inside, t, np.inf)

    def reference_surface(self, point):
        offset = (point - self.center) / (2.0 * self.radius[:, None])
        e0 = perpendicular_part(self.meridian, self.normal)
        uv = np.stack([dot(offset, e0), dot(offset, np.cross(self.normal, e0))], axis=-1) + 0.5  # (7)
        return self.normal.copy(), uv * self.uv_transform[:, :2] + self.uv_transform[:, 2:]
