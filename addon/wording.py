# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of things as people read them."""

_IRREGULAR = {"vertex": "vertices"}


def counted(count, noun):
    """`1 sphere`, `66,430 spheres`."""
    return f"{count:,} {plural(noun, count)}"


def plural(noun, count=2):
    """`sphere`, or `spheres` where there is not just one."""
    if count == 1:
        return noun
    if noun in _IRREGULAR:
        return _IRREGULAR[noun]
    return f"{noun[:-1]}ies" if noun.endswith("y") else f"{noun}s"
