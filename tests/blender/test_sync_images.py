"""Images: what is read of them, sharing, changes that compile nothing, and what is missing. How they look is in the
`shading_table`."""

import bpy
import numpy as np
import pytest

from addon.engine.expression import Call, Expression, in_order
from addon.engine.image_file import srgb_to_linear
from addon.engine.node_programs import NodePrograms
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


def image_node(made):
    return next(n for n in made.node_tree.nodes if n.type == "TEX_IMAGE")


def synced_with(*materials):
    add_camera()
    for made in materials:
        quad(made.name).data.materials.append(made)
    return sync()


def colors(read):
    """The colours of an engine image as scene-linear floats."""
    values = read.pixels / (255.0 if read.pixels.dtype == np.uint8 else 1.0)
    return srgb_to_linear(values[..., :3]) if read.srgb else values[..., :3]


def numbers(made):
    """The numbers of the images that an engine material looks up."""
    calls = [x for x in in_order((made.diffuse,)) if isinstance(x, Call) and x.name.startswith("image_sample")]
    return [int(x.inputs[0].value[0]) for x in calls]


def is_pink(made):
    return not isinstance(made.diffuse, Expression) or tuple(made.diffuse.value[:3]) == (1.0, 0.0, 1.0)


def ramp(alpha=1.0):
    """Pixels (2, 4, 4) of values that a byte holds exactly, all different."""
    pixels = np.arange(32, dtype=np.float64).reshape(2, 4, 4) * 8.0 / 255.0
    pixels[..., 3] = alpha
    return pixels


def test_byte_image_stays_in_bytes_bottom_row_first():
    (read,) = synced_with(textured(image(ramp()))).scene.images
    np.testing.assert_array_equal(read.pixels, np.rint(255.0 * ramp()))
    assert read.pixels.dtype == np.uint8
    assert (read.interpolation, read.extension, read.srgb) == ("LINEAR", "REPEAT", True)


def test_non_color_image_is_raw():
    picture = image(ramp(), is_data=True)
    (read,) = synced_with(textured(picture)).scene.images
    np.testing.assert_allclose(read.pixels / 255.0, ramp(), atol=1e-6)
    assert not read.srgb


def test_float_image_is_linear_as_it_is():
    (read,) = synced_with(textured(image(ramp() * (10.0, 10.0, 10.0, 1.0), float_buffer=True))).scene.images
    np.testing.assert_allclose(read.pixels[..., :3], ramp()[..., :3] * 10.0, rtol=1e-6)
    assert read.pixels.dtype == np.float32 and not read.srgb


def test_what_is_not_finite_becomes_finite():
    picture = image(np.full((2, 2, 4), np.inf), float_buffer=True)
    (read,) = synced_with(textured(picture)).scene.images
    assert np.isfinite(read.pixels).all() and read.pixels.min() > 1e38


@pytest.mark.parametrize("mode, multiplied", [("STRAIGHT", True), ("CHANNEL_PACKED", False), ("NONE", False)])
def test_alpha(mode, multiplied):
    picture = image(ramp(alpha=51 / 255))
    picture.alpha_mode = mode
    (read,) = synced_with(textured(picture)).scene.images
    factor = 0.2 if multiplied else 1.0
    np.testing.assert_allclose(read.pixels[..., :3] / 255.0, ramp()[..., :3] * factor, atol=1 / 255)
    assert not read.divided


def test_where_alpha_is_used_too_the_color_is_divided_by_it():
    made = textured(image(ramp(alpha=51 / 255)))
    diffuse = next(n for n in made.node_tree.nodes if n.type == "BSDF_DIFFUSE")
    made.node_tree.links.new(image_node(made).outputs["Alpha"], diffuse.inputs["Roughness"])
    scene = synced_with(made).scene
    assert [read.divided for read in scene.images] == [True]


@pytest.mark.parametrize("extension", ("REPEAT", "EXTEND", "CLIP", "MIRROR"))
@pytest.mark.parametrize(
    "interpolation, read_as", [("Linear",) * 2, ("Closest",) * 2, ("Cubic",) * 2, ("Smart", "Cubic")]
)
def test_sampling(interpolation, read_as, extension):
    synced = synced_with(textured(image(ramp()), interpolation=interpolation, extension=extension))
    (read,) = synced.scene.images
    assert (read.interpolation, read.extension) == (read_as.upper(), extension) and not synced.messages


def test_an_image_is_shared_by_all_its_materials():
    picture = image(ramp())
    scene = synced_with(textured(picture, "a"), textured(picture, "b"), textured(picture, "c", extension="CLIP")).scene
    assert len(scene.images) == 2 and scene.images[0].pixels is scene.images[1].pixels
    assert [numbers(made) for made in scene.materials] == [[0], [0], [1]]


def programs(scene):
    """How many programs the diffuse colours of a scene's materials take."""
    made = NodePrograms()
    for read in scene.materials:
        made.add({"diffuse": (read.diffuse, "{0}")})
    return len(made)


def test_materials_that_differ_in_the_image_share_a_program():
    others = [textured(image(ramp() * (0.1 * i), f"image {i}"), f"material {i}") for i in range(5)]
    others.append(textured(image(ramp()), "other", extension="MIRROR", interpolation="Cubic"))
    scene = synced_with(*others).scene
    assert len(scene.images) == 6 and programs(scene) == 1


