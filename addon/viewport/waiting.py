# SPDX-License-Identifier: GPL-3.0-or-later
"""Has viewports redrawn when another thread has done what their scene waits for. Without a window there are no timers;
who draws there asks the scene itself."""

import weakref

import bpy

_LOOK_SECONDS = 0.01
_waiting = weakref.WeakSet()  # `ViewportScene`s


def watch(scene):
    """Have the viewports of a `ViewportScene` redrawn once, when its next `renew` has something to take."""
    _waiting.add(scene)
    if not bpy.app.background and not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=_LOOK_SECONDS)


def _look():
    """Called by a timer; seconds until the next look, None for none. Who is told once and pauses is not told again."""
    for scene in list(_waiting):
        prepared, taken = scene.prepared, not scene.preparing
        if prepared and not taken:
            scene.tag_redraw()
        if prepared or taken:
            _waiting.discard(scene)
    return _LOOK_SECONDS if _waiting else None


def unregister():
    _waiting.clear()
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
