# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene on its way to a viewport, from what was read of Blender's data to the GPU."""

import threading

from .job import Job


class Renewal:
    """Takes the place of what a `LoadedScene` has: another thread runs `prepare(stopped)`, then `upload` brings the
    `Update` that it returns to the GPU, a part at a time. Use it in the main thread. `statistics`: of the reading that
    it began with, None for none."""

    def __init__(self, loaded, prepare, statistics=None):
        self.statistics = statistics
        self._loaded = loaded
        self._stop = threading.Event()
        self._job = Job(prepare, self._stop.is_set)
        self._update = None  # what was prepared, once it is on its way to the GPU

    @property
    def preparing(self):
        """Whether another thread works, or has done so, on what the first `upload` takes."""
        return self._update is None

    @property
    def stopped(self):
        """Whether it is to be dropped, once it is prepared."""
        return self._stop.is_set()

    def wait(self, seconds):
        """Wait until it is prepared, for at most `seconds`; whether it is."""
        return self._job.wait(seconds)

    @property
    def update(self):
        """The `Update`, once it is prepared. Raises what preparing it has raised."""
        self._update = self._update or self._job.result()
        return self._update

    def upload(self, seconds):
        """Bring it to the GPU for about `seconds`; the `Update` once all of it is there, else None."""
        return self.update if self._loaded.apply(self.update, seconds) else None

    def stop(self):
        """Nobody wants it any more: have the other thread end soon."""
        self._stop.set()

    def drop(self):
        """Give back what of it is on the GPU already. Call it where the GPU context is active."""
        self.stop()
        if self._update:
            self._loaded.drop(self._update)
