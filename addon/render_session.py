# SPDX-License-Identifier: GPL-3.0-or-later
"""A final render: one view layer of one frame, in all its views, from Blender's data to the render result."""

import time
import traceback
from dataclasses import replace

import bpy
import numpy as np

from . import gpu_thread
from .device import new_device
from .engine import Session
from .engine.timing import timed
from .failures import is_defect, sentence_of
from .statistics import Statistics, log_line, primitives_text, publish
from .sync.camera import camera_of_render
from .sync.scene_sync import SyncStatistics, sync_scene
from .sync.settings import sync_settings

STEP_SECONDS = 0.05 if bpy.app.background else 0.04  # between two looks at whether the user wants out
RESULT_SECONDS = 0.5  # between two showings of what is there so far
PREVIEW_SAMPLES = 32  # of a small picture: the area lights of its scene are large
_MEBIBYTE = 1024.0**2


class Reporter:
    """Passes messages to Blender's report and its console: each once in a render of any frames and layers.

    Previews say nothing: their scenes are not the user's.
    """

    def __init__(self, engine):
        self.engine = engine

    def __call__(self, level, message):
        """Report `message`; `level` is INFO, WARNING or ERROR."""
        if message not in self.engine.reported and not self.engine.is_preview:
            self.engine.reported.add(message)
            self.engine.report({level}, message)


def border_of(engine, render):
    """What to render of the frame, (x, y, width, height) in pixels from the lower left; None for all of it.

    As Blender cuts it: float32 products, their fractions dropped.
    """
    if engine.is_preview or not render.use_border:
        return None
    size = np.array([engine.resolution_x, engine.resolution_y], np.float32)
    low = (np.array([render.border_min_x, render.border_min_y], np.float32) * size).astype(int)
    high = (np.array([render.border_max_x, render.border_max_y], np.float32) * size).astype(int)
    return (*low.tolist(), *(high - low).tolist())


def settings_of(engine, scene):
    """The engine Settings of a render; `scene` is evaluated. The scenes of previews are Blender's and have defaults."""
    settings = sync_settings(scene)
    return replace(settings, samples=PREVIEW_SAMPLES) if engine.is_preview else settings


def render_layer(engine, depsgraph):
    """Render the view layer of `depsgraph` for a bpy.types.RenderEngine.

    Whatever fails is reported as an error, upon which Blender writes no picture and ends an animation; without
    it Blender would write a black one and go on.
    """
    try:
        LayerRender(engine, depsgraph).run()
    except gpu_thread.StoppedError:
        pass  # Blender knows
    except Exception as error:
        if is_defect(error):
            traceback.print_exception(error)
        engine.report({"ERROR"}, sentence_of(error))


class LayerRender:
    """The render of one view layer."""

    def __init__(self, engine, depsgraph):
        self.engine = engine
        self.depsgraph = depsgraph
        self.report = Reporter(engine)
        self.size = engine.resolution_x, engine.resolution_y
        self.border = border_of(engine, depsgraph.scene_eval.render)
        self.settings = settings_of(engine, depsgraph.scene_eval)
        self.views = [view.name for view in engine.get_result().views]
        self.statistics = Statistics("Render", samples=self.settings.samples)
        self.shapes = ""

    def run(self):
        """Render all views, until done or until the user stops it. Raises ConicError."""
        self.engine.update_stats("Conic", "Reading the scene")
        self.engine.active_view_set(self.views[0])
        session = self.on_gpu(lambda: Session(new_device()))
        try:
            self.load(session)
            for index, view in enumerate(self.views):
                if not self.engine.test_break():
                    self.render_view(session, index, view)
            if not self.engine.test_break():
                self.tell(session)
        finally:
            self.on_gpu(session.free)

    def load(self, session):
        """Read the scene and load it. Nothing of what was read is kept once the GPU has it."""
        session.build(self.read(), self.settings)
        self.on_gpu(session.upload)
        used = self.statistics_of(session).gpu_total / _MEBIBYTE
        self.engine.update_memory_stats(memory_used=used, memory_peak=used)

    def read(self):
        """The engine's scene."""
        found = SyncStatistics()
        with timed(self.statistics.seconds, "read"):
            scene = sync_scene(self.depsgraph, *self.size, engine=self.engine, report=self.report, statistics=found)
        self.statistics.add_reading(found)
        self.shapes = primitives_text(scene.primitive_counts())
        self.engine.update_stats("Conic", f"Building | {self.shapes}")
        return scene

    def statistics_of(self, session):
        """The statistics, with what the session knows by now."""
        self.statistics.add_session(session.statistics())
        return self.statistics

    def tell(self, session):
        """Show what the picture was made of and what it cost; previews say nothing."""
        if self.engine.is_preview:
            return
        self.statistics.reach("total")
        self.statistics_of(session)
        self.engine.update_stats("Conic", log_line(self.statistics))
        self.on_gpu(publish, self.statistics)

    def on_gpu(self, function, *arguments):
        """Call where Blender's GPU context is active."""
        return gpu_thread.call(function, *arguments, stopped=self.engine.test_break)

    def render_view(self, session, index, view):
        """Render one view (an eye, where there are several), and show it as it grows."""
        self.engine.active_view_set(view)
        camera = camera_of_render(self.engine, self.depsgraph, *self.size)
        self.on_gpu(lambda: session.start(*self.size, camera=camera, border=self.border))
        size = self.border[2:] if self.border else self.size
        self.statistics.width, self.statistics.height = size
        # The place of a result is relative to the border.
        result = self.engine.begin_result(0, 0, *size, layer=self.depsgraph.view_layer.name, view=view)
        try:
            self.draw(session, index, result)
            self.show(session, result)
        finally:
            self.engine.end_result(result)
        for warning in session.warnings:
            self.report("WARNING", warning)

    def draw(self, session, index, result):
        """Draw until done or stopped, with progress and, now and then, the picture so far."""
        shown = time.monotonic()
        while not self.engine.test_break() and self.on_gpu(session.step, STEP_SECONDS):
            self.engine.update_progress((index + session.progress) / len(self.views))
            if session.sample > 0:
                self.statistics.reach("first_picture")
            if time.monotonic() - shown > RESULT_SECONDS:
                sample = f"Sample {session.sample + 1}/{self.settings.samples}"
                self.engine.update_stats("Conic", f"{sample} | {self.shapes}")
                self.show(session, result)
                self.engine.update_result(result)
                shown = time.monotonic()
        self.statistics.reach("first_picture")
        self.engine.update_progress((index + session.progress) / len(self.views))

    def show(self, session, result):
        """Copy what is there so far to the render result."""
        result.layers[0].passes["Combined"].rect.foreach_set(self.on_gpu(session.pixels).reshape(-1))
