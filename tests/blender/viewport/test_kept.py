"""Scenes that nobody shows are kept for whoever comes back soon."""

import time
import weakref

import bpy
import numpy as np
import pytest

from addon.viewport import kept_scenes, scenes
from tests.blender.viewport.stand_in import StandIn, loads, mark


@pytest.fixture
def kept(view, monkeypatch):
    """kept_scenes as in a window, but that nobody looks."""
    monkeypatch.setattr(kept_scenes, "keep", lambda scene: kept_scenes._kept.update({scene: time.monotonic()}))
    yield kept_scenes
    kept_scenes._kept.clear()


def test_who_comes_back_finds_the_scene_and_what_has_changed(kept, view):
    before = view.settle()
    loaded = view.session.scene.loaded
    view.close()
    again = StandIn()
    count = len(loads())
    assert np.array_equal(again.settle(), before) and again.session.scene.loaded is loaded
    assert len(loads()) == count, "nothing was loaded again"
    again.close()
    bpy.app.handlers.depsgraph_update_post.remove(mark)  # no viewport, no `view_update`
    bpy.context.object.location.x = 1.0
    bpy.context.view_layer.update()
    bpy.app.handlers.depsgraph_update_post.append(mark)
    again = StandIn()
    assert not np.array_equal(again.settle(), before) and again.session.scene.loaded is loaded
    again.close()


def test_scenes_are_kept_for_a_while(kept, view, monkeypatch):
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    bpy.context.scene.render.engine = "CONIC"
    view.redraw()
    now[0] += 100.0
    scene = weakref.ref(view.session.scene)
    assert kept._look() and len(kept._kept) == 1, "it is shown"
    view.close()
    now[0] += 0.9 * kept.SECONDS
    assert kept._look() and scene()
    now[0] += 0.2 * kept.SECONDS
    assert kept._look() is None and not scene()


@pytest.mark.parametrize("end", ["render", "load", "another engine"])
def test_scenes_are_not_kept(kept, view, end):
    bpy.context.scene.render.engine = "CONIC"
    view.redraw()
    scene = weakref.ref(view.session.scene)
    view.close()
    if end == "render":
        kept._before_render()
    elif end == "load":
        scenes._begin_loading()
        scenes._end_replacing()
    else:
        bpy.context.scene.render.engine = "BLENDER_WORKBENCH"
    assert kept._look() is None and not scene()
