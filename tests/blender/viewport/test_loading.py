"""A changed scene is prepared in another thread, while what was loaded before is shown."""

import time

import bpy
import pytest

from addon.engine import LoadedScene, loaded_scene
from addon.engine.packing import pack
from addon.viewport import scenes, waiting
from addon.viewport.pace import MOST_BEFORE_FIRST
from addon.viewport.scene import ViewportScene
from tests.blender.viewport.gate import Gate
from tests.blender.viewport.stand_in import WIDTH, loads, sphere_at


def test_the_old_scene_can_be_turned_while_the_new_one_is_prepared(view, monkeypatch):
    view.settle()
    gate = Gate(monkeypatch, LoadedScene, "prepare")
    bpy.context.object.location.x = 1.0
    view.redraw()
    assert view.session.waiting and "Loading" in view.engine.text
    assert sphere_at(view.pixels())[0] == pytest.approx(WIDTH / 2, abs=0.25)
    view.look_from(-1.0)
    while view.redraw():
        pass
    assert view.session.waiting and sphere_at(view.pixels())[0] == pytest.approx(WIDTH / 2 + WIDTH / 6, abs=0.5)
    bpy.context.object.location.x = 0.5  # and again
    view.redraw()
    gate.opened.set()
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 + 1.5 * WIDTH / 6, abs=0.5)
    assert "Loading" not in view.engine.text


def test_a_viewport_may_close_while_its_scene_is_prepared(view, monkeypatch):
    view.settle()
    gate = Gate(monkeypatch, LoadedScene, "prepare")
    bpy.context.object.location.x = 1.0
    view.redraw()
    assert view.session.waiting
    view.close()
    gate.opened.set()
    assert not scenes._scenes


def test_a_viewport_that_pauses_hears_once_of_what_has_been_prepared(view, monkeypatch):
    view.settle()
    gate = Gate(monkeypatch, LoadedScene, "prepare")
    bpy.context.object.location.x = 1.0
    view.redraw()
    bpy.context.scene.conic.preview_pause = True
    assert waiting._look() is not None
    gate.opened.set()
    while not view.session.scene.prepared:
        time.sleep(0.001)
    before = view.engine.redraws
    assert waiting._look() is None and view.engine.redraws == before + 1
    bpy.context.scene.conic.preview_pause = False
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 + WIDTH / 6, abs=0.5)


def test_what_an_undo_has_replaced_is_not_prepared_to_the_end(view, monkeypatch):
    view.settle()
    asked = []

    def ask(*arguments, stopped, **settings):
        asked.append(stopped())
        return pack(*arguments, stopped=stopped, **settings)

    monkeypatch.setattr(loaded_scene, "pack", ask)
    gate = Gate(monkeypatch, loaded_scene, "pack")
    bpy.context.object.location.x = 1.0
    view.redraw()
    scenes._begin_replacing()
    scenes._end_replacing()
    bpy.context.object.location.x = -1.0
    gate.opened.set()
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 - WIDTH / 6, abs=0.5)
    assert asked == [True, False] and not any(load.error for load in loads())


def test_what_is_prepared_for_nobody_keeps_nothing_on_the_gpu(view, monkeypatch):
    """Its thread must not be the one that frees textures."""
    view.settle()
    gate = Gate(monkeypatch, loaded_scene, "pack")
    bpy.context.object.location.x = 1.0
    view.redraw()
    assert gate.reached.wait(60.0)
    drawn = view.session.scene.loaded.drawn
    assert drawn.textures
    view.close()
    assert not drawn.textures
    gate.opened.set()


def test_without_a_picture_loading_may_take_longer_at_a_time(view, monkeypatch):
    """Nobody waits for a redraw then."""
    given, renew = [], ViewportScene.renew

    def watch(scene, depsgraph, shown, space, seconds, patience):
        given.append(seconds)
        renew(scene, depsgraph, shown, space, seconds, patience)

    monkeypatch.setattr(ViewportScene, "renew", watch)
    view.redraw()
    assert given == [MOST_BEFORE_FIRST]
    view.settle()
    view.look_from(1.0)
    view.redraw()
    assert given[-1] < MOST_BEFORE_FIRST
