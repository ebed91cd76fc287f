"""Boxes on their way into a hierarchy: checks, outward rounding, spans and Morton codes.

The builders work on *spans*: (6, n) float32 with rows -lo.x, -lo.y, -lo.z, hi.x, hi.y, hi.z, scaled by a
power of two so that squares neither overflow nor vanish. The union of two spans is one maximum, the size is
one sum.
"""

from __future__ import annotations

import itertools

import numpy as np

from ..threads import LARGE, each, each_piece

MAX_LABELS = 1 << 16
MORTON_BITS = 21  # per axis: three of them fit in 64 bits
SORTED_PIECE = 1 << 13
OUTLIER_REACH = 512  # leaves 11 bits an axis to the middle of the scene


def checked_boxes(lo: np.ndarray, hi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) float32 lo and hi, rounded outward from the given (n, 3) boxes.

    Raises:
        ValueError: the shapes differ, or a box is not finite, is inverted, or does not fit in float32.
    """
    lo, hi = np.asarray(lo), np.asarray(hi)
    if lo.shape != hi.shape or lo.ndim != 2 or lo.shape[1] != 3:
        raise ValueError(f"boxes: lo and hi must both be of shape (n, 3), not {lo.shape} and {hi.shape}")
    _refuse(~(np.isfinite(lo) & np.isfinite(hi)), lo, hi, "not finite (NaN or infinite)")
    _refuse(lo > hi, lo, hi, "inverted (lo above hi)")
    low, high = rounded_outward(lo, hi)
    _refuse(~(np.isfinite(low) & np.isfinite(high)), lo, hi, "beyond the range of float32 (3.4e38)")
    return low, high


def _refuse(bad: np.ndarray, lo: np.ndarray, hi: np.ndarray, what: str) -> None:
    """Raise a ValueError that counts the boxes with a bad coordinate and shows the first."""
    if bad.any():
        rows = bad.any(axis=1)
        first = int(rows.argmax())
        raise ValueError(
            f"boxes: {np.count_nonzero(rows)} of {len(rows)} are {what}; "
            f"the first is primitive {first}: lo {lo[first].tolist()}, hi {hi[first].tolist()}"
        )


def rounded_outward(lo: np.ndarray, hi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """float32 corners of boxes that hold the given ones, infinite beyond the range of float32; float32 as they are."""
    with np.errstate(over="ignore"):
        return _round_outward(lo, -np.inf), _round_outward(hi, np.inf)


def _round_outward(values: np.ndarray, direction: float) -> np.ndarray:
    """float32 of `values`, a step towards `direction` (±inf) where the conversion went the other way."""
    rounded = values.astype(np.float32, copy=False)
    if values.dtype == np.float32:
        return rounded
    inward = rounded > values if direction < 0 else rounded < values
    rounded[inward] = np.nextafter(rounded[inward], np.float32(direction))
    return rounded


def checked_labels(label: np.ndarray | None, n: int) -> np.ndarray:
    """(n,) int32 labels, zeros if none are given.

    Raises:
        ValueError: the shape is wrong, a label is not an integer, or one is out of range.
    """
    if label is None:
        return np.zeros(n, np.int32)
    label = np.asarray(label)
    if label.shape != (n,) or not (np.issubdtype(label.dtype, np.integer) or n == 0):
        raise ValueError(f"labels: expected {n} integers, not shape {label.shape} of {label.dtype}")
    bad = (label < 0) | (label >= MAX_LABELS)
    if bad.any():
        first = int(bad.argmax())
        raise ValueError(f"labels: primitive {first} has label {label[first]}, expected 0 to {MAX_LABELS - 1}")
    return label.astype(np.int32, copy=False)


def spans(lo: np.ndarray, hi: np.ndarray, counts: np.ndarray | None = None) -> np.ndarray:
    """(6, n) float32 scaled spans of the (n, 3) float32 boxes (n > 0).

    `counts`: (t,) how many belong together, each lot scaled for itself; by default all.
    """
    if counts is None:
        first, second = _scale(max(-lo.min(), hi.max()))
    else:
        start = np.cumsum(counts) - counts
        reach = np.maximum(-np.minimum.reduceat(lo, start).min(axis=1), np.maximum.reduceat(hi, start).max(axis=1))
        first, second = (np.repeat(factor, counts) for factor in _scale(reach))
    span = np.empty((6, len(lo)), np.float32)

    def fill(rows):
        one, other = (first, second) if counts is None else (first[rows], second[rows])
        for axis in range(3):
            np.multiply(lo[rows, axis], -one, out=span[axis, rows])
            np.multiply(hi[rows, axis], one, out=span[3 + axis, rows])
        span[:, rows] *= other

    each_piece(fill, len(lo))
    return span


def _scale(reach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two float32 powers of two that bring coordinates up to `reach` down to 1; their product may be beyond float32."""
    exponent = np.where(reach > 0, -np.frexp(reach)[1], 0)
    half = exponent // 2
    return np.ldexp(np.float32(1), half), np.ldexp(np.float32(1), exponent - half)


