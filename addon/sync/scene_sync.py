# SPDX-License-Identifier: GPL-3.0-or-later
"""The full sync: everything that Blender's depsgraph shows becomes one engine scene."""

from dataclasses import dataclass, field

from ..engine.scene import Scene
from ..engine.settings import Settings
from ..engine.timing import timed
from .camera import camera_of_render
from .images import Images
from .lights import Lights
from .object_sync import ObjectSync
from .reports import Reports
from .shading import Shadings
from .world import read_world


@dataclass
class SyncStatistics:
    """Of one sync: how many things were taken as each kind, where `instances` are copies that objects make, and
    `seconds` by part."""

    objects: dict = field(default_factory=dict)
    seconds: dict = field(default_factory=dict)


def sync_scene(depsgraph, width, height, *, engine=None, camera=None, report, space=None, statistics=None):
    """The engine Scene of a depsgraph, for a frame of width x height pixels.

    `engine`: the RenderEngine that asks, None outside of a render. `camera`: an engine Camera to use instead of the
    scene's. `report(level, message)` is called once for each thing that is not rendered as it is. Raises SceneError
    where there is no camera. No reference to Blender's data is kept. `space`: the SpaceView3D that shows it, None for a
    render. `statistics`: a `SyncStatistics` to fill.
    """
    statistics = statistics or SyncStatistics()
    reports = Reports(report)
    if camera is None:
        camera = camera_of_render(engine, depsgraph, width, height, reports=reports)
    if depsgraph.scene_eval.render.use_motion_blur:
        reports.warn("motion blur is not rendered")
    scene = Scene(camera=camera)
    images = Images(scene, reports)
    view_layer = depsgraph.view_layer_eval
    world = view_layer.world_override or depsgraph.scene_eval.world
    scene.world = read_world(world, scene, images, reports)
    layers = tuple(owner for owner in (view_layer, depsgraph.scene_eval, world) if owner is not None)
    shadings = Shadings(scene, images, reports, layers)
    lights = Lights(scene, reports)
    with timed(statistics.seconds, "collect"):
        objects = ObjectSync(scene, shadings, lights, reports, depsgraph, height, space)
    with timed(statistics.seconds, "read"):
        statistics.objects |= objects.read()
    with timed(statistics.seconds, "place"):
        objects.place()
        shadings.finish()
    return scene


def sync_settings(scene, preview=False):
    """The engine Settings of a Blender scene (evaluated or not); `preview` for the viewport and previews."""
    conic = scene.conic
    return Settings(
        samples=conic.preview_samples if preview else conic.samples,
        max_depth=conic.max_depth,
        weight_cutoff=conic.weight_cutoff,
        tinted_shadows=conic.shadows == "TINTED",
        film_transparent=scene.render.film_transparent,
    )
