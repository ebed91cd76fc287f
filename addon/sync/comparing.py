# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether what was read anew is what was there before, so that it can be the same object."""

from ..engine.primitives.base import is_one_value


def same_primitives(geometry, other):
    """Whether two geometries, which have as many of each kind, have the same values."""
    pairs = zip(geometry.kinds(), other.kinds(), strict=True)
    return all(same_rows(part, old) for (_, part), (_, old) in pairs)


def same_rows(part, other):
    """Whether primitives of one kind, as many, have the same values."""
    names = [column.name for column in part.columns]
    return part.attributes.keys() == other.attributes.keys() and all(
        same_values(a, b)
        for a, b in (
            *((getattr(part, name), getattr(other, name)) for name in names),
            *((part.attributes[key], other.attributes[key]) for key in part.attributes),
        )
    )


def same_values(a, b):
    """Whether two arrays (n, ...) are equal; NaN, which stands for none, equals itself."""
    if a is b:
        return True
    if a.dtype != b.dtype or a.shape != b.shape:
        return False
    if len(a) and is_one_value(a) and is_one_value(b):
        a, b = a[:1], b[:1]
    equal = a == b
    return bool(equal.all()) or (a.dtype.kind == "f" and bool((equal | ((a != a) & (b != b))).all()))


def same_dicts(a, b):
    """Whether two dictionaries have equal arrays."""
    return a.keys() == b.keys() and all(same_values(a[key], b[key]) for key in a)
