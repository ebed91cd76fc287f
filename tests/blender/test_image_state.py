"""Images are read again where something of them changed, and only there."""

import os

import bpy
import numpy as np
import pytest

from addon.sync.scene_reader import SceneReader
from tests.blender.building import add_camera, image, quad
from tests.blender.test_sync_images import image_node, ramp, save, textured


class Kept:
    """Reads the images of Blender's scene again and again, as a viewport that hears of changes."""

    def __init__(self, *pictures):
        add_camera()
        self.messages = []
        self.reader = SceneReader(lambda level, message: self.messages.append(message))
        for handlers in (bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.frame_change_post):
            handlers.append(lambda _scene, depsgraph: self.reader.mark(depsgraph))
        self.materials = [textured(picture, f"material {i}") for i, picture in enumerate(pictures)]
        for made in self.materials:
            quad(made.name).data.materials.append(made)
        self.images = self.read()

    def read(self):
        self.messages.clear()
        self.images = self.reader.read(bpy.context.evaluated_depsgraph_get(), 64, 48).images
        return self.images

    def changes(self):
        """Whether the images are others than at the last reading; they are equal where they are the same objects."""
        return self.images != self.read()


def red(read):
    """The first number of the first pixel of an image of bytes, 0 to 1."""
    return read.pixels[0, 0, 0] / 255.0


def picture(tmp_path, name="kept.png", pixels=None):
    return bpy.data.images.load(save(tmp_path / name, ramp() if pixels is None else pixels))


def overwrite(path, value):
    save(path, np.full((2, 4, 4), (value, value, value, 1.0)))


@pytest.mark.parametrize("kind", ["generated", "file", "packed", "tiled", "float"])
def test_what_did_not_change_stays_the_same_object(kind, tmp_path):
    if kind == "generated":
        made = bpy.data.images.new("generated", 4, 4)
    else:
        made = picture(tmp_path, "kept1001.png")
    if kind == "packed":
        made.pack()
    elif kind == "tiled":
        made.filepath = made.filepath.replace("1001", "<UDIM>")
        made.source = "TILED"
    elif kind == "float":
        made = image(ramp(), float_buffer=True)
        made.pack()
    kept = Kept(made)
    assert len(kept.images) == 1 and not kept.changes() and not kept.changes()


@pytest.mark.parametrize("of_file", [False, True])
def test_a_painted_image_is_read_again_and_the_same_where_its_pixels_are(of_file, tmp_path):
    made = picture(tmp_path) if of_file else bpy.data.images.new("painted", 4, 4)
    kept = Kept(made)
    made.pixels[0] = 1.0
    assert kept.changes() and red(kept.images[0]) == 1.0
    assert not kept.changes()
    made.pixels[0] = 0.0
    assert kept.changes() and red(kept.images[0]) == 0.0


def test_painting_and_packing_again(tmp_path):
    made = picture(tmp_path)
    made.pack()
    kept = Kept(made)
    made.pixels[0] = 1.0
    made.pack()
    assert not made.is_dirty
    assert kept.changes() and red(kept.images[0]) == 1.0


@pytest.mark.parametrize("reloaded", [True, False])
@pytest.mark.parametrize("looked_at", [True, False])
def test_a_file_that_was_written_again(reloaded, looked_at, tmp_path):
    made = picture(tmp_path)
    kept = Kept(made)
    overwrite(tmp_path / "kept.png", 0.2)
    if reloaded:
        made.reload()
    if looked_at:
        len(made.pixels)
    assert kept.changes() and red(kept.images[0]) == pytest.approx(0.2, abs=0.002)
    made.reload()
    assert not kept.changes()


def test_a_file_that_went_away_and_came_back(tmp_path):
    made = picture(tmp_path)
    kept = Kept(made)
    os.rename(tmp_path / "kept.png", tmp_path / "elsewhere.png")
    made.reload()
    assert [made.pixels.shape for made in kept.read()] == [(1, 1, 4)]  # its place is kept
    os.rename(tmp_path / "elsewhere.png", tmp_path / "kept.png")
    made.reload()
    assert [made.pixels.shape for made in kept.read()] == [(2, 4, 4)]


