# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether timers have a GPU context. They have that of the window that was drawn last; when Blender closes a window,
no context is active until another one is drawn."""

import bpy


class WindowWatch:
    """Looks from time to time whether windows have come or gone. Use it in the main thread."""

    def __init__(self):
        self._known = None

    def note(self):
        """A GPU context is active: the windows are right as they are."""
        self._known = _windows()

    def changed(self):
        """Whether windows have come or gone since the last look: then all are asked to be redrawn, and GPU work has to
        wait until Blender has done so, before it calls timers again."""
        before, self._known = self._known, _windows()
        if before in (None, self._known):
            return False
        for manager in bpy.data.window_managers:
            for window in manager.windows:
                for area in window.screen.areas:
                    area.tag_redraw()
        return True


def _windows():
    return tuple(window.as_pointer() for manager in bpy.data.window_managers for window in manager.windows)
