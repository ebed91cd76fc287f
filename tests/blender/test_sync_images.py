"""Images: colour spaces, alpha, sampling, sharing, and what is missing."""

import bpy
import numpy as np
import pytest

from tests.blender.building import add_camera, image, material, node, quad, sync


def textured(picture, name="material", **settings):
    """A material whose diffuse colour is an image."""
    made, tree, output = material(name)
    diffuse = node(tree, "BsdfDiffuse", output.inputs["Surface"])
    textured = node(tree, "TexImage", diffuse.inputs["Color"])
    textured.image = picture
    for key, value in settings.items():
        setattr(textured, key, value)
    return made


def synced_with(*materials):
    add_camera()
    for made in materials:
        quad(made.name).data.materials.append(made)
    return sync()


def srgb_to_linear(encoded):
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def ramp(alpha=1.0):
    """Pixels (2, 4, 4) of values that a byte holds exactly, all different."""
    pixels = np.arange(32, dtype=np.float64).reshape(2, 4, 4) * 8.0 / 255.0
    pixels[..., 3] = alpha
    return pixels


def test_byte_image_is_decoded_bottom_row_first():
    (read,) = synced_with(textured(image(ramp()))).scene.images
    np.testing.assert_allclose(read.pixels[..., :3], srgb_to_linear(ramp()[..., :3]), atol=1e-6)
    assert (read.interpolation, read.extension) == ("LINEAR", "REPEAT")


def test_non_color_image_is_raw():
    picture = image(ramp(), is_data=True)
    (read,) = synced_with(textured(picture)).scene.images
    np.testing.assert_allclose(read.pixels, ramp(), atol=1e-6)


def test_float_image_is_linear_as_it_is():
    (read,) = synced_with(textured(image(ramp() * 10.0, float_buffer=True))).scene.images
    np.testing.assert_allclose(read.pixels[..., :3], ramp()[..., :3] * 10.0, rtol=1e-6)


def test_straight_alpha_is_multiplied_in():
    (read,) = synced_with(textured(image(ramp(alpha=51 / 255)))).scene.images
    np.testing.assert_allclose(read.pixels[..., :3], srgb_to_linear(ramp()[..., :3]) * 0.2, atol=1e-6)


def test_packed_channels_are_not_multiplied():
    picture = image(ramp(alpha=51 / 255))
    picture.alpha_mode = "CHANNEL_PACKED"
    (read,) = synced_with(textured(picture)).scene.images
    np.testing.assert_allclose(read.pixels[..., :3], srgb_to_linear(ramp()[..., :3]), atol=1e-6)


@pytest.mark.parametrize("extension", ("REPEAT", "EXTEND", "CLIP"))
@pytest.mark.parametrize("interpolation", ("Linear", "Closest"))
def test_sampling(interpolation, extension):
    synced = synced_with(textured(image(ramp()), interpolation=interpolation, extension=extension))
    (read,) = synced.scene.images
    assert (read.interpolation, read.extension) == (interpolation.upper(), extension) and not synced.messages


def test_mirrored_repetition_is_reported():
    synced = synced_with(textured(image(ramp()), extension="MIRROR"))
    assert synced.scene.images[0].extension == "REPEAT" and synced.warnings("'image'", "Mirror")


def test_an_image_is_shared_by_all_its_materials():
    picture = image(ramp())
    scene = synced_with(textured(picture, "a"), textured(picture, "b"), textured(picture, "c", extension="CLIP")).scene
    assert len(scene.images) == 2 and scene.images[0].pixels is scene.images[1].pixels
    assert [made.diffuse_image for made in scene.materials] == [0, 0, 1]


def test_missing_file_is_pink_and_named(tmp_path):
    saved = image(ramp(), "lost")
    path = tmp_path / "lost.png"
    saved.filepath_raw, saved.file_format = str(path), "PNG"
    saved.save()
    bpy.data.images.remove(saved)
    picture = bpy.data.images.load(str(path))
    path.unlink()
    synced = synced_with(textured(picture, "painted"))
    assert synced.scene.materials[0].diffuse == (1.0, 0.0, 1.0) and synced.scene.materials[0].diffuse_image == -1
    assert len(synced.warnings("'painted'", "lost.png", "pink")) == 1 == len(synced.messages)


def test_file_on_disk_and_packed(tmp_path):
    saved = image(ramp(), "kept")
    path = tmp_path / "kept.png"
    saved.filepath_raw, saved.file_format = str(path), "PNG"
    saved.save()
    on_disk, packed = (bpy.data.images.load(str(path)) for _ in range(2))
    packed.pack()
    assert on_disk.name != packed.name
    for read in synced_with(textured(on_disk, "a"), textured(packed, "b")).scene.images:
        np.testing.assert_allclose(read.pixels[..., :3], srgb_to_linear(ramp()[..., :3]), atol=2e-6)


def test_node_without_image_is_pink():
    synced = synced_with(textured(None, "unfinished"))
    assert synced.scene.materials[0].diffuse == (1.0, 0.0, 1.0) and synced.warnings("'unfinished'", "no image")


def test_other_coordinates_are_reported():
    made = textured(image(ramp()), "boxed")
    picture = next(n for n in made.node_tree.nodes if n.type == "TEX_IMAGE")
    node(made.node_tree, "TexCoord", picture.inputs["Vector"], output="Generated")
    assert len(synced_with(made).warnings("'boxed'", "generated coordinates", "uv map")) == 1