@pytest.mark.parametrize("change", ["generated_width", "generated_color", "generated_type"])
def test_settings_of_a_generated_image(change):
    made = bpy.data.images.new("generated", 4, 4)
    kept = Kept(made)
    setattr(
        made,
        change,
        {"generated_width": 8, "generated_color": (1.0, 0.0, 0.0, 1.0), "generated_type": "COLOR_GRID"}[change],
    )
    before = kept.images[0].pixels
    assert kept.changes() and not np.array_equal(kept.images[0].pixels, before)


def test_a_painted_image_that_was_scaled():
    made = image(ramp())
    kept = Kept(made)
    made.scale(8, 8)
    assert kept.changes() and kept.images[0].pixels.shape == (8, 8, 4)


def test_frames_of_a_sequence(tmp_path):
    for frame in (1, 2):
        path = save(tmp_path / f"frame{frame:04d}.png", np.full((2, 2, 4), (0.2 * frame,) * 3 + (1.0,)))
    made = bpy.data.images.load(path)
    made.source = "SEQUENCE"
    kept = Kept(made)
    image_node(kept.materials[0]).image_user.frame_duration = 2
    for frame in (1, 2, 1):
        bpy.context.scene.frame_set(frame)
        kept.changes()
        assert red(kept.images[0]) == pytest.approx(0.2 * frame, abs=0.002)
        assert not kept.changes()


@pytest.mark.parametrize("change", ["color space", "alpha"])
def test_what_the_pixels_mean(change, tmp_path):
    made = picture(tmp_path, pixels=ramp(alpha=0.2))
    kept = Kept(made)
    if change == "alpha":
        made.alpha_mode = "CHANNEL_PACKED"
    else:
        made.colorspace_settings.name = "Non-Color"
    before = kept.images[0]
    assert kept.changes()
    assert kept.images[0].srgb == (change == "alpha")
    assert not np.array_equal(kept.images[0].pixels, before.pixels)


def test_how_a_node_samples_needs_no_reading():
    made = bpy.data.images.new("generated", 4, 4)
    kept = Kept(made)
    image_node(kept.materials[0]).extension = "CLIP"
    before = kept.images[0]
    assert kept.changes() and any(made.pixels is before.pixels for made in kept.images)


def test_one_of_two_images_changes():
    first, second = (bpy.data.images.new(name, 4, 4) for name in ("first", "second"))
    kept = Kept(first, second)
    before = kept.images
    second.pixels[0] = 1.0
    now = kept.read()
    assert now[0] == before[0] and now[1] != before[1]


def test_what_a_scene_does_not_use_is_dropped():
    made = bpy.data.images.new("generated", 4, 4)
    kept = Kept(made)
    before = kept.images
    image_node(kept.materials[0]).image = None
    kept.read()
    image_node(kept.materials[0]).image = made
    assert kept.read() != before


def test_the_table_of_a_sky_is_made_once():
    kept = Kept(None)
    tree = kept.materials[0].node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    diffuse = next(n for n in tree.nodes if n.type == "BSDF_DIFFUSE")
    tree.links.new(sky.outputs[0], diffuse.inputs["Color"])
    assert kept.changes() and not kept.changes()


def test_warnings_are_given_at_each_reading(tmp_path):
    for number in (1001, 1003):
        path = save(tmp_path / f"tiles.{number}.png", ramp())
    made = bpy.data.images.load(path.replace("1003", "<UDIM>"))
    made.source = "TILED"
    for number in (1002, 1003):
        made.tiles.new(number)
    kept = Kept(made)
    for _ in range(2):
        kept.read()
        assert len([text for text in kept.messages if "tile 1002" in text and "pink" in text]) == 1
    save(tmp_path / "tiles.1002.png", ramp())
    assert kept.changes() and kept.images[1].pixels.shape == (2, 4, 4)
