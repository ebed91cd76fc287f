"""Scene, film and device together: load a scene, start a picture, draw it step by step."""

import time
from contextlib import closing
from dataclasses import dataclass

import numpy as np

from . import depth_cue, layout, outlines, shader_source
from .errors import ConicError, SceneError
from .film import UNENDED_ALPHA, Film
from .outlines import OutlinePass
from .packing import pack
from .settings import Settings
from .timing import timed
from .visibility import Visibility
from .world_light import light_of_world, world_digest

#: Surfaces that a shadow ray may pass before it counts as blocked.
_SHADOW_SURFACES = 32
#: The feature of the shader that each way of shadows needs.
_SHADOW_FEATURES = {"TRANSPARENT": "TRANSPARENT_SHADOWS", "TINTED": "TINTED_SHADOWS"}

_STAGES = ("build", "upload", "compile", "trace", "first_picture")

_GLOWS_IN_VAIN = (
    "all light comes from surfaces that glow, which light others only in a picture of more than one sample; "
    "take more samples or add a light"
)
_UNENDED = (
    "some pixels are too dark: this driver gives up samples that take very many steps; use a GPU, fewer lights, "
    "a lower maximum depth or a higher cut-off"
)


@dataclass(frozen=True)
class Picture:
    """A finished picture: pixels (height, width, 4) float32, scene-linear, premultiplied alpha, bottom row first."""

    pixels: np.ndarray
    statistics: dict
    warnings: list


