# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes that 3D viewports show. Viewports that show the same objects share one: it is read once, and is on the GPU
once. It is freed some time after the last of them."""

import weakref
from typing import NamedTuple

import bpy

from . import kept_scenes, waiting
from .scene import ViewportScene

_SHOWN_TYPES = sorted(
    name for name in bpy.types.SpaceView3D.bl_rna.properties.keys() if name.startswith("show_object_viewport_")
)
_scenes = weakref.WeakValueDictionary()  # by `ViewportScene.key`
_replacing = False  # whether Blender is just replacing its data, by an undo or a file


class Key(NamedTuple):
    """What decides which objects a viewport shows: those of equal keys share a `ViewportScene`. A viewport's own
    settings are no data of the scene, and nothing promises that Blender calls `view_update` for them."""

    scene: int  # its session_uid
    layer: str  # name of the view layer
    types: tuple = ()  # whether it shows each of `_SHOWN_TYPES`
    local: tuple = ()  # of a local view, or of collections shown in this viewport alone: which viewport

    def is_beside(self, other):
        """Whether both are of one depsgraph's scene and layer."""
        return (self.scene, self.layer) == (other.scene, other.layer)


def _key(space, depsgraph):
    """The key of a 3D viewport, None outside of a window."""
    owner = Key(depsgraph.scene.session_uid, depsgraph.view_layer.name)
    if space is None:
        return owner
    local = space.local_view is not None, space.use_local_collections
    return owner._replace(
        types=tuple(getattr(space, name) for name in _SHOWN_TYPES),
        local=(*local, space.as_pointer()) if any(local) else (),
    )


def scene_of(space, depsgraph, before=None):
    """The `ViewportScene` that a 3D viewport (None outside of a window) shows of a depsgraph. `before`: the one that it
    has shown up to now. One that nobody else shows becomes the new one: most of it may be the same."""
    key = _key(space, depsgraph)
    if before is not None and before.key == key:
        return before
    scene = _scenes.get(key)
    if scene is None:
        alone = (each for each in list(_scenes.values()) if len(each.sessions) == (each is before))
        scene = next((each for each in alone if each.key.is_beside(key)), None)
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
    changed = _key(None, depsgraph)
    for key, scene in list(_scenes.items()):
        if key.is_beside(changed):
            scene.mark(depsgraph)


# Blender's handlers


@bpy.app.handlers.persistent
def _begin_replacing(*_arguments):
    """Undo and redo replace any data."""
    global _replacing
    _replacing = True


@bpy.app.handlers.persistent
def _begin_loading(*_arguments):
    """Opening a file: nothing of this one comes back."""
    kept_scenes.let_go()
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
    kept_scenes.register()


def unregister():
    for handlers, function in _handlers():
        handlers.remove(function)
    kept_scenes.unregister()
    waiting.unregister()
