# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered view in a 3D viewport: each redraw brings the scene nearer to Blender's data and the picture nearer to
its end."""

import time
import weakref

from . import viewport_log
from .engine import Session
from .log_reporter import LogReporter
from .statistics import primitives_text, publish
from .viewport_display import Display
from .viewport_pace import MOST, RedrawPace
from .viewport_picture import ViewportPicture
from .viewport_scenes import explain, scene_of
from .viewport_view import view_of
from .wording import counted

_TRACING = 0.8  # of a redraw's seconds; the rest is for showing what was traced, and for Blender
_LEAST = 0.5  # of a redraw's seconds, where what came before took long


class ViewportSession:
    """What one 3D viewport shows. Make it and use it where Blender's GPU context is active."""

    def __init__(self, engine):
        self._engine = weakref.ref(engine)  # which holds this: in a circle nothing is freed when it should be
        self.display, self.pace = Display(), RedrawPace()
        self.scene = None  # the `ViewportScene`
        self.picture = None  # the `ViewportPicture` of what is loaded
        self.version = None  # of what is loaded, in the picture
        self.error = ""

    @property
    def waiting(self):
        """Whether the scene is being prepared in another thread."""
        return self.scene is not None and self.scene.preparing

    def tag_redraw(self):
        """Have this viewport redrawn, from anywhere in the main thread."""
        engine, self._asked = self._engine(), True
        if engine is not None:
            engine.tag_redraw()

    def draw(self, context, depsgraph):
        """Draw into the bound frame buffer, and ask for another redraw while there is more to do."""
        started, self._asked = time.perf_counter(), False
        self.pace.begin()
        settings = depsgraph.scene.conic
        try:
            self._attach(context.space_data, depsgraph)
            frame = settings.preview_frame_seconds / (1 + self._others())
            view = view_of(context, depsgraph, self._engine().get_preview_pixel_size(depsgraph.scene))
            if not settings.preview_pause:
                self._renew(depsgraph, view, context.space_data, frame)
            self.error = self.scene.error
            if self.scene.ready and not view.is_empty:
                began = self._show(view, frame, started, settings.preview_pause)
                self._log(began, time.perf_counter() - started)
        except Exception as error:  # a view that raises would do so at every redraw
            self.error = explain(error, self.scene.report if self.scene else LogReporter())
            self.picture = None  # it may have ended half way: the next redraw begins anew
        self._tell(settings.preview_pause, time.perf_counter() - started)
        self.pace.end(self._asked)

    def _renew(self, depsgraph, view, space, frame):
        """Bring the scene nearer to Blender's data. Without a picture nobody waits for another redraw."""
        if not self.scene.settled:
            self.pace.changed()
        seconds = self.pace.seconds(frame) if self.scene.ready else MOST
        self.scene.renew(depsgraph, view, space, seconds, max(0.5 * seconds, self.pace.overhead))
        if self.scene.prepared:
            self.tag_redraw()

    def _others(self):
        """How many other viewports of the scene have pictures that form, and share the time of a frame."""
        pictures = (session.picture for session in self.scene.sessions if session is not self)
        return sum(picture is not None and not picture.finished for picture in pictures)

    def _attach(self, space, depsgraph):
        """Find the scene that this viewport shows."""
        scene = scene_of(space, depsgraph, self.scene)
        if scene is not self.scene:
            if self.scene:
                self.scene.sessions.discard(self)
            self.scene, self.picture, self.version = scene, None, None
            scene.sessions.add(self)

    def _show(self, view, frame, started, paused):
        """Trace, and show what is there; whether the picture has begun anew. `frame`: what a redraw may take while
        something happens; `started`: when this one has."""
        loaded = self.scene.loaded
        if self.picture is None:
            self.picture = ViewportPicture(Session(self.scene.device, loaded))
        picture = self.picture
        same_scene = self.version == loaded.version
        began = not same_scene or picture.view is None or picture.view.key != view.key
        if began:
            self.pace.changed()
        seconds = self.pace.seconds(frame)
        seconds = max(_TRACING * seconds - (time.perf_counter() - started), _LEAST * seconds)
        if began:
            self.version = loaded.version
            picture.begin(view, seconds, same_scene)
            self._publish()
        elif not paused:
            picture.advance(seconds)
        self.display.draw(picture.layers, view)
        if not picture.finished and not paused:
            self.tag_redraw()
        if picture.sample and not paused:
            self.scene.improve(view)
        return began

    def _log(self, began, seconds):
        picture = self.picture
        record = viewport_log.Draw(began, picture.keeps, picture.step, picture.sample, picture.finished, seconds)
        viewport_log.records.append(record)

    def _publish(self):
        """The first picture of what is loaded is there: show what it is made of and what it cost."""
        statistics, self.scene.statistics = self.scene.statistics, None
        if statistics:
            statistics.reach("first_picture")
            statistics.width, statistics.height = self.picture.view.size
            statistics.samples = self.scene.loaded.drawn.settings.samples
            statistics.add_session(self.picture.session.statistics())
            publish(statistics)

    def _tell(self, paused, seconds):
        """Show in the viewport how far it is, and that there is something to read in the console."""
        text = self.error or " | ".join(self._state(paused, seconds))
        self._engine().update_stats("Conic", text)

    def _state(self, paused, seconds):
        """How far it is, in some words each."""
        report = self.scene.report
        if self.picture:
            for warning in (*self.scene.loaded.warnings, *self.picture.session.warnings):
                report("WARNING", warning)
            drawn = self.scene.loaded.drawn
            yield f"Sample {min(self.picture.sample + 1, drawn.settings.samples)}/{drawn.settings.samples}"
            yield primitives_text(drawn.packed.statistics["primitives"])
            yield f"{1000.0 * seconds:.0f} ms"
        if paused:
            yield "Paused"
        elif not self.scene.settled:
            yield "Loading"
        if report.warnings:
            yield f"{counted(report.warnings, 'warning')}, see the console"
