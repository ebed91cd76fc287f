# SPDX-License-Identifier: GPL-3.0-or-later
"""From the settings of a Blender scene to the engine's."""

from ..engine.film_options import DepthCue, Outlines
from ..engine.settings import Settings

_SEEDS = 2**31  # more than any of the engine's
_LEAST_FADE = 1e-4  # of a depth cue whose end was set before its start


def sync_settings(scene, preview=False):
    """The engine Settings of a Blender scene (evaluated or not); `preview` for the viewport and previews."""
    conic = scene.conic
    return Settings(
        samples=conic.preview_samples if preview else conic.samples,
        seed=(conic.seed + (scene.frame_current if conic.use_animated_seed else 0)) % _SEEDS,
        max_depth=conic.max_depth,
        weight_cutoff=conic.weight_cutoff,
        shadows=conic.shadows,
        film_transparent=scene.render.film_transparent,
        flat_colors=conic.use_flat_colors,
        depth_cue=_depth_cue(conic) if conic.use_depth_cue else None,
        outlines=_outlines(conic) if conic.use_outlines else None,
        world_light=conic.world_light,
        use_ao=conic.use_ao,
        ao_distance=conic.ao_distance,
        ao_factor=conic.ao_factor,
        entry=conic.entry,
    )


def _depth_cue(conic):
    has_range = conic.depth_cue_range == "DISTANCES"
    return DepthCue(
        color=tuple(conic.depth_cue_color) if conic.depth_cue_into == "COLOR" else None,
        start=conic.depth_cue_start if has_range else None,
        end=max(conic.depth_cue_end, conic.depth_cue_start + _LEAST_FADE) if has_range else None,
        strength=conic.depth_cue_strength,
    )


def _outlines(conic):
    return Outlines(
        color=tuple(conic.outline_color),
        around="SHAPES" if conic.outline_around == "SHAPES" else "ATTRIBUTE",
        width=conic.outline_width,
        inner_width=conic.outline_inner_width,
        crease_angle=conic.outline_crease_angle,
        depth_step=conic.outline_depth_step / 100.0,
    )
