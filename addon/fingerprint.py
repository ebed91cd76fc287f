# SPDX-License-Identifier: GPL-3.0-or-later
"""A digest of plain data: whether two readings of Blender's scene would give the same picture."""

import hashlib
from enum import Enum

import numpy as np


def fingerprint(value) -> bytes:
    """16 bytes that are equal for values of equal content: numbers, strings, numpy arrays, lists, tuples,
    dictionaries, and objects made of these. What is reached several times is read once."""
    digest = hashlib.blake2b(digest_size=16)
    _add(value, digest.update, {})
    return digest.digest()


def _add(value, update, seen):
    """Feed the type and content of `value` to `update`; `seen` maps the id of each object to its number."""
    if isinstance(value, np.ndarray):
        update(f"{value.dtype}{value.shape}".encode())
        update(np.ascontiguousarray(value))
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
