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

#: Surfaces that a tinted shadow ray may pass before it counts as blocked.
_TINTED_SHADOW_SURFACES = 32

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
        self._textures, self._film, self._packed, self._program = {}, None, None, None
        self._seconds = {"build": 0.0, "upload": 0.0, "compile": 0.0, "trace": 0.0}

    def load(self, scene, settings):
        """Build the trees, upload the scene and compile its program, in place of what was loaded before."""
        self.build(scene, settings)
        self.upload()

    def build(self, scene, settings):
        """The part of `load` that is the processor's work alone; it needs no GPU context and no particular thread."""
        self._packed = pack(scene, self.device.max_texture_size)
        self.settings, self.camera = settings, scene.camera
        self.warnings = list(self._packed.warnings)
        self._counts = settings.count_rays or settings.may_drop
        self._transmits = any(max(material.transmit) > 0.0 for material in scene.materials)
        self._seconds = dict.fromkeys(self._seconds, 0.0) | self._packed.statistics["seconds"]

    def upload(self):
        """The rest of `load`: textures and program of what was built."""
        textures = self._packed.textures
        self._gpu_bytes = sum(texels.nbytes for texels in textures.values())
        with self._timed("upload"):
            self._release_textures()
            self._textures = {name: self.device.texture(texels) for name, texels in textures.items()}
        self._packed.textures = {}  # they have been copied
        with self._timed("compile"):
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
            with self._timed("compile"):
                self._draw_outside()
            self._drawn = True

    def step(self, seconds):
        """Draw tiles for about `seconds`; True while there is more to draw."""
        film, deadline = self._film, time.perf_counter() + seconds
        with self._timed("trace"):
            while not film.finished:
                tile = film.next_tile()
                started = time.perf_counter()
                self._draw(tile.rectangle, film.raster(tile.sample, self.camera.window))
                self.device.read(film.target, 0, (0, 0, 1, 1))  # waits for the GPU
                film.advance(tile, time.perf_counter() - started)
                if time.perf_counter() > deadline:
                    break
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
        """Counts, seconds and bytes, as the command line writes them; `rays` only when they were counted."""
        statistics = {
            "primitives": self._packed.statistics["primitives"],
            "bvh": self._packed.statistics["bvh"],
            "seconds": dict(self._seconds),
            "gpu_bytes": int(self._gpu_bytes + self._film_bytes()),
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
        self._draw((0, 0, 1, 1), self._film.raster(0, self.camera.window), scratch)
        self.device.read(scratch, 0, (0, 0, 1, 1))
        self.device.release(scratch)

    def _draw(self, rectangle, raster, target=None):
        uniforms = self._frame_record(raster)
        self.device.draw(self._program, target or self._film.target, rectangle, self._textures, uniforms)

    def _frame_record(self, raster):
        """The uniform block (n,) float32."""
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
            "raster": raster,
            "max_depth": self.settings.max_depth,
            "weight_cutoff": self.settings.weight_cutoff,
            "film_transparent": self.settings.film_transparent,
        }
        for name, value in values.items():
            record[name] = value
        return record.view(np.float32)

    def _timed(self, stage):
        return _Timer(self._seconds, stage)


def _check_size(width, height, border, limit):
    """Raise SceneError for a picture without pixels, a border outside of it, or more than `limit` pixels a side."""
    if width < 1 or height < 1:
        raise SceneError(f"a picture of {width} x {height} pixels has no pixels")
    x, y, columns, rows = border or (0, 0, width, height)
    if columns < 1 or rows < 1 or x < 0 or y < 0 or x + columns > width or y + rows > height:
        raise SceneError(f"the border {(x, y, columns, rows)} is not within a picture of {width} x {height} pixels")
    if max(columns, rows) > limit:
        raise SceneError(f"a picture of {columns} x {rows} pixels is larger than this device's {limit} x {limit}")


class _Timer:
    """Adds the time spent in a with statement to a table of seconds."""

    def __init__(self, table, stage):
        self._table, self._stage = table, stage

    def __enter__(self):
        self._started = time.perf_counter()

    def __exit__(self, *_):
        self._table[self._stage] += time.perf_counter() - self._started


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
