# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of a shader as the engine takes them: a constant, or a constant times an image."""

from dataclasses import dataclass, replace

import numpy as np

#: Rec. 709 luminance.
_LUMINANCE = np.array((0.2126, 0.7152, 0.0722))
#: An addition of less than this part is too weak to be told about.
_UNSEEN = 0.1
MISSING = (1.0, 0.0, 1.0)  # the pink that Blender shows for an image that is not there


def luminance(rgb):
    return float(np.dot(rgb, _LUMINANCE))


@dataclass(frozen=True)
class Value:
    """`rgb` (3,), times the image number `image` of the scene (-1: none), whose mean colour is `mean` (3,).

    `blurred`: something that varies differently over the surface was added, and only its average is in it.
    """

    rgb: tuple = (0.0, 0.0, 0.0)
    image: int = -1
    mean: tuple = (1.0, 1.0, 1.0)
    blurred: bool = False

    @property
    def average(self):
        """The colour (3,) where no image can be used."""
        return np.multiply(self.rgb, self.mean)

    @property
    def weight(self):
        """Luminance of the average."""
        return luminance(self.average)

    def times(self, factor):
        """Multiplied by a number or by a colour (3,)."""
        return replace(self, rgb=tuple(np.multiply(self.rgb, factor)))

    def plus(self, other):
        """The sum. Of two different images the stronger one stays; the other is added as its average."""
        if other.image == self.image:
            return replace(self, rgb=tuple(np.add(self.rgb, other.rgb)), blurred=self.blurred or other.blurred)
        if other.weight > self.weight or (other.image >= 0 > self.image and other.weight == self.weight):
            return other.plus(self)
        share = np.divide(other.average, np.maximum(self.mean, 1e-3))
        blurred = self.blurred or other.blurred or other.weight > _UNSEEN * self.weight
        return replace(self, rgb=tuple(np.add(self.rgb, share)), blurred=blurred)

    def sqrt(self):
        """The root, of an image by its average."""
        if self.image < 0:
            return Value(tuple(np.sqrt(np.maximum(self.rgb, 0.0))))
        # sqrt(rgb * image) is near (rgb * image) / sqrt(average) around the average.
        return self.times(1.0 / np.sqrt(np.maximum(self.average, 1e-3)))
