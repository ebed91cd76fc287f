"""What differs between a scene and the one that was loaded before."""

from enum import Flag, auto


class Change(Flag):
    """What an update of a loaded scene changes, by what it costs; `Change(0)`, `NONE`: nothing, the picture goes on.

    The camera is no part of it: each session has its own.
    """

    NONE = 0
    FILM = auto()  #: the picture begins anew: with all others, or alone for a setting
    MATERIALS = auto()  #: values of materials
    LIGHTS = auto()  #: lamps, or surfaces that glow as lights
    WORLD = auto()  #: its glow, or the light that it gives
    PLANES = auto()  #: infinite planes
    IMAGES = auto()  #: pixels or how they are looked up
    ATTRIBUTES = auto()  #: values, or which are used
    INSTANCES = auto()  #: records of instances and the tree over them
    REFIT = auto()  #: a geometry's records and boxes; its tree keeps its form
    GEOMETRY = auto()  #: a geometry came or went; the tree of a new one is built
    TREES = auto()  #: trees that were built quickly gave way to good ones; alone, the picture goes on
    PROGRAM = auto()  #: another program of the GPU, which may have to be compiled
    ALL_TEXTURES = auto()  #: everything lies elsewhere
