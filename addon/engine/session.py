"""Scene, film and device together: load a scene, start a picture, draw it step by step."""

import time
from contextlib import closing
from dataclasses import dataclass

import numpy as np

from . import outlines
from .drawn_scene import frame_record
from .errors import ConicError, SceneError
from .film import TILE_SECONDS, Film, Pace
from .loaded_scene import LoadedScene
from .outlines import OutlinePass
from .settings import Settings
from .timing import timed

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
    """Renders scenes on one device. Every method raises ConicError with a sentence for the user.

    `loaded`: the `LoadedScene` that it draws; by default one of its own, which takes no more memory than a picture
    needs. One that is given may be another's too, who frees it.
    """

    def __init__(self, device, loaded=None):
        self.device = device
        self.loaded = loaded or LoadedScene(device, lasting=False)
        self._owns_loaded = loaded is None
        self.warnings = []
        self.pace = Pace()
        self._film = self._outlines = self._update = None
        self._picture, self._version = (), 0  # what was asked for, and of which version of the scene
        self._loading_since = time.perf_counter()
        self._seconds = dict.fromkeys(_STAGES, 0.0)

    def load(self, scene, settings):
        """Build the trees, upload the scene and compile its program, in place of what was loaded before."""
        self.build(scene, settings)
        self.upload()

    def build(self, scene, settings):
        """The part of `load` that is the processor's work alone; it needs no GPU context and no particular thread."""
        self._loading_since = time.perf_counter()
        self._update = self.loaded.prepare(scene, settings)
        self.warnings = list(self._update.warnings)
        self._seconds = dict.fromkeys(_STAGES, 0.0)

    def upload(self):
        """The rest of `load`: textures and program of what was built."""
        update, self._update = self._update, None
        self.loaded.apply(update)
        self.warnings = list(update.warnings)  # the driver's too

    def start(self, width, height, camera=None, border=None, pixel_size=1.0):
        """Begin a picture of `width` x `height` pixels, or the part `border` (x, y, width, height) of it. `pixel_size`:
        of a coarse picture, how many pixels of the screen one is wide; lines are as wide there as in the fine one."""
        drawn = self._drawn
        settings = drawn.settings
        _check_size(width, height, border, self.device.max_texture_size - settings.corner_rays)
        self._picture, self._version = (width, height, camera, border, pixel_size), self.loaded.version
        self.camera = camera or drawn.camera
        self._release_film()
        self._film = Film(
            self.device,
            width,
            height,
            border=border,
            samples=settings.samples,
            corner_rays=settings.corner_rays,
            attachments=len(drawn.outputs),
            pace=self.pace,
        )
        if settings.outlines:
            self._outlines = OutlinePass(self.device, settings)
            self._outlines.start(self._film.width, self._film.height)
        self._pixel_size, self._reported_drops = pixel_size, False

    def step(self, seconds, tile_seconds=TILE_SECONDS):
        """Draw tiles for about `seconds`; True while there is more to draw. `tile_seconds`: about what one of them may
        take, how late the answer may be. The picture of a scene that has changed meanwhile begins anew."""
        if self._version != self.loaded.version:
            self.start(*self._picture)
        film, deadline = self._film, time.perf_counter() + seconds
        with timed(self._seconds, "trace"):
            while not film.finished:
                tile = film.next_tile(tile_seconds)
                started = time.perf_counter()
                self._drawn.draw(self.device, film.target, tile.rectangle, self._frame_values(tile.sample))
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
    def film(self):
        """The `Film` of the picture, None before `start`."""
        return self._film

    @property
    def lines(self):
        """The `OutlinePass` of the picture, None where there are no outlines."""
        return self._outlines

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
        different geometries. bvh: nodes of all trees, depth of the deepest path, sah_cost of the largest tree,
        grids: how many geometries have one in place of a tree.
        seconds: build (trees and records), upload, compile, trace; first_picture: from the start of loading until each
        pixel had a sample, 0 before that. build: the seconds of building by stage. textures: bytes by name; gpu_bytes:
        those and the film's. device: its name. entry: how its program runs, FRAGMENT or COMPUTE. rays, only when they
        are counted: by kind.
        """
        packed, textures = self._drawn.packed, self.loaded.texture_bytes
        statistics = {
            **{name: packed.statistics[name] for name in ("primitives", "instances", "geometries", "bvh", "build")},
            "seconds": self._seconds | self.loaded.seconds,
            "gpu_bytes": sum(textures.values()) + self._film_bytes(),
            "textures": dict(textures),
            "device": self.device.name,
            "entry": self._drawn.entry,
        }
        if self._drawn.counts and self._film:
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
        """Give back the film and, where it is the session's own, the scene; programs stay with the device."""
        self._release_film()
        if self._owns_loaded:
            self.loaded.free()

    @property
    def _drawn(self):
        """The `DrawnScene` that is loaded."""
        if self.loaded.drawn is None:
            raise SceneError("no scene is loaded")
        return self.loaded.drawn

    def _film_bytes(self):
        if not self._film:
            return 0
        return self._film.bytes + (self._outlines.bytes if self._outlines else 0)

    def _release_film(self):
        for thing in (self._film, self._outlines):
            if thing:
                thing.release()
        self._film = self._outlines = None

    def _report_drops(self):
        if not self._drawn.counts or self._reported_drops:
            return
        self._reported_drops = True
        dropped = int(self._film.counters(2)[0])
        if dropped:
            self.warnings.append(
                f"{dropped} refracted rays were dropped, the stack holds {self._drawn.settings.stack_size}; "
                "lower the maximum depth"
            )

    def _draw_lines(self, sample):
        """A sample is complete: draw its lines, and make room for what the rays of the next one meet."""
        if self._outlines:
            target, guide = self._film.target, len(self._drawn.outputs) - 1
            uniforms = frame_record(self._frame_values(sample))
            self._outlines.add_sample(self.device.attachment(target, guide), uniforms)
            self.device.clear(target, guide)

    def _frame_values(self, sample):
        """Members of the record `Frame` of a sample."""
        drawn, camera = self._drawn, self.camera
        values = drawn.frame_values(camera) | {
            "raster": self._film.raster(sample, camera.window),
            "sample": sample if drawn.settings.samples > 1 else -1,
        }
        if drawn.settings.outlines:
            height = self._film.frame_size[1]
            values |= outlines.frame_values(drawn.settings.outlines, camera.window, height, self._pixel_size)
        return values


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