def take_spans(span: np.ndarray, index: np.ndarray) -> np.ndarray:
    """span[:, index] of (6, n) spans, a row at a time, which is faster."""
    out = np.empty((6, len(index)), np.float32)
    for row in range(6):
        np.take(span[row], index, out=out[row], mode="clip")
    return out


def half_areas(span: np.ndarray) -> np.ndarray:
    """(n,) half surface areas of the (6, n) spans."""
    x, y, z = span[:3] + span[3:]
    return x * y + z * (x + y)


def morton_order(span: np.ndarray) -> np.ndarray:
    """(n,) int64: the boxes along a Z-curve through their centres."""
    return sorted_codes(morton_codes(span))[0]


def morton_codes(span: np.ndarray) -> np.ndarray:
    """(n,) uint64: places of the boxes' centres on a Z-curve, on a cubic grid of 2^21 cells a side. The (6, n) float32
    spans may be of any scale, but must be finite."""
    low, side = _grid_cube(span)
    code = np.empty(span.shape[1], np.uint64)

    def fill(rows):
        for axis in range(3):
            cell = (_half_centres(span[:, rows], axis) - low[axis]) * np.float32(2**MORTON_BITS / side)
            cell = np.clip(cell, 0, 2**MORTON_BITS - 1, out=cell).astype(np.int32)
            spread = np.take(_SPREAD, cell >> _SPREAD_BITS) << np.uint64(3 * _SPREAD_BITS + axis)
            spread |= np.take(_SPREAD, cell & (1 << _SPREAD_BITS) - 1) << np.uint64(axis)
            code[rows] = spread if axis == 0 else code[rows] | spread

    each_piece(fill, len(code))
    return code


def _half_centres(span: np.ndarray, axis: int) -> np.ndarray:
    """(n,) halves of an axis of the boxes' centres: their differences do not overflow."""
    return span[3 + axis] * np.float32(0.25) - span[axis] * np.float32(0.25)


def sorted_codes(code: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n,) int64: np.argsort of (n,) uint64 codes of 63 bits, stable; and the codes in this order.

    Faster where they are many: first by 16 bits, which numpy does in linear time, then what has these in common,
    pieces of some thousands at a time.
    """
    if len(code) < LARGE:
        order = np.argsort(code, kind="stable")
        return order, code[order]
    upper = (code >> np.uint64(3 * MORTON_BITS - 16)).astype(np.uint16)
    order = np.argsort(upper, kind="stable")
    code, upper = np.take(code, order, mode="clip"), np.take(upper, order, mode="clip")
    bounds = np.searchsorted(upper, upper[::SORTED_PIECE])
    bounds = np.append(bounds[np.diff(bounds, prepend=-1) > 0], len(code)).tolist()

    def sort(pieces):
        for start, stop in pieces:
            inside = np.argsort(code[start:stop], kind="stable")
            order[start:stop], code[start:stop] = order[start:stop][inside], code[start:stop][inside]

    pieces = list(itertools.pairwise(bounds))
    each(sort, (pieces[start : start + 16] for start in range(0, len(pieces), 16)), worth_it=True)
    return order, code


def _grid_cube(span: np.ndarray) -> tuple[np.ndarray, float]:
    """Lower corner (3,) float32 and side of a cube around the `_half_centres` of (6, n) spans, but for far outliers.

    One sphere as the ground, or a stray point, must not leave the rest of the scene in a single cell: the
    cube reaches at most `OUTLIER_REACH` times as far as the middle 98% of a sample do.
    """

    def reach_of(rows):
        centre = [_half_centres(span[:, rows], axis) for axis in range(3)]
        return [axis.min() for axis in centre], [axis.max() for axis in centre]

    low, high = zip(*each_piece(reach_of, span.shape[1]), strict=True)
    low, high = np.min(low, axis=0), np.max(high, axis=0)
    few = span[:, :: max(span.shape[1] // 16384, 1)]
    sample = np.stack([_half_centres(few, axis) for axis in range(3)])
    core_low, core_high = np.quantile(sample, (0.01, 0.99), axis=1).astype(np.float64)
    reach = (core_high - core_low).max() * OUTLIER_REACH
    if reach > 0:
        low = np.maximum(low, core_low - reach).astype(np.float32)
        high = np.minimum(high, core_high + reach).astype(np.float32)
    # Coincident centres need a side too; the smallest here keeps the scale of the grid within float32.
    return low, max(float((high - low).max()), 1e-30)


def _spread_bits(x: np.ndarray) -> np.ndarray:
    """uint64 with the 21 low bits of `x` three places apart: halve the group, move its upper half, repeat."""
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        x = (x | (x << np.uint64(shift))) & np.uint64(mask)
    return x


_SPREAD_BITS = 11
_SPREAD = _spread_bits(np.arange(1 << _SPREAD_BITS, dtype=np.uint64))  # stays in the processor's cache
