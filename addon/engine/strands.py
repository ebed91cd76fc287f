"""Thick polylines as primitives: hair, curves and wires.

The solid of a segment is the convex hull of the balls at its two ends: between two spheres a cylinder, or the cone
that is tangent to both. The sphere at a point serves all segments that meet there.

u runs around the strand from a meridian that goes along it without twisting, v from root to tip. A sphere has one uv:
the u opposite the meridian and the v of its point.
"""

from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from . import rotations
from .primitives import Cones, Cylinders, Spheres
from .primitives.base import any_perpendicular, dot
from .scene import Geometry

#: u of the spheres: opposite the meridian, where u is 0.
JOINT_U = 0.5

#: Two radii are the same that differ by less than this part: the rounding of float32.
_SAME_RADIUS = 2.0**-22

#: A ball that sticks out of another by less than this part of their distance counts as inside.
_INSIDE = 1e-6

#: Points that are worked on at a time.
_AT_ONCE = 1 << 16


@dataclass(frozen=True)
class Polylines:
    """Many polylines: number i has the points offsets[i] to offsets[i + 1].

    points (n, 3), offsets (c + 1,) int, radius (n,) or one, cyclic (c,) bool or one, material (c,) int or one.
    v (n,): along the strand, None for 0 at the root to 1 at the tip by length; closed strands come round to v = 1.
    attributes: name -> (n, 4), a value a point; of_polylines: name -> (c, 4), a value a polyline.
    """

    points: np.ndarray
    offsets: np.ndarray
    radius: np.ndarray
    cyclic: np.ndarray = False
    v: np.ndarray | None = None
    material: np.ndarray = 0
    attributes: dict = field(default_factory=dict)
    of_polylines: dict = field(default_factory=dict)

    def part(self, first, stop):
        """The polylines number `first` to `stop`."""
        start, end = self.offsets[first], self.offsets[stop]

        def cut(values, a, b):
            return values if values is None or np.ndim(values) == 0 else values[a:b]

        return Polylines(
            self.points[start:end],
            self.offsets[first : stop + 1] - start,
            cut(self.radius, start, end),
            cut(self.cyclic, first, stop),
            cut(self.v, start, end),
            cut(self.material, first, stop),
            {name: values[start:end] for name, values in self.attributes.items()},
            {name: values[first:stop] for name, values in self.of_polylines.items()},
        )


@dataclass(frozen=True)
class Strands:
    """What polylines or edges became, None for a kind of which there is nothing, and how many of them were dropped for
    places or radii that are not finite."""

    spheres: Spheres | None = None
    cylinders: Cylinders | None = None
    cones: Cones | None = None
    dropped: int = 0

    def geometry(self, name=""):
        """The primitives as a Geometry; None where there is nothing."""
        parts = [part for part in (self.spheres, self.cylinders, self.cones) if part is not None]
        return Geometry(*parts, name=name) if parts else None


def strands(polylines):
    """The `Strands` of `Polylines`. Negative radii count as 0; a polyline of no length is a ball."""
    offsets = np.asarray(polylines.offsets, np.int64)
    polylines = replace(polylines, offsets=offsets)
    # By parts, so that temporaries stay in the cache: twice as fast.
    cuts = np.searchsorted(offsets, np.arange(_AT_ONCE, offsets[-1], _AT_ONCE))
    cuts = np.unique([0, *cuts, len(offsets) - 1])
    made = [_strands(polylines.part(first, stop)) for first, stop in pairwise(cuts)]
    return Strands(
        *(_joined([getattr(part, kind) for part in made]) for kind in ("spheres", "cylinders", "cones")),
        dropped=sum(part.dropped for part in made),
    )


def _joined(parts):
    """Primitives of one kind as one; None where there are none."""
    parts = [part for part in parts if part is not None]
    return type(parts[0]).concatenate(parts) if parts else None


def _strands(polylines):
    points, radius = _points_and_radius(polylines.points, polylines.radius)
    offsets = polylines.offsets
    counts = np.diff(offsets)
    of_point = np.repeat(np.arange(len(counts)), counts)
    bad = np.zeros(len(counts), bool)
    bad[of_point[~_finite(points, radius)]] = True
    used = ~bad[of_point]
    first, ends, closed = _segments(offsets, np.broadcast_to(polylines.cyclic, len(counts)), used)
    v = _v_by_length(points, ends, first) if polylines.v is None else np.asarray(polylines.v, np.float64)
    v_at_ends = v[ends]
    v_at_ends[ends[:, 1] < ends[:, 0], 1] = 1.0
    wires = _Wires(
        points,
        radius,
        v=v,
        material=np.broadcast_to(polylines.material, len(counts))[of_point],
        attributes=_float32(polylines.attributes)
        | {name: values[of_point] for name, values in _float32(polylines.of_polylines).items()},
        ends=ends,
        v_at_ends=v_at_ends,
    )
    return wires.strands(used, lambda axis, rows: _meridians(axis, first[rows], closed[rows]), int(bad.sum()))


