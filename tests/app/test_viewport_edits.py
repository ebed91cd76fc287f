"""What edits and settings do to a rendered viewport in Blender's window. Its pictures stay in build/app-viewport."""

import shutil
import time

import numpy as np
import pytest

from tests.app.viewport_scene import BLUE, RED, assert_only_turned, ball, changes, far, log, middle, region

pytestmark = pytest.mark.skipif(
    not (shutil.which("Xvfb") and shutil.which("xdotool")), reason="Xvfb or xdotool is not installed"
)


def select(window, name):
    """Select one object alone."""
    window.run(
        """
        for each in bpy.context.view_layer.objects:
            each.select_set(each.name == name)
        bpy.context.view_layer.objects.active = bpy.data.objects[name]
        """,
        name=name,
    )


# Edits


def test_selecting_does_not_begin_anew(rested):
    select(rested, "red")
    rested.rest()
    rested.run("view().overlay.show_overlays = False; bpy.context.area.tag_redraw() if bpy.context.area else None")
    rested.rest()
    rested.run("view().overlay.show_overlays = True")
    rested.rest()
    found = log(rested)
    assert not changes(found) and not found["began"]


def test_moving_an_object_with_the_mouse_and_undo(rested):
    select(rested, "blue")
    before = ball(rested.picture(), BLUE)
    x, y = middle(rested)
    rested.key("g")
    for k in range(12):
        rested.move(x + 5 * k, y + 2 * k)
        time.sleep(0.05)  # each is to be a step of its own
    rested.picture("moving")
    rested.key("Return")
    rested.rest()
    found = log(rested)
    assert len(changes(found)) >= 2 and found["finished"]
    moved = ball(rested.picture("moved"), BLUE)
    assert far(before, moved) > 20
    rested.key("ctrl+z")
    rested.rest()
    assert far(before, ball(rested.picture("undone"), BLUE)) < 1
    rested.key("ctrl+shift+z")
    rested.rest()
    assert far(moved, ball(rested.picture("redone"), BLUE)) < 1
    rested.key("ctrl+z")
    rested.rest()
    print(log(rested)["loads"])


def test_a_color_is_another_value_of_a_material(rested):
    found = []
    for color in ((0.02, 0.02, 0.9, 1.0), (0.8, 0.02, 0.02, 1.0)):
        node = "bpy.data.materials['red'].node_tree.nodes['Principled BSDF']"
        rested.run(f"{node}.inputs['Base Color'].default_value = {color}")
        rested.rest()
        found.append((changes(log(rested)), bool(ball(rested.picture("colored"), RED))))
    assert found == [(["FILM|MATERIALS"], False), (["FILM|MATERIALS"], True)]


def test_local_view(rested):
    select(rested, "red")
    rested.key("slash")
    rested.rest()
    local = rested.picture("local view")
    assert ball(local, RED) and not ball(local, BLUE)
    rested.key("slash")
    rested.rest()
    assert ball(rested.picture("local view left"), BLUE)
    print(log(rested))


def test_objects_hidden_and_shown(rested):
    select(rested, "red")
    rested.key("h")
    rested.rest()
    assert not ball(rested.picture("hidden"), RED)
    rested.key("alt+h")
    rested.rest()
    assert ball(rested.picture("shown again"), RED)
    print(log(rested))


def test_playing_an_animation(rested):
    rested.run("""
        blue = bpy.data.objects["blue"]
        for frame, z in ((1, 0.0), (20, 2.0)):
            blue.location.z = z
            blue.keyframe_insert("location", index=2, frame=frame)
        bpy.context.scene.frame_end = 20
        bpy.context.scene.frame_set(1)
    """)
    rested.rest()
    before = ball(rested.picture(), BLUE)
    records = log(rested)
    rested.run("bpy.context.scene.frame_set(20)")
    rested.rest()
    assert far(before, ball(rested.picture("frame 20"), BLUE)) > 20
    log(rested)
    rested.key("space")
    rested.wait_until(lambda: rested.run("result = sum(r.began for r in records if isinstance(r, Draw))") > 20)
    rested.key("space")
    rested.rest()
    records = log(rested)
    assert len(changes(records)) > 10
    rested.run("bpy.data.objects['blue'].animation_data_clear(); bpy.data.objects['blue'].location.z = 0.0")


# Settings of the viewport


def test_pause(rested):
    rested.run("bpy.context.scene.conic.preview_pause = True")
    rested.rest(0.5)
    before = rested.picture("paused")
    log(rested)
    x, y = middle(rested)
    rested.drag(2, (x, y), *[(x + 6 * k, y) for k in range(20)])
    rested.rest()
    found = log(rested)
    assert found["began"] and not found["finished"] and not changes(found)
    assert far(ball(before, BLUE), ball(rested.picture("turned while paused"), BLUE)) > 10
    rested.run("bpy.context.scene.conic.preview_pause = False")
    rested.rest()
    assert log(rested)["finished"]


def test_large_pixels(rested):
    rested.run("bpy.context.scene.render.preview_pixel_size = '8'")
    rested.rest()
    x, y, _, _ = region(rested)
    pixels = rested.picture("pixels of 8")[y + 60 : y + 140, x + 100 : x + 400]
    rested.run("bpy.context.scene.render.preview_pixel_size = 'AUTO'")
    same = (np.abs(np.diff(pixels, axis=1)) < 0.005).all(axis=-1).mean(axis=0)
    assert same.mean() > 0.8 and (same < 0.9).mean() < 0.2, "seven of eight columns are as the one before"


def test_resizing_shows_the_old_picture(rested):
    x, y, width, height = region(rested)
    edge = x + width // 2, y - 2
    rested.drag(1, edge, *[(edge[0], edge[1] + 6 * k) for k in range(16)], after=lambda: rested.picture("resizing"))
    rested.rest()
    assert region(rested)[3] < height - 40
    found = log(rested)
    assert_only_turned(found)
    assert found["began"] and found["kept"] and found["finished"]
    rested.picture("resized")
    edge = x + width // 2, region(rested)[1] - 2
    rested.drag(1, edge, *[(edge[0], edge[1] - 6 * k) for k in range(16)])
