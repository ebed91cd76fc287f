"""Outlines, depth cue and flat colors from Blender's settings, and presets of materials."""

import math

import bpy
import gpu
import numpy as np
import pytest

from addon.engine import render
from addon.engine.devices.headless import HeadlessDevice
from addon.operators.material_presets import PRESETS
from addon.sync.attributes import key_of
from addon.sync.settings import sync_settings
from tests.blender.building import add_camera, link, material, node, sync
from tests.blender.pictures import picture
from tests.blender.test_sync_points import cloud
from tests.blender.viewport.stand_in import StandIn

WIDTH, HEIGHT = 96, 72


def add_view():
    """A camera that looks along Y at the origin, 12 x 9 units, and a black world."""
    camera = add_camera(type="ORTHO", ortho_scale=12.0)
    camera.location, camera.rotation_euler = (0.0, -10.0, 0.0), (math.pi / 2.0, 0.0, 0.0)
    bpy.context.scene.world = None


def add_glowing_ball(location, radius=2.0, color=(1.0, 1.0, 1.0, 1.0)):
    bpy.ops.conic.sphere_add(location=location, radius=radius)
    glowing, tree, output = material()
    node(tree, "Emission", output.inputs["Surface"], Color=color)
    bpy.context.object.data.materials.append(glowing)


def rendered(scene, folder, engine="CONIC"):
    """The picture (h, w, 4), linear."""
    scene.render.engine = engine
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGBA", "32"
    scene.render.filepath = str(folder / f"{engine}.exr")
    bpy.ops.render.render(write_still=True)
    return picture(scene.render.filepath)


@pytest.fixture
def scene():
    add_view()
    for x in (-2.0, 1.0):
        add_glowing_ball((x, x, 0.5))
    scene = bpy.context.scene
    scene.conic.samples = 4
    return scene


@pytest.mark.skipif(bool(bpy.app.binary_path), reason="the application does not have moderngl; bpy compares the two")
@pytest.mark.parametrize("transparent", [False, True])
def test_blenders_gpu_draws_what_the_headless_device_draws(scene, tmp_path, transparent):
    scene.render.film_transparent = transparent
    scene.conic.use_outlines = scene.conic.use_depth_cue = True
    shown = rendered(scene, tmp_path)
    expected = render(sync(WIDTH, HEIGHT).scene, WIDTH, HEIGHT, sync_settings(scene), device=HeadlessDevice()).pixels
    different = np.abs(shown - expected).max(axis=-1) > 1e-4
    assert different.mean() < 0.002
    assert (shown[..., 3].min() == 0.0) == transparent


@pytest.mark.parametrize("samples", [1, 8])
def test_outlines_are_dark_around_and_between_balls(scene, tmp_path, samples):
    scene.conic.samples = samples
    plain = rendered(scene, tmp_path)[..., 0]
    scene.conic.use_outlines = True
    scene.conic.outline_color = (0.5, 0.0, 0.0, 1.0)
    lined = rendered(scene, tmp_path)
    x, z = np.meshgrid((np.arange(WIDTH) + 0.5 - WIDTH / 2) / 8.0, (np.arange(HEIGHT) + 0.5 - HEIGHT / 2) / 8.0)
    distance = np.minimum(*(np.abs(np.hypot(x - c, z - 0.5) - 2.0) for c in (-2.0, 1.0)))
    drawn = lined[..., 0] != plain
    assert distance[drawn].max() < 0.4 and drawn.sum() > 100
    assert (lined[..., 1] <= lined[..., 0] + 1e-6).all(), "lines are red"


@pytest.mark.skipif(not hasattr(gpu, "init"), reason="no GPU context in the background before Blender 5.2")
def test_the_viewport_draws_outlines():
    bpy.ops.conic.sphere_add()
    conic = bpy.context.scene.conic
    conic.preview_samples, conic.use_outlines, conic.outline_color = 2, True, (1.0, 0.0, 0.0, 1.0)
    view = StandIn()
    try:
        pixels = view.settle()
    finally:
        vars(view).clear()  # what the GPU holds goes before Blender does
    red = (pixels[..., 0] > 0.2) & (pixels[..., 1] < 0.1)
    rows, columns = np.nonzero(red)
    assert 60 < red.sum() < 400
    assert np.ptp(columns) == pytest.approx(np.ptp(rows), abs=2), "around a ball"


