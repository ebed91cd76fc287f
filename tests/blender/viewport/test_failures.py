"""What goes wrong is told in the viewport and in the log, and the next change or redraw tries again."""

import gc
import weakref

import bpy
import pytest

from addon.engine import DeviceError, LoadedScene, SceneError
from addon.engine.devices.blender_gpu import BlenderDevice
from addon.sync.scene_reader import SceneReader
from addon.viewport import session
from addon.viewport.picture import ViewportPicture
from tests.blender.viewport.stand_in import WIDTH, add_lamp, draws, sphere_at


def test_a_viewport_without_a_gpu_says_so(view, monkeypatch):
    def scene_of(*_arguments):
        raise DeviceError("Blender has no GPU context here")

    monkeypatch.setattr(session, "scene_of", scene_of)
    assert not view.redraw()
    assert view.engine.text == "Blender has no GPU context here"


def test_an_error_is_shown_and_the_next_change_tries_again(view, monkeypatch):
    def refuse(*_arguments, **_settings):
        raise SceneError("this cannot be")

    for loaded in (False, True):
        with monkeypatch.context() as patched:
            patched.setattr(SceneReader, "read", refuse)
            bpy.context.object.location.x = 1.0
            view.settle()
            assert view.engine.text == "this cannot be"
            assert not view.redraw(), "it does not try again and again"
            assert (view.pixels()[..., 3] > 0.0).all() == loaded, "what was there is shown"
        bpy.context.object.location.x = 0.0
        assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2, abs=0.25)


@pytest.mark.parametrize(
    "error, words",
    [(ValueError("shapes do not fit"), "ValueError: shapes do not fit"), (MemoryError(), "not enough memory")],
)
@pytest.mark.parametrize(
    "owner, name",
    [(SceneReader, "read"), (LoadedScene, "prepare"), (LoadedScene, "apply"), (session, "view_of")],
)
def test_a_defect_is_shown_and_its_traceback_logged_once(view, monkeypatch, caplog, owner, name, error, words):
    def fail(*_arguments, **_settings):
        raise type(error)(*error.args)

    with monkeypatch.context() as patched:
        patched.setattr(owner, name, fail)
        for x in (1.0, 2.0, 3.0):
            bpy.context.object.location.x = x
            view.settle()
            assert words in view.engine.text
    traces = [record for record in caplog.records if "Traceback" in record.getMessage()]
    assert len(traces) == (0 if isinstance(error, MemoryError) else 1)
    bpy.context.object.location.x = 0.0
    assert sphere_at(view.settle())[1] > 0


@pytest.mark.parametrize("owner, name", [(SceneReader, "read"), (LoadedScene, "prepare"), (LoadedScene, "apply")])
def test_a_scene_that_failed_is_freed_with_its_viewport(view, monkeypatch, owner, name):
    """At once: a search for garbage may be in a thread that must not free textures."""

    def fail(*_arguments, **_settings):
        raise SceneError("this cannot be")

    view.settle()
    monkeypatch.setattr(owner, name, fail)
    bpy.context.object.location.x = 1.0
    view.settle()
    assert view.session.error == "this cannot be"
    scene = weakref.ref(view.session.scene)
    gc.disable()
    try:
        view.close()
        assert scene() is None
    finally:
        gc.enable()


def test_a_picture_that_there_is_no_memory_for_is_tried_again(view, monkeypatch):
    def refuse(*_arguments):
        raise DeviceError("no memory for a picture")

    view.settle()
    with monkeypatch.context() as patched:
        patched.setattr(BlenderDevice, "target", refuse)
        view.look_from(1.0)
        for _ in range(2):
            assert not view.redraw() and view.engine.text == "no memory for a picture"
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 - WIDTH / 6, abs=0.5)


def test_the_count_of_warnings_is_that_of_the_scene_as_it_is(view, caplog):
    """A broken lamp, and so no light; mended; broken again, which is told again."""
    lamp = add_lamp()
    for energy, count in ((float("nan"), 2), (10.0, 0), (float("nan"), 2)):
        caplog.clear()
        lamp.data.energy = energy
        view.settle()
        assert (f"{count} warnings" in view.engine.text) == (count > 0)
        assert ("warning" in view.engine.text) == (count > 0)
        assert len(caplog.records) == count
        bpy.context.object.update_tag()  # read once more: nothing is said twice
        view.settle()
        assert len(caplog.records) == count


def test_a_picture_that_fails_between_redraws_is_reported_once(view, monkeypatch):
    def fail(*_arguments):
        raise DeviceError("lost")

    view.settle()
    view.look_from(1.0)
    view.redraw()
    with monkeypatch.context() as patch:
        patch.setattr(ViewportPicture, "advance", fail)
        before = view.engine.redraws
        assert not view.session.trace() and view.engine.redraws == before + 1
        assert not view.session.trace(), "nothing is left of it"
    assert not view.redraw() and "lost" in view.engine.text
    view.settle()
    assert draws()[-1].finished and "lost" not in view.engine.text
