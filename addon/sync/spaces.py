# SPDX-License-Identifier: GPL-3.0-or-later
"""The space of an object, as shaders take it: from the world's coordinates to the object's."""

import numpy as np

from ..engine.primitives import invertible


def space_rows(matrices):
    """Of matrices (n, 4, 4) from object to world three rows (n, 3, 4) float64 each: a row of the inverse of the linear
    part, and a component of the place of the origin. See `coordinate_nodes_lib.glsl`.

    What is flattened or nowhere has the nearest thing to an inverse.
    """
    matrices = np.nan_to_num(np.asarray(matrices, np.float64), posinf=0.0, neginf=0.0)
    linear, good = matrices[:, :3, :3], invertible(matrices)
    rows = np.empty((len(matrices), 3, 4))
    rows[good, :, :3] = np.linalg.inv(linear[good])
    rows[~good, :, :3] = np.linalg.pinv(linear[~good])
    rows[:, :, 3] = matrices[:, :3, 3]
    return rows


def texture_space(data):
    """Scale and offset (3,) float64 that take a place in the space of evaluated data to its generated coordinates; 1
    and 0 where the data has no texture space."""
    size = np.array(getattr(data, "texspace_size", (0.5, 0.5, 0.5)), np.float64)
    location = np.array(getattr(data, "texspace_location", (0.5, 0.5, 0.5)), np.float64)
    scale = np.divide(0.5, size, out=np.zeros(3), where=size != 0.0)
    return scale, 0.5 - location * scale