def edges(points, ends, radius, material=0, attributes=None):
    """The `Strands` of the edges `ends` (m, 2) int between points (n, 3) with radius (n,) or one, material (n,) int or
    one, and attributes name -> (n, 4). v goes from 0 to 1 along each edge. Points without an edge show nothing."""
    points, radius = _points_and_radius(points, radius)
    ends = np.asarray(ends, np.int64).reshape(-1, 2)
    good = _finite(points, radius)[ends].all(axis=1)
    dropped = int(len(good) - good.sum())
    ends = ends[good]
    used = np.zeros(len(points), bool)
    used[ends] = True
    wires = _Wires(
        points,
        radius,
        v=np.zeros(len(points)),
        material=np.broadcast_to(material, len(points)),
        attributes=_float32(attributes or {}),
        ends=ends,
        v_at_ends=np.broadcast_to((0.0, 1.0), ends.shape),
    )
    return wires.strands(used, lambda axis, _rows: any_perpendicular(axis), dropped)


def _points_and_radius(points, radius):
    points = np.asarray(points, np.float64).reshape(-1, 3)
    return points, np.maximum(np.broadcast_to(np.asarray(radius, np.float64), len(points)), 0.0)


def _finite(points, radius):
    return np.isfinite(points).all(axis=1) & np.isfinite(radius)


def _float32(attributes):
    return {name: np.asarray(values, np.float32) for name, values in attributes.items()}


def _segments(offsets, cyclic, used):
    """The segments between `used` points (n,) bool, polyline after polyline: the number of the first segment of the
    segment's polyline (m,), the points at its ends (m, 2) and whether its polyline is closed (m,) bool."""
    counts = np.diff(offsets)
    cyclic = cyclic & (counts > 2)
    after = np.arange(1, len(used) + 1)
    some = counts > 0
    after[offsets[1:][some] - 1] = np.where(cyclic, offsets[:-1], -1)[some]
    start = np.flatnonzero((after >= 0) & used)
    ends = np.stack([start, after[start]], axis=1)
    of_segment = np.repeat(np.arange(len(counts)), counts)[start]
    return _runs(of_segment)[0], ends, cyclic[of_segment]


def _runs(numbers):
    """The first and the last place (m,) of the run of equal numbers (m,) in which each stands."""
    first = np.flatnonzero(np.diff(numbers, prepend=-1))
    counts = np.diff(first, append=len(numbers))
    return np.repeat(first, counts), np.repeat(first + counts - 1, counts)


def _v_by_length(points, ends, first):
    """v (n,): the length to a point as a part of its polyline's. `first` and `ends` as `_segments` gives them."""
    v = np.zeros(len(points))
    if not len(ends):
        return v
    sums = np.concatenate([[0.0], np.cumsum(np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1))])
    _, last = _runs(first)
    total = sums[last + 1] - sums[first]
    total[total == 0.0] = 1.0
    v[ends[:, 1]] = (sums[1:] - sums[first]) / total
    v[ends[:, 0]] = (sums[:-1] - sums[first]) / total  # after the ends: the root of a closed polyline is 0
    return v


def _meridians(axis, first, closed):
    """Unit vectors (m, 3) perpendicular to the axes (m, 3) of segments, carried along each polyline without twisting.
    Where that comes round a closed polyline turned, the turn is spread over its length.

    `first` (m,): a number that the segments of one polyline share, and `closed` (m,) bool, whether it is closed.
    """
    start, last = _runs(first)
    before = np.maximum(np.arange(len(axis)) - 1, start)
    carried = rotations.running_products(rotations.between(axis[before], axis))
    turn = rotations.product(carried, rotations.inverse(carried[:, start]))
    root = any_perpendicular(axis[start])
    meridian = rotations.rotated(turn, root)
    if closed.any():
        rows = np.flatnonzero(closed)
        _untwist(meridian, axis, rows, start[rows], last[rows])
    return meridian


