"""References: what leads to a node, to the primitives of a leaf, to an instance or a grid, as one integer of 32 bits.

Its lowest `INDEX_BITS` are an index, those above say what is there, 0 an inner node. Records hold it in two fields.
"""

import numpy as np

INDEX_BITS = 26
COUNT_BITS = 3
MAX_LEAF_SIZE = 1 << COUNT_BITS
LOW_BITS = 23


def split_index(index):
    """Split non-negative integers below 2^40 into two parts below 2^23: (low, high)."""
    index = np.asarray(index, np.int64)
    return index & ((1 << LOW_BITS) - 1), index >> LOW_BITS


def pack_leaf(kind, count, index_high):
    """The `leaf` field of a node, what a reference has above the low part of its index: kind and number of primitives
    (0: an inner node) and the high part of the index. ValueError for an index of more than `INDEX_BITS`."""
    if np.max(index_high, initial=0) >> (INDEX_BITS - LOW_BITS):
        raise ValueError(f"a reference has {INDEX_BITS} bits for an index")
    holds = np.where(np.asarray(count) > 0, 1 + (np.asarray(kind) << COUNT_BITS) + np.asarray(count) - 1, 0)
    return np.asarray(index_high) + (holds << (INDEX_BITS - LOW_BITS))


def unpack_leaf(leaf):
    """(kind, count, index_high) that `pack_leaf` was given; the kind of an inner node is of no meaning."""
    leaf = np.asarray(leaf).astype(np.int64)
    holds = leaf >> (INDEX_BITS - LOW_BITS)
    kind, count = np.divmod(holds - 1, MAX_LEAF_SIZE)
    return kind, np.where(holds > 0, count + 1, 0), leaf & ((1 << (INDEX_BITS - LOW_BITS)) - 1)
