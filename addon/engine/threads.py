"""Work that is in independent pieces, on all cores."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor

LARGE = 1 << 17  # boxes, primitives from which on threads pay
MOST_THREADS = 4  # memory is hardly faster for more, and each needs room for what it works on


def each(function: Callable, items: Iterable, *, worth_it: bool) -> list:
    """The results of `function` for all items; in threads if that is `worth_it`, numpy lets go of the interpreter's
    lock within most of its loops."""
    threads = min(os.cpu_count() or 1, MOST_THREADS) if worth_it else 1
    if threads == 1:
        return [function(item) for item in items]
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(function, items))
