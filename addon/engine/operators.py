# SPDX-License-Identifier: GPL-3.0-or-later
"""The arithmetic of expressions: what an operator is in GLSL, and its twin in numpy."""

from dataclasses import dataclass

import numpy as np

#: Rec. 709 luminance.
LUMINANCE = np.array((0.2126, 0.7152, 0.0722))


@dataclass(frozen=True)
class Operator:
    """GLSL `text` with the inputs in braces, and its numpy twin. `type`: of the result; empty: the widest of the
    inputs, to which all are widened but the first `narrow` ones, which stay numbers, and where it `takes_numbers` all
    numbers."""

    text: str
    twin: object
    type: str = ""
    narrow: int = 0
    takes_numbers: bool = False


def _select(condition, a, b):
    return np.where(condition > 0.5, a, b)


#: What arithmetic compiles to. Where float and vector differ GLSL's own overloads serve both.
OPERATORS = {
    "add": Operator("({0} + {1})", np.add, takes_numbers=True),
    "subtract": Operator("({0} - {1})", np.subtract, takes_numbers=True),
    "multiply": Operator("({0} * {1})", np.multiply, takes_numbers=True),
    "divide": Operator(
        "operator_divided({0}, {1})",
        lambda a, b: np.where(b != 0.0, a / np.where(b != 0.0, b, 1.0), 0.0),
    ),
    "minimum": Operator("min({0}, {1})", np.minimum),
    "maximum": Operator("max({0}, {1})", np.maximum),
    "mix": Operator("mix({1}, {2}, {0})", lambda t, a, b: a + (b - a) * t, narrow=1),
    "select": Operator("({0} > 0.5 ? {1} : {2})", _select, narrow=1),
    "less": Operator("({0} < {1} ? 1.0 : 0.0)", lambda a, b: np.where(a < b, 1.0, 0.0), "float"),
    "sqrt": Operator("sqrt(max({0}, 0.0))", lambda a: np.sqrt(np.maximum(a, 0.0))),
    "exp": Operator("exp({0})", np.exp),
    "absolute": Operator("abs({0})", np.abs),
    "combine": Operator("vec3({0}, {1}, {2})", lambda *x: np.concatenate(x), "vec3", narrow=3),
    "mean": Operator("dot({0}, vec3(1.0 / 3.0))", lambda a: a.mean(keepdims=True), "float"),
    "luminance": Operator("dot({0}, vec3(0.2126, 0.7152, 0.0722))", lambda a: np.array([a @ LUMINANCE]), "float"),
    "largest": Operator("optics_largest({0})", lambda a: a.max(keepdims=True), "float"),
    "x": Operator("{0}.x", lambda a: a[0:1], "float"),
    "y": Operator("{0}.y", lambda a: a[1:2], "float"),
    "z": Operator("{0}.z", lambda a: a[2:3], "float"),
    "w": Operator("{0}.w", lambda a: a[3:4], "float"),
    "settled": Operator("{0}", lambda a: a),
}
for _from, _to, _text in (  # conversions: numbers are repeated, vectors lose components or gain 0, and 1 as the fourth
    ("float", "vec2", "vec2({0})"),
    ("float", "vec3", "vec3({0})"),
    ("float", "vec4", "vec4({0})"),
    ("vec2", "vec3", "vec3({0}, 0.0)"),
    ("vec2", "vec4", "vec4({0}, 0.0, 1.0)"),
    ("vec3", "vec2", "{0}.xy"),
    ("vec3", "vec4", "vec4({0}, 1.0)"),
    ("vec4", "vec2", "{0}.xy"),
    ("vec4", "vec3", "{0}.xyz"),
):
    OPERATORS[f"{_from}_{_to}"] = Operator(_text, None, _to)
