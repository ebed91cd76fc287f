# SPDX-License-Identifier: GPL-3.0-or-later
"""Light alone, as a camera sees it: Conic's defaults."""

import bpy

render = bpy.context.scene.render
conic = bpy.context.scene.conic

render.film_transparent = False
conic.use_flat_colors = False
conic.world_light = "SAMPLED"
conic.use_ao = False
conic.use_depth_cue = False
conic.use_outlines = False
