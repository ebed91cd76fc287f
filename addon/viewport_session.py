# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered view in a 3D viewport: read the scene when it changed, then draw a little at every redraw."""

import logging
from dataclasses import replace

from .engine import ConicError, Session
from .fingerprint import fingerprint
from .render_session import new_device, sample_text
from .sync.camera import camera_of_view
from .sync.scene_sync import sync_scene, sync_settings
from .viewport_display import draw_pixels

log = logging.getLogger(__name__)

DRAW_SECONDS = 1.0 / 30.0  # of tracing in one redraw


class LogReporter:
    """Passes messages to the log, each once: a viewport has no reports."""

    LEVELS = {"INFO": logging.INFO, "WARNING": logging.WARNING, "ERROR": logging.ERROR}

    def __init__(self):
        self.seen = set()

    def __call__(self, level, message):
        """Log `message`; `level` is INFO, WARNING or ERROR."""
        if message not in self.seen:
            self.seen.add(message)
            log.log(self.LEVELS[level], message)


class ViewportSession:
    """What one 3D viewport shows. Make it and use it where Blender's GPU context is active."""

    def __init__(self, engine):
        self.engine = engine
        self.report = LogReporter()
        self.session = None
        self.stale = True  # whether Blender's data may differ from what is loaded
        self.loaded = None  # fingerprint of what is loaded
        self.view = None  # camera and size of what is being drawn
        self.error = ""

    def mark(self):
        """Blender says that something changed."""
        self.stale = True

    def draw(self, context, depsgraph):
        """Draw into the bound frame buffer, and ask for another redraw while there is more to do."""
        pixel_size = int(self.engine.get_preview_pixel_size(depsgraph.scene))
        region = context.region
        size = -(-region.width // pixel_size), -(-region.height // pixel_size)  # rounded up
        camera = camera_of_view(region, context.region_data)
        try:
            if self.stale:
                self.read(depsgraph, size, camera)
            if not self.error:
                self.advance(depsgraph, size, camera, pixel_size)
        except ConicError as error:
            self.error = str(error)
        if self.error:
            self.engine.update_stats("Conic", self.error)

    def read(self, depsgraph, size, camera):
        """Read the scene, and load it unless it is what is loaded already: selecting an object changes
        nothing."""
        self.stale, self.error = False, ""
        scene = sync_scene(depsgraph, *size, camera=camera, report=self.report)
        settings = sync_settings(depsgraph.scene_eval, True)
        found = fingerprint((replace(scene, camera=None), settings))
        if found != self.loaded:
            self.loaded = self.view = None  # if what follows fails, nothing is
            self.session = self.session or Session(new_device())
            self.session.load(scene, settings)
            self.loaded = found

    def advance(self, depsgraph, size, camera, pixel_size):
        """Trace for a moment, and show what is there."""
        view = (size, fingerprint(camera))
        if view != self.view:
            self.session.start(*size, camera=camera)
            self.view = view
        more = self.session.step(DRAW_SECONDS)
        draw_pixels(self.session.pixels(), pixel_size)
        for warning in self.session.warnings:
            self.report("WARNING", warning)
        samples = depsgraph.scene_eval.conic.preview_samples
        self.engine.update_stats("Conic", sample_text(self.session.progress, samples))
        if more:
            self.engine.tag_redraw()
