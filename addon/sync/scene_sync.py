# SPDX-License-Identifier: GPL-3.0-or-later
"""The full sync: everything that Blender's depsgraph shows becomes one engine scene."""

from dataclasses import dataclass, field

from ..engine.film_options import DepthCue, Outlines
from ..engine.scene import Scene
from ..engine.settings import Settings
from ..engine.timing import timed
from .attributes import key_of
from .camera import camera_of_render
from .image_cache import ImageCache
from .images import Images
from .lights import Lights
from .object_sync import ObjectSync
from .reports import Reports
from .shading import Shadings
from .world import read_world
from .world_light import with_light

_LEAST_FADE = 1e-4  # of a depth cue whose end was set before its start


@dataclass
class SyncStatistics:
    """Of one sync: how many things were taken as each kind, where `instances` are copies that objects make, and
    `seconds` by part."""

    objects: dict = field(default_factory=dict)
    seconds: dict = field(default_factory=dict)


def sync_scene(
    depsgraph, width, height, *, engine=None, camera=None, report, space=None, statistics=None, image_cache=None
):
    """The engine Scene of a depsgraph, for a frame of width x height pixels.

    `engine`: the RenderEngine that asks, None outside of a render. `camera`: an engine Camera to use instead of the
    scene's. `report(level, message)` is called once for each thing that is not rendered as it is. Raises SceneError
    where there is no camera. No reference to Blender's data is kept. `space`: the SpaceView3D that shows it, None for a
    render. `statistics`: a `SyncStatistics` to fill. `image_cache`: an `ImageCache` that is kept from one sync to the
    next.
    """
    statistics = statistics or SyncStatistics()
    reports = Reports(report)
    if camera is None:
        camera = camera_of_render(engine, depsgraph, width, height, reports=reports)
    if depsgraph.scene_eval.render.use_motion_blur:
        reports.warn("motion blur is not rendered")
    scene = Scene(camera=camera, outline_attribute=outline_attribute(depsgraph.scene_eval))
    image_cache = image_cache or ImageCache()
    images = Images(scene, depsgraph.scene_eval.frame_current, image_cache)
    view_layer = depsgraph.view_layer_eval
    world = view_layer.world_override or depsgraph.scene_eval.world
    scene.world = with_light(read_world(world, images, reports), world, scene.images)
    layers = tuple(owner for owner in (view_layer, depsgraph.scene_eval, world) if owner is not None)
    shadings = Shadings(scene, images, reports, layers)
    lights = Lights(scene, reports)
    with timed(statistics.seconds, "collect"):
        objects = ObjectSync(scene, shadings, lights, reports, depsgraph, height, space)
    with timed(statistics.seconds, "read"):
        statistics.objects |= objects.read()
    with timed(statistics.seconds, "place"):
        objects.place()
    image_cache.finish()
    return scene


def outline_attribute(scene):
    """The key of the attribute that outlines go around, empty where they go around none."""
    conic = scene.conic
    if conic.use_outlines and conic.outline_around == "OBJECTS":
        return key_of("object", "random")
    if conic.use_outlines and conic.outline_around == "ATTRIBUTE":
        return key_of("geometry", conic.outline_attribute)
    return ""


def sync_settings(scene, preview=False):
    """The engine Settings of a Blender scene (evaluated or not); `preview` for the viewport and previews."""
    conic = scene.conic
    return Settings(
        samples=conic.preview_samples if preview else conic.samples,
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
