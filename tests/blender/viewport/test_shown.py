"""What a viewport shows is Blender's scene as it is now; viewports of one scene share it."""

import gc
import weakref

import bpy
import numpy as np
import pytest

from addon.sync.scene_reader import SceneReader
from addon.viewport import scenes, session
from tests.blender.viewport.stand_in import HEIGHT, WIDTH, draws, loads, sphere_at


def test_it_shows_the_scene_and_comes_to_rest(view):
    column, area = sphere_at(view.settle())
    assert column == pytest.approx(WIDTH / 2, abs=0.25)
    assert area == pytest.approx(np.pi * (WIDTH / 6) ** 2, rel=0.03)
    assert view.engine.text.startswith("Sample 2/2 | 1 sphere | ")
    assert not view.redraw(), "at rest it stays"


def test_turning_the_view_draws_anew_and_uploads_nothing(view, uploads):
    view.settle()
    assert uploads
    uploads.clear()
    view.look_from(1.0)
    assert view.redraw()
    assert draws()[-1].began
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 - WIDTH / 6, abs=0.5)
    assert not uploads and len(loads()) == 1


def test_a_change_is_shown_and_selecting_is_none(view):
    view.settle()
    count = len(draws())
    bpy.context.object.select_set(False)
    view.settle()
    assert len(loads()) == 1 and not any(draw.began for draw in draws()[count:])
    bpy.context.object.location.x = 1.0
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 + WIDTH / 6, abs=0.5)
    assert len(loads()) == 2


def test_viewports_of_one_scene_share_it(view, second, uploads):
    view.settle()
    count = len(uploads)
    second.look_from(1.0)
    shown = sphere_at(second.settle())[0], sphere_at(view.settle())[0]
    assert shown == (pytest.approx(WIDTH / 2 - WIDTH / 6, abs=0.5), pytest.approx(WIDTH / 2, abs=0.25))
    assert len(uploads) == count and len(loads()) == 1
    bpy.context.object.location.x = 1.0
    shown = sphere_at(second.settle())[0], sphere_at(view.settle())[0]
    assert shown == (pytest.approx(WIDTH / 2, abs=0.5), pytest.approx(WIDTH / 2 + WIDTH / 6, abs=0.5))
    assert len(loads()) == 2


def test_a_scene_is_freed_with_its_last_viewport(view, second):
    view.settle()
    second.settle()
    loaded = weakref.ref(view.session.scene.loaded)
    gc.disable()
    try:
        view.close()
        assert loaded() is not None and sphere_at(second.settle())[1] > 0
        second.close()
        assert loaded() is None and not scenes._scenes, "at once, without a search for garbage"
    finally:
        gc.enable()


def test_undo_and_new_files_read_anew(view, monkeypatch):
    forgotten = []
    view.settle()
    monkeypatch.setattr(SceneReader, "forget", lambda self: forgotten.append(self))
    for name in ("undo_post", "redo_post", "load_post"):
        for handler in getattr(bpy.app.handlers, name):
            if handler.__module__ == scenes.__name__:
                handler(bpy.context.scene, None)
    assert len(forgotten) == 3 and not view.session.scene.settled
    view.settle()
    assert len(loads()) == 1, "it was the same"


def test_an_add_on_that_was_disabled_by_a_file_hears_of_changes_when_it_is_enabled(view):
    """As by Load Factory Settings, which takes its handlers away in between."""
    view.settle()
    for handler in list(bpy.app.handlers.load_pre):
        if handler.__module__ == scenes.__name__:
            handler("", None)
    scenes.unregister()
    scenes.register()
    bpy.context.object.location.x = 1.0
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 + WIDTH / 6, abs=0.5)


def test_statistics_are_published_once_for_what_is_loaded(view, monkeypatch):
    published = []
    monkeypatch.setattr(session, "publish", published.append)
    view.settle()
    view.look_from(1.0)
    view.settle()
    (found,) = published
    assert (found.source, found.width, found.height, found.samples) == ("Viewport", WIDTH, HEIGHT, 2)
    assert found.primitives == {"sphere": 1} and found.objects == {"sphere": 1}
    assert found.seconds["read"] < found.seconds["first_picture"]
    bpy.context.object.location.x = 1.0
    view.settle()
    assert len(published) == 2
