# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps the scenes of viewports for a while after the last viewport has left: who turns from Rendered to Solid mostly
comes back soon, and large scenes take seconds to build. It costs memory, so a render and another file take it back."""

import time

import bpy

SECONDS = 60.0
_LOOK_SECONDS = 1.0
_kept = {}  # `ViewportScene`s: when a viewport was last seen to show it
_renders = False  # whether a render has begun since the last look


def keep(scene):
    """A viewport shows a `ViewportScene`. Without a window there is no time to look."""
    if bpy.app.background:
        return
    _kept[scene] = time.monotonic()
    if not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=_LOOK_SECONDS, persistent=True)


def let_go():
    """Free what no viewport shows."""
    for scene in [scene for scene in _kept if not scene.sessions]:
        del _kept[scene]


def _look():
    """Called by a timer; seconds until the next look, None for none. Who renders with another engine now does not come
    back soon."""
    global _renders
    if _renders:
        _renders = False
        let_go()
    now = time.monotonic()
    ours = {scene.session_uid for scene in bpy.data.scenes if scene.render.engine == "CONIC"}
    for scene, seen in list(_kept.items()):
        if scene.sessions:
            _kept[scene] = now
        elif now - seen > SECONDS or scene.key.scene not in ours:
            del _kept[scene]
    return _LOOK_SECONDS if _kept else None


@bpy.app.handlers.persistent
def _before_render(*_arguments):
    """In another thread, which must not free textures: the next look does."""
    global _renders
    _renders = True


def register():
    bpy.app.handlers.render_init.append(_before_render)


def unregister():
    bpy.app.handlers.render_init.remove(_before_render)
    _kept.clear()
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