def test_settings_reach_the_engine():
    conic = bpy.context.scene.conic
    settings = sync_settings(bpy.context.scene)
    assert settings.outlines is None and settings.depth_cue is None and not settings.flat_colors
    conic.use_outlines = conic.use_depth_cue = conic.use_flat_colors = True
    conic.outline_width, conic.outline_depth_step, conic.outline_around = 3.0, 5.0, "OBJECTS"
    conic.depth_cue_range, conic.depth_cue_start, conic.depth_cue_end = "DISTANCES", 7.0, 3.0
    settings = sync_settings(bpy.context.scene)
    assert settings.flat_colors and settings.outlines.around == "ATTRIBUTE"
    assert settings.outlines.width == 3.0 and settings.outlines.depth_step == pytest.approx(0.05)
    assert settings.outlines.crease_angle == pytest.approx(math.radians(40.0))
    cue = settings.depth_cue
    assert cue.color is None and cue.start == 7.0 and 7.0 < cue.end < 7.01, "an end before the start is none"
    conic.depth_cue_into, conic.depth_cue_range = "COLOR", "SCENE"
    cue = sync_settings(bpy.context.scene).depth_cue
    assert cue.color == (1.0, 1.0, 1.0) and cue.start is None


def test_objects_have_outlines_and_their_parts_inner_lines(tmp_path):
    """A cylinder is a side and two caps: one object. Seen from above at an angle, its edge is an inner line."""
    add_view()
    bpy.ops.conic.cylinder_add(rotation=(-0.6, 0.0, 0.0), radius=2.0, depth=4.0)
    scene = bpy.context.scene
    glowing, tree, output = material()
    node(tree, "Emission", output.inputs["Surface"])
    bpy.context.object.data.materials.append(glowing)
    scene.conic.samples, scene.conic.use_outlines, scene.conic.outline_inner_width = 1, True, 0.0
    edge = {}
    for around in ("SHAPES", "OBJECTS"):
        scene.conic.outline_around = around
        column = rendered(scene, tmp_path)[:, WIDTH // 2, 0]
        inside = np.flatnonzero(column > 0.5)
        edge[around] = (column[inside[0] : inside[-1]] < 0.5).any()
    assert edge == {"SHAPES": True, "OBJECTS": False}


def test_outlines_go_around_the_values_of_an_attribute():
    add_view()
    scene = bpy.context.scene
    scene.conic.use_outlines, scene.conic.outline_around = True, "ATTRIBUTE"
    cloud([(-3.0, 0.0, 0.0), (0.0, 0.0, 0.0), (3.0, 0.0, 0.0)], chain_id=(0.0, 0.0, 1.0))
    synced = sync().scene
    key = key_of("geometry", "chain_id")
    assert synced.outline_attribute == key
    parts = [part for placed in synced.instances for _, part in placed.geometry.kinds()]
    parts += [part for _, part in synced.shapes.kinds()]
    (values,) = [part.attributes[key] for part in parts]
    assert values[:, 0, 0].tolist() == [0.0, 0.0, 1.0]


def test_outlines_around_shapes_read_no_attribute(scene):
    scene.conic.use_outlines = True
    assert sync().scene.outline_attribute == ""


def test_flat_colors(tmp_path):
    add_view()
    bpy.ops.conic.sphere_add(radius=3.0)
    colored, tree, output = material()
    node(tree, "BsdfDiffuse", output.inputs["Surface"], Color=(0.7, 0.2, 0.1, 1.0))
    bpy.context.object.data.materials.append(colored)
    bpy.context.scene.conic.use_flat_colors = True
    assert rendered(bpy.context.scene, tmp_path)[HEIGHT // 2, WIDTH // 2 - 10 : WIDTH // 2 + 10, :3] == pytest.approx(
        np.tile((0.7, 0.2, 0.1), (20, 1)), abs=1e-4
    )


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_makes_a_material_that_renders_without_a_word(name):
    bpy.ops.mesh.primitive_uv_sphere_add()
    assert bpy.ops.material.conic_preset(preset=name) == {"FINISHED"}
    made = bpy.context.object.active_material
    assert made.name == PRESETS[name].name
    assert bpy.context.scene.conic.use_outlines == (name == "MOLECULE")
    add_camera()
    assert not sync().warnings(made.name)
    bpy.ops.material.conic_preset(preset="GOLD")
    assert bpy.context.object.active_material == made and len(made.node_tree.nodes) == 2


def test_a_preset_without_an_object_is_refused():
    assert not bpy.ops.material.conic_preset.poll()


@pytest.mark.parametrize("name", ["MOLECULE", "PLASTIC", "RUBBER", "EMITTER", "IRON"])
def test_presets_look_as_in_cycles(name, tmp_path):
    add_view()
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6, radius=3.0)
    bpy.context.object.data.shade_smooth()
    bpy.ops.material.conic_preset(preset=name)
    scene.conic.use_outlines = False
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle = 3.0, 0.3
    link(sun, "sun", rotation_euler=(0.7, 0.5, 0.0))
    scene.conic.samples = 64
    if not hasattr(scene, "cycles"):
        pytest.skip("this Blender has no Cycles")
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.filter_width = 128, False, 0.01
    ours, theirs = (rendered(scene, tmp_path, engine)[..., :3] for engine in ("CONIC", "CYCLES"))
    lit = theirs.max(axis=-1) > 0.05 * theirs.max()
    error = np.abs(ours - theirs)[lit] / np.maximum(theirs[lit], 1e-3)
    assert np.median(error) < 0.03
