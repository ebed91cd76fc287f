# SPDX-License-Identifier: GPL-3.0-or-later
"""How long tracing for a viewport may take at a time, and how often it is redrawn: as a frame while something happens.
Where nothing does, and Blender's part of a redraw is what takes the time, fewer redraws leave more of it for the
picture."""

import time
from collections import deque

#: Seconds to wait for what is being prepared, where there is no picture yet: redraws meanwhile would show nothing, and
#: on a software rasteriser take the processor from the thread that prepares.
MOST_BEFORE_FIRST = 0.5
#: Seconds from redraw to redraw at most, where there is something new to show.
MOST = 0.25
#: The same, where nobody sees what is new: parts of one more sample.
MOST_UNSEEN = 1.0
#: Of tracing between two looks at what the user does: so late may the answer come to who does something at last.
MOST_AT_ONCE = 0.1
#: Of the time that nothing has happened.
_SHARE = 0.3
#: Of what Blender's part takes: the rest of the time goes into the picture.
_TIMES = 6.0
_REMEMBERED = 4


class RedrawPace:
    """Learns what redraws cost beside the drawing itself. Times are in seconds."""

    def __init__(self):
        self._overheads = deque(maxlen=_REMEMBERED)
        self._asked = None  # when a redraw was asked for; None where nobody did, or its end was seen
        self._drawing = 0.0  # what drawing took in it
        self._began = self._rested_since = time.perf_counter()

    @property
    def overhead(self):
        """What Blender's part of a redraw takes, MOST at most; 0 where it is not known."""
        return min(min(self._overheads, default=0.0), MOST)

    def ask(self):
        """A redraw is asked for, at once."""
        self._asked, self._drawing = time.perf_counter(), 0.0

    def begin(self):
        """A redraw begins."""
        self._began = time.perf_counter()

    def end(self, traces):
        """The drawing is over; Blender goes on. `traces`: whether tracing goes on after that."""
        self._drawing += time.perf_counter() - self._began
        if not traces:
            self._asked = None

    def go_on(self):
        """Tracing goes on after a redraw, or has not been interrupted by one."""
        if self._asked is not None and self._drawing:
            self._overheads.append(time.perf_counter() - self._asked - self._drawing)
        self._asked = None

    def changed(self):
        """Something is happening: who asked for a redraw does not know what Blender does in it."""
        self._rested_since, self._asked = time.perf_counter(), None

    def seconds(self, frame):
        """What tracing may take at a time, where it may take `frame` while something happens."""
        rested = time.perf_counter() - self._rested_since
        return max(frame, min(_SHARE * rested, MOST_AT_ONCE))

    def is_due(self, frame, seen):
        """Whether it is time for the next redraw; `seen`: whether one sees what is new."""
        interval = max(frame, min(_TIMES * self.overhead, MOST)) if seen else max(frame, MOST_UNSEEN)
        return time.perf_counter() - self._began > interval
