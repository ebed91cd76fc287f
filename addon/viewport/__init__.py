# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered view in 3D viewports, from Blender's scene to what is on the screen.

A `ViewportSession` is one viewport, a `ViewportScene` what one or several of them show, a `ViewportPicture` what one
of them shows of it. Everything happens in the main thread, but for preparing.

A scene is marked (Blender says that something changed), read (by the next redraw), prepared (by another thread, while
viewports show what was loaded before; `waiting` has them redrawn after it) and uploaded, a part at each redraw.
A picture begins with each new view or scene: coarse at once, then finer, then with more samples, by redraws and, in
`tracing`, between them.
"""

from . import display, scenes, tracing


def register():
    scenes.register()


def unregister():
    scenes.unregister()
    tracing.unregister()
    display.unregister()
