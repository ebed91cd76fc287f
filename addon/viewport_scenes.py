# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes that 3D viewports show. Viewports that show the same objects share one: it is read once, and is on the GPU
once. It is freed some time after the last of them."""

import traceback
import weakref
from functools import partial

import bpy

from . import viewport_kept, viewport_log
from .engine import LoadedScene
from .engine.changes import Change
from .engine.timing import timed
from .log_reporter import LogReporter
from .render_session import blender_device, is_defect, sentence_of
from .statistics import Statistics
from .sync.scene_reader import SceneReader
from .sync.scene_sync import SyncStatistics, sync_settings
from .viewport_renewal import Renewal

_LOOK_SECONDS = 0.01  # between two looks whether a scene has been prepared
_NEARLY_FINISHED = 2.0  # seconds that a picture still takes: good trees come after it, where rays need the processor
_SHOWN_TYPES = sorted(
    name for name in bpy.types.SpaceView3D.bl_rna.properties.keys() if name.startswith("show_object_viewport_")
)
_scenes = weakref.WeakValueDictionary()  # by `ViewportScene.key`
_replacing = False  # whether Blender is just replacing its data, by an undo or a file


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
        self.key = None  # of what it shows, see `_key`
        self.report = LogReporter()
        self._renewal = None  # the `Renewal` under way; what has changed since it was read makes this stale
        self._better = None  # another one, of good trees for what is drawn
        self.loaded = None
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
        viewport_kept.keep(self)

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
            if self._renewal and self._renewal.stopped and self._renewal.wait(0.0):
                self._drop_renewal()
            if self._better and self._better.stopped:
                self._drop_better()
            if self.stale and not self._renewal:
                self._renewal = self._read(depsgraph, view, space)
                self._renewal.wait(patience)
            if self._renewal and not self._renewal.wait(0.0):
                _watch_jobs()
            elif self._renewal:
                self._upload(seconds)
            elif self._better and self._better.wait(0.0):
                self._upload_better(seconds)
        except Exception as error:  # raised, it would be so at every redraw
            self._drop()
            self.error = explain(error, self.report)
            viewport_log.records.append(viewport_log.Load(error=self.error))

    def improve(self, view, seconds_left):
        """A picture of a `View` is there, and finished in about `seconds_left`. If nothing else is to be done, cut
        strands finer that are too coarse for it, and build good trees in the place of those that were built quickly."""
        if self.settled and not self.error and self.reader.is_too_coarse(view.camera, view.size[1]):
            self.stale = True
            self.tag_redraw()
        waits = 0.0 < seconds_left < _NEARLY_FINISHED
        if self.loaded.can_improve and self.settled and not (self._better or self.error or waits):
            self._better = Renewal(self.loaded, self.loaded.prepare_better)
            _watch_jobs()

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
        viewport_log.records.append(viewport_log.Load(update.change, dict(update.bytes), spent | update.seconds))

    def tag_redraw(self):
        """Have the viewports redrawn that show it."""
        for session in self.sessions:
            session.tag_redraw()

    def _drop(self):
        """Forget what is under way."""
        self._drop_renewal()
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
        self._drop()
        if self.loaded is not None:  # there was a GPU
            self.loaded.free()


def explain(error, report):
    """What a user is told of an exception. The traceback of one that is Conic's fault goes to the log."""
    if is_defect(error):
        report("ERROR", "".join(traceback.format_exception(error)))
    return sentence_of(error)


def scene_of(space, depsgraph, before=None):
    """The `ViewportScene` that a 3D viewport (None outside of a window) shows of a depsgraph. `before`: the one that it
    has shown up to now. One that nobody else shows becomes the new one: most of it may be the same."""
    key = _key(space, depsgraph)
    if before is not None and before.key == key:
        return before
    scene = _scenes.get(key)
    if scene is None:
        alone = (each for each in list(_scenes.values()) if len(each.sessions) == (each is before))
        scene = next((each for each in alone if each.key[0] == key[0]), None)
        if scene is not None:
            del _scenes[scene.key]
            scene.stale = True
    scene = scene or ViewportScene()
    _scenes[key], scene.key = scene, key
    return scene


def mark(depsgraph):
    """Blender says that something changed in a depsgraph: call it in each `view_update`.

    While Blender replaces its data what it says is not looked at: it may refer to what is freed already.
    """
    if _replacing:
        return
    owner = _owner(depsgraph)
    for key, scene in list(_scenes.items()):
        if key[0] == owner:
            scene.mark(depsgraph)


def _owner(depsgraph):
    return depsgraph.scene.session_uid, depsgraph.view_layer.name


def _key(space, depsgraph):
    """What decides which objects a viewport shows. Its own settings are no data of the scene, and nothing promises that
    Blender calls `view_update` for them."""
    if space is None:
        return _owner(depsgraph), ()
    types = tuple(getattr(space, name) for name in _SHOWN_TYPES)
    local = space.local_view is not None, space.use_local_collections
    return _owner(depsgraph), (types, local, space.as_pointer() if any(local) else 0)


# Redraws of viewports that wait for another thread


def _watch_jobs():
    """Have the viewports redrawn whose scenes have been prepared, once they are."""
    if not bpy.app.background and not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=_LOOK_SECONDS)


def _look():
    """Called by a timer; seconds until the next look, None for none. What has been prepared is told once: a viewport
    that pauses does not take it."""
    preparing = [scene for scene in _scenes.values() if scene.preparing]
    prepared = [scene for scene in preparing if scene.prepared]
    for scene in prepared:
        scene.tag_redraw()
    return _LOOK_SECONDS if len(prepared) < len(preparing) else None


# Blender's handlers


@bpy.app.handlers.persistent
def _begin_replacing(*_arguments):
    """Undo and redo replace any data."""
    global _replacing
    _replacing = True


@bpy.app.handlers.persistent
def _begin_loading(*_arguments):
    """Opening a file: nothing of this one comes back."""
    viewport_kept.let_go()
    _begin_replacing()


@bpy.app.handlers.persistent
def _end_replacing(*_arguments):
    """Nothing is as it was."""
    global _replacing
    _replacing = False
    for scene in list(_scenes.values()):
        scene.forget()


def _handlers():
    """(list of Blender's, function) of each handler."""
    for name in ("undo_pre", "redo_pre"):
        yield getattr(bpy.app.handlers, name), _begin_replacing
    yield bpy.app.handlers.load_pre, _begin_loading
    for name in ("undo_post", "redo_post", "load_post", "load_post_fail"):
        yield getattr(bpy.app.handlers, name), _end_replacing


def register():
    global _replacing
    _replacing = False  # where factory settings disabled the add-on, nobody has told it of the end
    for handlers, function in _handlers():
        handlers.append(function)
    viewport_kept.register()


def unregister():
    for handlers, function in _handlers():
        handlers.remove(function)
    viewport_kept.unregister()
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
