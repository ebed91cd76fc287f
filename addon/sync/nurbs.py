"""Knots and basis functions of Blender's NURBS, for many curves at once. Numpy only."""

import numpy as np

#: Blender's numbers of the ways in which it makes knots.
NORMAL, ENDPOINT, BEZIER, ENDPOINT_BEZIER = range(4)


def valid_nurbs(counts, order, cyclic, knots_mode):
    """Which curves (c,) bool have points enough for their order and their knots; Blender takes the others for
    polylines."""
    bezier = np.isin(knots_mode, (BEZIER, ENDPOINT_BEZIER))
    enough = (order >= 2) & (counts >= order) & ~((knots_mode == BEZIER) & (counts <= order))
    whole = ~cyclic | (counts % np.maximum(order - 1, 1) == 0)
    return enough & (~bezier | whole)


def knots_of(counts, order, cyclic, knots_mode):
    """The knots of curves with `counts` (c,) points, one curve after the other, and their offsets (c + 1,).

    Knots count up by 1, repeated where the mode has the curve pass through points. A closed curve's points go on with
    its first order - 1, and its knots with the widths of its first.
    """
    total = counts + order + np.where(cyclic, order - 1, 0)
    offsets = np.concatenate([[0], np.cumsum(total)]).astype(np.int64)
    of_knot = np.repeat(np.arange(len(counts)), total)
    bezier = np.isin(knots_mode, (BEZIER, ENDPOINT_BEZIER))
    clamped = np.isin(knots_mode, (ENDPOINT, ENDPOINT_BEZIER))
    repeat = np.where(bezier, order - 1, 1)
    head = np.where(clamped, order - cyclic, np.where(bezier, np.minimum(2, repeat), 1))
    tail = np.where(cyclic, 2 * order - 1, np.where(clamped, order, 0))
    shift = (clamped & cyclic).astype(np.int64)  # one knot before all others

    def counted(i, curve):
        after_head = i - shift[curve] - head[curve]
        value = shift[curve] + np.where(after_head >= 0, 1 + after_head // repeat[curve], 0)
        return np.where(i < shift[curve], 0, value)

    body = (total - tail)[of_knot]
    local = np.arange(offsets[-1]) - offsets[:-1][of_knot]
    period = counted(body, of_knot)
    turns = local // np.maximum(body, 1)
    return (counted(local - turns * body, of_knot) + turns * period).astype(np.float64), offsets


def nonempty_spans(knots, offsets, order):
    """Where curves run: the curve (m,) and the number in `knots` (m,) of each knot from which the parameter goes on to
    a larger one."""
    counts = np.diff(offsets)
    of_knot = np.repeat(np.arange(len(counts)), counts)
    local = np.arange(len(knots)) - offsets[:-1][of_knot]
    inner = (local >= order - 1) & (local < counts[of_knot] - order)
    spans = np.flatnonzero(inner & (np.append(knots[1:], 0.0) > knots))
    return of_knot[spans], spans


def basis(knots, span, t, order):
    """The basis functions (order, n) that are not 0 at the part `t` (n,) of the spans `span` (n,).

    Piegl and Tiller 1997, The NURBS Book, algorithm A2.2.
    """
    u = knots[span] + t * (knots[span + 1] - knots[span])
    functions = np.zeros((order, len(span)))
    functions[0] = 1.0
    for degree in range(1, order):
        saved = np.zeros(len(span))
        for r in range(degree):
            right, left = knots[span + r + 1], knots[span + 1 - degree + r]
            share = functions[r] / (right - left)
            functions[r] = saved + (right - u) * share
            saved = (u - left) * share
        functions[degree] = saved
    return functions
