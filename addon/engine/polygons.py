# SPDX-License-Identifier: GPL-3.0-or-later
"""Planar polygons to triangles: convex ones and quads by fans, all at once; other concave ones by clipping
ears, one by one."""

import numpy as np

from .primitives.base import any_perpendicular

#: A vertex may leave the plane by this part of the polygon's size, and by this part of its coordinates: six
#: printed digits.
PLANARITY = 1e-2
ROUNDING = 1e-5

# Twice an area, in parts of the squared size, that counts as none: a corner flatter than what six digits can
# tell is straight.
_NO_AREA = 1e-10
_STRAIGHT = 1e-5


class PolygonError(ValueError):
    """Polygon number `index` cannot be cut into triangles; `reason` says why."""

    def __init__(self, index, reason):
        super().__init__(f"polygon {index}: {reason}")
        self.index, self.reason = index, reason


def triangulate(points):
    """Cut m planar polygons of n vertices each, `points` (m, n, 3), into triangles that keep the vertices'
    sense of rotation.

    Returns owner (k,) int, the polygon of each triangle, in order, and corners (k, 3) int, its vertices.
    Raises PolygonError for a polygon without area, one that is not planar and one that crosses itself.
    """
    points = np.asarray(points, np.float64)
    xy = _flattened(points)
    convex = _turns(xy).min(axis=1) >= -_STRAIGHT
    convex &= _fan_areas(xy, 0).min(axis=1, initial=np.inf) >= -_STRAIGHT
    parts = [_fans(xy, np.flatnonzero(convex), 0)]
    rest = np.flatnonzero(~convex)
    if points.shape[1] == 4:  # from the vertex that points inwards, a quad is a fan too
        inwards = _fan_areas(xy[rest], 1).min(axis=1) > 0.0
        parts.append(_fans(xy, rest[inwards], 1))
        inwards_0 = ~inwards & (_fan_areas(xy[rest], 0).min(axis=1) > 0.0)
        parts.append(_fans(xy, rest[inwards_0], 0))
        rest = rest[~inwards & ~inwards_0]
    for index in rest:
        corners = _clip_ears(xy[index])
        if corners is None:
            raise PolygonError(int(index), "the polygon crosses itself")
        parts.append((np.full(len(corners), index), corners))
    owner = np.concatenate([part[0] for part in parts])
    order = np.argsort(owner, kind="stable")
    return owner[order], np.concatenate([part[1] for part in parts])[order]


def _flattened(points):
    """The vertices (m, n, 2) in their planes, counter-clockwise, in units of each polygon's size."""
    # Newell's method: the sum of the cross products of neighbours is twice the area along the normal, concave
    # or not.
    local = points - points[:, :1]
    normal = np.cross(local, np.roll(local, -1, axis=1)).sum(axis=1)
    size = np.linalg.norm(np.ptp(points, axis=1), axis=-1)
    magnitude = np.abs(points).max(axis=(1, 2))
    area = np.linalg.norm(normal, axis=-1)
    noise = 8.0 * np.finfo(np.float64).eps * magnitude * size
    _refuse(
        ~(area > _NO_AREA * size**2 + noise),
        "the polygon has no area: its vertices lie on a line, or it crosses itself",
    )
    normal /= area[:, None]
    height = np.einsum("mni,mi->mn", local, normal)
    off = np.ptp(height, axis=1) / 2.0
    _refuse(
        off > PLANARITY * size + ROUNDING * magnitude,
        lambda i: f"the polygon is not planar: its vertices leave a plane by {off[i]:.3g} of its size {size[i]:.3g}",
    )
    e0 = any_perpendicular(normal)
    frame = np.stack([e0, np.cross(normal, e0)], axis=-1)
    return np.einsum("mni,mik->mnk", local, frame) / size[:, None, None]


def _refuse(bad, reason):
    if bad.any():
        first = int(np.argmax(bad))
        raise PolygonError(first, reason(first) if callable(reason) else reason)


def _cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _turns(xy):
    """Cross product (m, n) of the edges before and after each vertex: positive where the polygon turns
    left."""
    edge = np.roll(xy, -1, axis=-2) - xy
    return _cross(np.roll(edge, 1, axis=-2), edge)


def _fan_areas(xy, center):
    """Twice the signed areas (m, n - 2) of the triangles from vertex number `center` to each edge that it is
    not on."""
    spokes = np.roll(xy, -center, axis=1)[:, 1:] - xy[:, center : center + 1]
    return _cross(spokes[:, :-1], spokes[:, 1:])


def _fans(xy, rows, center):
    """Owner and corners of the fans from vertex `center` of the polygons `rows`, without triangles that have
    no area."""
    n = xy.shape[1]
    around = (np.arange(1, n) + center) % n
    corners = np.stack([np.full(n - 2, center), around[:-1], around[1:]], axis=-1)
    keep = _fan_areas(xy[rows], center) > _NO_AREA
    owner, which = np.nonzero(keep)
    return rows[owner], corners[which]


def _clip_ears(xy):
    """Corners (k, 3) of the triangles of one polygon (n, 2) that runs counter-clockwise, or None where it
    crosses itself.

    Ear clipping, of the ears that are there the one with the shortest cut: sequential by nature, but for the
    search of ears.
    """
    left, corners = np.arange(len(xy)), []
    while len(left) > 2:
        points = xy[left]
        turn = _turns(points)
        flat = np.flatnonzero(np.abs(turn) <= _NO_AREA)
        if len(flat):  # nothing to cut off there
            left = np.delete(left, flat[0])
            continue
        ear = _shortest_ear(points, turn)
        if ear is None:
            return None
        corners.append(left[[ear - 1, ear, (ear + 1) % len(left)]])
        left = np.delete(left, ear)
    corners = np.array(corners, np.int64).reshape(-1, 3)
    a, b, c = np.moveaxis(xy[corners], 1, 0)
    whole = _cross(xy, np.roll(xy, -1, axis=0)).sum()
    return corners if np.isclose(_cross(b - a, c - a).sum(), whole, rtol=1e-6) else None


def _shortest_ear(points, turn):
    """The vertex (n, 2) whose neighbours see each other inside the polygon at the shortest distance, or
    None."""
    before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    tips = np.flatnonzero(turn > 0.0)
    blockers = points[turn < 0.0]
    inside = np.ones((len(tips), len(blockers)), bool)
    for a, b in ((before, points), (points, after), (after, before)):
        a, b = a[tips, None], b[tips, None]
        inside &= _cross(b - a, blockers - a) >= 0.0
        inside &= (blockers != a).any(
            axis=-1
        )  # a corner of the triangle does not block it, nor one that touches it there
    ears = tips[~inside.any(axis=1)]
    if not len(ears):
        return None
    return int(ears[np.argmin(np.linalg.norm(after[ears] - before[ears], axis=-1))])
