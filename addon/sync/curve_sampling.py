"""Points along Blender's curves: Catmull-Rom, poly, Bezier and NURBS. Numpy only, all curves of a type at once.

A curve is made of segments, cubic or rational polynomials. Each is cut into equal steps of its parameter, a fixed
number or as many as keep the chords within a tolerance. What a sample is, a place or an attribute, is always a
weighted sum of control points: a `_Blend`.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from .nurbs import basis, knots_of, nonempty_spans, valid_nurbs

#: Blender's numbers of the types.
CATMULL_ROM, POLY, BEZIER, NURBS = range(4)

#: Most that shows of a ball between two pieces, in tolerances.
_WIDEST_BALL = 2.0

#: No segment is cut finer, however near the camera is.
MAX_STEPS = 1024

#: Nor all together into more pieces: memory is to hold them, and near a camera among hairs a pixel is very small.
MAX_PIECES = 1 << 24


@dataclass(frozen=True)
class ControlCurves:
    """Blender's curves as arrays. Curve i has the control points offsets[i] to offsets[i + 1].

    A row a point: points (n, 3), radius (n,), handles (n, 2, 3) left and right, None where no curve is a Bezier, weight
    (n,) of NURBS, attributes name -> (n, 4). A row a curve: kind, cyclic bool, order, knots_mode, resolution (c,).
    """

    points: np.ndarray
    offsets: np.ndarray
    radius: np.ndarray
    kind: np.ndarray
    cyclic: np.ndarray
    handles: np.ndarray | None = None
    weight: np.ndarray | None = None
    order: np.ndarray | None = None
    knots_mode: np.ndarray | None = None
    resolution: np.ndarray | None = None
    attributes: dict = field(default_factory=dict)

    def take(self, rows):
        """The curves `rows` (k,) int, in that order."""
        counts = np.diff(self.offsets)[rows]
        points = ranges(self.offsets[:-1][rows], counts)
        of_points = {name: _rows(getattr(self, name), points) for name in ("points", "radius", "handles", "weight")}
        names = ("kind", "cyclic", "order", "knots_mode", "resolution")
        return ControlCurves(
            offsets=offsets_of(counts),
            attributes={name: values[points] for name, values in self.attributes.items()},
            **of_points,
            **{name: _rows(getattr(self, name), rows) for name in names},
        )


@dataclass(frozen=True)
class Sampling:
    """How fine curves are cut: chords and radii nowhere off by more than `tolerance`, a length, one or (c,); where that
    is None, `steps` a segment, 0 for each curve's own resolution."""

    tolerance: float | np.ndarray | None = None
    steps: int = 0

    def take(self, rows):
        """That of the curves `rows` (k,) int."""
        return replace(self, tolerance=np.asarray(self.tolerance)[rows]) if np.ndim(self.tolerance) else self


@dataclass(frozen=True)
class Samples:
    """Polylines: points (n, 3), offsets (c + 1,), radius (n,), cyclic (c,) bool, attributes name -> (n, 4). `coarser`:
    whether they are off by more than the tolerance, for there would be more than `MAX_PIECES`."""

    points: np.ndarray
    offsets: np.ndarray
    radius: np.ndarray
    cyclic: np.ndarray
    attributes: dict
    coarser: bool = False


def sample(curves, sampling):
    """The `Samples` of `ControlCurves`, as many polylines as curves, in their order.

    Polylines pass through the control points where the curves do. What is no curve of its type (one point, no handles,
    fewer points than the order) is its control points, as in Blender.
    """
    kind = _kinds(curves)
    parts, rows = [], []
    for group in np.unique(kind) if len(kind) else (POLY,):
        rows.append(np.flatnonzero(kind == group))
        members = curves if len(rows[-1]) == len(kind) else curves.take(rows[-1])
        parts.append(_sample_group(members, group, sampling.take(rows[-1])))
    if len(parts) == 1:
        return parts[0]
    return _in_order(parts, rows, curves)


def ranges(start, counts):
    """The numbers start[i] to start[i] + counts[i], one run after the other."""
    first = np.cumsum(counts) - counts
    return np.arange(int(counts.sum())) + np.repeat(start - first, counts)


def offsets_of(counts):
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)


def _rows(values, rows):
    return None if values is None else values[rows]


def _kinds(curves):
    """What each curve (c,) is evaluated as: NURBS as NURBS + order."""
    counts = np.diff(curves.offsets)
    kind = np.where(np.isin(curves.kind, (CATMULL_ROM, BEZIER, NURBS)), curves.kind, POLY).astype(np.int64)
    kind[counts < 2] = POLY
    if curves.handles is None:
        kind[kind == BEZIER] = POLY
    nurbs = kind == NURBS
    if nurbs.any():
        valid = valid_nurbs(counts, curves.order, curves.cyclic, curves.knots_mode)
        kind = np.where(nurbs, np.where(valid, NURBS + curves.order, POLY), kind)
    return kind


