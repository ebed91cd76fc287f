"""F12: the whole way from Blender's scene to the written picture, through the RenderEngine."""

import ctypes
import gc
import os
import subprocess
import sys
import time
import weakref
from pathlib import Path

import bpy
import numpy as np
import pytest

from addon import render_engine, render_session
from addon.engine.devices.headless import HeadlessDevice
from tests.blender.pictures import picture

ROOT = Path(__file__).resolve().parents[2]
WIDTH, HEIGHT = 64, 48
SKY = (0.25, 0.5, 1.0)
GLOW = (2.0, 0.5, 0.125)


@pytest.fixture
def scene():
    """A glowing sphere of radius 1 in the middle of an orthographic view 6 wide, in front of a sky of one color."""
    scene = bpy.context.scene
    bpy.ops.object.camera_add(location=(0.0, 0.0, 10.0))
    scene.camera = bpy.context.object
    scene.camera.data.type = "ORTHO"
    scene.camera.data.ortho_scale = 6.0
    bpy.ops.conic.sphere_add()
    bpy.context.object.data.materials.append(glowing())
    scene.world = bpy.data.worlds.new("World")
    nodes_of(scene.world)["Background"].inputs["Color"].default_value = (*SKY, 1.0)
    render = scene.render
    render.engine = "CONIC"
    render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, HEIGHT, 100
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    scene.conic.samples = 1
    return scene


def nodes_of(owner):
    """The nodes of a new material or world, which have them only on demand before 5.0."""
    if bpy.app.version < (5, 0, 0):
        owner.use_nodes = True
    return owner.node_tree.nodes


def glowing(color=GLOW):
    """A material that shines in `color` and reflects nothing."""
    material = bpy.data.materials.new("glowing")
    nodes = nodes_of(material)
    emission = nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (*color, 1.0)
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    material.node_tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material


def rendered(scene, path):
    """Render the scene; its pixels (h, w, 4)."""
    scene.render.filepath = str(path / "picture.exr")
    bpy.ops.render.render(write_still=True)
    return picture(scene.render.filepath)


def is_sphere(pixels):
    """Where the glowing sphere is, (h, w) bool."""
    return pixels[..., 0] > 1.0


def test_picture_is_right_to_the_pixel(scene, tmp_path):
    pixels = rendered(scene, tmp_path)
    x, y = np.meshgrid(np.arange(WIDTH) + 0.5 - WIDTH / 2, np.arange(HEIGHT) + 0.5 - HEIGHT / 2)
    inside = np.hypot(x, y) < WIDTH / 6
    np.testing.assert_array_equal(is_sphere(pixels), inside)
    np.testing.assert_allclose(pixels[inside], [(*GLOW, 1.0)] * inside.sum(), rtol=1e-5)
    np.testing.assert_allclose(pixels[~inside], [(*SKY, 1.0)] * (~inside).sum(), rtol=1e-5)