def test_the_sun_of_a_sky_may_move_without_another_program():
    kind = bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"].enum_items.keys()
    kind = "SINGLE_SCATTERING" if "SINGLE_SCATTERING" in kind else "NISHITA"
    skies = []
    for i in range(3):
        made, tree, output = material(f"sky {i}")
        sky = node(tree, "TexSky", node(tree, "BsdfDiffuse", output.inputs["Surface"]).inputs["Color"])
        sky.sky_type, sky.sun_elevation, sky.sun_rotation, sky.sun_size = kind, 0.2 * i - 0.1, 0.3 * i, 0.01 + 0.01 * i
        skies.append(made)
    scene = synced_with(*skies).scene
    assert programs(scene) == 1 and len(scene.images) == 3


def test_missing_file_is_pink_and_named_once(tmp_path):
    saved = image(ramp(), "lost")
    path = tmp_path / "lost.png"
    saved.filepath_raw, saved.file_format = str(path), "PNG"
    saved.save()
    bpy.data.images.remove(saved)
    picture = bpy.data.images.load(str(path))
    path.unlink()
    made = textured(picture, "painted")
    diffuse = next(n for n in made.node_tree.nodes if n.type == "BSDF_DIFFUSE")
    made.node_tree.links.new(image_node(made).outputs["Alpha"], diffuse.inputs["Roughness"])
    synced = synced_with(made)
    assert is_pink(synced.scene.materials[0]) and not synced.scene.images
    assert len(synced.warnings("'painted'", "lost.png", "pink")) == 1 == len(synced.messages)


def save(path, pixels):
    """A PNG file of pixels; its path as text."""
    saved = image(pixels, "kept")
    saved.filepath_raw, saved.file_format = str(path), "PNG"
    saved.save()
    bpy.data.images.remove(saved)
    return str(path)


def test_file_on_disk_and_packed(tmp_path):
    path = save(tmp_path / "kept.png", ramp())
    on_disk, packed = (bpy.data.images.load(path) for _ in range(2))
    packed.pack()
    assert on_disk.name != packed.name
    for read in synced_with(textured(on_disk, "a"), textured(packed, "b")).scene.images:
        np.testing.assert_allclose(colors(read), srgb_to_linear(ramp()[..., :3]), atol=2e-6)


@pytest.mark.parametrize("frame, shown", [(1, 1), (2, 2), (5, 3), (-3, 1)])
def test_frame_of_a_sequence(frame, shown, tmp_path):
    for i in (1, 2, 3):
        path = save(tmp_path / f"part7_{i:04d}.png", ramp() * (i / 3.0, i / 3.0, i / 3.0, 1.0))
    picture = bpy.data.images.load(path)
    picture.source = "SEQUENCE"
    made = textured(picture)
    image_node(made).image_user.frame_duration = 3
    bpy.context.scene.frame_set(frame)
    (read,) = synced_with(made).scene.images
    np.testing.assert_allclose(read.pixels[..., :3] / 255.0, ramp()[..., :3] * shown / 3.0, atol=1 / 255)


def test_frame_that_is_missing(tmp_path):
    picture = bpy.data.images.load(save(tmp_path / "part0001.png", ramp()))
    picture.source = "SEQUENCE"
    made = textured(picture)
    image_node(made).image_user.frame_duration = 9
    bpy.context.scene.frame_set(4)
    synced = synced_with(made)
    assert is_pink(synced.scene.materials[0]) and len(synced.warnings("part0004.png", "pink")) == 1


def test_tile_that_is_missing(tmp_path):
    for number in (1001, 1003):
        path = save(tmp_path / f"tiles.{number}.png", ramp())
    picture = bpy.data.images.load(path.replace("1003", "<UDIM>"))
    picture.source = "TILED"
    for number in (1002, 1003):
        picture.tiles.new(number)
    synced = synced_with(textured(picture))
    assert len(synced.warnings("tile 1002", "pink")) == 1
    images = synced.scene.images
    assert [read.pixels.shape[:2] for read in images] == [(2, 4), (1, 1), (2, 4)]
    assert images[1].pixels.ravel().tolist() == [255, 0, 255, 255]


def test_node_without_image_is_pink():
    synced = synced_with(textured(None, "unfinished"))
    assert is_pink(synced.scene.materials[0]) and len(synced.warnings("'unfinished'", "no image")) == 1


def test_of_a_movie_the_first_frame_is_taken_and_named(tmp_path):
    scene = bpy.context.scene
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "VIDEO"
    settings.file_format = "FFMPEG"
    scene.render.engine, scene.render.filepath = "BLENDER_WORKBENCH", str(tmp_path / "movie")
    scene.render.resolution_x, scene.render.resolution_y, scene.frame_end = 64, 32, 1
    scene.sequence_editor_create()
    editor = scene.sequence_editor
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    length = {"length": 1} if bpy.app.version >= (5, 0, 0) else {"frame_end": 2}
    strips.new_effect(name="red", type="COLOR", channel=1, frame_start=1, **length).color = (0.8, 0.0, 0.0)
    bpy.ops.render.render(animation=True)
    (path,) = tmp_path.iterdir()
    synced = synced_with(textured(bpy.data.images.load(str(path))))
    (read,) = synced.scene.images
    assert read.pixels.shape[:2] == (32, 64)
    assert read.pixels[..., 0].min() > 150 and read.pixels[..., 1].max() < 60
    assert len(synced.warnings("a movie", "first frame")) == 1
