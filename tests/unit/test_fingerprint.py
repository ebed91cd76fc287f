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
