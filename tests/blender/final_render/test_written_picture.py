"""F12: the whole way from Blender's scene to the written picture, through the RenderEngine."""

import bpy
import numpy as np
import pytest

from tests.blender.final_render.rendering import GLOW, HEIGHT, SKY, WIDTH, glowing, is_sphere, nodes_of, rendered
from tests.blender.pictures import picture


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
