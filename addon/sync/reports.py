# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages to the user, each at most once."""


class Reports:
    """Passes messages on to `report(level, message)`, `level` INFO, WARNING or ERROR, and drops repetitions.

    `once`: what else is said once alone, whatever the words.
    """

    def __init__(self, report):
        self._report = report
        self._seen = set()
        self._records = []

    def info(self, message, once=None):
        self._send("INFO", message, once)

    def warn(self, message, once=None):
        self._send("WARNING", message, once)

    def record(self, record):
        """From now on messages are noted in the list `record` as well, those that are dropped too."""
        self._records.append(record)

    def end_record(self):
        """End what `record` began last."""
        self._records.pop()

    def repeat(self, record):
        """Say what was recorded."""
        for message in record:
            self._pass(*message)

    def _send(self, level, message, once):
        if self._records:
            self._records[-1].append((level, message, once))
        self._pass(level, message, once)

    def _pass(self, level, message, once):
        key = message if once is None else once
        if key not in self._seen:
            self._seen.add(key)
            self._report(level, message)
