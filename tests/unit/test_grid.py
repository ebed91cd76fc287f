"""Grids: what is in which cell, and what that costs."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.engine import grid
from addon.engine.bvh import build as build_tree
from addon.engine.bvh import sah_cost

each_seed = pytest.mark.parametrize("seed", range(4))


def built(base, axis, radius, test_cost=0.5, most_cost=np.inf):
    return grid.build(base, axis, radius, test_cost, most_cost)


def crowd(rng, count, length=0.0, spread=1.0):
    """Capsules of like size, evenly spread: bases, axes, radii."""
    cell = spread * count ** (-1 / 3)
    axis = rng.normal(size=(count, 3)) * length * cell * (rng.random((count, 1)) < 0.7)
    return rng.uniform(-spread, spread, (count, 3)), axis, rng.uniform(0.2, 0.7, count) * cell


def surface_points(rng, base, axis, radius, count):
    """Points (count, 3) on random shapes, or within them, and the numbers of these."""
    shape = rng.integers(0, len(base), count)
    away = rng.normal(size=(count, 3))
    away /= np.linalg.norm(away, axis=-1, keepdims=True)
    along = rng.random((count, 1)) * axis[shape]
    return base[shape] + along + away * radius[shape, None] * rng.choice([1.0, 0.5], (count, 1)), shape


def cell_of(made, points):
    place = np.floor((points - made.lower) / made.size).astype(int)
    assert (place >= 0).all() and (place < made.resolution).all()
    return place @ np.array([1, made.resolution[0], made.resolution[0] * made.resolution[1]])


def is_in(made, cell, shape):
    """Whether each shape is among the items of its cell."""
    pairs = np.repeat(np.arange(len(made.first) - 1), np.diff(made.first)) * len(made.items) + made.items
    return np.isin(cell * len(made.items) + shape, pairs)


@each_seed
@pytest.mark.parametrize("length", [0.0, 0.5, 3.0])
def test_each_shape_is_in_every_cell_that_it_reaches(seed, length):
    rng = np.random.default_rng(seed)
    shapes = crowd(rng, 700, length)
    made = built(*shapes)
    points, shape = surface_points(rng, *shapes, 20_000)
    assert is_in(made, cell_of(made, points), shape).all()


@each_seed
def test_a_shape_is_in_cells_a_little_beyond_its_surface_too(seed):
    """Rays' steps are rounded: a hit may be thought to be in the next cell."""
    rng = np.random.default_rng(seed)
    shapes = crowd(rng, 700, 1.0)
    made = built(*shapes)
    points, shape = surface_points(rng, *shapes, 20_000)
    points += rng.uniform(-0.99, 0.99, points.shape) * grid.PADDING / np.sqrt(3.0) * made.size.min()
    assert is_in(made, cell_of(made, points), shape).all()


