# SPDX-License-Identifier: GPL-3.0-or-later
"""What viewports did lately, for tests and for whoever wonders where the time goes.

`records` has the newest last; from Blender's Python console: `[r for r in history.records]`.
"""

from collections import deque
from dataclasses import dataclass

from ..engine.changes import Change


@dataclass(frozen=True)
class Load:
    """A scene was read and is loaded, or was found to be the same. `change`: what differs from the one before;
    `bytes`: uploaded, by texture; `seconds`: by stage; `error`: why it failed, empty if it did not."""

    change: Change = Change.NONE
    bytes: dict | None = None
    seconds: dict | None = None
    error: str = ""


@dataclass(frozen=True)
class Draw:
    """A redraw of one viewport. `began`: whether its picture began anew, `kept`: and showed parts of the one before;
    `step`: how many finished pixels one of the film is wide; `sample`: how many whole samples the picture has, 0 while
    it is a coarse one; `finished`; `seconds` in all."""

    began: bool
    kept: bool
    step: int
    sample: int
    finished: bool
    seconds: float


records = deque(maxlen=4096)
