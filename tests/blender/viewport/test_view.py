"""What a region shows: the camera's frame and borders in it, and where the picture of one view lies in another."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from addon.engine.scene import Camera
from addon.sync.camera import camera_of_view
from addon.viewport.view import View, border_in_region, view_of

SIZE = 400, 300
EYE = (3.0, -7.0, 4.0)
TARGET = (0.3, 0.2, 0.1)


def random_points(count, seed=5):
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (count, 3))


def window_points(camera, points):
    """Where points (n, 3) are seen on a camera's window, (n, 2), in float64."""
    matrix = np.asarray(camera.matrix, float)
    local = (points - matrix[:3, 3]) @ matrix[:3, :3]
    return local[:, :2] if camera.orthographic else local[:, :2] / -local[:, 2:]


def view(camera, size=SIZE, border=None, pixel_size=1):
    return View(camera, size, border or (0, 0, *size), pixel_size)


# Where the picture of one view lies in another


@pytest.mark.parametrize("angle", [20.0, 60.0])
def test_zoom_and_resize_about_one_eye_move_nothing(angle):
    first, second = (Camera.look_at(EYE, TARGET, angle=each, aspect=4 / 3) for each in (40.0, angle))
    assert np.array_equal(view(second, (300, 500)).shift_from(view(first)), (0.0, 0.0))


def test_panning_parallel_rays_moves_what_was_seen():
    first = Camera.orthographic_at(EYE, TARGET, 6.0, aspect=4 / 3)
    matrix = np.array(first.matrix, float)
    matrix[:3, 3] += matrix[:3, :3] @ (0.7, -0.3, 2.0)
    second = Camera(matrix, (-1.0, 2.0, -1.5, 0.5), True, first.clip)
    points = random_points(20)
    shift = view(second).shift_from(view(first))
    assert np.allclose(window_points(first, points) + shift, window_points(second, points), atol=1e-9)


def test_no_shift_where_what_is_seen_depends_on_its_distance():
    camera = Camera.look_at(EYE, TARGET)
    others = (
        Camera.look_at((3.0, -7.0, 4.1), (0.3, 0.2, 0.2)),
        Camera.look_at(EYE, (0.3, 0.3, 0.1)),
        Camera.orthographic_at(EYE, TARGET, 6.0),
    )
    assert [view(other).shift_from(view(camera)) for other in others] == [None] * 3


@pytest.mark.parametrize("step, pixel_size", [(1, 1), (4, 1), (16, 1), (8, 2), (1, 3)])
def test_a_raster_covers_the_border(step, pixel_size):
    border = (37, 101, 203, 55)
    found = view(Camera.look_at(EYE, TARGET), border=border, pixel_size=pixel_size)
    size, (x, y, width, height) = found.raster(step)
    scale = np.array(size) / SIZE
    assert np.allclose(1.0 / scale, step * pixel_size, rtol=0.05)
    assert x >= 0 and y >= 0 and x + width <= size[0] and y + height <= size[1]
    assert (np.array([x, y]) <= np.array(border[:2]) * scale).all()
    assert (np.array([x + width, y + height]) >= np.add(border[:2], border[2:]) * scale - 1e-9).all()
    left, right, bottom, top = found.part(size, (x, y, width, height))
    window = found.camera.window
    assert left == pytest.approx(window[0] + (window[1] - window[0]) * x / size[0])
    assert top == pytest.approx(window[2] + (window[3] - window[2]) * (y + height) / size[1])
    assert left < right and bottom < top


# The camera's frame in a region


