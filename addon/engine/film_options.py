"""What a film shows beyond light: depth cue and outlines, as pictures of molecules have them."""

import math
from dataclasses import dataclass

from .errors import SceneError

#: What outlines go around, see `Outlines`.
OUTLINED = ("SHAPES", "ATTRIBUTE")
LARGEST_LINE = 64.0  # pixels


@dataclass(frozen=True)
class DepthCue:
    """What is far fades away, as in fog. Raises SceneError for values out of range.

    `color` (r, g, b): what it fades into, None for what is behind everything. `start`, `end`: depths along the view
    where it begins and where it is complete; None for the nearest and the farthest of the scene. `strength`: share that
    is gone at the end, 0 to 1.
    """

    color: tuple | None = None
    start: float | None = None
    end: float | None = None
    strength: float = 1.0

    def __post_init__(self):
        _check_range("the strength of the depth cue", self.strength, 0.0, 1.0)
        if self.start is not None and self.end is not None and not self.start < self.end:
            raise SceneError(f"the depth cue ends at {self.end:g}, before it starts at {self.start:g}")


@dataclass(frozen=True)
class Outlines:
    """Lines around what is seen and where its surface breaks. Raises SceneError for values out of range.

    `color` (r, g, b, a). `around`: what has an outline of its own: SHAPES each exact shape and each mesh, ATTRIBUTE
    what has one value of the scene's `outline_attribute`. `width`: of these outlines in pixels. `inner_width`: of the
    lines within them, at creases and steps. `crease_angle`: radians between two normals from which on there is a
    crease. `depth_step`: how far a surface must lie behind another, as a share of the picture's height where it is.
    """

    color: tuple = (0.0, 0.0, 0.0, 1.0)
    around: str = "SHAPES"
    width: float = 1.5
    inner_width: float = 1.0
    crease_angle: float = math.radians(40.0)
    depth_step: float = 0.01

    def __post_init__(self):
        if self.around not in OUTLINED:
            raise SceneError(f"outlines go around {self.around!r}; expected one of {', '.join(OUTLINED)}")
        _check_range("the width of outlines", self.width, 0.0, LARGEST_LINE)
        _check_range("the width of inner lines", self.inner_width, 0.0, LARGEST_LINE)
        _check_range("the crease angle of outlines", self.crease_angle, 0.0, math.pi)
        _check_range("the depth step of outlines", self.depth_step, 0.0, math.inf)

    @property
    def feature(self):
        """The feature of the shaders that finds what they go around."""
        return "OUTLINE_SHAPES" if self.around == "SHAPES" else "OUTLINE_ATTRIBUTES"


def _check_range(name, value, lowest, highest):
    if not lowest <= value <= highest:
        raise SceneError(f"{name} is {value:g}; it must lie between {lowest:g} and {highest:g}")
