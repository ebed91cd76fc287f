"""Every function of value nodes against its numpy twin, over anything and over special numbers."""

import numpy as np
import pytest

from addon.engine.glsl_functions import function
from addon.sync.shader_nodes.value_functions import TWINS

from . import harness

N = 20_000
_PLACES = [f"{vector}.{component}" for vector in "ab" for component in "xyzw"]
_SWIZZLE = {"float": "r", "vec3": "rgb", "vec4": "rgba"}


def numbers(rng):
    """Numbers (N, 8) as the GPU sees them: anything, colors, and what is special."""
    kinds = (
        rng.uniform(-3.0, 3.0, (N, 8)),
        rng.uniform(0.0, 1.0, (N, 8)),
        rng.choice([-1.0, 0.0, 0.5, 1.0, 2.0], (N, 8)),
    )
    return np.choose(np.arange(N)[:, None] % 3, kinds).astype(np.float32)


def arguments(inputs):
    """For each input the numbers that it takes, from the first on again where they end."""
    first = 0
    for kind in inputs:
        size = {"float": 1, "vec3": 3}[kind]
        yield [(first + i) % 8 for i in range(size)]
        first += size


def evaluated(device, call, values, textures):
    (found,) = harness.run_values(
        device, "value_frag.glsl", *values.T, constants={"TEST_CALL": call}, textures={"tables": textures}
    )
    return found


@pytest.fixture
def values():
    return numbers(np.random.default_rng(3))


def no_tables():
    return harness.texels(np.zeros((1, 4), np.float32))


@pytest.mark.parametrize("name", TWINS)
def test_function_is_as_its_twin(device, values, name):
    known = function(name)
    taken = list(arguments(known.inputs))
    texts = (", ".join(_PLACES[i] for i in numbers) for numbers in taken)
    inputs = (f"vec3({text})" if "," in text else text for text in texts)
    swizzle = _SWIZZLE[known.results[0]]
    found = evaluated(device, f"out_color.{swizzle} = {name}({', '.join(inputs)})", values, no_tables())
    with np.errstate(all="ignore"):
        exact = TWINS[name](*(values[:, i].astype(np.float64) for i in taken))
    exact = np.broadcast_to(exact, (N, len(swizzle)))
    found = found[:, : len(swizzle)]
    assert np.ptp(exact) > 0.1 and np.isfinite(exact).all()
    # What jumps or has a pole nearby may differ for a few.
    same = np.isclose(found, exact, rtol=2e-4, atol=2e-5).all(axis=-1)
    assert same.mean() > 0.998, (values[~same][:5], found[~same][:5], exact[~same][:5])
    special = np.arange(N) % 3 == 2
    assert same[special].mean() > 0.998


@pytest.mark.parametrize("extends", (0, 1))
def test_color_of_a_table(device, values, extends):
    table = np.random.default_rng(4).random((11, 4)).astype(np.float32)
    found = evaluated(device, f"out_color = color_of_table(1, 10, {extends}, a.x)", values, harness.texels(table))
    x = values[:, 0].astype(np.float64) * 9.0
    rows = table[1:].astype(np.float64)
    exact = np.stack([np.interp(x, np.arange(10), column) for column in rows.T], axis=-1)
    if extends:
        exact += np.minimum(x, 0.0)[:, None] * (rows[1] - rows[0])
        exact += np.maximum(x - 9.0, 0.0)[:, None] * (rows[-1] - rows[-2])
    np.testing.assert_allclose(found, exact, atol=2e-5)


def test_curves_take_a_column_each(device, values):
    table = np.random.default_rng(5).random((256, 4)).astype(np.float32)
    found = evaluated(device, "out_color.rgb = color_of_curves(0, 0, b.xyz)", values, harness.texels(table))
    x = np.clip(values[:, 4:7].astype(np.float64), 0.0, 1.0) * 255.0
    exact = np.stack([np.interp(x[:, i], np.arange(256), table[:, i]) for i in range(3)], axis=-1)
    np.testing.assert_allclose(found[:, :3], exact, atol=1e-4)


def test_steps_lie_between_rows(device, values):
    places, colors = np.array([0.0, 0.3017, 0.6031]), np.random.default_rng(6).random((3, 4)).astype(np.float32)
    even = np.arange(256) / 255.0
    table = np.zeros((512, 4), np.float32)
    table[:256] = colors[np.searchsorted(places, even, side="right") - 1]
    for place in places[1:]:
        table[256 + int(place * 255.0), 0] = place * 255.0 % 1.0
    found = evaluated(device, "out_color = color_of_steps(0, a.x)", values, harness.texels(table))
    x = np.clip(values[:, 0], 0.0, 1.0)
    clear = np.abs(x[:, None] - places[1:]).min(axis=-1) > 1e-6
    exact = colors[np.searchsorted(places, x, side="right") - 1]
    np.testing.assert_array_equal(found[clear], exact[clear])
