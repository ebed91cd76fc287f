# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered view in a 3D viewport: each redraw brings the scene nearer to Blender's data and the picture nearer to
its end."""

import time
import weakref

import bpy

from ..engine import Session
from ..statistics import primitives_text, publish
from ..wording import counted
from . import history, tracing
from .display import Display
from .log_reporter import LogReporter
from .pace import MOST_BEFORE_FIRST, RedrawPace
from .picture import ViewportPicture
from .scenes import scene_of
from .view import view_of

_TRACING = 0.8  # of a redraw's seconds; the rest is for showing what was traced, and for Blender
_LEAST = 0.5  # of a redraw's seconds, where what came before took long


class ViewportSession:
    """What one 3D viewport shows. Make it and use it where Blender's GPU context is active."""

    def __init__(self, engine):
        self._engine = weakref.ref(engine)  # which holds this: in a circle nothing is freed when it should be
        self.display, self.pace = Display(), RedrawPace()
        self.scene = None  # the `ViewportScene`
        self.picture = None  # the `ViewportPicture` of what is loaded
        self.error = ""
        self.paused = False
        self._tracing = False  # whether there is something left for `trace`
        self._shown = 0  # samples of the picture, at the last redraw
        self._failure = ""  # why tracing between redraws failed, until the next redraw tells
        self._frame = 0.0  # seconds that a redraw may take while something happens

    @property
    def waiting(self):
        """Whether the scene is being prepared in another thread."""
        return self.scene is not None and self.scene.preparing

    def tag_redraw(self):
        """Have this viewport redrawn, from anywhere in the main thread."""
        engine = self._engine()
        if engine is not None:
            engine.tag_redraw()

    def draw(self, context, depsgraph):
        """Draw into the bound frame buffer, and see to it that what is left to do is done: by `trace`, or by another
        redraw."""
        started = time.perf_counter()
        self.pace.begin()
        settings = depsgraph.scene.conic
        self.paused, failure, self._failure = settings.preview_pause, self._failure, ""
        self._tracing = False
        try:
            self._attach(context.space_data, depsgraph)
            self._frame = settings.preview_frame_seconds / (1 + self._others())
            view = view_of(context, depsgraph, self._engine().get_preview_pixel_size(depsgraph.scene))
            if not self.paused:
                self._renew(depsgraph, view, context.space_data)
            self.error = failure or self.scene.error
            if self.scene.ready and not view.is_empty and not failure:
                began = self._show(view, started)
                self._log(began, time.perf_counter() - started)
        except Exception as error:  # a view that raises would do so at every redraw
            self._fail(error)
        self._tell()
        self.pace.end(self._tracing)

    def trace(self):
        """Go on with the picture between redraws, until there is something to see: a redraw is asked for then. Whether
        there is more to trace before. Call it in the main thread, where the GPU context is active."""
        if not self._tracing or not self.picture.is_of_what_is_loaded:
            return False  # nothing is left, or a redraw will follow
        self.pace.go_on()
        try:
            finer = self.picture.advance(self.pace.seconds(self._frame))
        except Exception as error:
            self._fail(error)
            self._failure, finer = self.error, True
        if finer or self.pace.is_due(self._frame, seen=not self._shown or self.picture.sample > self._shown):
            self.pace.ask()
            self.tag_redraw()
            return False
        return True

    def _fail(self, error):
        """What was drawn has ended half way: the next redraw begins anew."""
        self.error = (self.scene.report if self.scene else LogReporter()).explain(error)
        self.picture, self._tracing = None, False

    def _renew(self, depsgraph, view, space):
        """Bring the scene nearer to Blender's data. Without a picture nobody waits for another redraw."""
        if not self.scene.settled:
            self.pace.changed()
        before = self.scene.loaded.drawn
        if self.picture:
            seconds = self.pace.seconds(self._frame)
            patience = max(0.5 * seconds, self.pace.overhead)
        else:
            seconds = patience = MOST_BEFORE_FIRST
        self.scene.renew(depsgraph, view, space, seconds, patience)
        if self.scene.prepared:
            self.tag_redraw()
        if self.scene.loaded.drawn is not before:
            for other in self.scene.sessions - {self}:  # they may have been redrawn already
                other.tag_redraw()

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
            self.scene, self.picture = scene, None
            scene.attach(self)

    def _show(self, view, started):
        """Show what is there, of a new view what can be traced at once; whether the picture has begun anew. `started`:
        when this redraw has."""
        if self.picture is None:
            self.picture = ViewportPicture(Session(self.scene.device, self.scene.loaded))
        picture = self.picture
        began = not picture.is_of(view)
        if began:
            self.pace.changed()
            spent = time.perf_counter() - started
            picture.begin(view, max(_TRACING * self._frame - spent, _LEAST * self._frame))
            self._publish()
        elif bpy.app.background and not self.paused:
            picture.advance(self._frame)
        self.display.draw(picture.layers, view)
        self._shown = picture.sample
        self._tracing = not (picture.finished or self.paused)
        if self._tracing:
            tracing.go_on(self, quiet=began)
        if picture.sample and not self.paused:
            self.scene.improve(view, picture.seconds_left)
        return began

    def _log(self, began, seconds):
        picture = self.picture
        record = history.Draw(began, picture.keeps, picture.step, picture.sample, picture.finished, seconds)
        history.records.append(record)

    def _publish(self):
        """The first picture of what is loaded is there: show what it is made of and what it cost."""
        statistics, self.scene.statistics = self.scene.statistics, None
        if statistics:
            statistics.reach("first_picture")
            statistics.width, statistics.height = self.picture.view.size
            statistics.samples = self.scene.loaded.drawn.settings.samples
            statistics.add_session(self.picture.session.statistics())
            publish(statistics)

    def _tell(self):
        """Show in the viewport how far it is, and that there is something to read in the console."""
        if self.picture and not self.error:
            for warning in (*self.scene.loaded.warnings, *self.picture.session.warnings):
                self.scene.report("WARNING", warning)
        text = self.error or " | ".join(self._state())
        self._engine().update_stats("Conic", text)

    def _state(self):
        """How far it is, in some words each."""
        if self.picture:
            drawn = self.scene.loaded.drawn
            yield f"Sample {min(self.picture.sample + 1, drawn.settings.samples)}/{drawn.settings.samples}"
            yield primitives_text(drawn.packed.statistics["primitives"])
            yield f"{1000.0 * self.picture.sample_seconds:.0f} ms a sample"
        if self.paused:
            yield "Paused"
        elif not self.scene.settled:
            yield "Loading"
        if warnings := self.scene.report.warnings:
            yield f"{counted(warnings, 'warning')}, see the console"
