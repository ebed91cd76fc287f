# SPDX-License-Identifier: GPL-3.0-or-later
"""A digest of plain data: whether two readings of Blender's scene would give the same picture.

A cryptographic hash of a scene of ten million spheres would block the window for half a second. Large arrays are
first reduced, at nearly the speed of memory, by a multilinear hash with secret random weights (Lemire and Kaser,
Strongly Universal String Hashing is Fast, 2014). A digest is of use within one run of Blender only.
"""

import hashlib
import os
from enum import Enum

import numpy as np

_WORDS = 1 << 12  # 8-byte words that become one
_ROWS = 1 << 6  # of so many words reduced at a time: they and what is made of them stay in the cache
_WEIGHTS = np.frombuffer(os.urandom(16 * _WORDS), np.uint64).reshape(2, _WORDS)


def fingerprint(value) -> bytes:
    """16 bytes that are equal for values of equal content: numbers, strings, numpy arrays, lists, tuples,
    dictionaries, and objects made of these. What is reached several times is read once."""
    digest = hashlib.blake2b(digest_size=16)
    _add(value, digest.update, {})
    return digest.digest()


def _add(value, update, seen):
    """Feed the type and content of `value` to `update`; `seen` maps the id of each object to its number."""
    if isinstance(value, np.ndarray):
        _add_array(value, update)
    elif isinstance(value, list | tuple):
        update(f"{type(value).__name__}{len(value)}".encode())
        for item in value:
            _add(item, update, seen)
    elif isinstance(value, dict):
        _add(list(value.items()), update, seen)
    elif isinstance(value, Enum) or not hasattr(value, "__dict__"):
        update(repr(value).encode())
    elif id(value) in seen:
        update(f"again {seen[id(value)]}".encode())
    else:
        seen[id(value)] = len(seen)
        update(type(value).__name__.encode())
        _add(vars(value), update, seen)


def _add_array(array, update):
    """Feed type, shape and content of an array. Of what repeats one row (a column that was given as one value), that
    row counts: such an array and one that has the rows in full differ."""
    repeats = array.ndim > 0 and len(array) > 1 and array.strides[0] == 0
    update(f"{array.dtype}{array.shape}{repeats}".encode())
    content = np.ascontiguousarray(array[:1] if repeats else array)
    data = content.reshape(-1).view(np.uint8)
    whole = len(data) // (8 * _WORDS) * (8 * _WORDS)
    if whole:
        update(_reduced(data[:whole].view(np.uint64).reshape(-1, _WORDS)))
    update(data[whole:])


def _reduced(rows):
    """Rows (n, _WORDS) uint64 as two numbers each, (2, n) uint64.

    A sum of words times random weights modulo 2^64 is equal for two rows whose words differ with a probability of at
    most 2^(k - 64), k the number of low bits in which all words agree. For k < 32 that is at most 2^-33. For rows
    that differ in the upper halves of words alone, as by the signs of floats, the sum of the upper halves is.
    """
    sums = np.empty((2, len(rows)), np.uint64)
    upper = np.empty((_ROWS, _WORDS), np.uint64)
    for start in range(0, len(rows), _ROWS):
        block = rows[start : start + _ROWS]
        np.right_shift(block, np.uint64(32), out=upper[: len(block)])
        np.einsum("ij,j->i", block, _WEIGHTS[0], out=sums[0, start : start + _ROWS])
        np.einsum("ij,j->i", upper[: len(block)], _WEIGHTS[1], out=sums[1, start : start + _ROWS])
    return sums
