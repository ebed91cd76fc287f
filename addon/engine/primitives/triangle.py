"""The triangle (paper 3.1.5 and 3.2.2), with vertex normals and uv."""

import numpy as np

from ..layout import TRIANGLE, TRIANGLE_SURFACE
from .base import Column, Primitives, dot, fill


class Triangles(Primitives):
    """Triangles: p0, p1, p2 (n, 3), n0, n1, n2 (n, 3) vertex normals, uv0, uv1, uv2 (n, 2), material, one_sided (n,).

    Normals of any length count by their direction; all zero (the default): a flat triangle. `one_sided`: seen only from
    where the vertices run counter-clockwise.
    """

    kind = "triangle"
    attribute_places = 3
    record = TRIANGLE
    surface_record = TRIANGLE_SURFACE
    columns = (
        *(Column(name, 3) for name in ("p0", "p1", "p2")),
        *(Column(name, 3, default=(0.0, 0.0, 0.0)) for name in ("n0", "n1", "n2")),
        Column("uv0", 2, default=(0.0, 0.0)),
        Column("uv1", 2, default=(1.0, 0.0)),
        Column("uv2", 2, default=(0.0, 1.0)),
        Column("material", default=0, integer=True),
        Column("one_sided", default=0, integer=True),
    )

    def bounds(self):
        lower = np.minimum(np.minimum(self.p0, self.p1), self.p2)
        return lower, np.maximum(np.maximum(self.p0, self.p1), self.p2)

    def transformed(self, similarity):
        points = {name: similarity.points(getattr(self, name)) for name in ("p0", "p1", "p2")}
        normals = {name: similarity.directions(getattr(self, name)) for name in ("n0", "n1", "n2")}
        return self._with(points | normals)

    def records(self):
        hit = self.record.zeros(len(self))
        surface = self.surface_record.zeros(len(self))
        fill(hit, p0=self.p0, p1=self.p1, p2=self.p2, one_sided=self.one_sided)
        fill(surface, n0=_unit_or_zero(self.n0), n1=_unit_or_zero(self.n1), n2=_unit_or_zero(self.n2))
        fill(surface, u0=self.uv0[:, 0], v0=self.uv0[:, 1], uv1=self.uv1, uv2=self.uv2, material=self.material)
        return hit, surface

    def reference_hit(self, origin, direction, t_min=0.0):
        p0 = np.asarray(self.p0, np.float64)
        normal = np.cross(self.p1 - p0, self.p2 - p0)
        facing = dot(normal, direction)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = dot(normal, p0 - origin) / facing
            u, v = self._affine(origin + t[:, None] * direction)
            inside = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0)  # (22)
        visible = np.where(self.one_sided != 0, facing < 0.0, facing != 0.0)
        return np.where(visible & inside & (t > t_min), t, np.inf)

    def _affine(self, point):
        """u', v' (n,) of points in the triangles' planes, equations (17) to (21) with d measured from p0."""
        p0 = np.asarray(self.p0, np.float64)
        e1, e2, d = self.p1 - p0, self.p2 - p0, point - p0
        e11, e12, e22 = dot(e1, e1), dot(e1, e2), dot(e2, e2)
        cross = np.cross(e1, e2)
        s = dot(cross, cross)
        with np.errstate(divide="ignore", invalid="ignore"):
            return (e22 * dot(e1, d) - e12 * dot(e2, d)) / s, (e11 * dot(e2, d) - e12 * dot(e1, d)) / s

    def reference_surface(self, point):
        p0 = np.asarray(self.p0, np.float64)
        u, v = (value[:, None] for value in self._affine(point))
        w = 1.0 - u - v
        flat = np.cross(self.p1 - p0, self.p2 - p0)
        n0, n1, n2 = (_unit_or_zero(n) for n in (self.n0, self.n1, self.n2))
        smooth = w * n0 + u * n1 + v * n2
        normal = np.where((smooth == 0.0).all(axis=-1, keepdims=True), flat, smooth)
        normal = normal / np.linalg.norm(normal, axis=-1, keepdims=True)
        return normal, w * self.uv0 + u * self.uv1 + v * self.uv2


def _unit_or_zero(vectors):
    """Vectors (n, 3) at unit length; those without length stay zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0.0, length, 1.0)
