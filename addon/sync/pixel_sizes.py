# SPDX-License-Identifier: GPL-3.0-or-later
"""How fine curves have to be: as pixels are where they are seen."""

import numpy as np

from .keys import data_key, original_key
from .raw_attributes import read_positions

#: The kinds of copies whose form depends on how large pixels are.
STRANDS = {"CURVES", "CURVE", "HAIR"}


class PixelSizes:
    """How long a pixel is, in the space of an object, where the object is nearest to one of those that see it.

    `eyes`: (engine Camera, height of its picture in pixels) of each.
    """

    #: Of its own size, how near the camera an object counts at least: it may stand in the middle of it.
    _NEAREST = 0.02

    def __init__(self, eyes, all_copies):
        self._least, self._owners, self._places = {}, {}, {}
        for copies in all_copies:
            if copies.kind in STRANDS:
                key, places = self._key(copies), _places(copies)
                self._owners.setdefault(key, (copies.kind, original_key(copies.obj)))
                self._places.setdefault(key, []).append(places)
                lengths = (self._length(places, camera, height) for camera, height in eyes)
                self._least[key] = min(self._least.get(key, np.inf), *lengths)

    def of(self, copies):
        """The length, for all copies of the data in the scene."""
        length = self._least.get(self._key(copies), np.inf)
        return length if np.isfinite(length) else 1.0

    def are_too_long(self, camera, height):
        """Whether another camera sees pixels that are less than half as long, in a picture of this height."""
        return any(
            self._length(places, camera, height) < 0.5 * self._least[key]
            for key, all_places in self._places.items()
            for places in all_places
        )

    def settle(self, known):
        """Keep to the lengths of an earlier read, as this gave them, where they are no more than twice or half as long;
        the lengths, to be given to the next."""
        for key, owner in self._owners.items():
            length = (known or {}).get(owner, 0.0)
            if 0.5 <= length / self._least[key] <= 2.0:
                self._least[key] = length
        return {owner: self._least[key] for key, owner in self._owners.items()}

    def _key(self, copies):
        return copies.kind, data_key(copies.data)

    def _length(self, places, camera, height):
        center, radius, scale = places
        distance = np.ones(len(scale))
        if not camera.orthographic:
            distance = np.linalg.norm(center - camera.matrix[:3, 3], axis=1) - radius
            distance = np.maximum(distance, self._NEAREST * radius)
        with np.errstate(divide="ignore", invalid="ignore"):
            length = (camera.window[3] - camera.window[2]) / height * distance / scale
        length = length[np.isfinite(length) & (length > 0.0)]
        return float(length.min()) if len(length) else np.inf


def _places(copies):
    """Of copies the center (n, 3) and radius (n,) of balls that they are in, and how much larger they are (n,) than the
    data."""
    low, high = _bounds(copies)
    matrices = copies.matrices.astype(np.float64)
    scale = np.linalg.norm(matrices[:, :3, :3], axis=1).max(axis=1)
    center = matrices[:, :3, :3] @ ((low + high) / 2.0) + matrices[:, :3, 3]
    return center, scale * np.linalg.norm(high - low) / 2.0, scale


def _bounds(copies):
    """The lower and upper corner of the data of strands, in its own space."""
    if copies.is_own:
        corners = np.array(copies.obj.bound_box)
    elif copies.kind == "CURVE":  # Blender tells nothing of them
        corners = np.empty((0, 3))
    else:
        corners = read_positions(copies.data)
        corners = corners[np.isfinite(corners).all(axis=1)]
    return (corners.min(axis=0), corners.max(axis=0)) if len(corners) else (np.zeros(3), np.zeros(3))
