# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs GPU work of a render in Blender's main thread, piece by piece.

With `bl_use_gpu_context` Blender gives a GPU context to `RenderEngine.render`, but holds its lock until that returns:
with a window, nothing is drawn meanwhile and no key is noticed. So with a window Conic does without, and hands each
short piece to a timer of the main thread, which has the window's context. Without a window `render` is in the main
thread already.
"""

import queue
import threading
import time

import bpy

from .engine.errors import StoppedError
from .window_watch import WindowWatch

_IDLE_SECONDS = 0.1  # between two looks for work
_BUSY_SECONDS = 0.002  # the same, while there has been some lately

_pieces = queue.SimpleQueue()
_windows = WindowWatch()
_last = 0.0


class _Piece:
    """A function to call in the main thread, and what came of it."""

    def __init__(self, function, arguments):
        self.function, self.arguments = function, arguments
        self.done = threading.Event()
        self.result = self.error = None

    def run(self):
        try:
            self.result = self.function(*self.arguments)
        except BaseException as error:  # raised again in the thread that waits for it
            self.error = error
        self.done.set()


def call(function, *arguments, stopped):
    """function(*arguments), called where a GPU context is active; its result, or the error that it raises.

    Raises StoppedError when `stopped()` while the main thread has not come to it, as when Blender is closing.
    """
    if threading.current_thread() is threading.main_thread():
        return function(*arguments)
    piece = _Piece(function, arguments)
    _pieces.put(piece)
    while not piece.done.wait(0.1):
        if stopped() and not piece.done.wait(0.4):
            raise StoppedError("rendering was stopped")
    if piece.error is None:
        return piece.result
    try:
        raise piece.error
    finally:
        piece.error = None  # its traceback refers to this frame: nothing is freed in a circle


def _pump():
    """Do one piece of the work that waits, if any; seconds until the next look."""
    global _last
    if _windows.changed():
        return _BUSY_SECONDS
    try:
        piece = _pieces.get_nowait()
    except queue.Empty:
        return _BUSY_SECONDS if time.monotonic() - _last < 1.0 else _IDLE_SECONDS
    piece.run()
    _last = time.monotonic()
    return 0.0


def register():
    if not bpy.app.background:
        bpy.app.timers.register(_pump, persistent=True)


def unregister():
    if bpy.app.timers.is_registered(_pump):
        bpy.app.timers.unregister(_pump)
