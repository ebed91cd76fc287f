"""The operators of expressions in GLSL against their numpy twins."""

import numpy as np
import pytest

from addon.engine.operators import OPERATORS

from . import harness

#: Operators by how many inputs they take, of what types.
_TAKES = {
    "combine": ("float",) * 3,
    "mix": ("float", "vec3", "vec3"),
    "select": ("float", "vec3", "vec3"),
    "less": ("float", "float"),
}
_OF_ONE = ("sqrt", "absolute", "exp", "mean", "luminance", "largest", "settled", "x", "y", "z")
_SPECIAL = (0.0, 1.0, -1.0, 0.5, 2.0)


_NAMES = [name for name, operator in OPERATORS.items() if operator.twin and name != "w"]
#: Those that take numbers as well as vectors.
_OF_BOTH = [name for name in _NAMES if name not in _TAKES and not (name in _OF_ONE and OPERATORS[name].type)]


@pytest.mark.parametrize(("name", "kind"), [(name, "vec3") for name in _NAMES] + [(name, "float") for name in _OF_BOTH])
def test_operator(device, name, kind):
    operator = OPERATORS[name]
    types = _TAKES.get(name) or ((kind,) if name in _OF_ONE else (kind, kind))
    columns = np.random.default_rng(5).uniform(-2.0, 2.0, (400, 8)).astype(np.float32)
    special = np.array(np.meshgrid(_SPECIAL, _SPECIAL)).reshape(2, -1).T
    columns[: len(special)] = special[:, [0, 0, 0, 0, 1, 1, 1, 1]]
    names = ("value.a.xyz", "value.b.xyz", "vec3(value.a.w)")
    order = [names[i] for i in (2, 0, 1)] if name in ("mix", "select") else names
    order = ("value.a.x", "value.b.x", "value.a.w") if types[0] == types[-1] == "float" else order
    inputs = [
        f"{text}.x" if (k == "float" and "xyz" in text) or "vec3" in text else text
        for text, k in zip(order, types, strict=False)
    ]
    text = f"""#include "operator_lib.glsl"
#include <test_value>
void main()
{{
  TestValue value = read_test_value(TEST_INDEX);
  out_color = vec4(vec3({operator.text.format(*inputs)}), 0.0);
}}
"""
    (found,) = harness.run_values(device, "operator_frag.glsl", *columns.T, generated=(("operator_frag.glsl", text),))
    a, b, w = columns[:, :3].astype(np.float64), columns[:, 4:7].astype(np.float64), columns[:, 3:4].astype(np.float64)
    if order[0] == "value.a.x":
        values = [a[:, :1], b[:, :1], w][: len(types)]
    else:
        values = [w, a, b] if name in ("mix", "select") else [a, b][: len(types)]
    expected = np.array([np.broadcast_to(operator.twin(*rows), 3) for rows in zip(*values, strict=True)])
    np.testing.assert_allclose(found[:, :3], expected, rtol=2e-5, atol=1e-6)
