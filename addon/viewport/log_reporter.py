# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a viewport's messages go."""

import logging
import traceback

from ..failures import is_defect, sentence_of

log = logging.getLogger(__name__)


class LogReporter:
    """Passes messages to the log: a viewport has no reports. A message that holds on from one reading of the scene to
    the next is logged once. `warnings`: how many there are of the scene as it was read last."""

    LEVELS = {"INFO": logging.INFO, "WARNING": logging.WARNING, "ERROR": logging.ERROR}

    def __init__(self):
        self._before, self._now = {}, {}

    def begin(self):
        """The scene is read anew: what is not said again is no longer so."""
        self._before, self._now = self._now, {}

    def __call__(self, level, message):
        """Log `message`; `level` is INFO, WARNING or ERROR."""
        if message not in self._now and message not in self._before:
            log.log(self.LEVELS[level], message)
        self._now[message] = level

    def explain(self, error):
        """What a user is told of an exception. The traceback of one that is Conic's fault goes to the log."""
        if is_defect(error):
            self("ERROR", "".join(traceback.format_exception(error)))
        return sentence_of(error)

    @property
    def warnings(self):
        return sum(level != "INFO" for level in self._now.values())
