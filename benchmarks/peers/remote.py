"""A peer in a process of its own: two libraries that compile code do not meet, and one that ends does so alone."""

import multiprocessing

from .base import Peer


class Remote(Peer):
    """What `peer` does, done in another process; arguments and answers are pickled."""

    def __init__(self, peer, *arguments):
        self.name, self.unequal = peer.name, peer.unequal
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, peer, arguments), daemon=True)
        self._process.start()
        theirs.close()
        self._answer()

    def _answer(self):
        try:
            error, value = self._pipe.recv()
        except EOFError:
            self._process.join()
            raise RuntimeError(f"{self.name}'s process ended with {self._process.exitcode}") from None
        if error:
            raise RuntimeError(error)
        return value

    def _call(self, method):
        self._pipe.send(method)
        return self._answer()

    def trace(self):
        return self._call("trace")

    def picture(self):
        return self._call("picture")

    def rays(self):
        return self._call("rays")

    def close(self):
        self._pipe.close()
        self._process.join(10.0)
        if self._process.is_alive():
            self._process.terminate()


def _serve(pipe, peer, arguments):
    """Make the peer and do what is asked for until the other end is closed."""
    served = None

    def make():
        nonlocal served
        served = peer(*arguments)

    try:
        _reply(pipe, make)
        while served is not None:
            _reply(pipe, getattr(served, pipe.recv()))
    except EOFError:
        if served is not None:
            served.close()


def _reply(pipe, function):
    try:
        pipe.send(("", function()))
    except Exception as error:  # told to the other process, which has the table
        pipe.send((f"{type(error).__name__}: {error}", None))
