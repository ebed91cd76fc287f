"""Bottom-up clustering of many boxes: parallel locally-ordered clustering.

D. Meister, J. Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction", TVCG
2018. The clusters lie along a Morton curve; each looks some places to either side for the neighbour with
which it would make the box of least area; two that choose each other merge. Every step is a handful of
whole-array operations on ever fewer clusters, which suits numpy far better than partitioning does.

They look far while they are small and less far later: the curve has then been thinned out, and what merges
across a large part of it spoils the levels above.

The one clever thing: an edge between places i and i + d is a single non-negative int32, the bits of the area
as float32 (which order as the floats do) with the low `CODE_BITS` replaced by (d - 1, parity of i // d). The
edges of a cluster thus never compare equal, and both ends see the same number: so each round merges at least
the least edge, and equal boxes pair off in halves.
"""

from __future__ import annotations

import numpy as np

from .boxes import half_areas, take_spans
from .topology import Topology

RADIUS = 8  # places
LATER_RADIUS = 4  # once only a `LATER`th of the clusters is left
LATER = 4
CODE_BITS = 4  # d - 1 < 8, and the parity
CODE_MASK = (1 << CODE_BITS) - 1
CHUNK = 1 << 15  # clusters worked on at a time: the scratch arrays stay in the cache


def agglomerate(span: np.ndarray, ids: np.ndarray, topology: Topology, stop: int) -> tuple[np.ndarray, np.ndarray]:
    """Merge clusters until at most `stop` (at least 1) remain, adding the nodes to `topology`.

    Args:
        span: (6, n) float32 boxes of the clusters along the curve, see `boxes`; overwritten.
        ids: (n,) int32, their nodes in `topology`; overwritten.

    Returns:
        The spans (6, k) and the nodes (k,) of what remains, still along the curve.
    """
    coarse, codes = CODE_BITS, [_edge_codes(distance) for distance in range(1, RADIUS + 1)]
    later = len(ids) // LATER
    while len(ids) > stop:
        if len(ids) <= later:
            codes = codes[:LATER_RADIUS]
        left, right = _mutual_pairs(_cheapest_edges(span, codes, coarse))
        # Sizes that grow steadily along the curve make chains in which only the last two choose each other.
        # Compare fewer bits of the areas then, in the end none: neighbours pair off.
        coarse = CODE_BITS if len(left) * 16 > len(ids) else min(coarse + 8, 31)
        merged = np.maximum(take_spans(span, left), take_spans(span, right))
        nodes = topology.add(ids[left], ids[right], half_areas(merged))
        span[:, left] = merged
        ids[left] = nodes
        keep = np.ones(len(ids), bool)
        keep[right] = False
        keep = np.flatnonzero(keep)
        span, ids = take_spans(span, keep), ids[keep]
    return span, ids


def _cheapest_edges(span: np.ndarray, codes: list[np.ndarray], coarse: int) -> np.ndarray:
    """(n,) int32: the cheapest edge of each cluster, its `coarse` low bits of area ignored."""
    n = span.shape[1]
    best = np.full(n, np.iinfo(np.int32).max, np.int32)
    union = np.empty((6, CHUNK), np.float32)
    size = np.empty((3, CHUNK), np.float32)
    mask = np.int32(-1 << coarse) if coarse < 31 else np.int32(0)
    for start in range(0, n - 1, CHUNK):
        for distance, code in enumerate(codes, start=1):
            k = min(CHUNK, n - distance - start)
            if k <= 0:
                break
            here, there = slice(start, start + k), slice(start + distance, start + distance + k)
            u, s = union[:, :k], size[:, :k]
            np.maximum(span[:, here], span[:, there], out=u)
            np.add(u[:3], u[3:], out=s)
            area = u[0]
            np.multiply(s[0], s[1], out=area)
            np.add(s[0], s[1], out=s[0])
            np.multiply(s[0], s[2], out=s[0])
            np.add(area, s[0], out=area)
            edge = area.view(np.int32)
            np.bitwise_and(edge, mask, out=edge)
            phase = start % (2 * distance)
            np.bitwise_or(edge, code[phase : phase + k], out=edge)
            np.minimum(best[here], edge, out=best[here])
            np.minimum(best[there], edge, out=best[there])
    return best


def _edge_codes(distance: int) -> np.ndarray:
    """Codes of the edges (i, i + distance), i from 0: for a chunk that starts within the first period."""
    parity = (np.arange(CHUNK + 2 * distance, dtype=np.int32) // distance) & 1
    return (2 * (distance - 1) + parity).astype(np.int32)


def _mutual_pairs(best: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The places (left < right) of the clusters that chose each other."""
    pairs = []
    for start in range(0, len(best), CHUNK):
        code = best[start : start + CHUNK] & CODE_MASK
        distance = (code >> 1) + 1
        left = np.arange(start, start + len(code), dtype=np.int64)
        right = left + distance
        mutual = np.flatnonzero(np.take(best, right, mode="clip") == best[start : start + CHUNK])
        left, right, code, distance = left[mutual], right[mutual], code[mutual], distance[mutual]
        # Seen from the far end the same distance and parity mean backward, so equal numbers are one edge.
        forward = ((left // distance) & 1) == (code & 1)
        pairs.append((left[forward], right[forward]))
    left, right = zip(*pairs, strict=True)
    return np.concatenate(left), np.concatenate(right)
