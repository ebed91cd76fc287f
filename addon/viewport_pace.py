# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a redraw of a viewport may take: as long as a frame while something happens. Longer where nothing does, and
Blender's own part of a redraw is what takes the time: fewer redraws leave more of it for the picture."""

import time
from collections import deque

#: What a redraw may take at most beside a frame: so late may the answer come to who does something at last.
MOST = 0.25
#: Of the time that nothing has happened.
_SHARE = 0.6
#: Of what Blender's part takes: the rest of the time goes into the picture.
_TIMES = 3.0
_REMEMBERED = 4


class RedrawPace:
    """Learns what redraws that follow each other cost beside the drawing itself. Times are in seconds."""

    def __init__(self):
        self._pauses = deque(maxlen=_REMEMBERED)  # from the end of a redraw to the beginning of the next
        self._ended = self._asked = None
        self._rested_since = time.perf_counter()

    @property
    def overhead(self):
        """What Blender's part of a redraw takes, MOST at most; 0 where it is not known."""
        return min(min(self._pauses, default=0.0), MOST)

    def begin(self):
        """A redraw begins."""
        if self._asked:
            self._pauses.append(time.perf_counter() - self._ended)

    def changed(self):
        """Something is happening."""
        self._rested_since = time.perf_counter()

    def seconds(self, frame):
        """What this redraw may take where one may take `frame` while something happens."""
        rested = time.perf_counter() - self._rested_since
        return max(frame, min(_SHARE * rested, _TIMES * self.overhead, MOST))

    def end(self, asked):
        """The redraw is over; `asked`: whether it has asked for the next one."""
        self._ended, self._asked = time.perf_counter(), asked
