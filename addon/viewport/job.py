# SPDX-License-Identifier: GPL-3.0-or-later
"""A function that is called in a thread of its own."""

import threading


class Job:
    """function(*arguments) runs from the moment this is made."""

    def __init__(self, function, *arguments):
        self._function, self._arguments = function, arguments
        self._done = threading.Event()
        self._result = self._error = None
        # A daemon: Blender need not wait for a tree that nobody will see.
        threading.Thread(target=self._run, name="conic", daemon=True).start()

    def wait(self, seconds):
        """Wait for at most `seconds`; whether it is done."""
        return self._done.wait(seconds)

    def result(self):
        """What the function returned, once it is done. What it raised is raised here, the first time: kept, it would
        keep all that its traceback refers to, until Python looks for garbage, in whichever thread."""
        error, self._error = self._error, None
        if error is None:
            return self._result
        try:
            raise error
        finally:
            del error  # which this frame is in the traceback of

    def _run(self):
        try:
            self._result = self._function(*self._arguments)
        except BaseException as error:  # raised again where the result is asked for
            self._error = error
        self._function = self._arguments = None
        self._done.set()
