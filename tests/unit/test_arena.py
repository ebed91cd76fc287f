"""Ranges of an arena: none overlap, what is free is found again."""

import numpy as np
import pytest

from addon.engine.arena import Arena


@pytest.mark.parametrize("seed", range(20))
def test_ranges_never_overlap_and_all_can_be_given_back(seed):
    rng, arena, taken = np.random.default_rng(seed), Arena(), []
    used = np.zeros(100_000, bool)
    for _ in range(300):
        if taken and rng.random() < 0.45:
            first, count = taken.pop(rng.integers(len(taken)))
            arena.give_back(first, count)
            used[first : first + count] = False
        else:
            count = int(rng.choice([0, 1, 3, 100]))
            first = arena.take(count)
            assert not used[first : first + count].any()
            used[first : first + count] = True
            taken.append((first, count))
        assert arena.end == (np.flatnonzero(used)[-1] + 1 if used.any() else 0)
    for first, count in taken:
        arena.give_back(first, count)
    assert arena.end == 0


def test_a_hole_is_filled_before_the_arena_grows():
    arena = Arena()
    starts = [arena.take(count) for count in (10, 5, 10, 3, 10)]
    arena.give_back(starts[1], 5)
    arena.give_back(starts[3], 3)
    assert arena.take(3) == starts[3], "the smallest that has room"
    assert arena.take(2) == starts[1] and arena.take(3) == starts[1] + 2
    assert arena.take(1) == 38


def test_a_copy_is_independent():
    arena = Arena()
    arena.take(10)
    copy = arena.copy()
    copy.give_back(2, 3)
    assert copy.take(3) == 2 and arena.take(3) == 10