@each_seed
@pytest.mark.parametrize(("length", "most"), [(0.0, 0.0), (3.0, 0.06)])
def test_few_shapes_are_in_cells_that_they_do_not_reach(seed, length, most):
    rng = np.random.default_rng(seed)
    base, axis, radius = crowd(rng, 300, length)
    made = built(base, axis, radius)
    cell = np.repeat(np.arange(len(made.first) - 1), np.diff(made.first))
    x, yz = cell % made.resolution[0], cell // made.resolution[0]
    corner = made.lower + made.size * np.stack([x, yz % made.resolution[1], yz // made.resolution[1]], axis=-1)
    steps = np.linspace(0.0, 1.0, 2001)[:, None, None]
    item, distance = made.items, np.full(len(made.items), np.inf)
    for points in np.array_split(base[item] + steps * axis[item], 40):
        away = points - np.clip(points, corner, corner + made.size)
        distance = np.minimum(distance, np.sqrt((away**2).sum(axis=-1)).min(axis=0))
    padded = radius[item] + grid.PADDING * made.size.max() + 1e-3 * made.size.max()
    assert np.mean(distance > padded) <= most


@pytest.mark.parametrize("side", [8, 12, 16])
def test_cells_suit_a_lattice(monkeypatch, side):
    """Finer ones cost less where shapes of neighbouring planes then share fewer cells."""
    place = np.stack(np.meshgrid(*[np.arange(side + 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    struts = [(place[place[:, k] < side], np.eye(3)[k]) for k in range(3)]
    base = np.concatenate([place, *(start + 0.12 * step for start, step in struts)])
    axis = np.concatenate([np.zeros_like(place), *(np.tile(0.76 * step, (len(start), 1)) for start, step in struts)])
    radius = np.repeat([0.25, 0.0625], [len(place), len(base) - len(place)])
    taken = built(base, axis, radius)
    monkeypatch.setattr(grid, "_finer", lambda *_: None)
    plain = built(base, axis, radius)
    assert taken.resolution.max() > plain.resolution.max()
    assert taken.cost(0.8) < 0.96 * plain.cost(0.8)


@settings(deadline=None, max_examples=60)
@given(st.integers(1, 40), st.sampled_from(["point", "line", "sheet", "heap"]), st.integers(0, 2**32 - 1))
def test_no_arrangement_is_too_odd(count, arrangement, seed):
    rng = np.random.default_rng(seed)
    extent = {"point": (0, 0, 0), "line": (1, 0, 0), "sheet": (1, 1, 0), "heap": (1, 1, 1)}[arrangement]
    base = rng.uniform(-1.0, 1.0, (count, 3)) * extent + rng.uniform(-50.0, 50.0, 3)
    shapes = base, np.zeros((count, 3)), rng.uniform(0.01, 0.3, count)
    made = built(*shapes)
    if made is None:
        return
    points, shape = surface_points(rng, *shapes, 500)
    assert is_in(made, cell_of(made, points), shape).all()


def test_a_radius_that_says_which_side_is_seen_counts_as_its_size():
    base, axis, radius = crowd(np.random.default_rng(0), 200)
    plain, inside = built(base, axis, radius), built(base, axis, -radius)
    assert np.array_equal(plain.items, inside.items)
    assert np.array_equal(plain.first, inside.first)


def test_no_grid_where_it_would_take_much_memory():
    """Large shapes among many small ones, a line, and so far off that no radius is left."""
    base, axis, radius = crowd(np.random.default_rng(0), 1000)
    large = radius.copy()
    large[:200] = 1.0
    assert built(base, axis, large) is None
    assert built(base * (1, 0, 0), axis, radius * 1e-3) is None
    assert built(base + 1e20, axis, radius) is None


def test_no_grid_where_a_few_are_close_together():
    """Their cell would take as long as all others, in the cost it hardly counts."""
    base, axis, radius = crowd(np.random.default_rng(0), 5000)
    assert built(base, axis, radius) is not None
    base[:100] *= 0.02
    assert built(base, axis, 0.1 * radius) is None


@pytest.mark.parametrize("thickness", [0.0, 1e-6, 1e-3, 0.01])
@pytest.mark.parametrize("size", [1e-6, 1e-3])
def test_flat_crowds_keep_their_tree_and_thin_ones_have_as_many_cells_as_others(size, thickness):
    base, axis, _ = crowd(np.random.default_rng(0), 3000)
    radius = np.full(3000, size)
    assert built(base * (1.0, thickness, 1.0), axis, radius) is None
    made = built(base * (1.0, 0.1 + thickness, 1.0), axis, radius)
    assert 0.7 < made.resolution.prod() / (3000 * grid.DENSITY) < 1.4


def test_no_grid_that_costs_more_than_it_may():
    shapes = crowd(np.random.default_rng(0), 1000)
    cost = built(*shapes).cost(0.5)
    assert built(*shapes, most_cost=1.01 * cost)
    assert built(*shapes, most_cost=0.99 * cost) is None
    assert built(*shapes, most_cost=0.1 * cost) is None


def test_a_grid_costs_less_than_a_tree_where_shapes_crowd_evenly_and_more_where_they_do_not():
    rng = np.random.default_rng(0)
    even = crowd(rng, 5000)
    middle = rng.uniform(-1.0, 1.0, (8, 3))[rng.integers(0, 8, 5000)]
    clustered = middle + 0.2 * even[0], even[1], 0.2 * even[2]
    costs = []
    for base, axis, radius in (even, clustered):
        tree = build_tree(base - radius[:, None], base + radius[:, None])
        costs.append(built(base, axis, radius).cost(0.5) / sah_cost(tree))
    assert costs[0] < 0.7
    assert costs[1] > 1.0
