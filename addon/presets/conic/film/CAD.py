# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts as in a drawing: even light, lines around objects and thinner ones along their edges."""

import bpy

render = bpy.context.scene.render
conic = bpy.context.scene.conic

render.film_transparent = False
conic.use_flat_colors = False
conic.world_light = "HEMISPHERE"
conic.use_ao = True
conic.ao_distance = 0.0
conic.ao_factor = 0.7
conic.use_depth_cue = False
conic.use_outlines = True
conic.outline_around = "OBJECTS"
conic.outline_color = (0.01, 0.01, 0.015, 1.0)
conic.outline_width = 1.5
conic.outline_inner_width = 0.8
conic.outline_crease_angle = 0.349066
conic.outline_depth_step = 0.5
