# SPDX-License-Identifier: GPL-3.0-or-later
"""What 3D viewports show of a Blender scene, and how it is renewed."""

import weakref
from functools import partial

from ..device import blender_device
from ..engine import LoadedScene
from ..engine.changes import Change
from ..engine.timing import timed
from ..statistics import Statistics
from ..sync.scene_reader import SceneReader
from ..sync.scene_sync import SyncStatistics
from ..sync.settings import sync_settings
from . import history, kept_scenes, waiting
from .log_reporter import LogReporter
from .renewal import Renewal

_NEARLY_FINISHED = 2.0  # seconds that a picture still takes: good trees come after it, where rays need the processor


class ViewportScene:
    """Blender's scene as viewports show it, read again when it has changed. Use it where the GPU context is active.

    `loaded`: the engine's `LoadedScene`. A change takes three parts: reading, here and now; preparing, in another
    thread; and bringing it to the GPU, a little at each redraw. Meanwhile viewports draw what was loaded before. Large
    trees are built quickly first; once a picture is there, good ones take their place, by the latter two parts. A newer
    change waits until the one under way is through: where changes come faster than they can be loaded, as while the
    mouse moves something, each would stop the one before and none would be shown. What is stopped is what nobody will
    see: of a viewport that is closed, of data that an undo or a file has replaced, trees of what is drawn no more.
    """

    def __init__(self):
        self._renewal = None  # the `Renewal` under way; what has changed since it was read makes this stale
        self._better = None  # another one, of good trees for what is drawn
        self.loaded = None  # as long as there is no GPU
        self.key = None  # the `scenes.Key` of those who show it
        self.report = LogReporter()
        self.device = blender_device()
        self.loaded = LoadedScene(self.device)
        self.reader = SceneReader(self.report)
        self.stale = True  # whether Blender's data may differ from what was read
        self.error = ""  # why what was read last could not be loaded
        self.statistics = None  # of what is loaded, until its first picture is there
        self.sessions = weakref.WeakSet()  # the viewports that show it

    @property
    def ready(self):
        """Whether there is something to draw."""
        return self.loaded.drawn is not None

    @property
    def preparing(self):
        """Whether another thread works, or has done so, on what the next `renew` takes."""
        return any(renewal and renewal.preparing for renewal in (self._renewal, self._better))

    @property
    def prepared(self):
        """Whether the next `renew` has something to do at once."""
        if self._renewal:
            return self._renewal.wait(0.0)
        return self.stale or (self._better is not None and self._better.wait(0.0))

    @property
    def settled(self):
        """Whether what is loaded is what there is."""
        return not (self.stale or self._renewal)

    def mark(self, depsgraph):
        """Blender says that something changed."""
        self.stale = True
        self.reader.mark(depsgraph)

    def attach(self, session):
        """A viewport's session shows it from now on. Nobody said what has changed while no viewport did."""
        if not self.sessions:
            self._distrust()
        self.sessions.add(session)
        kept_scenes.keep(self)

    def _distrust(self):
        """Read all of it anew. What comes out equal is not loaded again."""
        self.stale = True
        self.reader.forget()

    def forget(self):
        """Nothing that was read before can be trusted, nor what is made of it."""
        self._distrust()
        for renewal in filter(None, (self._renewal, self._better)):
            renewal.stop()

    def renew(self, depsgraph, view, space, seconds, patience):
        """Bring what is loaded nearer to Blender's data: read it, or go on with what was read for about `seconds`.
        What takes no longer than `patience` to prepare shows at once. Where that fails, what was loaded stays, and
        `error` tells why until the scene is read again."""
        try:
            self._drop_stopped()
            if self.stale and not self._renewal:
                self._renewal = self._read(depsgraph, view, space)
                self._renewal.wait(patience)
            if self._renewal:
                if self._renewal.wait(0.0):
                    self._upload(seconds)
            elif self._better and self._better.wait(0.0):
                self._upload_better(seconds)
        except Exception as error:  # raised, it would be so at every redraw
            self._drop_renewal()
            self._drop_better()
            self.error = self.report.explain(error)
            history.records.append(history.Load(error=self.error))
        if self.preparing:
            waiting.watch(self)

    def improve(self, view, seconds_left):
        """A picture of a `View` is there, and finished in about `seconds_left`. If nothing else is to be done, cut
        strands finer that are too coarse for it, or build good trees in the place of those that were built quickly."""
        if not self.settled or self.error:
            return
        if self.reader.is_too_coarse(view.camera, view.size[1]):
            self.stale = True
            self.tag_redraw()
        elif self.loaded.can_improve and not self._better and not 0.0 < seconds_left < _NEARLY_FINISHED:
            self._better = Renewal(self.loaded, self.loaded.prepare_better)
            waiting.watch(self)

    def _read(self, depsgraph, view, space):
        """Read the scene, and begin to prepare it: the `Renewal`."""
        self.stale, self.error = False, ""
        self.report.begin()
        statistics, found = Statistics("Viewport"), SyncStatistics()
        with timed(statistics.seconds, "read"):
            views = [session.picture.view for session in self.sessions if session.picture and session.picture.view]
            others = [(each.camera, each.size[1]) for each in views]
            scene = self.reader.read(
                depsgraph, *view.size, camera=view.camera, space=space, others=others, statistics=found
            )
        statistics.add_reading(found)
        settings = sync_settings(depsgraph.scene_eval, True)
        return Renewal(self.loaded, partial(self.loaded.prepare, scene, settings, True), statistics)

    def _upload(self, seconds):
        """Bring what was prepared to the GPU, or a part of it. Good trees are those of what is drawn now; while they
        are being built, the work is not lost where they stay."""
        update = self._renewal.update
        if update.change and self._better and not (self._better.preparing and update.leaves_trees):
            self._drop_better()
        if update := self._renewal.upload(0.5 * seconds):
            statistics, self._renewal = self._renewal.statistics, None
            self._log(update, {"read": statistics.seconds["read"]})
            if update.change & Change.FILM:
                self.statistics = statistics

    def _upload_better(self, seconds):
        if self._better.update.before is not self.loaded.drawn:  # what is drawn is not what these were prepared for
            self._drop_better()
        elif update := self._better.upload(0.5 * seconds):
            self._better = None
            self._log(update, {})

    @staticmethod
    def _log(update, spent):
        history.records.append(history.Load(update.change, dict(update.bytes), spent | update.seconds))

    def tag_redraw(self):
        """Have the viewports redrawn that show it."""
        for session in self.sessions:
            session.tag_redraw()

    def _drop_stopped(self):
        """Drop what was stopped. What was read goes on until its thread notices: so one at a time is prepared."""
        if self._renewal and self._renewal.stopped and self._renewal.wait(0.0):
            self._drop_renewal()
        if self._better and self._better.stopped:
            self._drop_better()

    def _drop_renewal(self):
        if self._renewal:
            self._renewal.drop()
        self._renewal = None

    def _drop_better(self):
        if self._better:
            self._better.drop()
        self._better = None

    def __del__(self):
        """Free what the GPU holds here and now: the last reference may be that of another thread."""
        self._drop_renewal()
        self._drop_better()
        if self.loaded is not None:  # there was a GPU
            self.loaded.free()
