"""The infinite plane (paper 3.1.4 and 3.2.1). It has no box and stands in a list outside the tree."""

import numpy as np

from ..layout import PLANE, PLANE_SURFACE
from ..visibility import Visibility
from .base import Column, Primitives, dot, perpendicular_part


class Planes(Primitives):
    """Infinite planes: point (n, 3), normal (n, 3), material (n,) int, meridian (n, 3), tile (n,), visibility (n,) int.

    uv = ((p - point) . e0, (p - point) . e1) / tile with e0 the meridian and e1 = normal x e0, so that an image
    repeats every `tile` units; the paper leaves the plane's uv open.
    """

    kind = "plane"
    record = PLANE
    surface_record = PLANE_SURFACE
    columns = (
        Column("point", 3),
        Column("normal", 3, unit=True),
        Column("material", default=0, integer=True),
        Column("meridian", 3, default=(1.0, 0.0, 0.0), unit=True),
        Column("tile", default=1.0),
        Column("visibility", default=Visibility.ALL, integer=True),
    )

    def _check(self):
        self._refuse(self.tile <= 0.0, "the tile size must be positive")

    def transformed(self, similarity):
        return self._with(
            {
                "point": similarity.points(self.point),
                "normal": similarity.directions(self.normal),
                "meridian": similarity.directions(self.meridian),
                "tile": self.tile * similarity.scale,
            }
        )

    def records(self):
        hit = self.record.zeros(len(self))
        hit["normal"], hit["offset"] = self.normal, -dot(self.normal, self.point)
        hit["visibility"] = self.visibility
        surface = self.surface_record.zeros(len(self))
        surface["meridian"] = perpendicular_part(self.meridian, self.normal) / self.tile[:, None]
        surface["material"], surface["origin"] = self.material, self.point
        return hit, surface

    def reference_hit(self, origin, direction, t_min=0.0):
        facing = dot(self.normal, direction)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = dot(self.normal, self.point - origin) / facing  # (16), W taken from the point
        return np.where((facing != 0.0) & (t > t_min), t, np.inf)

    def reference_surface(self, point):
        offset = point - self.point
        e0 = perpendicular_part(self.meridian, self.normal) / self.tile[:, None]
        return self.normal.copy(), np.stack([dot(offset, e0), dot(offset, np.cross(self.normal, e0))], axis=-1)