def _sample_group(curves, kind, sampling):
    if kind == POLY:
        return Samples(curves.points, curves.offsets, curves.radius, curves.cyclic, curves.attributes)
    if kind == CATMULL_ROM:
        pieces = _CatmullRom(curves)
    elif kind == BEZIER:
        pieces = _Bezier(curves)
    else:
        pieces = _Nurbs(curves, int(kind - NURBS))
    wanted = _steps(pieces, curves, sampling)
    steps = wanted if sampling.tolerance is None else _bounded(wanted)
    of_curve = pieces.of_curve
    is_last = np.append(of_curve[1:] != of_curve[:-1], True)
    counts = steps + (is_last & ~curves.cyclic[of_curve])  # an open curve has one sample more than steps
    piece = np.repeat(np.arange(len(steps)), counts)
    t = ranges(np.zeros(len(counts), np.int64), counts) / steps[piece]
    place, value = pieces.blends(piece, t)
    return Samples(
        place.of(pieces.places),
        offsets_of(np.bincount(of_curve, counts, len(curves.kind)).astype(np.int64)),
        value.of(curves.radius),
        curves.cyclic,
        {name: value.of(values) for name, values in curves.attributes.items()},
        coarser=steps is not wanted,
    )


def _bounded(steps):
    """Steps (m,) of segments, fewer in proportion where they are more than `MAX_PIECES` in all."""
    total = int(steps.sum())
    return steps if total <= MAX_PIECES else np.maximum(steps * MAX_PIECES // total, 1)


def _steps(pieces, curves, sampling):
    """The number of steps (m,) of each segment.

    A chord over the step h of the parameter is off by h^2 / 8 times the largest second derivative at most. Thick
    strands are cut finer than that asks for: where two pieces meet at an angle, a ball shows between them, as wide as
    its radius times the angle.
    """
    if sampling.tolerance is None:
        steps = sampling.steps or curves.resolution[pieces.of_curve]
        return np.clip(np.broadcast_to(steps, len(pieces.of_curve)).astype(np.int64), 1, MAX_STEPS)
    tolerance = np.broadcast_to(sampling.tolerance, len(curves.kind))[pieces.of_curve]
    polygon = pieces.polygon()
    with np.errstate(all="ignore"):  # places that are no numbers are the caller's
        bend = pieces.bend_of_polygon * np.linalg.norm(np.diff(polygon, 2, axis=0), axis=-1).max(axis=0, initial=0.0)
        balls = _turn(polygon) * polygon[..., 3].max(axis=0) / (_WIDEST_BALL * tolerance)
        steps = np.ceil(np.maximum(np.sqrt(bend / (8.0 * tolerance)), balls))
    return np.clip(np.nan_to_num(steps, nan=1.0, posinf=MAX_STEPS), 1, MAX_STEPS).astype(np.int64)


def _turn(polygon):
    """The angle (m,) that polygons (k, m, d) turn by in all; that of a cubic is never more than its polygon's."""
    legs = np.diff(polygon, axis=0)
    legs /= np.maximum(np.linalg.norm(legs, axis=-1, keepdims=True), 1e-300)
    cosines = np.einsum("kmi,kmi->km", legs[1:], legs[:-1])
    around = np.einsum("mi,mi->m", legs[-1], legs[0])  # legs of no length turn nowhere
    has_length = np.abs(legs).max(axis=-1) > 0.0
    angles = np.arccos(np.clip(cosines, -1.0, 1.0)) * (has_length[1:] & has_length[:-1])
    return np.maximum(angles.sum(axis=0), np.arccos(np.clip(around, -1.0, 1.0)) * (has_length[-1] & has_length[0]))


def _in_order(parts, rows, curves):
    """The `Samples` of all groups as one, in the order of the curves."""
    order = np.argsort(np.concatenate(rows))
    counts = np.concatenate([np.diff(part.offsets) for part in parts])
    points = ranges((offsets_of(counts)[:-1])[order], counts[order])
    return Samples(
        np.concatenate([part.points for part in parts])[points],
        offsets_of(counts[order]),
        np.concatenate([part.radius for part in parts])[points],
        curves.cyclic,
        {name: np.concatenate([part.attributes[name] for part in parts])[points] for name in curves.attributes},
        coarser=any(part.coarser for part in parts),
    )


@dataclass(frozen=True)
class _Blend:
    """Weighted sums of rows: indices and weights (k, n), k rows for each of n samples."""

    indices: np.ndarray
    weights: np.ndarray

    def of(self, values):
        total = 0.0
        for index, weight in zip(self.indices, self.weights, strict=True):
            total = total + (weight[:, None] if values.ndim > 1 else weight) * values[index]
        return total


def _segments(curves):
    """The segments between control points: their curve (m,) and the points at their ends, start and end (m,)."""
    counts = np.diff(curves.offsets)
    of_curve = np.repeat(np.arange(len(counts)), counts - ~curves.cyclic)
    start = ranges(curves.offsets[:-1], counts - ~curves.cyclic)
    end = start + 1
    end = np.where(end == curves.offsets[1:][of_curve], curves.offsets[:-1][of_curve], end)
    return of_curve, start, end


def _with_radius(places, radius):
    return np.concatenate([places, radius[..., None]], axis=-1)


class _CatmullRom:
    """Cubics through the control points; open ends are doubled."""

    bend_of_polygon = 6.0  # the second derivative at the ends of a cubic, over second differences of its polygon

    def __init__(self, curves):
        self.of_curve, self._start, self._end = _segments(curves)
        first, stop = curves.offsets[:-1][self.of_curve], curves.offsets[1:][self.of_curve]
        round_about = curves.cyclic[self.of_curve] & (stop - first > 2)
        before, after = self._start - 1, self._end + 1
        self._before = np.where(before < first, np.where(round_about, stop - 1, first), before)
        self._after = np.where(after == stop, np.where(round_about, first, stop - 1), after)
        # Two points and back: the second segment runs from the last to the first.
        back = ~round_about & (self._end < self._start)
        self._before[back], self._after[back] = self._start[back], self._end[back]
        self.places, self._radius = curves.points, curves.radius

    def polygon(self):
        """The control points (4, m, 4) as cubic Beziers, the radius last."""
        points = _with_radius(self.places, self._radius)
        p0, p1, p2, p3 = (points[i] for i in (self._before, self._start, self._end, self._after))
        return np.stack([p1, p1 + (p2 - p0) / 6.0, p2 - (p3 - p1) / 6.0, p2])

    def blends(self, piece, t):
        s = 1.0 - t
        near, far = 2.0 + t * t * (3.0 * t - 5.0), 2.0 + s * s * (3.0 * s - 5.0)
        weights = 0.5 * np.stack([-t * s * s, near, far, -s * t * t])
        blend = _Blend(np.stack([self._before, self._start, self._end, self._after])[:, piece], weights)
        return blend, blend


class _Bezier:
    """Cubics with handles. Radius and attributes run linearly along the parameter, as in Blender."""

    bend_of_polygon = _CatmullRom.bend_of_polygon

    def __init__(self, curves):
        self.of_curve, self._start, self._end = _segments(curves)
        self.places = np.concatenate([curves.points, curves.handles[:, 0], curves.handles[:, 1]])
        count = len(curves.points)
        self._radius = curves.radius
        self._control = np.stack([self._start, self._start + 2 * count, self._end + count, self._end])

    def polygon(self):
        """As of `_CatmullRom`."""
        first, last = self._radius[self._start], self._radius[self._end]
        radius = np.stack([first, (2.0 * first + last) / 3.0, (first + 2.0 * last) / 3.0, last])
        return _with_radius(self.places[self._control], radius)

    def blends(self, piece, t):
        s = 1.0 - t
        place = _Blend(self._control[:, piece], np.stack([s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]))
        return place, _Blend(self._control[::3, piece], np.stack([s, t]))


class _Nurbs:
    """Rational B-splines of one order; a segment is a span of knots that is not empty."""

    def __init__(self, curves, order):
        self._order, self.places, self._radius, self._weight = order, curves.points, curves.radius, curves.weight
        self._polygon_steps = 2 * order if order > 2 else 1
        self.bend_of_polygon = 1.2 * self._polygon_steps**2  # with a margin
        counts = np.diff(curves.offsets)
        self._knots, knot_offsets = knots_of(counts, order, curves.cyclic, curves.knots_mode)
        self.of_curve, self._span = nonempty_spans(self._knots, knot_offsets, order)
        self._first, self._count = curves.offsets[:-1][self.of_curve], counts[self.of_curve]
        self._start = self._span - knot_offsets[:-1][self.of_curve] - (order - 1)

    def polygon(self):
        """Samples (k, m, 4), the radius last: derivatives of rational curves have no simple bound."""
        count, steps = len(self.of_curve), self._polygon_steps
        blend, _ = self.blends(np.repeat(np.arange(count), steps + 1), np.tile(np.arange(steps + 1) / steps, count))
        samples = blend.of(_with_radius(self.places, self._radius)).reshape(count, steps + 1, 4)
        return np.moveaxis(samples, 1, 0)

    def blends(self, piece, t):
        span = self._span[piece]
        weights = basis(self._knots, span, t, self._order)
        local = self._start[piece] + np.arange(self._order)[:, None]
        indices = self._first[piece] + local % self._count[piece]
        if self._weight is not None:
            weights = weights * self._weight[indices]
            total = weights.sum(axis=0)
            weights = weights / np.where(total != 0.0, total, 1.0)
        blend = _Blend(indices, weights)
        return blend, blend
