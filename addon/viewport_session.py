# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered view in a 3D viewport: read the scene when it changed, then draw a little at every redraw."""

import logging
import traceback
from dataclasses import replace

import bpy

from .engine import Session
from .engine.timing import timed
from .fingerprint import fingerprint
from .render_session import is_defect, new_device, sentence_of
from .statistics import Statistics, publish
from .sync.camera import camera_of_view
from .sync.scene_sync import SyncStatistics, sync_scene, sync_settings
from .viewport_display import Display

log = logging.getLogger(__name__)

DRAW_SECONDS = 1.0 / 30.0  # of tracing in one redraw
COARSE = 8  # a first picture, of every so manyth pixel, shows until the real one has a whole sample
_SHOWN_TYPES = sorted(
    name for name in bpy.types.SpaceView3D.bl_rna.properties.keys() if name.startswith("show_object_viewport_")
)


class LogReporter:
    """Passes messages to the log: a viewport has no reports. A message that holds on from one reading of the scene to
    the next is logged once. `warnings`: how many there are of the scene as it was read last."""

    LEVELS = {"INFO": logging.INFO, "WARNING": logging.WARNING, "ERROR": logging.ERROR}

    def __init__(self):
        self._before, self._now = {}, {}

    def begin(self):
        """The scene is read anew: what is not said again is no longer so."""
        self._before, self._now = self._now, {}

    def __call__(self, level, message):
        """Log `message`; `level` is INFO, WARNING or ERROR."""
        if message not in self._now and message not in self._before:
            log.log(self.LEVELS[level], message)
        self._now[message] = level

    @property
    def warnings(self):
        return sum(level != "INFO" for level in self._now.values())


class ViewportSession:
    """What one 3D viewport shows. Make it and use it where Blender's GPU context is active."""

    def __init__(self, engine):
        self.engine = engine
        self.report = LogReporter()
        self.display = Display()
        self.session = None
        self.settings = None
        self.stale = True  # whether Blender's data may differ from what is loaded
        self.loaded = None  # fingerprint of what is loaded
        self.shown = None  # which objects this viewport shows, as `shown_objects` has it, when they were read
        self.statistics = None  # of what is loaded, until its first picture is there
        self.view = None  # of what is being drawn: size in pixels, pixel size, fingerprint of the camera
        self.coarse = False  # whether the first picture is being drawn
        self.error = ""

    def mark(self):
        """Blender says that something changed."""
        self.stale = True

    def draw(self, context, depsgraph):
        """Draw into the bound frame buffer, and ask for another redraw while there is more to do."""
        try:
            camera = camera_of_view(context.region, context.region_data)
            size = context.region.width, context.region.height
            shown = shown_objects(context.space_data)
            if self.stale or shown != self.shown:
                self.shown = shown
                self.read(depsgraph, size, camera, context.space_data)
            if not self.error:
                self.advance(size, self.engine.get_preview_pixel_size(depsgraph.scene), camera)
        except Exception as error:  # a view that raises would do so at every redraw
            self.error = sentence_of(error)
            if is_defect(error):
                self.report("ERROR", "".join(traceback.format_exception(error)))
        if self.error:
            self.engine.update_stats("Conic", self.error)

    def read(self, depsgraph, size, camera, space):
        """Read the scene; load it unless it is what is loaded: selecting an object changes nothing."""
        self.stale, self.error = False, ""
        self.report.begin()
        statistics, reading = Statistics("Viewport", width=size[0], height=size[1]), SyncStatistics()
        with timed(statistics.seconds, "read"):
            scene = sync_scene(depsgraph, *size, camera=camera, report=self.report, space=space, statistics=reading)
            settings = sync_settings(depsgraph.scene_eval, True)
            with timed(reading.seconds, "compare"):
                found = fingerprint((replace(scene, camera=None), settings))
        statistics.add_reading(reading)
        if found == self.loaded:
            return
        self.loaded = self.view = None  # if what follows fails, nothing is
        self.session = self.session or Session(new_device())
        self.session.build(scene, settings)
        del scene  # the session has it in its own form; uploading takes memory too
        self.session.upload()
        self.loaded, self.settings, self.statistics = found, settings, statistics

    def advance(self, size, pixel_size, camera):
        """Trace for a moment, and show what is there."""
        view = (size, pixel_size, fingerprint(camera))
        if view != self.view:
            self.start(size, pixel_size * COARSE, camera)
            self.view, self.coarse = view, True
        more = self.session.step(DRAW_SECONDS)
        whole = not more or self.session.sample > 0
        if self.coarse and whole:
            self.display.keep(self.session.pixels())
            self.publish()
            self.start(size, pixel_size, camera)
            self.coarse, more = False, True
            self.display.draw()
        else:
            self.display.draw(self.session.pixels(), over_kept=not whole)
        self.tell()
        if more:
            self.engine.tag_redraw()

    def start(self, size, pixel_size, camera):
        """Begin a picture whose pixels are squares of `pixel_size` in a region of `size`."""
        pixels = (max(1, round(length / pixel_size)) for length in size)
        self.session.start(*pixels, camera=camera, pixel_size=pixel_size)

    def publish(self):
        """The first picture of what is loaded is there: show what it is made of and what it cost."""
        if self.statistics:
            self.statistics.reach("first_picture")
            self.statistics.samples = self.settings.samples
            self.statistics.add_session(self.session.statistics())
            publish(self.statistics)
            self.statistics = None

    def tell(self):
        """Show in the viewport how far it is, and that there is something to read in the console."""
        for warning in self.session.warnings:
            self.report("WARNING", warning)
        text = f"Sample {self.session.sample + 1}/{self.settings.samples}"
        if self.report.warnings:
            text += f" | {self.report.warnings} warning{'s' * (self.report.warnings > 1)}, see the console"
        self.engine.update_stats("Conic", text)


def shown_objects(space):
    """What of a 3D viewport's own settings decides which objects it shows; () for none, outside of a window.

    They are no data of the scene. Blender 5.2 calls `view_update` for them too, but nothing promises that; it does when
    objects enter or leave a local view or a hidden collection.
    """
    if space is None:
        return ()
    types = (getattr(space, name) for name in _SHOWN_TYPES)
    return (space.local_view is not None, space.use_local_collections, *types)
