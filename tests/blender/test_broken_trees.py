"""Trees that are broken, odd or not understood: they are rendered, and the picture around them is as it was."""

import bpy
import numpy as np
import pytest

from tests.blender.broken_trees import (
    MATERIALS,
    color_as_a_shader,
    cycle_of_values,
    driver_that_divides_by_zero,
    group_fed_by_itself,
    group_in_itself,
    long_chain,
    missing_image,
    no_image,
    unknown_node,
)
from tests.blender.building import add_camera, link, material, mesh_of, node, sync
from tests.blender.pictures import picture

#: What the square beside the one of a broken material shows.
_GOOD = (0.2, 0.5, 0.8)
#: Pixels along an edge of a square.
_SIZE = 12
#: What Cycles crashes on.
CRASHES_CYCLES = [group_fed_by_itself] if bpy.app.version < (5, 0, 0) else []
#: What may look otherwise: Cycles takes a color for a shader that emits it.
UNLIKE_CYCLES = [color_as_a_shader, *CRASHES_CYCLES]


def _square(column, made):
    corners = [(column + x, y, 0.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    mesh = mesh_of(corners, [(0, 1, 2, 3)], "square")
    mesh.materials.append(made)
    return link(mesh, "square")


def _broken(build):
    made, tree, output = material(build.__name__[:60])
    build(tree, output)
    return made


def _rendered(count, folder, engine="CONIC"):
    """The squares (count, pixels, 4) of a row."""
    camera = add_camera(type="ORTHO", ortho_scale=float(count))
    camera.location = (count / 2.0, 0.5, 10.0)
    scene = bpy.context.scene
    render = scene.render
    render.engine, render.film_transparent = engine, True
    render.resolution_x, render.resolution_y, render.resolution_percentage = count * _SIZE, _SIZE, 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.image_settings.color_mode = "RGBA"
    render.filepath = str(folder / f"{engine}.exr")
    scene.conic.samples, scene.cycles.samples, scene.cycles.device = 1, 4, "CPU"
    bpy.ops.render.render(write_still=True)
    pixels = picture(render.filepath).reshape(_SIZE, count, _SIZE, 4).transpose(1, 0, 2, 3)
    return pixels[:, 2:-2, 2:-2].reshape(count, -1, 4)


def _good():
    made, tree, output = material("good")
    node(tree, "Emission", output.inputs["Surface"], Color=(*_GOOD, 1.0))
    return made


def _add_sun():
    light = bpy.data.lights.new("sun", "SUN")
    light.energy = 3.0
    link(light, "sun")


@pytest.fixture(scope="module")
def squares(registered, tmp_path_factory):
    """A row of squares by each engine: a good one, all broken ones, one without a material, a good one."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    _add_sun()
    for column, made in enumerate((_good(), *map(_broken, MATERIALS), None, _good())):
        _square(column, made)
    folder = tmp_path_factory.mktemp("pictures")
    conic = _rendered(len(MATERIALS) + 3, folder)
    for build in CRASHES_CYCLES:
        bpy.data.materials.remove(bpy.data.materials[build.__name__])
    return conic[..., :3], _rendered(len(MATERIALS) + 3, folder, "CYCLES")[..., :3]


def test_what_is_beside_broken_materials(squares):
    conic, _ = squares
    assert np.isfinite(conic).all()
    for good in (conic[0], conic[-1]):
        np.testing.assert_allclose(good, np.broadcast_to(_GOOD, good.shape), rtol=1e-5)
    assert conic[-2].min() > 0.1, "without a material it is grey"


@pytest.mark.parametrize("build", MATERIALS)
def test_broken_material(build, squares):
    """It looks as in Cycles; where that shows nothing, something may be seen."""
    ours, theirs = (row[MATERIALS.index(build) + 1].mean(axis=0) for row in squares)
    assert ours.any() or theirs.max() < 0.01
    if theirs.max() > 0.01 and build not in UNLIKE_CYCLES:
        np.testing.assert_allclose(ours, theirs, atol=0.1)


def test_reports_of_broken_materials():
    """Each is named at most twice, and nothing is said twice."""
    for column, build in enumerate(MATERIALS):
        _square(column, _broken(build))
    add_camera()
    texts = [text for _, text in sync().messages]
    assert len(texts) == len(set(texts))
    for build in MATERIALS:
        assert sum(repr(build.__name__) in text for text in texts) <= 2, build.__name__


@pytest.mark.parametrize("build", [cycle_of_values, no_image, missing_image, long_chain, unknown_node, group_in_itself])
def test_broken_world(build, tmp_path):
    """A world whose Background is fed by what is broken, with a body that glows before it."""
    world = bpy.data.worlds.new("broken")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    world.node_tree.nodes.clear()
    output = world.node_tree.nodes.new("ShaderNodeOutputWorld")
    build(world.node_tree, output)
    bpy.context.scene.world = world
    _square(0, _good())
    squares = _rendered(1, tmp_path)
    np.testing.assert_allclose(squares[0, :, :3], np.broadcast_to(_GOOD, squares[0, :, :3].shape), rtol=1e-5)


@pytest.mark.parametrize("build", [cycle_of_values, no_image, unknown_node, driver_that_divides_by_zero])
def test_broken_light(build, tmp_path):
    light = bpy.data.lights.new("broken", "SUN")
    if bpy.app.version < (5, 2, 0):
        light.use_nodes = True
    light.node_tree.nodes.clear()
    build(light.node_tree, light.node_tree.nodes.new("ShaderNodeOutputLight"))
    link(light, "light")
    _square(0, _good())
    squares = _rendered(1, tmp_path)
    np.testing.assert_allclose(squares[0, :, :3], np.broadcast_to(_GOOD, squares[0, :, :3].shape), rtol=1e-5)
