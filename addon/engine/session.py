"""Scene, film and device together: load a scene, start a picture, draw it step by step."""

import time
from contextlib import closing
from dataclasses import dataclass

import numpy as np

from . import layout, shader_source
from .errors import ConicError, SceneError
from .film import UNENDED_ALPHA, Film
from .packing import pack
from .settings import Settings
from .timing import timed

#: Surfaces that a tinted shadow ray may pass before it counts as blocked.
_TINTED_SHADOW_SURFACES = 32

_STAGES = ("build", "upload", "compile", "trace", "first_picture")

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
        self._seconds = dict.fromkeys(_STAGES, 0.0)

    def load(self, scene, settings):
        """Build the trees, upload the scene and compile its program, in place of what was loaded before."""
        self.build(scene, settings)
        self.upload()

    def build(self, scene, settings):
        """The part of `load` that is the processor's work alone; it needs no GPU context and no particular thread."""
        self._loading_since = time.perf_counter()
        self._packed = pack(scene, self.device.max_texture_size)
        self.settings, self.camera = settings, scene.camera
        self.warnings = list(self._packed.warnings)
        self._counts = settings.count_rays or settings.may_drop
        self._transmits = any(max(material.transmit) > 0.0 for material in scene.materials)
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
        with timed(self._seconds, "compile"):
            self._program = self.device.program(self._source())
        self._drawn = False

    def _source(self):
        features = set(self._packed.features)
        if self.settings.tinted_shadows and self._transmits:
            features.add("TINTED_SHADOWS")
        if self._counts:
            features.add("COUNT_RAYS")
        constants = self._packed.constants | {
            "PATH_STACK_SIZE": self.settings.stack_size,
            "TINTED_SHADOW_SURFACES": _TINTED_SHADOW_SURFACES,
            "UNENDED_ALPHA": UNENDED_ALPHA,
        }
        return shader_source.program("trace_frag.glsl", features, constants, self._outputs)

    @property
    def _outputs(self):
        """What the program writes, an attachment of the film each."""
        return ("out_color", "out_rays", "out_dropped") if self._counts else ("out_color",)

    def start(self, width, height, camera=None, border=None):
        """Begin a picture of `width` x `height` pixels, or the part `border` (x, y, width, height) of it."""
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
        if self._film:
            self._film.release()
        self._film = self._packed = None

    def _film_bytes(self):
        return self._film.width * self._film.height * 16 * len(self._outputs) if self._film else 0

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

    def _draw(self, rectangle, sample, target=None):
        uniforms = self._frame_record(sample)
        self.device.draw(self._program, target or self._film.target, rectangle, self._textures, uniforms)

    def _frame_record(self, sample):
        """The uniform block (n,) float32 of a sample."""
        camera = self.camera
        matrix = np.asarray(camera.matrix, np.float64)
        record = layout.FRAME.zeros(1)
        values = self._packed.frame | {
            "camera_origin": matrix[:3, 3] - self._packed.origin,
            "camera_right": matrix[:3, 0],
            "camera_up": matrix[:3, 1],
            "camera_forward": -matrix[:3, 2],
            "orthographic": camera.orthographic,
            "clip_start": camera.clip[0],
            "clip_end": camera.clip[1],
            "raster": self._film.raster(sample, camera.window),
            "sample": sample if self.settings.samples > 1 else -1,
            "max_depth": self.settings.max_depth,
            "weight_cutoff": self.settings.weight_cutoff,
            "film_transparent": self.settings.film_transparent,
        }
        for name, value in values.items():
            record[name] = value
        return record.view(np.float32)


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
