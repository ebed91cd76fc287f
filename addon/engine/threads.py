"""Work that is in independent pieces, on all cores."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor

LARGE = 1 << 17  # boxes, primitives from which on threads pay
PIECE = 1 << 15  # rows that are worked on at a time: their temporary arrays stay in the processor's cache
MOST_THREADS = 4  # memory is hardly faster for more, and each needs room for what it works on


def each(function: Callable, items: Iterable, *, worth_it: bool) -> list:
    """The results of `function` for all items; in threads if that is `worth_it`, numpy lets go of the interpreter's
    lock within most of its loops."""
    threads = min(os.cpu_count() or 1, MOST_THREADS) if worth_it else 1
    if threads == 1:
        return [function(item) for item in items]
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(function, items))


def both(first: Callable, second: Callable) -> tuple:
    """The results of two functions that are called at the same time: what of one is in no pieces, the other fills."""
    with ThreadPoolExecutor(1) as pool:
        other = pool.submit(second)
        return first(), other.result()


def pieces(count: int) -> Iterator[slice]:
    """Slices of `PIECE` rows that cover `count` rows."""
    return (slice(start, min(start + PIECE, count)) for start in range(0, count, PIECE))


def each_piece(function: Callable, count: int) -> list:
    """The results of `function` for the slices of `pieces`, as of `each`; in threads where they are many."""
    return each(function, pieces(count), worth_it=count >= LARGE)
