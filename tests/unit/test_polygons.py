"""Polygons to triangles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.engine.polygons import PolygonError, triangulate
from tests.unit.shape_arrays import areas


def turned(flat, random, scale):
    """Points (n, 2) somewhere in space, at any orientation and size: (n, 3)."""
    frame, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return scale * (flat @ frame[:, :2].T + random.normal(size=3))


@given(st.integers(0, 1 << 32), st.integers(3, 40), st.floats(-4.0, 5.0))
def test_triangles_cover_a_star_shaped_polygon_once(seed, n, exponent):
    random = np.random.default_rng(seed)
    angle = (np.arange(n) + random.uniform(0.0, 0.7, n)) * 2.0 * np.pi / n
    flat = random.uniform(0.3, 1.0, (n, 1)) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    points = turned(flat, random, 10.0**exponent)
    owner, index = triangulate(points[None])
    part = areas(points[index])
    whole = np.cross(points - points[0], np.roll(points - points[0], -1, axis=0)).sum(axis=0) / 2.0
    # All turn as the polygon does, and their areas sum to its own: so none lies outside, and no two overlap.
    assert (part @ whole > 0.0).all()
    np.testing.assert_allclose(part.sum(axis=0), whole, atol=1e-9 * np.linalg.norm(whole))
    assert len(index) <= n - 2
    assert not owner.any()


DART = np.array([(0, 0), (2, 1), (0, 2), (1, 1)], np.float64)
CROSS = np.array(
    [(1, 0), (2, 0), (2, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3), (1, 2), (0, 2), (0, 1), (1, 1)], np.float64
)


WITH_HOLE = np.array([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)], np.float64)
SPIRAL = np.array(
    [(0, 0), (5, 0), (5, 5), (1, 5), (1, 2), (3, 2), (3, 3), (2, 3), (2, 4), (4, 4), (4, 1), (0, 1)], np.float64
)


@pytest.mark.parametrize("flat, area", [(DART, 1.0), (CROSS, 5.0), (WITH_HOLE, 12.0), (SPIRAL, 15.0)])
@pytest.mark.parametrize("reverse", [False, True])
def test_concave_polygons_from_every_first_vertex(flat, area, reverse):
    for first in range(len(flat)):
        points = turned(np.roll(flat, first, axis=0), np.random.default_rng(first), 7.0)
        points = points[::-1] if reverse else points
        _, index = triangulate(points[None])
        part = areas(points[index])
        assert np.linalg.norm(part, axis=-1).sum() == pytest.approx(49.0 * area)
        assert np.linalg.norm(part.sum(axis=0)) == pytest.approx(49.0 * area)


def test_many_quads_at_once_keep_their_order():
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float64)
    dart = np.pad(DART, ((0, 0), (0, 1)))
    owner, index = triangulate(np.stack([square, dart, square, np.roll(dart, 1, axis=0)]))
    np.testing.assert_array_equal(owner, np.repeat(np.arange(4), 2))
    assert all(3 in row and 1 in row for row in index[2:4])  # from its inward corner


def test_rounded_digits_count_as_planar_and_more_does_not():
    points = turned(CROSS, np.random.default_rng(5), 3.0)
    rounded = np.array([[float(f"{x:.5g}") for x in point] for point in points])
    assert len(triangulate(rounded[None])[1]) == 10
    bent = rounded.copy()
    normal = areas(points[None, :3])[0]
    bent[4] += 0.5 * normal / np.linalg.norm(normal)
    with pytest.raises(PolygonError, match="polygon 1: the polygon is not planar"):
        triangulate(np.stack([rounded, bent]))
