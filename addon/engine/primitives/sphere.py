"""The sphere (paper 3.1.6 and 3.2.3)."""

import numpy as np

from ..layout import FIXED_UV, SPHERE, SPHERE_SURFACE
from .base import Column, Primitives, angle_u, dot, fill, is_one_value, nearest_root, perpendicular_part


class Spheres(Primitives):
    """Spheres: center (n, 3), radius (n,), material (n,) int, pole (n, 3), meridian (n, 3), fixed_uv (n, 2).

    The pole e2 is where v = 1, the meridian e0 where u = 0. A negative radius shows the inside only. `fixed_uv` is the
    uv of the whole sphere, NaN for none.
    """

    kind = "sphere"
    intersection_cost_of_many = 0.25  # a leaf holds some, and a sphere takes less than 48 bytes, its tree included
    record = SPHERE
    surface_record = SPHERE_SURFACE
    columns = (
        Column("center", 3),
        Column("radius"),
        Column("material", default=0, integer=True),
        Column("pole", 3, default=(0.0, 0.0, 1.0), unit=True),
        Column("meridian", 3, default=(1.0, 0.0, 0.0), unit=True),
        Column("fixed_uv", 2, default=(np.nan, np.nan), optional=True),
    )

    def _check(self):
        self._refuse(self.radius == 0.0, "the radius is 0, a sphere needs one")

    def bounds(self):
        radius = np.abs(self.radius)
        lower = np.empty((len(self), 3), np.result_type(self.center, radius))
        upper = np.empty_like(lower)
        for axis in range(3):  # faster than row by row
            np.subtract(self.center[:, axis], radius, out=lower[:, axis])
            np.add(self.center[:, axis], radius, out=upper[:, axis])
        return lower, upper

    def transformed(self, similarity):
        return self._with(
            {
                "center": similarity.points(self.center),
                "radius": self.radius * similarity.scale,
                "pole": similarity.directions(self.pole),
                "meridian": similarity.directions(self.meridian),
            }
        )

    def records(self):
        hit = self.record.zeros(len(self))
        fill(hit, center=self.center, radius=self.radius)
        surface = self.surface_record.zeros(len(self))
        fill(surface, rotation=self._rotation_parameters(), material=self.material)
        return hit, surface

    def _frames(self):
        """Rotation matrices (n, 3, 3) whose columns are e0, e1, e2."""
        e0 = perpendicular_part(self.meridian, self.pole)
        return np.stack([e0, np.cross(self.pole, e0), self.pole], axis=-1)

    def _rotation_parameters(self):
        """Modified Rodrigues parameters (n, 3) of the frames, tan(angle / 4) times the axis: three numbers without
        loss. (u, v, FIXED_UV) for spheres with one uv."""
        if not all(is_one_value(column) for column in (self.pole, self.meridian, self.fixed_uv)):
            fixed = np.isfinite(self.fixed_uv).all(axis=-1)
            parameters = _rodrigues(self._frames())
            parameters[fixed, :2], parameters[fixed, 2] = self.fixed_uv[fixed], FIXED_UV
            return parameters
        # One for all, most often no rotation.
        one = self._with({name: getattr(self, name)[:1] for name in ("pole", "meridian", "fixed_uv")})
        if np.isfinite(one.fixed_uv).all():
            return np.array([[*one.fixed_uv[0], FIXED_UV]])
        return _rodrigues(one._frames())

    def reference_hit(self, origin, direction, t_min=0.0):
        # The distance of the centre from the ray, (23), keeps its digits where |d|^2 - R^2 would lose them.
        to_center = self.center - origin
        along = dot(to_center, direction)
        across = to_center - along[:, None] * direction
        squared = self.radius.astype(np.float64) ** 2 - dot(across, across)
        s = np.sqrt(np.maximum(squared, 0.0))
        hit = squared >= 0.0
        return nearest_root(along - s, along + s, hit & (self.radius > 0.0), hit, t_min)

    def reference_surface(self, point):
        normal = (point - self.center) / np.abs(self.radius)[:, None]
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        local = np.einsum("nij,ni->nj", self._frames(), normal)
        v = 1.0 - np.arccos(np.clip(local[:, 2], -1.0, 1.0)) / np.pi
        uv = np.stack([angle_u(local[:, 0], local[:, 1]), v], axis=-1)
        return normal, np.where(np.isfinite(self.fixed_uv), self.fixed_uv, uv)


def _rodrigues(frames):
    """Modified Rodrigues parameters (n, 3) of rotation matrices (n, 3, 3): q_xyz / (1 + q_w) with q_w >= 0."""
    m = np.asarray(frames, np.float64)
    trace = np.trace(m, axis1=1, axis2=2)
    # Shepperd's method: of the four ways to the quaternion, take the one that divides by the largest component.
    squared = np.stack([1.0 + trace, *(1.0 + 2.0 * m[:, i, i] - trace for i in range(3))], axis=-1)
    q = np.empty((len(m), 4))
    for pick in range(4):
        rows = np.argmax(squared, axis=-1) == pick
        if rows.any():
            q[rows] = _quaternion(m[rows], pick, np.sqrt(squared[rows, pick]))
    q *= np.where(q[:, :1] < 0.0, -1.0, 1.0)
    return q[:, 1:] / (1.0 + q[:, :1])


def _quaternion(m, pick, root):
    """Unit quaternions (n, 4), w first, from rotation matrices when component `pick` is root / 2."""
    w = (m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1])
    q = np.empty((len(m), 4))
    q[:, pick] = root / 2.0
    if pick == 0:
        for i in range(3):
            q[:, 1 + i] = w[i] / (2.0 * root)
        return q
    i = pick - 1
    q[:, 0] = w[i] / (2.0 * root)
    for j in range(3):
        if j != i:
            q[:, 1 + j] = (m[:, i, j] + m[:, j, i]) / (2.0 * root)
    return q
