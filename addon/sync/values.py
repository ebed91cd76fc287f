# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of a shader as the engine takes them: a constant, times an image, times an attribute."""

from dataclasses import dataclass, replace

import numpy as np

#: Rec. 709 luminance.
LUMINANCE = np.array((0.2126, 0.7152, 0.0722))
#: An addition of less than this part is too weak to be told about.
_UNSEEN = 0.1
MISSING = (1.0, 0.0, 1.0)  # the pink that Blender shows for an image that is not there


def luminance(rgb):
    return float(np.dot(rgb, LUMINANCE))


@dataclass(frozen=True)
class Value:
    """`rgb` (3,), times the image number `image` of the scene (-1: none), times the attribute of the key `attribute`
    (empty: none). `mean` (3,): the mean colour of what varies.

    `blurred`: something that varies differently over the surface was added, and only its average is in it.
    """

    rgb: tuple = (0.0, 0.0, 0.0)
    image: int = -1
    attribute: str = ""
    mean: tuple = (1.0, 1.0, 1.0)
    blurred: bool = False

    @classmethod
    def of_attribute(cls, key):
        """An attribute alone. Materials are read before the data: its mean is taken as grey."""
        return cls((1.0, 1.0, 1.0), attribute=key, mean=(0.5, 0.5, 0.5))

    @property
    def varies(self):
        """Whether it is more than a constant."""
        return self.image >= 0 or bool(self.attribute)

    @property
    def average(self):
        """The colour (3,) where neither image nor attribute can be used."""
        return np.multiply(self.rgb, self.mean)

    @property
    def weight(self):
        """Luminance of the average."""
        return luminance(self.average)

    def times(self, factor):
        """Multiplied by a number or by a colour (3,)."""
        return replace(self, rgb=tuple(np.multiply(self.rgb, factor)))

    def product(self, other):
        """The product of two Values; None for two images or two attributes, which the engine cannot multiply."""
        if (self.image >= 0 and other.image >= 0) or (self.attribute and other.attribute):
            return None
        return Value(
            tuple(np.multiply(self.rgb, other.rgb)),
            max(self.image, other.image),
            self.attribute or other.attribute,
            tuple(np.multiply(self.mean, other.mean)),
            self.blurred or other.blurred,
        )

    def plus(self, other):
        """The sum. Of two that vary differently the stronger one stays; the other is added as its average."""
        if (other.image, other.attribute) == (self.image, self.attribute):
            return replace(self, rgb=tuple(np.add(self.rgb, other.rgb)), blurred=self.blurred or other.blurred)
        if other.weight > self.weight or (other.varies and not self.varies and other.weight == self.weight):
            return other.plus(self)
        share = np.divide(other.average, np.maximum(self.mean, 1e-3))
        blurred = self.blurred or other.blurred or other.weight > _UNSEEN * self.weight
        return replace(self, rgb=tuple(np.add(self.rgb, share)), blurred=blurred)

    def sqrt(self):
        """The root; where it varies by its average."""
        if not self.varies:
            return Value(tuple(np.sqrt(np.maximum(self.rgb, 0.0))))
        # The root of x is near x / sqrt(average) around the average.
        return self.times(1.0 / np.sqrt(np.maximum(self.average, 1e-3)))
