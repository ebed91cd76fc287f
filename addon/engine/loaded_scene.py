"""A scene on a device, which others take the place of. Any number of sessions use it.

A scene takes the place of the one before in two parts: `prepare` is the processor's work, `apply` the GPU's. What is
there can be drawn until `apply` is through.
"""

import time
from dataclasses import dataclass, field, replace

import numpy as np

from . import entries, shader_source
from .changes import Change
from .drawn_scene import DrawnScene
from .errors import DeviceError, SceneError
from .new_textures import NewTextures
from .packed_scene import PackedScene, table_changes
from .packing import pack
from .scene import Camera, Scene
from .scene_program import features_of, source_of
from .settings import Settings
from .timing import timed
from .world_light import light_of_world, world_digest

#: With these the shader must know whether there are instances: shapes in the world's space have no visibility.
_ASK_FOR_INSTANCES = {"HAS_VISIBILITY", "HAS_SHADOW_CATCHER", "HAS_LIGHT_LINKING"}


@dataclass(eq=False)
class Update:
    """What `LoadedScene.prepare` made for `LoadedScene.apply`.

    `before`: the `DrawnScene` whose place it takes, None for none. `scene`: what was packed, None unless its trees are
    to be improved. `change`: what differs from the scene before. `bytes`: to upload, by texture. `seconds`: by stage.
    `warnings`: sentences for the user.
    """

    before: object = field(repr=False)
    scene: Scene | None = field(repr=False)
    packed: PackedScene
    settings: Settings
    camera: Camera
    world_digest: bytes
    change: Change
    bytes: dict
    seconds: dict
    warnings: list
    job: object = field(default=None, repr=False)  # what `apply` still has to do, an iterator of steps
    made: list = field(default_factory=list, repr=False)  # textures that are there already

    @property
    def improves(self):
        """Whether all that differs are better trees: of the same picture."""
        return bool(self.change & Change.TREES) and not self.change & Change.FILM

    @property
    def leaves_trees(self):
        """Whether the quick trees of the scene before are still there: good ones of them are of use yet."""
        ours, its = self.packed.residency.quick, self.before.packed.residency.quick if self.before else []
        return set(map(id, its)) <= set(map(id, ours))


