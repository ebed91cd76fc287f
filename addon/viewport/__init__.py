# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered view in 3D viewports, from Blender's scene to what is on the screen.

A `ViewportSession` is one viewport, a `ViewportScene` what some of them show. Each redraw takes the scene a stage
nearer to Blender's data and draws the `ViewportPicture`; between redraws `tracing` goes on with the picture.
"""

from . import display, scenes, tracing


def register():
    scenes.register()


def unregister():
    scenes.unregister()
    tracing.unregister()
    display.unregister()
