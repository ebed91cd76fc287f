# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's depsgraph to `engine.Scene`, one direction, no way back.

- `scene_sync`: the entry, `sync_scene`; `settings`: what the picture is rendered with.
- `instancing`: all that stands in the scene, as blocks of copies: `geometry_sets` reads instances of geometry nodes
  whole, `dupli_iterator` all others; `visibility`: which rays see them.
- `object_sync`: what the copies are drawn as (`contents`: `meshes`, `points`, `curves`, `particle_hair`) and where
  (`placement`); `pixel_sizes`: how fine curves must be.
- `taken`: which meshes are taken as exact `shapes`; `recognise`, `islands`: the search for them (numpy only);
  `objects`: the same in words, for the panel.
- `shading`: materials; `lobes`: the parts of a shader and how they become one material; `nodes`, `values`: reading
  node trees.
- `images`, `lights`, `world`, `camera`: as their names say.
- `reports`: what could not be rendered is said once; `compat`: every difference between Blender's versions.

This file imports nothing, so that `recognise` can be used without Blender.
"""
