# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a depsgraph again and again; what did not change since is the same object in the Scene as before."""

from dataclasses import dataclass, field

import numpy as np

from ..engine.scene import Scene
from ..engine.timing import timed
from ..fingerprint import fingerprint
from .attributes import key_of
from .camera import camera_of_render
from .changes import Changes, ids_in
from .image_state import changed_images, image_states
from .images import FRAME, Images, image_places
from .instancing import SceneCopies
from .keys import original_key
from .memory import Memory
from .object_sync import ObjectSync
from .reports import Reports
from .shading import Shadings, material_places
from .visibility import shown_in
from .world import read_world
from .world_light import with_light

_PASSES_MADE = {"combined", "grease_pencil", "cryptomatte_accurate"}  # the last is a setting, on by default


@dataclass
class SyncStatistics:
    """Of one sync: how many things were taken as each kind, where `instances` are copies that objects make, and
    `seconds` by part."""

    objects: dict = field(default_factory=dict)
    seconds: dict = field(default_factory=dict)


class SceneReader:
    """Reads a depsgraph as the engine's Scene, any number of times.

    What did not change since the read before is the same object: a `Geometry`, `Instances`, `Image`, `Material`, also
    where Blender said that it may have changed. Materials and images keep their numbers. `report(level, message)` is
    called once at each read for each thing that is not rendered as it is. No reference to Blender's data is kept.
    """

    def __init__(self, report):
        self._report = report
        self._changes = Changes()
        self._memory = Memory(Reports(self._report))
        self._materials, self._images = material_places(), image_places()
        self._objects = [], np.empty((0, 4, 4), np.float32)
        self._states, self._frame, self._graph = {}, None, None
        self._pixels = None  # the `PixelSizes` that strands were cut for, None where they are cut in any number

    def mark(self, depsgraph):
        """Take note of what Blender says has changed: call it in each `view_update`, as often as one likes."""
        self._changes.mark(depsgraph.updates)

    def forget(self):
        """Nothing that was read is to be trusted, as after undo or when a file was loaded: the next read is a full one.
        What then comes out equal is still the same object."""
        self._changes.everything = True

    def is_too_coarse(self, camera, height):
        """Whether strands, as they were read, are too coarse for an engine Camera and a picture of this height."""
        return self._pixels is not None and self._pixels.are_too_long(camera, height)

    def read(self, depsgraph, width, height, *, engine=None, camera=None, space=None, others=(), statistics=None):
        """The Scene of a depsgraph, for a frame of width x height pixels. Raises SceneError where there is no camera.

        `engine`: the RenderEngine that asks, None outside of a render. `camera`: an engine Camera to use instead of the
        scene's. `space`: the SpaceView3D that shows it, None for a render. `others`: (engine Camera, height of the
        picture) of further views that show the scene. `statistics`: a `SyncStatistics` to fill.
        """
        statistics = statistics or SyncStatistics()
        reports = Reports(self._report)
        try:
            if camera is None:
                camera = camera_of_render(engine, depsgraph, width, height, reports=reports)
            return self._read(depsgraph, camera, [(camera, height), *others], space, reports, statistics)
        except Exception:
            self.forget()
            raise

    def _read(self, depsgraph, camera, eyes, space, reports, statistics):
        with timed(statistics.seconds, "collect"):
            copies = SceneCopies(depsgraph, shown_in(space))
            self._begin(depsgraph, copies, reports)
            if depsgraph.scene_eval.render.use_motion_blur:
                reports.warn("motion blur is not rendered")
            if depsgraph.mode == "RENDER" and (passes := _passes_of(depsgraph.view_layer)):
                reports.warn(f"view layer {depsgraph.view_layer.name!r}: not rendered as passes: {', '.join(passes)}")
            scene = Scene(camera=camera, outline_attribute=outline_attribute(depsgraph.scene_eval))
            memory = self._memory
            images = Images(depsgraph.scene_eval.frame_current, memory, self._images)
            view_layer = depsgraph.view_layer_eval
            world = view_layer.world_override or depsgraph.scene_eval.world
            scene.world = self._world(world, images, reports)
            layers = tuple(owner for owner in (view_layer, depsgraph.scene_eval, world) if owner is not None)
            shadings = Shadings(images, reports, layers, memory, self._materials, scene.outline_attribute)
            objects = ObjectSync(scene, copies, shadings, eyes, memory)
        with timed(statistics.seconds, "read"):
            statistics.objects |= objects.read()
        with timed(statistics.seconds, "place"):
            objects.place()
        self._pixels = objects.pixels if depsgraph.scene_eval.conic.curve_sampling != "FIXED" else None
        self._end(scene, images)
        return scene

    def _begin(self, depsgraph, copies, reports):
        """Let go of what has changed since the last read."""
        changes, self._changes = self._changes, Changes()
        tokens = changes.tokens | self._moved(copies)
        frame = depsgraph.scene_eval.frame_current
        if frame != self._frame:
            tokens.add(FRAME)
        before, self._states = self._states, image_states(self._states)
        tokens |= changed_images(before, self._states)
        graph = original_key(depsgraph.scene), depsgraph.view_layer.name, depsgraph.mode
        self._memory.begin(reports, tokens, changes.everything or graph != self._graph)
        self._frame, self._graph = frame, graph

    def _moved(self, copies):
        """The uids of the objects that do not stand where they stood."""
        uids, matrices = self._objects
        self._objects = copies.uids, copies.matrices
        if uids != copies.uids:
            number = {uid: i for i, uid in enumerate(uids)}
            rows = np.array([(i, number[uid]) for i, uid in enumerate(copies.uids) if uid in number], np.intp)
            uids = [copies.uids[i] for i in rows[:, 0]] if len(rows) else []
            before, now = (matrices[rows[:, 1]], copies.matrices[rows[:, 0]]) if len(rows) else (matrices[:0],) * 2
        else:
            before, now = matrices, copies.matrices
        return {uids[i] for i in np.flatnonzero((before != now).any(axis=(1, 2)))}

    def _world(self, world, images, reports):
        """The engine's World of a Blender world, or of None."""

        def read(previous):
            if world is not None:
                self._memory.depend(original_key(world), *ids_in(world.node_tree))
            first = len(images.asked)
            made, numbers = read_world(world, images, reports), images.asked[first:]
            if previous is not None and fingerprint(made) == fingerprint(previous[0]):
                made = previous[0]
            return made, numbers

        made, numbers = self._memory.get("world", read, None if world is None else original_key(world))
        return with_light(made, world, [self._images.things[number] for number in numbers])

    def _end(self, scene, images):
        """Drop what is no longer in the scene, and give the scene lists of its own."""
        _settle_replacements(scene)
        self._memory.end()
        states = self._states | image_states(images.keys)  # to look is slow where they are packed or on a network
        self._states = {key: state for key, state in states.items() if self._memory.last(("image", *key)) is not None}
        for places in (self._materials, self._images):
            places.drop_unused(lambda key: self._memory.last(key) is not None)
        scene.materials, scene.images = list(self._materials.things), list(self._images.things)


def _settle_replacements(scene):
    """Let a geometry be replaced by one other, and only if it is no longer in the scene."""
    geometries = [scene.shapes, *(placed.geometry for placed in scene.instances)]
    taken = set(geometries)
    for geometry in dict.fromkeys(geometries):
        replaced = geometry.replaces and geometry.replaces()
        if replaced in taken:
            geometry.replaces = None
        taken.add(replaced)


def _passes_of(view_layer):
    """The names of the passes that a view layer asks for, as its panel has them, and its own outputs (AOVs), but for
    Combined and what Blender adds by itself."""
    names = [name for name in view_layer.bl_rna.properties.keys() if name.startswith("use_pass_")]
    names = [name for name in names if name.removeprefix("use_pass_") not in _PASSES_MADE and getattr(view_layer, name)]
    return [view_layer.bl_rna.properties[name].name for name in names] + [aov.name for aov in view_layer.aovs]


def outline_attribute(scene):
    """The key of the attribute that outlines go around, empty where they go around none."""
    conic = scene.conic
    if conic.use_outlines and conic.outline_around == "OBJECTS":
        return key_of("object", "random")
    if conic.use_outlines and conic.outline_around == "ATTRIBUTE":
        return key_of("geometry", conic.outline_attribute)
    return ""
