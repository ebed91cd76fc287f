"""Pieces of a render that the main thread does for the render's own thread."""

import gc
import threading
import time
import weakref
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress

import pytest

from addon import gpu_thread


@pytest.fixture
def render_thread():
    """A thread such as Blender renders in when it has a window."""
    with ThreadPoolExecutor(1) as pool:
        yield pool


def never():
    return False


def pump(future):
    """Do what Blender's timer does, until `future` is done."""
    deadline = time.monotonic() + 10.0
    while not future.done() and time.monotonic() < deadline:
        time.sleep(min(gpu_thread._pump(), 0.01))
    return future


def test_pieces_run_in_the_main_thread_and_give_back_what_they_return(render_thread):
    def piece(a, b):
        return a + b, threading.current_thread()

    future = pump(render_thread.submit(gpu_thread.call, piece, 1, 2, stopped=never))
    assert future.result() == (3, threading.main_thread())


def test_in_the_main_thread_they_run_at_once():
    assert gpu_thread.call(lambda: 7, stopped=never) == 7


def test_errors_are_raised_where_the_piece_was_asked_for(render_thread):
    future = pump(render_thread.submit(gpu_thread.call, lambda: 1 / 0, stopped=never))
    with pytest.raises(ZeroDivisionError):
        future.result()


def test_an_error_that_was_caught_keeps_nothing(render_thread):
    """Python's search for garbage may be in a thread that must not free textures."""
    held = []

    def fail():
        data = {1.0}
        held.append(weakref.ref(data))
        raise ValueError

    def render():
        with suppress(ValueError):
            gpu_thread.call(fail, stopped=never)

    gc.disable()
    try:
        pump(render_thread.submit(render)).result()
        assert held[0]() is None
    finally:
        gc.enable()


def test_a_stopped_render_does_not_wait_for_a_main_thread_that_never_comes(render_thread):
    future = render_thread.submit(gpu_thread.call, list, stopped=lambda: True)
    with pytest.raises(gpu_thread.StoppedError):
        future.result(timeout=5.0)
    gpu_thread._pump()  # the piece that nobody wants any more
