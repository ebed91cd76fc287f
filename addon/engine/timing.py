"""Seconds by stage."""

import time
from contextlib import contextmanager


@contextmanager
def timed(seconds, stage):
    """Add the time spent in a with statement to `seconds[stage]`."""
    started = time.perf_counter()
    try:
        yield
    finally:
        seconds[stage] = seconds.get(stage, 0.0) + time.perf_counter() - started
