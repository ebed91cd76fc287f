"""Which rays see a thing, and how."""

from enum import IntFlag


class Visibility(IntFlag):
    """Which rays see a thing, and how it is seen: the sum of these. The shader knows the same numbers."""

    CAMERA = 1
    DIFFUSE = 2
    GLOSSY = 4
    TRANSMISSION = 8
    SHADOW = 16
    ALL = 31
    HOLDOUT = 32  # a hole in the picture, for the camera
    SHADOW_CATCHER = 64  # only the shadows on it, for the camera
