"""Work on all cores: every item is done, in order, and what goes wrong is heard of."""

import threading

import pytest

from addon.engine.threads import both


def test_both_are_called_at_the_same_time():
    """Each waits for the other."""
    meeting = threading.Barrier(2, timeout=60.0)
    assert both(lambda: (meeting.wait(), 1)[1], lambda: (meeting.wait(), 2)[1]) == (1, 2)


@pytest.mark.parametrize("failing", [0, 1])
def test_what_either_raises_is_raised_when_both_are_through(failing):
    done = []
    functions = [lambda: done.append(1), lambda: done.append(1)]
    functions[failing] = lambda: 1 / 0
    with pytest.raises(ZeroDivisionError):
        both(*functions)
    assert done