def _untwist(meridian, axis, rows, start, last):
    """Turn `meridian` of the segments `rows` so that they close up: `start` and `last` are the numbers of the first and
    last segment of each one's polyline."""
    come_round = rotations.rotated(rotations.between(axis[last], axis[start]), meridian[last])
    root = meridian[start]
    off = np.arctan2(dot(np.cross(root, come_round), axis[start]), dot(root, come_round))
    angle = (-off * (rows - start) / (last - start + 1))[:, None]
    m = meridian[rows]
    meridian[rows] = np.cos(angle) * m + np.sin(angle) * np.cross(axis[rows], m)


@dataclass(frozen=True)
class _Wires:
    """Points and the segments between them. `ends` (m, 2) int are the segments' points and `v_at_ends` (m, 2) their v;
    all else is a row a point."""

    points: np.ndarray
    radius: np.ndarray
    v: np.ndarray
    material: np.ndarray
    attributes: dict
    ends: np.ndarray
    v_at_ends: np.ndarray

    def strands(self, used, meridians, dropped):
        """The `Strands`: sides of segments and the balls of the `used` points (n,) bool. `meridians` is called with
        the axes (k, 3) and numbers (k,) of the segments that have a side, in order."""
        p0, p1 = self.points[self.ends[:, 0]], self.points[self.ends[:, 1]]
        r0, r1 = self.radius[self.ends[:, 0]], self.radius[self.ends[:, 1]]
        axis = p1 - p0
        length = np.linalg.norm(axis, axis=1)
        swallowed = np.abs(r0 - r1) >= length * (1.0 - _INSIDE)
        rows = np.flatnonzero(~swallowed & (np.maximum(r0, r1) > 0.0))
        axis = axis[rows] / length[rows, None]
        meridian = meridians(axis, rows).astype(np.float32) if len(rows) else None
        same = np.abs(r0 - r1)[rows] <= _SAME_RADIUS * np.maximum(r0, r1)[rows]
        return Strands(
            self._spheres(used, swallowed, r0, r1),
            self._cylinders(rows[same], meridian[same]) if same.any() else None,
            self._cones(rows[~same], axis[~same], length[rows[~same]], meridian[~same]) if not same.all() else None,
            dropped,
        )

    def _spheres(self, used, swallowed, r0, r1):
        """A ball at each used point, but none that is inside that of a neighbor; of equal ones the first stays."""
        shown = used & (self.radius > 0.0)
        ends = self.ends[swallowed]
        by_first = (r0 < r1) | ((r0 == r1) & (self.ends[:, 0] > self.ends[:, 1]))
        shown[np.where(by_first[swallowed], ends[:, 0], ends[:, 1])] = False
        rows = np.flatnonzero(shown)
        if not len(rows):
            return None
        return Spheres(
            center=self.points[rows],
            radius=self.radius[rows],
            material=self.material[rows],
            fixed_uv=np.stack([np.full(len(rows), JOINT_U), self.v[rows]], axis=1),
            attributes={name: values[rows] for name, values in self.attributes.items()},
        )

    def _cylinders(self, rows, meridian):
        start, end = self.ends[rows].T
        radius = np.maximum(self.radius[start], self.radius[end])
        return Cylinders(
            base=self.points[start], apex=self.points[end], radius=radius, meridian=meridian, **self._surface(rows)
        )

    def _cones(self, rows, axis, length, meridian):
        """Cones tangent to both balls: they touch them on circles that lie r sin(a) along the axis, where a is half
        the angle of the cone."""
        start, end = self.ends[rows].T
        r0, r1 = self.radius[start], self.radius[end]
        sine = (r0 - r1) / length
        cosine = np.sqrt(1.0 - sine * sine)
        return Cones(
            base=self.points[start] + axis * (r0 * sine)[:, None],
            apex=self.points[end] + axis * (r1 * sine)[:, None],
            base_radius=r0 * cosine,
            apex_radius=r1 * cosine,
            meridian=meridian,
            **self._surface(rows),
        )

    def _surface(self, rows):
        """The columns of the sides of segments that cylinders and cones have alike. What runs along a cone does so
        between its circles, so that it meets the balls' values."""
        ends, v = self.ends[rows], self.v_at_ends[rows]
        uv_transform = np.zeros((len(rows), 4), np.float32)
        uv_transform[:, 0], uv_transform[:, 1], uv_transform[:, 3] = 1.0, v[:, 1] - v[:, 0], v[:, 0]
        return {
            "material": self.material[ends[:, 0]],
            "uv_transform": uv_transform,
            "attributes": {name: values[ends] for name, values in self.attributes.items()},
        }
