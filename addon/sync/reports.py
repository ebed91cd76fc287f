# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages to the user, each at most once."""


class Reports:
    """Passes messages on to `report(level, message)`, `level` INFO, WARNING or ERROR, and drops repetitions."""

    def __init__(self, report):
        self._report = report
        self._seen = set()

    def info(self, message):
        self._send("INFO", message)

    def warn(self, message):
        self._send("WARNING", message)

    def _send(self, level, message):
        if message not in self._seen:
            self._seen.add(message)
            self._report(level, message)