class Session:
    """Renders scenes on one device. Every method raises ConicError with a sentence for the user."""

    def __init__(self, device):
        self.device = device
        self.warnings = []
        self._textures, self._texture_bytes, self._film, self._packed, self._program = {}, {}, None, None, None
        self._outlines, self._pixel_size = None, 1.0
        self._world_light, self._world_drawn = None, b""  # the light of the world of this digest
        self._seconds = dict.fromkeys(_STAGES, 0.0)

    def load(self, scene, settings):
        """Build the trees, upload the scene and compile its program, in place of what was loaded before."""
        self.build(scene, settings)
        self.upload()

    def build(self, scene, settings):
        """The part of `load` that is the processor's work alone; it needs no GPU context and no particular thread."""
        self._loading_since = time.perf_counter()
        if settings.outlines and settings.outlines.around == "ATTRIBUTE" and not scene.outline_attribute:
            raise SceneError("outlines go around the values of an attribute, but the scene does not say of which")
        self._packed = pack(scene, self.device.max_texture_size)
        self._world_digest = world_digest(self._packed) if settings.world_light != "NONE" else b""
        self.settings, self.camera = settings, scene.camera
        self.warnings = self._packed.warnings_with(settings)
        if settings.samples == 1 and self._packed.lit_by_surfaces_alone:
            self.warnings.append(_GLOWS_IN_VAIN)
        self._counts = settings.count_rays or settings.may_drop
        self._seconds = dict.fromkeys(_STAGES, 0.0) | self._packed.statistics["seconds"]

    def upload(self):
        """The rest of `load`: textures and program of what was built."""
        textures = self._packed.textures
        self._texture_bytes = {name: texels.nbytes for name, texels in textures.items()}
        with timed(self._seconds, "upload"):
            self._release_textures()
            while textures:  # one after the other: each is freed here as soon as it is there
                name, texels = textures.popitem()
                self._textures[name] = self.device.texture(texels)
                del texels
            self._upload_world_light()
        with timed(self._seconds, "compile"):
            self._program = self.device.program(self._source())
            if self._outlines:
                self._outlines.release()
            self._outlines = OutlinePass(self.device, self.settings) if self.settings.outlines else None
        self._drawn = False

    def _upload_world_light(self):
        if self._world_digest != self._world_drawn:
            self._world_drawn, self._world_light = self._world_digest, None
            if self._world_digest:
                self._world_light = light_of_world(self.device, self._packed, self._textures)
        if self._world_light and self.settings.samples_world:
            texels = self._world_light.texels
            self._textures["world_light"] = self.device.texture(texels)
            self._texture_bytes["world_light"] = texels.nbytes

    def _world_features(self):
        if self._world_light is None:
            return set()
        if self.settings.samples_world:
            return {"HAS_WORLD_LIGHT"} | ({"HAS_WORLD_GLOSS"} if self._gloss_asks_world() else set())
        return {"HAS_HEMISPHERE_LIGHT"} | ({"HAS_AMBIENT_OCCLUSION"} if self.settings.use_ao else set())

    def _gloss_asks_world(self):
        """Whether what is rough asks bright parts of the world for light, as what is diffuse does: where the world is
        the same for all rays, and not the same everywhere."""
        packed, rays = self._packed, Visibility.DIFFUSE | Visibility.GLOSSY | Visibility.TRANSMISSION
        programs, program = packed.world_programs
        alike = packed.world.visibility & rays == rays and "HAS_LIGHT_PATH" not in programs.features()
        return alike and program is not None and "HAS_ROUGHNESS" in packed.features

    def _source(self):
        features = self._packed.features | self._world_features() | self.settings.film_features
        features -= {*_SHADOW_FEATURES.values()} - {_SHADOW_FEATURES.get(self.settings.shadows)}
        if self._counts:
            features |= {"COUNT_RAYS"}
        constants = self._packed.constants | {
            "PATH_STACK_SIZE": self.settings.stack_size,
            "SHADOW_SURFACES": _SHADOW_SURFACES,
            "UNENDED_ALPHA": UNENDED_ALPHA,
        }
        programs = (("programs_lib.glsl", self._packed.programs),)
        return shader_source.program("trace_frag.glsl", features, constants, self._outputs, generated=programs)

    @property
    def _outputs(self):
        """What the program writes, an attachment of the film each."""
        counters = ("out_rays", "out_dropped") if self._counts else ()
        guide = ("out_guide",) if self.settings.outlines else ()  # the last: of one sample only, it is not summed up
        return ("out_color", *counters, *guide)

    def start(self, width, height, camera=None, border=None, pixel_size=1.0):
        """Begin a picture of `width` x `height` pixels, or the part `border` (x, y, width, height) of it. `pixel_size`:
        of a coarse picture, how many pixels of the screen one is wide; lines are as wide there as in the fine one."""
        if self._packed is None:
            raise SceneError("no scene is loaded")
        _check_size(width, height, border, self.device.max_texture_size - self.settings.corner_rays)
        self.camera = camera or self.camera
        if self._film:
            self._film.release()
        self._film = Film(
            self.device,
            width,
            height,
            border=border,
            samples=self.settings.samples,
            corner_rays=self.settings.corner_rays,
            attachments=len(self._outputs),
        )
        self._pixel_size = pixel_size
        if self._outlines:
            self._outlines.start(self._film.width, self._film.height)
        self._reported_drops = False
        if not self._drawn:  # drivers leave much of their work to the first draw: make it a small one
            with timed(self._seconds, "compile"):
                self._draw_outside()
            self._drawn = True

    def step(self, seconds):
        """Draw tiles for about `seconds`; True while there is more to draw."""
        film, deadline = self._film, time.perf_counter() + seconds
        with timed(self._seconds, "trace"):
            while not film.finished:
                tile = film.next_tile()
                started = time.perf_counter()
                self._draw(tile.rectangle, tile.sample)
                self.device.read(film.target, 0, (0, 0, 1, 1))  # waits for the GPU
                film.advance(tile, time.perf_counter() - started)
                if film.sample != tile.sample or film.finished:
                    self._draw_lines(tile.sample)
                if time.perf_counter() > deadline:
                    break
        if not self._seconds["first_picture"] and (film.sample > 0 or film.finished):
            self._seconds["first_picture"] = time.perf_counter() - self._loading_since
        if film.finished:
            self._report_drops()
        return not film.finished

    @property
    def progress(self):
        return self._film.progress if self._film else 0.0

    @property
    def sample(self):
        """Number of the sample being drawn, from 0."""
        return self._film.sample if self._film else 0

    def pixels(self):
        """The picture so far, see `Film.pixels`."""
        pixels = self._film.pixels()
        if self._outlines:
            pixels = outlines.over(self._film.of_pixels(self._outlines.pixels()), pixels)
        if self._film.unended and _UNENDED not in self.warnings:
            self.warnings.append(_UNENDED)
        return pixels

    def statistics(self):
        """What was loaded and drawn, as the command line writes it and the panel shows it; plain numbers and text.

        primitives: number by kind, those of instances each time. instances: how many stand in the scene, of how many
        different geometries. bvh: nodes of all trees, depth of the deepest path, sah_cost of the largest tree.
        seconds: build (trees and records), upload, compile, trace; first_picture: from the start of loading until each
        pixel had a sample, 0 before that. build: the seconds of building by stage. textures: bytes by name; gpu_bytes:
        those and the film's. device: its name. rays, only when they are counted: by kind.
        """
        statistics = {
            **{
                name: self._packed.statistics[name]
                for name in ("primitives", "instances", "geometries", "bvh", "build")
            },
            "seconds": dict(self._seconds),
            "gpu_bytes": sum(self._texture_bytes.values()) + self._film_bytes(),
            "textures": dict(self._texture_bytes),
            "device": self.device.name,
        }
        if self._counts:
            eye_hit, reflect, refract, shadow = (int(v) for v in self._film.counters(1))
            dropped, eye = (int(v) for v in self._film.counters(2)[:2])
            statistics["rays"] = {
                "eye": eye,
                "eye_hit": eye_hit,
                "reflect": reflect,
                "refract": refract,
                "shadow": shadow,
                "dropped": dropped,
            }
        return statistics

    def free(self):
        """Give back textures and film; programs stay with the device."""
        self._release_textures()
        for thing in (self._film, self._outlines):
            if thing:
                thing.release()
        self._film = self._outlines = self._packed = None

    def _film_bytes(self):
        if not self._film:
            return 0
        own = self._film.width * self._film.height * 16 * len(self._outputs)
        return own + (self._outlines.bytes if self._outlines else 0)

    def _release_textures(self):
        for texture in self._textures.values():
            self.device.release(texture)
        self._textures = {}

    def _report_drops(self):
        if not self._counts or self._reported_drops:
            return
        self._reported_drops = True
        dropped = int(self._film.counters(2)[0])
        if dropped:
            self.warnings.append(
                f"{dropped} refracted rays were dropped, the stack holds {self.settings.stack_size}; "
                "lower the maximum depth"
            )

    def _draw_outside(self):
        """Draw one pixel of a target that is thrown away."""
        scratch = self.device.target(1, 1, len(self._outputs))
        self._draw((0, 0, 1, 1), 0, scratch)
        self.device.read(scratch, 0, (0, 0, 1, 1))
        self.device.release(scratch)

    def _draw_lines(self, sample):
        """A sample is complete: draw its lines, and make room for what the rays of the next one meet."""
        if self._outlines:
            target, guide = self._film.target, len(self._outputs) - 1
            self._outlines.add_sample(self.device.attachment(target, guide), self._frame_record(sample))
            self.device.clear(target, guide)

    def _draw(self, rectangle, sample, target=None):
        uniforms = self._frame_record(sample)
        self.device.draw(self._program, target or self._film.target, rectangle, self._textures, uniforms)

    def _frame_record(self, sample):
        """The uniform block (n,) float32 of a sample."""
        camera = self.camera
        matrix = np.asarray(camera.matrix, np.float64)
        record = layout.FRAME.zeros(1)
        world = self._world_light.frame if self._world_light else {}
        values = (
            self._packed.frame
            | world
            | {
                "camera_origin": matrix[:3, 3] - self._packed.origin,
                "camera_right": matrix[:3, 0],
                "camera_up": matrix[:3, 1],
                "camera_forward": -matrix[:3, 2],
                "orthographic": camera.orthographic,
                "clip_start": camera.clip[0],
                "clip_end": camera.clip[1],
                "raster": self._film.raster(sample, camera.window),
                "window": _window(camera.window),
                "world_origin": self._packed.origin,
                "sample": sample if self.settings.samples > 1 else -1,
                "max_depth": self.settings.max_depth,
                "shadows_pass": self._packed.shadows_pass[self.settings.shadows],
                "weight_cutoff": self.settings.weight_cutoff,
                "ao_distance": self.settings.ao_distance or 1e30,
                "ao_factor": self.settings.ao_factor,
                "ao_rays": self.settings.ao_rays,
                "film_transparent": self.settings.film_transparent,
            }
            | self._film_options(camera)
        )
        for name, value in values.items():
            record[name] = value
        return record.view(np.float32)

    def _film_options(self, camera):
        """Members of the record `Frame` for depth cue and outlines, where they are on."""
        values = {}
        if self.settings.depth_cue:
            values |= depth_cue.frame_values(self.settings.depth_cue, camera, self._packed.bounds, self._packed.origin)
        if self.settings.outlines:
            height = self._film.frame_size[1]
            values |= outlines.frame_values(self.settings.outlines, camera.window, height, self._pixel_size)
        return values


