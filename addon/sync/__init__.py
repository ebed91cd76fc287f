# SPDX-License-Identifier: GPL-3.0-or-later
"""From Blender's depsgraph to `engine.Scene`, one direction, no way back.

- `scene_sync`: the entry, `sync_scene` and `sync_settings`.
- `objects`: what each object is taken as; `placement`: where its shapes stand; `meshes`, `shapes`: the geometry.
- `recognise`: which meshes are exact shapes (numpy only).
- `shading`: materials; `lobes`: the parts of a shader and how they become one material; `nodes`, `values`: reading
  node trees.
- `images`, `lights`, `world`, `camera`: as their names say.
- `reports`: what could not be rendered is said once; `compat`: every difference between Blender's versions.

This file imports nothing, so that `recognise` can be used without Blender.
"""
