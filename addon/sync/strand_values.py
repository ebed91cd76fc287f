# SPDX-License-Identifier: GPL-3.0-or-later
"""What materials want to know of strands that no attribute tells: Hair Info's outputs, and where hair has its root."""

import numpy as np

from .attributes import GENERATED_OFFSET, GENERATED_SCALE, key_of
from .spaces import texture_space

_IS_STRAND, _INTERCEPT, _LENGTH, _THICKNESS = (
    key_of("hair", name) for name in ("is_strand", "intercept", "length", "thickness")
)


def of_strands(keys, is_particle_hair=False):
    """What all strands have in common, (4,) by key. Generated coordinates of particle hair are those of its root."""
    found = {_IS_STRAND: np.ones(4)} if _IS_STRAND in keys else {}
    if is_particle_hair and GENERATED_SCALE in keys:
        found[GENERATED_SCALE] = np.zeros(4)
    return found


def of_points(keys, points, offsets, radius):
    """What differs along curves through control points (n, 3) with `radius` (n,), (n, 4) by key. `offsets` (c + 1,):
    the first point of each curve."""
    found = {}
    if _INTERCEPT in keys:
        along, total = _lengths(points, offsets)
        total = np.repeat(total, np.diff(offsets))
        found[_INTERCEPT] = _grey(np.divide(along, total, out=np.zeros(len(along)), where=total > 0.0))
    if _THICKNESS in keys:
        found[_THICKNESS] = _grey(2.0 * np.asarray(radius))
    return found


def of_curves(keys, points, offsets):
    """What curves have in all, (c, 4) by key."""
    return {_LENGTH: _grey(_lengths(points, offsets)[1])} if _LENGTH in keys else {}


def of_roots(keys, mesh, roots):
    """The generated coordinates of hair that grows from `roots` (c, 3) on a mesh, (c, 4) by key."""
    if GENERATED_OFFSET not in keys:
        return {}
    scale, offset = texture_space(mesh)
    return {GENERATED_OFFSET: np.insert(roots * scale + offset, 3, 1.0, axis=1)}


def _lengths(points, offsets):
    """Length (n,) from the first point of its curve to each point, and of each curve (c,)."""
    steps = np.zeros(len(points))
    steps[1:] = np.linalg.norm(np.diff(points, axis=0), axis=1)
    starts = np.asarray(offsets[:-1])[np.diff(offsets) > 0]
    steps[starts] = 0.0
    sums = np.cumsum(steps)
    along = sums - np.repeat(sums[starts], np.diff(offsets)[np.diff(offsets) > 0])
    total = np.zeros(len(offsets) - 1)
    total[np.diff(offsets) > 0] = along[np.asarray(offsets[1:])[np.diff(offsets) > 0] - 1]
    return along, total


def _grey(values):
    return np.insert(np.repeat(np.asarray(values, np.float64)[:, None], 3, axis=1), 3, 1.0, axis=1)
