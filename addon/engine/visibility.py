"""Which rays see a thing, and how; which lights light it."""

from enum import IntFlag

from . import reference

_FIRST_GROUP = 7

#: Groups of objects that lights can be linked to: as many bits as a record's integers have beside the others.
GROUPS = reference.LOW_BITS - _FIRST_GROUP


class Visibility(IntFlag):
    """Which rays see a thing, and how it is seen: the sum of these, and of the groups that it is in. The shader knows
    the same numbers."""

    CAMERA = 1
    DIFFUSE = 2
    GLOSSY = 4
    TRANSMISSION = 8
    SHADOW = 16
    ALL = 31
    HOLDOUT = 32  # a hole in the picture, for the camera
    SHADOW_CATCHER = 64  # only the shadows on it, for the camera

    @classmethod
    def group(cls, number):
        """Group `number` of things that a light alone lights, or that alone cast a light's shadows; below GROUPS."""
        if not 0 <= number < GROUPS:
            raise ValueError(f"there are {GROUPS} groups, no number {number}")
        return cls(1 << (_FIRST_GROUP + number))