def test_resolution_percentage(scene, tmp_path):
    scene.render.resolution_percentage = 50
    pixels = rendered(scene, tmp_path)
    assert pixels.shape == (HEIGHT // 2, WIDTH // 2, 4)
    assert is_sphere(pixels).mean() == pytest.approx(np.pi / (6.0 * 4.5), rel=0.05)


def test_transparent_film_is_premultiplied(scene, tmp_path):
    scene.render.film_transparent = True
    scene.conic.samples = 16
    pixels = rendered(scene, tmp_path)
    alpha = pixels[..., 3]
    assert (alpha == 0.0).any() and (alpha == 1.0).any() and ((alpha > 0.0) & (alpha < 1.0)).any()
    np.testing.assert_allclose(pixels[..., :3], alpha[..., None] * np.array(GLOW), atol=1e-5)


def test_samples_smooth_the_edge(scene, tmp_path):
    one = rendered(scene, tmp_path)
    scene.conic.samples = 64
    many = rendered(scene, tmp_path)
    exact = np.pi / (6.0 * 4.5) * (GLOW[0] - SKY[0]) + SKY[0]
    assert abs(many[..., 0].mean() - exact) < 0.002 * exact
    assert abs(many[..., 0].mean() - exact) <= abs(one[..., 0].mean() - exact)
    assert len(np.unique(many[..., 0].round(4))) > 10 > len(np.unique(one[..., 0].round(4)))


@pytest.mark.parametrize("crop", [False, True])
@pytest.mark.parametrize("low, high", [((0.25, 0.25), (0.75, 1.0)), ((0.31, 0.17), (0.77, 0.63))])
def test_border_is_that_part_of_the_picture(scene, tmp_path, low, high, crop):
    scene.conic.samples = 4
    whole = rendered(scene, tmp_path)
    render = scene.render
    render.use_border, render.use_crop_to_border = True, crop
    render.border_min_x, render.border_min_y, render.border_max_x, render.border_max_y = *low, *high
    pixels = rendered(scene, tmp_path)
    x0, y0 = int(np.float32(low[0]) * WIDTH), int(np.float32(low[1]) * HEIGHT)
    x1, y1 = int(np.float32(high[0]) * WIDTH), int(np.float32(high[1]) * HEIGHT)
    expected = whole[y0:y1, x0:x1]
    assert is_sphere(expected).any() and not is_sphere(expected).all()
    if crop:
        np.testing.assert_array_equal(pixels, expected)
    else:
        np.testing.assert_array_equal(pixels[y0:y1, x0:x1], expected)
        outside = np.ones((HEIGHT, WIDTH), bool)
        outside[y0:y1, x0:x1] = False
        assert (pixels[outside][:, :3] == 0.0).all()


def columns_of_eyes(scene, folder, mode):
    """Where the left and the right eye see the sphere's centre, in pixels from the middle of the picture."""
    scene.camera.data.type = "PERSP"
    stereo = scene.camera.data.stereo
    stereo.convergence_mode, stereo.pivot, stereo.interocular_distance = mode, "CENTER", 1.0
    stereo.convergence_distance = 10.0  # where the sphere is
    scene.render.use_multiview, scene.render.image_settings.views_format = True, "INDIVIDUAL"
    scene.render.image_settings.file_format = "PNG"  # before 5.0 Blender cannot read the EXR of an eye
    scene.view_settings.view_transform = "Raw"
    scene.render.filepath = str(folder / "eyes.png")
    bpy.ops.render.render(write_still=True)
    masks = [picture(folder / f"eyes_{eye}.png")[..., 0] > 0.9 for eye in "LR"]
    return [np.nonzero(mask)[1].mean() + 0.5 - WIDTH / 2 for mask in masks]


def test_parallel_eyes_see_from_two_places(scene, tmp_path):
    left, right = columns_of_eyes(scene, tmp_path, "PARALLEL")
    shift = 0.5 / 10.0 * scene.camera.data.lens / scene.camera.data.sensor_width * WIDTH
    assert (left, right) == (pytest.approx(shift, abs=0.5), pytest.approx(-shift, abs=0.5))


@pytest.mark.parametrize("mode", ["OFFAXIS", "TOE"])
def test_converging_eyes_see_what_they_converge_on_in_the_same_place(scene, tmp_path, mode):
    assert columns_of_eyes(scene, tmp_path, mode) == [pytest.approx(0.0, abs=0.5)] * 2


def test_each_view_layer_has_its_own_objects(scene, tmp_path):
    bpy.ops.conic.sphere_add(location=(-2.0, 0.0, 0.0), radius=0.5)
    left = bpy.context.object
    left.data.materials.append(glowing())
    collection = bpy.data.collections.new("left")
    scene.collection.children.link(collection)
    scene.collection.objects.unlink(left)
    collection.objects.link(left)
    without = scene.view_layers.new("Without")
    without.layer_collection.children["left"].exclude = True
    if hasattr(scene.render.image_settings, "media_type"):
        scene.render.image_settings.media_type = "MULTI_LAYER_IMAGE"
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.filepath = str(tmp_path / "layers.exr")
    bpy.ops.render.render(write_still=True)
    red = {name: red_of(tmp_path / "layers.exr", name) for name in (scene.view_layers[0].name, "Without")}
    assert (red["Without"][:, : WIDTH // 4] > 1.0).sum() == 0
    assert (red[scene.view_layers[0].name][:, : WIDTH // 4] > 1.0).sum() > 50
    assert (red["Without"][:, WIDTH // 3 :] == red[scene.view_layers[0].name][:, WIDTH // 3 :]).all()


def red_of(path, layer):
    """The red of a layer's Combined pass in a multilayer EXR, (h, w)."""
    OpenEXR = pytest.importorskip("OpenEXR", reason="reads layers, which Blender does not; not in the application")  # noqa: N806
    with OpenEXR.File(str(path), separate_channels=True) as file:
        for part in file.parts:
            for name, channel in part.channels.items():
                if name.startswith(f"{layer}.Combined") and name.endswith(".R"):
                    return channel.pixels
    raise AssertionError(f"{path} has no layer {layer}")


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


class Watched:
    """A RenderEngine some of whose methods are replaced: Blender's own come before those that a class is given."""

    def __init__(self, engine, methods):
        self._engine, self._methods = engine, methods

    def __getattr__(self, name):
        return self._methods.get(name) or getattr(self._engine, name)


@pytest.fixture
def watch(monkeypatch):
    """Call it with methods by name, to have them called in place of the engine's."""

    def replace(**methods):
        monkeypatch.setattr(
            render_engine,
            "render_layer",
            lambda engine, depsgraph: render_session.render_layer(Watched(engine, methods), depsgraph),
        )

    return replace


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


def test_a_glass_ball_behind_a_pane_of_the_same_glass_is_seen(scene, tmp_path):
    """The pane is a sheet: beyond it there is air, in which the ball bends light as it does without the pane."""
    glass = bpy.data.materials.new("glass")
    nodes = nodes_of(glass)
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    glass.node_tree.links.new(nodes.new("ShaderNodeBsdfGlass").outputs[0], output.inputs["Surface"])
    nodes["Glass BSDF"].inputs["IOR"].default_value = 1.5
    nodes["Glass BSDF"].inputs["Roughness"].default_value = 0.0
    without_ball = rendered(scene, tmp_path)[..., :3]
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.8, location=(0.3, 0.0, 3.0))
    bpy.context.object.data.materials.append(glass)
    ball = rendered(scene, tmp_path)[..., :3]
    assert (np.abs(ball - without_ball).max(axis=-1) > 0.5).sum() > 50
    bpy.ops.mesh.primitive_plane_add(size=20.0, location=(0.0, 0.0, 6.0))
    bpy.context.object.data.materials.append(glass)
    behind = rendered(scene, tmp_path)[..., :3]
    # Within what goes to and fro between the two.
    np.testing.assert_allclose(behind, 0.96 * ball + 0.04 * np.array(SKY), atol=0.05)


def test_empty_scene_is_sky(scene, tmp_path):
    bpy.data.objects.remove(bpy.data.objects["Sphere"])
    np.testing.assert_allclose(rendered(scene, tmp_path)[..., :3], np.broadcast_to(SKY, (HEIGHT, WIDTH, 3)), rtol=1e-6)


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


def test_escape_ends_a_render_within_half_a_second(scene, watch):
    pressed = []

    def stopped():
        if not pressed and time.monotonic() - started > 1.0:
            pressed.append(time.monotonic())
        return bool(pressed)

    watch(test_break=stopped)
    scene.render.resolution_x, scene.render.resolution_y = 1920, 1080
    scene.conic.samples = 65536
    started = time.monotonic()
    bpy.ops.render.render()
    assert pressed and time.monotonic() - pressed[0] < 0.5


# Renders the startup scene with a glass sphere and every kind of shape; sys.argv ends with the picture to write.
BOTH_WAYS = """
import sys, bpy, addon, atexit
addon.register()
atexit.register(addon.unregister)
scene = bpy.context.scene
bpy.ops.mesh.primitive_uv_sphere_add(location=(2.0, -1.0, 0.5))
bpy.ops.object.shade_smooth()
glass = bpy.data.materials.new("glass")
if bpy.app.version < (5, 0, 0):
    glass.use_nodes = True
bsdf = glass.node_tree.nodes["Principled BSDF"]
bsdf.inputs["Transmission Weight"].default_value, bsdf.inputs["Roughness"].default_value = 1.0, 0.0
bpy.context.object.data.materials.append(glass)
bpy.ops.conic.plane_add(location=(0.0, 0.0, -1.0))
bpy.ops.conic.cone_add(location=(-2.0, -1.0, 0.0), radius2=0.3)
bpy.ops.conic.cylinder_add(location=(-1.0, 3.0, 0.0))
bpy.ops.conic.disc_add(location=(0.0, 0.0, 2.0), rotation=(0.3, 0.2, 0.0))
render = scene.render
render.engine = "CONIC"
render.resolution_x, render.resolution_y, render.resolution_percentage = 96, 72, 100
render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
render.filepath = sys.argv[-1]
bpy.ops.render.render(write_still=True)
"""


@pytest.mark.skipif(bool(bpy.app.binary_path), reason="the application does not have moderngl; bpy compares the two")
def test_blenders_gpu_and_a_headless_context_give_the_same_picture(tmp_path):
    pictures = {}
    for device in ("blender", "headless"):
        path = tmp_path / f"{device}.exr"
        environment = {**os.environ, "CONIC_DEVICE": device, "PYTHONPATH": str(ROOT)}
        subprocess.run(
            [sys.executable, "-c", BOTH_WAYS, path], env=environment, capture_output=True, text=True, timeout=240
        )
        pictures[device] = picture(path)
    ours, other = pictures["blender"], pictures["headless"]
    assert ours[..., :3].std() > 0.02, "there is something to see"
    different = np.abs(ours - other).max(axis=-1) > 1e-4 * np.maximum(1.0, np.abs(other).max(axis=-1))
    assert different.mean() < 0.002


@pytest.mark.skipif(sys.platform != "linux", reason="the library is called so there")
def test_a_headless_device_gives_back_the_context(scene, tmp_path):
    """Blender's context is current after it as before: else its programs could not be freed, and Blender would end."""
    pytest.importorskip("moderngl")  # not in the application
    egl = ctypes.CDLL("libEGL.so.1")
    egl.eglGetCurrentContext.restype = ctypes.c_void_p
    scene.render.filepath = str(tmp_path / "picture.exr")
    bpy.ops.render.render(write_still=True)
    before = egl.eglGetCurrentContext()
    HeadlessDevice().close()
    assert egl.eglGetCurrentContext() == before
