# SPDX-License-Identifier: GPL-3.0-or-later
"""What value nodes of a shader make of attributes: expressions, evaluated in numpy for all elements at once.

Values are arrays (..., 1) for numbers and (..., 3) for colours and vectors, which broadcast as Blender converts a
number that is linked to a colour.
"""

from collections.abc import Callable
from dataclasses import dataclass
from hashlib import blake2b

import numpy as np

#: Rows that are evaluated together: bounds the memory for millions of elements.
_PIECE = 1 << 18
_MADE = "made:"
_LARGEST = float(np.finfo(np.float32).max)


@dataclass(frozen=True)
class Constant:
    """A number (1,) or a colour or vector (3,)."""

    value: tuple

    @property
    def keys(self):
        return frozenset()


@dataclass(frozen=True)
class Attribute:
    """The attribute of a `key` (see `attributes`): a number of it, or its colour."""

    key: str
    is_number: bool = False

    @property
    def keys(self):
        return frozenset((self.key,))


@dataclass(frozen=True, eq=False)
class Made:
    """An attribute made from others: `function(*settings, *inputs)`, with expressions as inputs.

    `key`: its name for the engine, the same for all that are made in the same way. `keys`: the attributes it needs.
    """

    function: Callable
    settings: tuple
    inputs: tuple
    key: str
    keys: frozenset


def made(function, settings, inputs):
    """The expression `function(*settings, *inputs)`: a constant where all inputs are constants, 0 for what is no number
    or beyond float32."""
    if all(isinstance(i, Constant) for i in inputs):
        with np.errstate(all="ignore"):
            value = function(*settings, *(np.array(i.value) for i in inputs))
        return Constant(tuple(float(x) if abs(x) <= _LARGEST else 0.0 for x in value))
    digest = blake2b(digest_size=12)
    for part in (function.__name__, settings, *(i.key if isinstance(i, Made) else i for i in inputs)):
        digest.update(repr(part).encode() + b";")
    return Made(function, settings, inputs, _MADE + digest.hexdigest(), frozenset().union(*(i.keys for i in inputs)))


def evaluate(expression, values, shape):
    """An expression's values (*shape, 4) float32, their alpha 1.

    `values`: arrays by key that broadcast to that shape; an attribute that is not there is 0, its alpha too. `shape`:
    (n, k), or (n,).
    """
    used = {key: values[key] for key in expression.keys if key in values}
    if all(len(array) == 1 or array.strides[0] == 0 for array in used.values()):
        row = _evaluate_rows(expression, {key: array[:1] for key, array in used.items()}, (1, *shape[1:]))
        return np.broadcast_to(row, (*shape, 4))
    out = np.empty((*shape, 4), np.float32)
    for start in range(0, shape[0], _PIECE):
        rows = slice(start, start + _PIECE)
        piece = {key: array[rows] if len(array) > 1 else array for key, array in used.items()}
        out[rows] = _evaluate_rows(expression, piece, out[rows].shape[:-1])
    return out


def _evaluate_rows(expression, values, shape):
    color = np.ones((*shape, 4), np.float32)
    with np.errstate(all="ignore"):  # what is not finite becomes 0
        color[..., :3] = np.nan_to_num(_value(expression, values, {}), posinf=0.0, neginf=0.0)
    return color


def _value(expression, values, known):
    """The value of an expression; `known`: those of made ones that are evaluated already, by key."""
    if isinstance(expression, Constant):
        return np.array(expression.value, np.float32)
    if isinstance(expression, Attribute):
        width = 1 if expression.is_number else 3
        read = values.get(expression.key)
        return np.zeros(width, np.float32) if read is None else read[..., :width]
    if expression.key not in known:
        inputs = (_value(i, values, known) for i in expression.inputs)
        known[expression.key] = expression.function(*expression.settings, *inputs)
    return known[expression.key]