def camera_view(kind, zoom, offset):
    """(Scene's camera, region_data) of a viewport that looks through it: the frame is `zoom` of the region's height,
    its middle `offset` (x, y) off the region's, in parts of that."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 1600, 900
    bpy.ops.object.camera_add(location=EYE, rotation=(1.0, 0.2, 0.5))
    camera = scene.camera = bpy.context.object
    camera.scale = (2.0, 2.0, 2.0)
    camera.data.type, camera.data.shift_x, camera.data.shift_y = kind, 0.15, -0.1
    depsgraph = bpy.context.evaluated_depsgraph_get()
    frame = np.array(camera.calc_matrix_camera(depsgraph, x=1600, y=900))
    to_region = np.diag([zoom * (1600 / 900) / (SIZE[0] / SIZE[1]), zoom, 1.0, 1.0])
    to_region[:2, 3] = np.multiply(offset, 2.0)
    rigid = np.array(camera.matrix_world.normalized())
    region_data = SimpleNamespace(
        view_perspective="CAMERA",
        is_perspective=kind == "PERSP",
        view_matrix=np.linalg.inv(rigid),
        window_matrix=to_region @ frame,
    )
    return camera, region_data


@pytest.fixture
def space():
    return SimpleNamespace(
        use_local_camera=False,
        camera=None,
        use_render_border=False,
        **{f"render_border_{end}_{axis}": value for end, value in (("min", 0.0), ("max", 1.0)) for axis in "xy"},
    )


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("zoom, offset", [(0.5, (0.0, 0.0)), (0.6, (0.1, -0.05)), (3.0, (0.2, 0.3))])
def test_the_border_of_the_camera_lies_in_its_frame(kind, zoom, offset, space):
    _, region_data = camera_view(kind, zoom, offset)
    render = bpy.context.scene.render
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.5, 1.0
    depsgraph = bpy.context.evaluated_depsgraph_get()
    x, y, width, height = border_in_region(SIZE, region_data, space, depsgraph)
    across, up = zoom * (1600 / 900) * SIZE[1], zoom * SIZE[1]
    middle = (0.5 + np.array(offset)) * SIZE
    low = np.clip(np.add(middle, (-0.25 * across, 0.0)), 0, SIZE)
    high = np.clip(np.add(middle, (0.25 * across, 0.5 * up)), 0, SIZE)
    assert np.allclose((x, y), low, atol=1.01) and np.allclose((x + width, y + height), high, atol=1.01)


def test_the_border_of_the_viewport_is_its_own(space):
    region_data = SimpleNamespace(view_perspective="PERSP")
    bpy.context.scene.render.use_border = True  # the camera's
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert border_in_region(SIZE, region_data, space, depsgraph) == (0, 0, *SIZE)
    space.use_render_border, space.render_border_min_x, space.render_border_max_y = True, 0.25, 0.5
    assert border_in_region(SIZE, region_data, space, depsgraph) == (100, 0, 300, 150)


def test_a_border_outside_of_the_region_is_empty(space):
    _, region_data = camera_view("PERSP", 0.5, (2.0, 0.0))
    bpy.context.scene.render.use_border = True
    context = SimpleNamespace(
        region=SimpleNamespace(width=SIZE[0], height=SIZE[1]), region_data=region_data, space_data=space
    )
    assert view_of(context, bpy.context.evaluated_depsgraph_get(), 1).is_empty


def test_without_a_camera_all_is_drawn(space):
    bpy.context.scene.render.use_border = True
    region_data = SimpleNamespace(view_perspective="CAMERA")
    assert border_in_region(SIZE, region_data, space, bpy.context.evaluated_depsgraph_get()) == (0, 0, *SIZE)


def test_a_view_is_another_where_anything_of_it_is():
    camera = Camera.look_at(EYE, TARGET)
    same = view(Camera.look_at(EYE, TARGET))
    assert view(camera).key == same.key
    others = [
        view(Camera.look_at(EYE, TARGET, angle=44.0)),
        view(Camera.look_at(EYE, TARGET, clip=(0.1, 9.0))),
        view(camera, (401, 300)),
        view(camera, border=(0, 0, 10, 10)),
        view(camera, pixel_size=2),
    ]
    assert same.key not in [other.key for other in others]


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
def test_the_view_through_a_camera_sees_what_the_camera_sees(kind):
    """The frame's edges on the camera's window, found from the viewport's own matrices."""
    camera, region_data = camera_view(kind, 0.5, (0.0, 0.0))
    found = camera_of_view(SimpleNamespace(width=SIZE[0], height=SIZE[1]), region_data)
    assert found.orthographic == (kind == "ORTHO")
    corners = np.array(
        [tuple(camera.matrix_world.normalized() @ c) for c in camera.data.view_frame(scene=bpy.context.scene)]
    )
    seen = window_points(found, corners)
    left, right, bottom, top = found.window
    place = (seen - (left, bottom)) / (right - left, top - bottom)
    assert np.allclose(place.min(axis=0)[1], 0.25, atol=1e-4) and np.allclose(place.max(axis=0)[1], 0.75, atol=1e-4)
