"""When viewports are traced between redraws, and how long redraws and slices take."""

import time
from types import SimpleNamespace

import bpy
import pytest

from addon.viewport import tracing
from addon.viewport.pace import MOST, MOST_AT_ONCE, MOST_UNSEEN, RedrawPace
from addon.viewport.picture import STEPS, ViewportPicture
from tests.blender.viewport.stand_in import draws


@pytest.fixture
def clock(monkeypatch):
    """[seconds] that `time.perf_counter` says it is."""
    now = [100.0]
    monkeypatch.setattr(time, "perf_counter", lambda: now[0])
    return now


def redraw(pace, clock, drawing, overhead, traces=True):
    """A redraw that was asked for, of `drawing` seconds and so many of Blender's own, half of them before."""
    pace.ask()
    clock[0] += 0.5 * overhead
    pace.begin()
    clock[0] += drawing
    pace.end(traces)
    clock[0] += 0.5 * overhead


def test_tracing_takes_longer_where_nothing_happens(clock):
    pace, taken = RedrawPace(), []
    for _ in range(40):
        taken.append(pace.seconds(0.02))
        clock[0] += taken[-1]
    assert taken[0] == 0.02 and taken == sorted(taken) and taken[-1] == MOST_AT_ONCE
    pace.changed()
    assert pace.seconds(0.02) == 0.02
    assert pace.seconds(0.5) == 0.5, "who sets a long frame gets it"


def test_redraws_are_fewer_where_blender_takes_its_time(clock):
    pace = RedrawPace()
    for overhead, interval in ((0.001, 0.02), (0.01, 0.06), (0.2, MOST)):
        for _ in range(5):
            redraw(pace, clock, 0.007, overhead)
            pace.go_on()
        assert pace.overhead == pytest.approx(overhead)
        for passed, due in ((0.9, False), (1.1, True)):
            pace.begin()
            clock[0] += passed * interval
            assert pace.is_due(0.02, seen=True) == due and not pace.is_due(0.02, seen=False)
    clock[0] += MOST_UNSEEN
    assert pace.is_due(0.02, seen=False) and not pace.is_due(2.0 * MOST_UNSEEN, seen=False)


def test_only_redraws_that_tracing_waits_for_tell_what_they_cost(clock):
    pace = RedrawPace()
    redraw(pace, clock, 0.007, 0.05, traces=False)
    clock[0] += 5.0
    pace.go_on()
    pace.ask()
    pace.changed()
    pace.begin()
    pace.end(True)
    clock[0] += 5.0
    pace.go_on()
    assert pace.overhead == 0.0


# Tracing between redraws


class Traced:
    """A session that has so many slices left to trace."""

    def __init__(self, slices):
        self.slices, self.calls = slices, []

    def trace(self):
        self.calls.append(time.perf_counter())
        self.slices -= 1
        return self.slices > 0


@pytest.fixture
def in_window(clock, monkeypatch):
    """Tracing as with a window; the timer is called by hand."""
    monkeypatch.setattr(tracing, "bpy", SimpleNamespace(app=SimpleNamespace(background=False, timers=Timers())))
    yield
    tracing._new.clear()
    tracing._due.clear()


class Timers:
    def __init__(self):
        self.registered = []

    def register(self, function):
        self.registered.append(function)

    def is_registered(self, function):
        return function in self.registered


def test_tracing_waits_until_blender_has_seen_what_happened(in_window, clock):
    session = Traced(2)
    tracing.go_on(session, quiet=True)
    clock[0] += 1.0  # a slow redraw
    wait = tracing._trace()
    assert wait > 0.0 and not session.calls, "what happened meanwhile is handled first"
    tracing.go_on(session, quiet=True)  # the view has turned further
    clock[0] += 1.0
    assert tracing._trace() > 0.0 and not session.calls
    clock[0] += wait
    assert tracing._trace() == 0.0 and len(session.calls) == 1
    assert tracing._trace() is None and len(session.calls) == 2


def test_viewports_are_traced_in_turn(in_window, clock):
    sessions = Traced(3), Traced(2)
    for session in sessions:
        tracing.go_on(session, quiet=False)
    turns = []
    while (wait := tracing._trace()) is not None:
        assert wait == 0.0
        clock[0] += 0.05
        turns.append([len(session.calls) for session in sessions])
    assert [abs(a - b) for a, b in turns[:4]] == [1, 0, 1, 0] and not any(session.slices for session in sessions)


def test_a_viewport_that_is_gone_is_not_traced(in_window):
    session = Traced(5)
    tracing.go_on(session, quiet=False)
    del session
    assert tracing._trace() is None


def test_a_redraw_is_asked_for_when_there_is_something_to_see(view, monkeypatch):
    """The whole picture first, and the last sample; slices that give neither ask for none until it is time."""
    bpy.context.scene.conic.preview_samples = 3
    view.settle()
    view.look_from(1.0)
    with monkeypatch.context() as patch:
        patch.setattr(ViewportPicture, "_choose_step", lambda picture, seconds: STEPS[-1])
        view.redraw()
    assert draws()[-1].step > 1
    shown = []
    while not view.session.picture.finished:
        before = view.engine.redraws
        while view.session.trace():
            assert view.engine.redraws == before
        assert view.engine.redraws == before + 1
        shown.append((view.session.picture.step, view.session.picture.sample))
        view.session.pace.begin()  # the redraw
    assert shown[-1] == (1, 3) and (1, 1) in shown
