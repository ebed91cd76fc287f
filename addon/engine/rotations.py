"""Rotations as quaternions (4, n), w first, in float64: as many as there are segments of strands, without a loop."""

import numpy as np

from .primitives.base import any_perpendicular, dot


def between(a, b):
    """The smallest rotation that takes each unit vector a (n, 3) to b (n, 3); half a turn about any axis where they
    are opposite."""
    q = np.empty((4, len(a)))
    q[0], q[1:] = 1.0 + dot(a, b), np.cross(a, b).T
    opposite = q[0] < 1e-12
    if opposite.any():
        q[0, opposite], q[1:, opposite] = 0.0, any_perpendicular(a[opposite]).T
    return q / np.sqrt(np.einsum("in,in->n", q, q))


def product(p, q):
    """The rotations p after q."""
    pw, px, py, pz = p
    qw, qx, qy, qz = q
    return np.stack(
        [
            pw * qw - px * qx - py * qy - pz * qz,
            pw * qx + px * qw + py * qz - pz * qy,
            pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw,
        ]
    )


def inverse(q):
    """The rotations back."""
    return np.stack([q[0], -q[1], -q[2], -q[3]])


def rotated(q, vectors):
    """Vectors (n, 3) turned by q."""
    axis = np.ascontiguousarray(q[1:].T)
    twice = 2.0 * np.cross(axis, vectors)
    return vectors + q[0][:, None] * twice + np.cross(axis, twice)


def running_products(q):
    """Number k is the rotation by number 0, then by number 1, ... then by number k of q.

    A scan (Blelloch 1990): the products of pairs give every second one, and those the rest.
    """
    if q.shape[1] < 2:
        return q
    every_second = running_products(product(q[:, 1::2], q[:, :-1:2]))
    out = np.empty_like(q)
    out[:, 0], out[:, 1::2] = q[:, 0], every_second
    rest = q[:, 2::2]
    out[:, 2::2] = product(rest, every_second[:, : rest.shape[1]])
    return out