def _window(window):
    """Left and bottom edge of a camera's window, and 1 over its width and height: (4,)."""
    left, right, bottom, top = window
    return left, bottom, 1.0 / (right - left), 1.0 / (top - bottom)


def _check_size(width, height, border, limit):
    """Raise SceneError for a picture without pixels, a border outside of it, or more than `limit` pixels a side."""
    if width < 1 or height < 1:
        raise SceneError(f"a picture of {width} x {height} pixels has no pixels")
    x, y, columns, rows = border or (0, 0, width, height)
    if columns < 1 or rows < 1 or x < 0 or y < 0 or x + columns > width or y + rows > height:
        raise SceneError(f"the border {(x, y, columns, rows)} is not within a picture of {width} x {height} pixels")
    if max(columns, rows) > limit:
        raise SceneError(f"a picture of {columns} x {rows} pixels is larger than this device's {limit} x {limit}")


class CancelledError(ConicError):
    """The caller asked to stop."""


def render(scene, width, height, settings=None, *, device=None, progress=None, cancelled=None):
    """Render a scene to a `Picture`.

    `device`: where to draw, by default a headless context of its own. `progress(share)` is called some times a second;
    `cancelled()` returning True raises CancelledError. Raises ConicError.
    """
    if device is None:
        from .devices.headless import HeadlessDevice

        with closing(HeadlessDevice()) as own:
            return render(scene, width, height, settings, device=own, progress=progress, cancelled=cancelled)
    session = Session(device)
    try:
        session.load(scene, settings or Settings())
        session.start(width, height)
        while session.step(0.1):
            if progress:
                progress(session.progress)
            if cancelled and cancelled():
                raise CancelledError("rendering was stopped")
        if progress:
            progress(1.0)
        return Picture(session.pixels(), session.statistics(), session.warnings)
    finally:
        session.free()
