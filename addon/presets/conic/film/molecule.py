# SPDX-License-Identifier: GPL-3.0-or-later
"""Molecules as on a screen: light from all sides, hollows dark, each atom outlined, what is far fades away."""

import bpy

render = bpy.context.scene.render
conic = bpy.context.scene.conic

render.film_transparent = False
conic.use_flat_colors = False
conic.world_light = "HEMISPHERE"
conic.use_ao = True
conic.ao_distance = 0.0
conic.ao_factor = 1.0
conic.use_depth_cue = True
conic.depth_cue_into = "BACKGROUND"
conic.depth_cue_strength = 0.7
conic.depth_cue_range = "SCENE"
conic.use_outlines = True
conic.outline_around = "SHAPES"
conic.outline_color = (0.0, 0.0, 0.0, 1.0)
conic.outline_width = 1.5
conic.outline_inner_width = 1.0
conic.outline_crease_angle = 0.698132
conic.outline_depth_step = 1.0
