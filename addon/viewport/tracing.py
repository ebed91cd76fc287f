# SPDX-License-Identifier: GPL-3.0-or-later
"""Goes on with the pictures of viewports between redraws: in a timer of the main thread, which mostly has a window's
GPU context. A redraw of Blender's window may take longer than what is traced in it; this way most redraws have
something new to show. Without a window there are no timers, and redraws follow each other."""

import time
import weakref

import bpy

from ..window_watch import WindowWatch

_QUIET = 0.02  # seconds that nothing happens after a view has begun anew: the next motion of the mouse comes sooner
_new = weakref.WeakKeyDictionary()  # `ViewportSession`s that were redrawn just now: seconds of quiet
_due = weakref.WeakKeyDictionary()  # the others: when their next turns begin
_windows = WindowWatch()


def go_on(session, quiet):
    """A session was redrawn and has more to trace: call its `trace()` until that returns False. `quiet`: only after
    Blender had time to notice what the user does."""
    if bpy.app.background:
        session.tag_redraw()
        return
    _windows.note()
    _due.pop(session, None)
    _new[session] = _QUIET if quiet else 0.0
    if not bpy.app.timers.is_registered(_trace):
        bpy.app.timers.register(_trace)


def _trace():
    """Called by a timer; seconds until the next call, None for none. Blender calls it first after the redraw: so the
    quiet begins here."""
    if _windows.changed():  # all are redrawn, and begin again
        _forget()
        return None
    now = time.perf_counter()
    for session, quiet in list(_new.items()):
        _due[session] = now + quiet
    _new.clear()
    session = min(_due, key=_due.get, default=None)
    if session is None:
        return None
    if (wait := _due.pop(session) - now) > 0.0:
        _due[session] = now + wait
        return wait
    if session.trace():
        _due[session] = now  # after the others
    return 0.0 if _due else None


def _forget():
    _new.clear()
    _due.clear()


def unregister():
    _forget()
    if bpy.app.timers.is_registered(_trace):
        bpy.app.timers.unregister(_trace)
