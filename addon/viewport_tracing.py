# SPDX-License-Identifier: GPL-3.0-or-later
"""Goes on with the pictures of viewports between redraws: in a timer of the main thread, which has a window's GPU
context. A redraw of Blender's window may take longer than what is traced in it; this way most redraws have something
new to show. Without a window there are no timers, and redraws follow each other."""

import time
import weakref

import bpy

_QUIET = 0.02  # seconds that nothing happens after a view has begun anew: the next motion of the mouse comes sooner
_new = weakref.WeakKeyDictionary()  # `ViewportSession`s that were redrawn just now: seconds of quiet
_due = weakref.WeakKeyDictionary()  # the others: when their next turns begin


def go_on(session, quiet):
    """A session was redrawn and has more to trace: call its `trace()` until that returns False. `quiet`: only after
    Blender had time to notice what the user does."""
    if bpy.app.background:
        session.tag_redraw()
        return
    _due.pop(session, None)
    _new[session] = _QUIET if quiet else 0.0
    if not bpy.app.timers.is_registered(_trace):
        bpy.app.timers.register(_trace)


def _trace():
    """Called by a timer; seconds until the next call, None for none. Blender calls timers before it handles what has
    happened meanwhile: so the quiet begins here."""
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


def unregister():
    if bpy.app.timers.is_registered(_trace):
        bpy.app.timers.unregister(_trace)
