"""What a peer is."""

import re
import subprocess


class Peer:
    """A program with a scene, ready to trace it again and again.

    `name`; `unequal`: what is not equal about its comparison with Conic, a sentence each.
    """

    name = ""
    unequal = ()

    @classmethod
    def missing(cls):
        """Why it cannot run here, None where it can."""
        return None

    @classmethod
    def version(cls):
        return ""

    def trace(self):
        """Trace the picture once: seconds of tracing alone, as the program reports them."""
        raise NotImplementedError

    def picture(self):
        """The picture that was traced last: (height, width, 3) float, linear, 0 to 1, bottom row first."""
        raise NotImplementedError

    def close(self):
        """Give back what it holds."""


def run_program(command, folder):
    """What a program printed, stdout and stderr together. Raises RuntimeError with the end of it where it fails."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=folder)
    if done.returncode:
        raise RuntimeError(f"{command[0]} ended with {done.returncode}: {done.stdout[-500:]}")
    return done.stdout


def number_in(text, pattern):
    """The number that `pattern` captures in what a program printed. Raises RuntimeError where there is none."""
    found = re.search(pattern, text)
    if not found:
        raise RuntimeError(f"no {pattern!r} in what the program printed: {text[-500:]}")
    return float(found.group(1))
