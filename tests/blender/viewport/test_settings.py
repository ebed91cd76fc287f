"""Settings: the scene's for the viewport, and what each viewport hides or cuts off."""

import bpy
import numpy as np
import pytest

from tests.blender.viewport.stand_in import HEIGHT, WIDTH, add_lamp, draws, loads, sphere_at


def test_pause_keeps_the_picture_and_turning_shows_a_coarse_one(view):
    view.settle()
    settings = bpy.context.scene.conic
    settings.preview_pause = True
    bpy.context.object.location.x = 1.0
    assert not view.redraw() and "Paused" in view.engine.text
    assert sphere_at(view.pixels())[0] == pytest.approx(WIDTH / 2, abs=0.25)
    view.look_from(-1.0)
    assert not view.redraw() and draws()[-1].began
    assert sphere_at(view.pixels())[0] == pytest.approx(WIDTH / 2 + WIDTH / 6, abs=3.0)
    settings.preview_pause = False
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 + WIDTH / 3, abs=0.5)
    assert draws()[-1].finished and "Paused" not in view.engine.text


@pytest.mark.parametrize("name, value", [("preview_samples", 1), ("max_depth", 2), ("shadows", "OPAQUE"), ("seed", 5)])
def test_a_setting_of_the_picture_is_a_change(view, name, value):
    view.settle()
    setattr(bpy.context.scene.conic, name, value)
    view.settle()
    assert len(loads()) == 2


def test_a_setting_of_the_viewport_is_none(view):
    view.settle()
    bpy.context.scene.conic.preview_frame_seconds = 0.1
    view.settle()
    assert len(loads()) == 1


@pytest.fixture
def space():
    """The 3D viewport of the factory window, and what an operator in it needs."""
    screen = bpy.context.window_manager.windows[0].screen
    area = next(area for area in screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=region):
        yield area.spaces.active


def test_types_that_a_viewport_hides_are_not_drawn_without_an_update(view, space):
    view.space_data = space
    assert sphere_at(view.settle())[1] > 0
    space.show_object_viewport_mesh = False
    view.redraw()
    assert not (view.settle()[..., 0] < 0.5).any()
    space.show_object_viewport_mesh = True
    assert sphere_at(view.settle())[1] > 0
    assert len(loads()) == 3


def test_local_view_shows_its_objects_without_an_update(view, space):
    view.space_data = space
    add_lamp()
    bpy.ops.conic.sphere_add(location=(2.0, 0.0, 0.0), radius=0.5)
    both = sphere_at(view.settle())[1]
    bpy.ops.view3d.localview()
    column, area = sphere_at(view.settle())
    assert "warning" not in view.engine.text, "the scene's lamp lights the local view too"
    assert area < 0.5 * both and column == pytest.approx(WIDTH / 2 + WIDTH / 3, abs=0.5)
    bpy.ops.view3d.localview()
    assert sphere_at(view.settle())[1] == both


def test_only_the_border_is_drawn(view, space):
    view.space_data = space
    whole = view.settle()
    space.use_render_border = True
    space.render_border_min_x, space.render_border_max_x = 0.25, 0.75
    space.render_border_min_y, space.render_border_max_y = 0.5, 0.75
    part = view.settle()
    x, y, right, top = WIDTH // 4, HEIGHT // 2, 3 * WIDTH // 4, 3 * HEIGHT // 4
    assert np.array_equal(part[y:top, x:right], whole[y:top, x:right])
    part[y:top, x:right] = 0.0
    assert not part.any()
    space.use_render_border = False
