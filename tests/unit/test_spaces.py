"""Spaces of objects, parts of meshes and lengths of strands, as materials ask for them."""

from types import SimpleNamespace

import numpy as np
import pytest

from addon.sync import strand_values
from addon.sync.mesh_values import islands
from addon.sync.spaces import space_rows, texture_space


@pytest.fixture
def rng():
    return np.random.default_rng(17)


def test_space_takes_a_place_of_the_world_to_the_object(rng):
    matrices = np.tile(np.eye(4), (50, 1, 1))
    matrices[:, :3, :3] = rng.normal(size=(50, 3, 3)) * 10.0 ** rng.uniform(-4, 4, (50, 1, 1))
    matrices[:, :3, 3] = rng.normal(size=(50, 3)) * 1e3
    places = rng.normal(size=(50, 3))
    world = np.einsum("nij,nj->ni", matrices[:, :3, :3], places) + matrices[:, :3, 3]
    rows = space_rows(matrices)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", rows[..., :3], world - rows[..., 3]), places, atol=1e-6)


def test_space_of_what_is_flat_or_nowhere_is_finite():
    flat, nowhere = np.diag([2.0, 3.0, 0.0, 1.0]), np.full((4, 4), np.nan)
    rows = space_rows(np.stack([flat, nowhere]))
    assert np.isfinite(rows).all()
    np.testing.assert_allclose(rows[0, :, :3], np.diag([0.5, 1.0 / 3.0, 0.0]))


def test_texture_space_goes_from_0_to_1_and_has_no_size_where_it_is_flat():
    data = SimpleNamespace(texspace_size=(2.0, 1.0, 0.0), texspace_location=(1.0, 0.0, 5.0))
    scale, offset = texture_space(data)
    np.testing.assert_allclose(
        np.array([[-1.0, -1.0, 5.0], [3.0, 1.0, 5.0]]) * scale + offset, [[0, 0, 0.5], [1, 1, 0.5]]
    )
    scale, offset = texture_space(SimpleNamespace())
    np.testing.assert_array_equal(np.concatenate([scale, offset]), [1, 1, 1, 0, 0, 0])


def parts(count, edges):
    """The lowest vertex of each vertex's part, by walking."""
    found = np.full(count, -1)
    for start in range(count):
        waiting = [start] if found[start] < 0 else []
        while waiting:
            vertex = waiting.pop()
            if found[vertex] < 0:
                found[vertex] = start
                waiting += [b if a == vertex else a for a, b in edges if vertex in (a, b)]
    return found


@pytest.mark.parametrize("seed", range(4))
def test_islands_as_by_walking(seed):
    rng = np.random.default_rng(seed)
    edges = rng.integers(0, 60, (45, 2))
    np.testing.assert_array_equal(islands(60, edges), parts(60, edges.tolist()))


def test_a_long_chain_is_one_island(rng):
    order = rng.permutation(20000)
    assert not islands(20000, np.stack([order[:-1], order[1:]], axis=-1)).any()
    np.testing.assert_array_equal(islands(3, np.empty((0, 2))), [0, 1, 2])


def test_strands_know_how_far_along_they_are():
    points = np.array([[0, 0, 0], [3, 4, 0], [3, 4, 5], [9, 9, 9], [1, 1, 1], [1, 1, 3]], float)
    offsets = np.array([0, 3, 4, 4, 6])
    keys = ("hair:intercept", "hair:length", "hair:thickness", "hair:is_strand")
    of_points = strand_values.of_points(keys, points, offsets, np.arange(6.0))
    np.testing.assert_allclose(of_points["hair:intercept"][:, 0], [0, 0.5, 1, 0, 0, 1])
    np.testing.assert_allclose(of_points["hair:thickness"][:, 1], 2.0 * np.arange(6.0))
    np.testing.assert_allclose(strand_values.of_curves(keys, points, offsets)["hair:length"][:, 0], [10, 0, 0, 2])
    assert strand_values.of_strands(keys)["hair:is_strand"].all() and not strand_values.of_strands(())
