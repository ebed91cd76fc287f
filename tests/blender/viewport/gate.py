"""Threads that wait for a test."""

import threading


class Gate:
    """Holds back the calls of a function until it is opened: those for which `holds(*arguments)` is true.

    `reached` and `opened` are `threading.Event`s: a call waits, and a test lets it go on. `held`: how many calls.
    """

    def __init__(self, monkeypatch, owner, name, holds=lambda *_arguments, **_options: True):
        self.reached, self.opened, self.held = threading.Event(), threading.Event(), 0
        function = getattr(owner, name)

        def wait(*arguments, **options):
            if holds(*arguments, **options):
                self.held += 1
                self.reached.set()
                assert self.opened.wait(60.0)
            return function(*arguments, **options)

        monkeypatch.setattr(owner, name, wait)
