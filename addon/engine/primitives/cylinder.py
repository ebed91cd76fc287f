"""The side of a cylinder (paper 3.1.8 and 3.2.5); its caps are discs."""

import numpy as np

from ..layout import CYLINDER, CYLINDER_SURFACE
from .base import Column, Primitives, angle_u, dot, fill, nearest_root, perpendicular_part
from .disc import IDENTITY_UV


class Cylinders(Primitives):
    """Cylinder sides: base (n, 3), apex (n, 3), radius (n,), material (n,) int, meridian (n, 3), uv_transform (n, 4).

    `base` and `apex` are the centres of the two ends. A negative radius shows the inside only.
    """

    kind = "cylinder"
    attribute_places = 2
    record = CYLINDER
    surface_record = CYLINDER_SURFACE
    columns = (
        Column("base", 3),
        Column("apex", 3),
        Column("radius"),
        Column("material", default=0, integer=True),
        Column("meridian", 3, default=(1.0, 0.0, 0.0), unit=True),
        Column("uv_transform", 4, default=IDENTITY_UV),
    )

    def _check(self):
        self._refuse(self.radius == 0.0, "the radius is 0, a cylinder needs one")
        self._refuse((self.base == self.apex).all(axis=-1), "both ends are the same point, a cylinder needs a length")

    def bounds(self):
        return segment_bounds(self.base, self.apex, np.abs(self.radius), np.abs(self.radius))

    def transformed(self, similarity):
        return self._with(
            {
                "base": similarity.points(self.base),
                "apex": similarity.points(self.apex),
                "radius": self.radius * similarity.scale,
                "meridian": similarity.directions(self.meridian),
            }
        )

    def records(self):
        hit = self.record.zeros(len(self))
        fill(hit, base=self.base, radius=self.radius, axis=self.apex - self.base)
        surface = self.surface_record.zeros(len(self))
        axis, _ = axis_and_length(self.base, self.apex)
        meridian = perpendicular_part(self.meridian, axis)
        fill(surface, meridian=meridian, material=self.material, uv_transform=self.uv_transform)
        return hit, surface

    def reference_hit(self, origin, direction, t_min=0.0):
        return quadric_hit(self.base, self.apex, self.radius, self.radius, origin, direction, t_min)

    def reference_surface(self, point):
        axis, length = axis_and_length(self.base, self.apex)
        offset = point - self.base
        normal = perpendicular_part(offset, axis)
        u = meridian_u(normal, axis, self.meridian)
        uv = np.stack([u, dot(offset, axis) / length], axis=-1)  # (10)
        return normal, uv * self.uv_transform[:, :2] + self.uv_transform[:, 2:]


def axis_and_length(base, apex):
    """Unit axis (n, 3) and length (n,) from base to apex, float64."""
    axis = np.asarray(apex, np.float64) - base
    length = np.linalg.norm(axis, axis=-1)
    return axis / length[:, None], length


def segment_bounds(base, apex, base_radius, apex_radius):
    """Boxes of truncated cones: the union of the boxes of their two end circles."""
    axis, _ = axis_and_length(base, apex)
    sine = np.sqrt(np.maximum(1.0 - axis**2, 0.0))
    lower = np.minimum(base - base_radius[:, None] * sine, apex - apex_radius[:, None] * sine)
    upper = np.maximum(base + base_radius[:, None] * sine, apex + apex_radius[:, None] * sine)
    return lower, upper


def meridian_u(normal, axis, meridian):
    """u of unit vectors (n, 3) around the axis from the meridian, (39)."""
    e0 = perpendicular_part(meridian, axis)
    return angle_u(dot(normal, e0), dot(normal, np.cross(axis, e0)))


def quadric_hit(base, apex, base_radius, apex_radius, origin, direction, t_min):
    """Nearest t (n,) on the sides of truncated cones whose radius grows linearly from base to apex; inf for a miss.

    With R(z) = r0 + k z the side is |(p - base) x axis|^2 = R(z)^2, which contains (34) for k = 0 and (40) for r0 =
    0. Between the ends R is nowhere of the other sign, so the mirrored nappe never counts. Negative radii: only what
    is hit from within counts.
    """
    axis, length = axis_and_length(base, apex)
    outside = np.asarray(base_radius) + apex_radius > 0.0
    r0, r1 = (np.abs(np.asarray(r, np.float64)) for r in (base_radius, apex_radius))
    slope = (r1 - r0) / length
    d = origin - base
    z, dz = dot(d, axis), dot(direction, axis)
    d_across, n_across = d - z[:, None] * axis, direction - dz[:, None] * axis
    radius = r0 + slope * z
    a = dot(n_across, n_across) - (slope * dz) ** 2
    b = dot(d_across, n_across) - slope * dz * radius
    c = dot(d_across, d_across) - radius**2
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(b * b - a * c, 0.0))
        q = -b - np.where(b < 0.0, -1.0, 1.0) * root
        roots = np.stack([q / a, c / q])
    real = (b * b - a * c >= 0.0) & (q != 0.0)
    t0, t1 = (np.where(np.isfinite(t) & real, t, np.inf) for t in roots)
    t0, t1 = np.minimum(t0, t1), np.maximum(t0, t1)

    def valid(t):
        with np.errstate(invalid="ignore"):
            height = z + t * dz
            # The side seen from outside is where the ray goes into the body: against the gradient of the quadric.
            entering = a * t + b < 0.0
            return np.isfinite(t) & (height >= 0.0) & (height <= length) & (outside | ~entering)

    return nearest_root(t0, t1, valid(t0), valid(t1), t_min)
