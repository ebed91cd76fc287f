"""How a render goes on and ends: frames, progress, what is told, what fails, Esc."""

import gc
import weakref

import bpy
import numpy as np
import pytest

from addon import render_session
from addon.engine import Session
from tests.blender.final_render.rendering import WIDTH, is_sphere, rendered
from tests.blender.pictures import picture


def test_animation_renders_each_frame_and_warns_once(scene, tmp_path, watch):
    told = []
    watch(report=lambda level, message: told.append((*level, message)))
    sphere = bpy.data.objects["Sphere"]
    for frame, x in ((1, -1.0), (3, 1.0)):
        sphere.location.x = x
        sphere.keyframe_insert("location", index=0, frame=frame)
    scene.render.use_motion_blur = True
    scene.frame_start, scene.frame_end = 1, 3
    scene.render.filepath = str(tmp_path / "frame_")
    bpy.ops.render.render(animation=True)
    columns = [np.nonzero(is_sphere(picture(tmp_path / f"frame_000{f}.exr")))[1].mean() for f in (1, 2, 3)]
    np.testing.assert_allclose(np.array(columns) + 0.5 - WIDTH / 2, [-WIDTH / 6, 0.0, WIDTH / 6], atol=0.6)
    assert [level for level, message in told if "motion blur" in message] == ["WARNING"]


def test_passes_that_are_not_rendered_are_named(scene, tmp_path, watch):
    told = []
    watch(report=lambda level, message: told.append((*level, message)))
    scene.render.filepath = str(tmp_path / "picture")
    bpy.ops.render.render(write_still=True)
    assert not told
    layer = bpy.context.view_layer
    layer.use_pass_normal, layer.aovs.add().name = True, "mine"
    bpy.ops.render.render(write_still=True)
    ((level, message),) = told
    assert level == "WARNING" and repr(layer.name) in message and message.endswith(": Normal, mine")


def test_scene_without_a_camera_is_an_error_and_no_picture(scene, tmp_path):
    scene.camera = None
    scene.render.filepath = str(tmp_path / "picture.exr")
    with pytest.raises(RuntimeError, match="camera"):
        bpy.ops.render.render(write_still=True)
    assert not list(tmp_path.iterdir())


def test_conics_own_errors_reach_the_user_without_a_traceback(scene, tmp_path, capfd):
    scene.camera.scale = (0.0, 0.0, 0.0)
    scene.view_layers.update()
    scene.camera = bpy.data.objects.new("no camera", None)
    with pytest.raises(RuntimeError, match="camera"):
        rendered(scene, tmp_path)
    assert "Traceback" not in "".join(capfd.readouterr())


@pytest.mark.parametrize(
    "place, error, words, traced",
    [
        ("sync_scene", lambda: ValueError("shapes do not fit"), "ValueError: shapes do not fit", True),
        ("sync_scene", KeyError, "KeyError: see the console", True),
        ("Session", MemoryError, "not enough memory for this scene", False),
    ],
)
def test_whatever_fails_is_an_error_and_no_picture(scene, tmp_path, monkeypatch, capfd, place, error, words, traced):
    def fail(*_arguments, **_settings):
        raise error()  # anew: one that is kept would keep Blender's data in its traceback

    monkeypatch.setattr(render_session, place, fail)
    scene.render.filepath = str(tmp_path / "picture.exr")
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.render.render(write_still=True)
    assert not list(tmp_path.iterdir())
    assert ("Traceback" in "".join(capfd.readouterr())) == traced


def test_an_animation_ends_where_it_fails(scene, tmp_path, monkeypatch):
    def fail_later(depsgraph, *arguments, **settings):
        if depsgraph.scene_eval.frame_current > 1:
            raise ValueError("not this frame")
        return sync_scene(depsgraph, *arguments, **settings)

    sync_scene = render_session.sync_scene
    monkeypatch.setattr(render_session, "sync_scene", fail_later)
    scene.frame_start, scene.frame_end = 1, 3
    scene.render.filepath = str(tmp_path / "frame_")
    with pytest.raises(RuntimeError, match="not this frame"):
        bpy.ops.render.render(animation=True)
    assert [path.name for path in tmp_path.iterdir()] == ["frame_0001.exr"]


def test_nothing_of_the_scene_is_kept_while_it_is_drawn(scene, monkeypatch):
    synced, alive = [], []

    def watched(*arguments, **settings):
        found = sync_scene(*arguments, **settings)
        synced.extend(weakref.ref(kept) for kept in (found, found.shapes))
        return found

    def draw(self, *arguments):
        gc.collect()
        alive.extend(kept() for kept in synced)
        plain_draw(self, *arguments)

    sync_scene, plain_draw = render_session.sync_scene, render_session.LayerRender.draw
    monkeypatch.setattr(render_session, "sync_scene", watched)
    monkeypatch.setattr(render_session.LayerRender, "draw", draw)
    bpy.ops.render.render()
    assert alive == [None, None]


def test_progress_and_partial_results(scene, monkeypatch, watch):
    seen = {"progress": [], "stats": [], "results": []}

    monkeypatch.setattr(render_session, "RESULT_SECONDS", 0.02)
    monkeypatch.setattr(render_session, "STEP_SECONDS", 0.001)
    watch(
        update_progress=seen["progress"].append,
        update_stats=lambda _, text: seen["stats"].append(text),
        update_result=seen["results"].append,
    )
    scene.conic.samples = 1024
    bpy.ops.render.render()
    assert len(seen["results"]) >= 2
    assert seen["progress"] == sorted(seen["progress"]) and seen["progress"][-1] == 1.0
    assert len(seen["progress"]) > 10
    assert any(text.startswith("Sample ") and text.endswith("/1024 | 1 sphere") for text in seen["stats"])


def test_escape_ends_a_render_with_the_step_that_is_drawn(scene, monkeypatch, watch):
    """There are thousands to go; one takes a fraction of a second, whatever the picture."""
    steps, step = [], Session.step

    def counted(session, seconds):
        steps.append(seconds)
        assert len(steps) < 20, "it goes on"
        return step(session, seconds)

    monkeypatch.setattr(Session, "step", counted)
    watch(test_break=lambda: len(steps) == 3)
    scene.render.resolution_x, scene.render.resolution_y = 640, 360
    scene.conic.samples = 65536
    bpy.ops.render.render()
    assert steps == [render_session.STEP_SECONDS] * 3 and steps[0] < 0.2