class LoadedScene:
    """What is loaded on a device. Every method raises ConicError with a sentence for the user.

    `drawn`: the `DrawnScene`, None before anything is loaded. `version`: grows with each change; pictures of an older
    one are to begin anew. `warnings`: sentences. `seconds`: of the last update, by stage.
    `lasting`: whether other scenes follow that share much with this one; it costs memory of the processor.
    """

    def __init__(self, device, lasting=True):
        self.device, self.lasting = device, lasting
        self.drawn, self.version = None, 0
        self.warnings, self.seconds = [], {}

    # The processor's part

    def prepare(self, scene, settings, quick=False, stopped=None):
        """The `Update` to a scene. It touches no GPU and may run in any thread, while sessions draw what is there. It
        may be dropped, and must be where another one is applied before it. `quick`: build large trees in a fraction of
        the time, until `prepare_better` has built good ones; rays are slower meanwhile. Raises StoppedError soon after
        `stopped()`."""
        if settings.outlines and settings.outlines.around == "ATTRIBUTE" and not scene.outline_attribute:
            raise SceneError("outlines go around the values of an attribute, but the scene does not say of which")
        return self._prepare(self.drawn, scene, settings, quick, stopped)

    @property
    def can_improve(self):
        """Whether what is drawn has trees that were built quickly."""
        return self.drawn is not None and self.drawn.scene is not None

    def prepare_better(self, stopped=None):
        """As `prepare`, the update to the same scene with good trees, where it `can_improve`. Pictures go on; but not
        those with lines, which are drawn where the places of neighbours in the textures differ."""
        before = self.drawn
        update = self._prepare(before, before.scene, before.settings, quick=False, stopped=stopped)
        update.change = Change.TREES | (Change.FILM if before.settings.outlines else Change.NONE)
        return update

    def _prepare(self, before, scene, settings, quick, stopped):
        packed = pack(
            scene,
            self.device.max_texture_size,
            before.packed.residency if before else None,
            keep=self.lasting,
            quick=quick,
            stopped=stopped,
        )
        digest = world_digest(packed) if settings.world_light != "NONE" else b""
        return Update(
            before=before,
            scene=scene if packed.residency.quick else None,
            packed=packed,
            settings=settings,
            camera=scene.camera,
            world_digest=digest,
            change=self._changes(before, packed, settings, digest),
            bytes={},
            seconds=dict(packed.statistics["seconds"]),
            warnings=packed.warnings_with(settings),
        )

    def _changes(self, before, packed, settings, world_digest):
        """The `Change` from the `DrawnScene` before."""
        if before is None:
            return ~Change.NONE
        change = packed.change | table_changes(before.packed, packed)
        if world_digest != before.world_digest:
            change |= Change.WORLD
        light = before.world_light if world_digest == before.world_digest else world_digest or None
        if self._source(before, packed, settings, light)[0] != before.source:
            change |= Change.PROGRAM
        if not entries.is_settled(self.device, settings.entry):
            change |= Change.PROGRAM  # perhaps: nothing is measured here
        if not _same_values(packed.frame, before.packed.frame):
            change |= Change.FILM
        return change | Change.FILM if change or not settings.draws_as(before.settings) else change

    def _source(self, before, packed, settings, world_light):
        """(Source, features) of the program: the one that is there if it can draw things that the scene has no more,
        for compiling takes seconds; else the one that has no more than it needs."""
        features, entry = features_of(packed, settings, world_light), entries.known(self.device, settings.entry)
        if self.lasting and before:
            spare = (before.features - features) & shader_source.SPARE
            if spare and not features & _ASK_FOR_INSTANCES:
                source = source_of(packed, settings, features | spare, entry)
                if source == before.source:
                    return source, features | spare
        return source_of(packed, settings, features, entry), features

    # The GPU's part

    def apply(self, update, seconds=None):
        """Bring an update to the GPU; True when all of it is there, else the next call goes on after about `seconds`.

        Until then, and if it fails, the scene before is there as it was.
        """
        if update.before is not self.drawn:
            raise RuntimeError("an update to a scene was prepared before another one was applied")
        if not update.change:  # what is drawn stays, and an update to it that is being prepared can follow
            self.drawn.settings, self.drawn.camera = update.settings, update.camera
            self.warnings, self.seconds = update.warnings, update.seconds
            return True
        if update.before and update.change & Change.TREES:  # meanwhile that may have happened
            update.settings, update.camera = self.drawn.settings, self.drawn.camera
            update.warnings = update.packed.warnings_with(update.settings)
        deadline = np.inf if seconds is None else time.perf_counter() + seconds
        update.job = update.job or self._apply(update, in_pieces=seconds is not None)
        try:
            for _ in update.job:
                if time.perf_counter() >= deadline:
                    return False
        except BaseException:
            self.drop(update)
            raise
        return True

    def drop(self, update):
        """Give back what an update that is not to be applied any further has brought to the GPU."""
        if update.job:
            update.job.close()
        self._release(update.made)
        update.made = []

    def _apply(self, update, in_pieces):
        """Do what `update` takes, step by step."""
        packed, before = update.packed, update.before
        new = NewTextures(self.device, update, before, in_pieces)
        while packed.uploads:  # one after the other: each is freed here as soon as it is there
            name, upload = packed.uploads.popitem()
            yield from new.add(name, upload)
            del upload
        yield
        light = yield from self._world_light(update, new)
        yield
        entries.settle(self.device, update.settings.entry)
        yield
        with timed(update.seconds, "compile"):
            source, features, program = self._program(update, light)
            new.complete(source.textures)
            drawn = DrawnScene(
                scene=update.scene,
                packed=packed,
                settings=update.settings,
                camera=update.camera,
                world_light=light,
                world_digest=update.world_digest,
                textures=new.textures,
                rooms=new.rooms,
                source=source,
                features=features,
                program=program,
            )
            if before is None or source != before.source:
                update.change |= Change.PROGRAM | (Change.NONE if update.improves else Change.FILM)
                yield
                drawn.draw_outside(self.device)  # drivers leave much of their work to the first draw
        if before and before.scene and not update.scene:
            before.scene.forget_trees()
        self.drawn, update.before, update.made = drawn, drawn, []
        self.warnings, self.seconds = update.warnings, update.seconds
        self.version += bool(update.change & Change.FILM)
        if before:
            textures, before.textures, before.program = before.textures, {}, None
            kept = set(map(id, drawn.textures.values()))
            self._release([texture for texture in textures.values() if id(texture) not in kept])

    def _program(self, update, light):
        """(Source, features, program) of an update; fragments where the driver refuses a compute program."""
        source, features = self._source(update.before, update.packed, update.settings, light)
        try:
            return source, features, self.device.program(source)
        except DeviceError as error:
            if not source.is_compute:
                raise
            why = str(error).strip().splitlines()[0]
        settings = replace(update.settings, entry="FRAGMENT")
        source, features = self._source(update.before, update.packed, settings, light)
        program = self.device.program(source)
        entries.refuse(self.device)  # the text is not at fault
        if update.settings.entry == "COMPUTE":
            update.warnings.append(f"fragment shaders are used, the driver refuses the compute shader: {why}")
        return source, features, program

    def _world_light(self, update, new):
        """Make the `WorldLight` of an update, step by step; its texture is uploaded where samples need it."""
        before, digest = update.before, update.world_digest
        if before and digest == before.world_digest:
            light = before.world_light
        else:
            light = (yield from light_of_world(self.device, update.packed, new.textures)) if digest else None
        if not (light and update.settings.samples_world):
            new.leave_out("world_light")
        elif "world_light" not in new.textures or light is not before.world_light:
            new.put("world_light", light.texels)
        return light

    @property
    def texture_bytes(self):
        """Bytes of the textures by name."""
        return {name: 16 * room for name, room in self.drawn.rooms.items()} if self.drawn else {}

    def free(self):
        """Give back the textures and the program, here and now: the thread of a `prepare` that nobody waits for does
        not keep them, as it does the `DrawnScene`."""
        if self.drawn:
            textures, self.drawn.textures, self.drawn.program = self.drawn.textures, {}, None
            self._release(list(textures.values()))
        self.drawn = None

    def _release(self, textures):
        for texture in textures:
            self.device.release(texture)


def _same_values(these, those):
    """Whether two dictionaries have the same numbers or arrays."""
    return these.keys() == those.keys() and all(np.array_equal(value, those[key]) for key, value in these.items())
