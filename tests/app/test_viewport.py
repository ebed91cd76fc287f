"""The rendered viewport in Blender's window, turned and zoomed by mouse and keyboard. Its pictures stay in
build/app-viewport."""

import shutil

import numpy as np
import pytest

from tests.app.viewport_scene import BLUE, GREEN, assert_only_turned, ball, log, middle

pytestmark = pytest.mark.skipif(
    not (shutil.which("Xvfb") and shutil.which("xdotool")), reason="Xvfb or xdotool is not installed"
)


# Turning


def test_orbit(rested):
    before = ball(rested.picture("start"), BLUE)
    x, y = middle(rested)
    rested.drag(2, (x, y), *[(x + 6 * k, y + 2 * k) for k in range(30)], after=lambda: rested.picture("orbiting"))
    moving = log(rested)
    assert moving["began"] >= 5
    rested.rest()
    after = ball(rested.picture("orbited"), BLUE)
    still = log(rested)
    for found in (moving, still):
        assert_only_turned(found)
    assert still["finished"] and still["samples"][-1] == 4
    assert np.abs(np.subtract(before, after)).max() > 10


def test_zoom_by_the_wheel(rested):
    before = ball(rested.picture(), GREEN)
    rested.move(*middle(rested))
    rested.wheel(4)
    rested.rest()
    assert ball(rested.picture("zoomed"), GREEN)[2] > 1.3 * before[2]
    assert_only_turned(log(rested))
    rested.wheel(-4)


def test_orthographic(rested):
    rested.key("KP_5")
    rested.rest()
    rested.picture("orthographic")
    assert_only_turned(log(rested))
    x, y = middle(rested)
    rested.key("shift", down=True)
    rested.drag(2, (x, y), *[(x + 4 * k, y) for k in range(20)])
    rested.key("shift", down=False)
    found = log(rested)
    assert_only_turned(found)
    assert found["kept"] >= 1, "what was seen moves along"
    rested.rest()
    rested.picture("panned")
    rested.key("KP_5")


# The camera's view and borders


def test_camera_view_with_its_frame(rested):
    rested.run("bpy.context.scene.camera.data.passepartout_alpha = 0.9")
    rested.key("KP_0")
    rested.rest()
    camera = rested.picture("camera")
    assert_only_turned(log(rested))
    rested.wheel(2)
    rested.rest()
    zoomed = rested.picture("camera zoomed")
    found = log(rested)
    assert_only_turned(found)
    assert found["kept"] >= 1
    assert ball(zoomed, GREEN)[2] > 1.1 * ball(camera, GREEN)[2]
    rested.wheel(-2)


def test_border_in_the_camera_view(rested):
    x, y = middle(rested)
    rested.run("bpy.ops.object.select_all(action='DESELECT')")  # no outline
    rested.key("KP_0")
    rested.rest()
    before = rested.picture()
    rested.key("ctrl+b")
    rested.drag(1, (x - 60, y - 40), (x, y), (x + 50, y + 40))
    rested.rest()
    shown = rested.picture("camera border")
    assert rested.run("result = bpy.context.scene.render.use_border")
    found = log(rested)
    assert_only_turned(found)
    inside = np.abs(shown - before)[y - 34 : y + 34, x - 54 : x + 44]
    assert (inside.max(axis=-1) > 0.1).mean() < 0.02, "within it nothing changes"
    outside = shown[y - 34 : y + 34, x + 60 : x + 100]
    assert outside.std(axis=(0, 1)).max() < 0.03, "beside it nothing is drawn"
    rested.key("ctrl+alt+b")
    rested.rest()
    rested.key("KP_0")


def test_border_of_the_viewport(rested):
    x, y = middle(rested)
    rested.key("ctrl+b")
    rested.drag(1, (x - 90, y - 50), (x, y), (x + 90, y + 50))
    rested.rest()
    rested.picture("border")
    assert rested.run("result = view().use_render_border")
    assert_only_turned(log(rested))
    rested.drag(2, (x, y), *[(x - 4 * k, y) for k in range(20)])
    rested.rest()
    rested.picture("border orbited")
    rested.key("ctrl+alt+b")
    rested.rest()
    rested.picture("border gone")
