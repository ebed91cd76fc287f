"""Fingerprints of plain data: equal for equal content, different for any difference."""

from dataclasses import dataclass

import numpy as np
import pytest

from addon.engine import Light, Material, Scene
from addon.fingerprint import fingerprint


@dataclass
class Thing:
    value: object


def scene(**changes):
    """A small scene; `changes`: of the sphere's columns."""
    made = Scene(materials=[Material()], lights=[Light.point((0.0, 0.0, 5.0), 10.0)])
    made.add_spheres(**({"center": [(0.0, 0.0, 0.0), (1.0, 2.0, 3.0)], "radius": [1.0, 2.0]} | changes))
    return made


def test_equal_scenes_have_the_same():
    assert fingerprint(scene()) == fingerprint(scene())


@pytest.mark.parametrize("changes", [{"radius": [1.0, 2.0 + 1e-12]}, {"material": 1}, {"meridian": (0.0, 1.0, 0.0)}])
def test_any_column_counts(changes):
    assert fingerprint(scene(**changes)) != fingerprint(scene())


def test_lights_and_materials_count():
    for name, item in (("lights", Light.sun((0.0, 0.0, 1.0), 1.0)), ("materials", Material.mirror())):
        other = scene()
        getattr(other, name).append(item)
        assert fingerprint(other) != fingerprint(scene())


@pytest.mark.parametrize(
    "one, other",
    [
        (1, "1"),
        ([1, 2], (1, 2)),
        ([[1], 2], [1, [2]]),
        ({"a": 1}, {"a": 2}),
        (np.zeros(4, np.float32), np.zeros(2, np.float64)),
        (np.zeros((2, 3)), np.zeros((3, 2))),
        (Thing(1), Thing(2)),
        (None, 0),
    ],
)
def test_different_things_have_different_ones(one, other):
    assert fingerprint(one) != fingerprint(other)


def test_a_thing_that_holds_itself_ends():
    thing = Thing(None)
    thing.value = [thing, thing]
    assert fingerprint(thing) == fingerprint(thing)


def test_sliced_arrays_count_by_content():
    numbers = np.arange(12).reshape(3, 4)
    assert fingerprint(numbers[:, ::2]) == fingerprint(numbers[:, ::2].copy())


LARGE = 3 * 4096 * 64 + 1234  # words: some blocks, and a rest


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int32, np.uint8])
def test_any_bit_of_a_large_array_counts(dtype):
    rng = np.random.default_rng(7)
    array = rng.integers(0, 200, LARGE).astype(dtype)
    seen = {fingerprint(array)}
    places = rng.integers(0, array.nbytes, 40)
    for place in (0, array.nbytes - 1, *places):
        changed = array.copy()
        changed.view(np.uint8)[place] ^= 1 << rng.integers(0, 8)
        seen.add(fingerprint(changed))
    assert len(seen) == 43
    assert fingerprint(array.copy()) in seen


@pytest.mark.parametrize("count", [1, 2, 4096, 2 * 4096])
def test_signs_of_a_large_array_count(count):
    """Sums of words modulo 2^64 alone would not see an even number of changed top bits under odd weights."""
    array = np.ones(LARGE)
    changed = array.copy()
    changed[:count] *= -1.0
    assert fingerprint(array) != fingerprint(changed)
    assert fingerprint(array) != fingerprint(2.0 * array)


def test_the_order_of_a_large_array_counts():
    array = np.arange(LARGE, dtype=np.float64)
    assert fingerprint(array) != fingerprint(array[::-1])
    swapped = np.concatenate([array[4096:8192], array[:4096], array[8192:]])
    assert fingerprint(array) != fingerprint(swapped)


def test_what_repeats_one_row_counts_by_that_row_and_takes_no_memory():
    def repeated(row):
        return np.broadcast_to(np.array(row, np.float64), (10**11, 3))

    assert fingerprint(repeated([1.0, 2.0, 3.0])) == fingerprint(repeated([1.0, 2.0, 3.0]))
    assert fingerprint(repeated([1.0, 2.0, 3.0])) != fingerprint(repeated([1.0, 2.0, 4.0]))
    assert fingerprint(repeated([1.0, 2.0, 3.0])[: 10**10]) != fingerprint(repeated([1.0, 2.0, 3.0]))


def test_arrays_without_elements_or_dimensions():
    assert fingerprint(np.zeros((0, 3))) != fingerprint(np.zeros((0, 4)))
    assert fingerprint(np.array(1.0)) != fingerprint(np.array(2.0))
