"""Crowds of points in final renders: a grid in place of their tree, with the same picture."""

import bpy
import numpy as np
import pytest

from addon.engine import grid_packing
from tests.blender.building import add_camera, link, material, node
from tests.blender.pictures import picture
from tests.blender.test_sync_points import cloud, paint

COUNT = 5000


@pytest.fixture
def scene():
    """Where a crowd is seen from the front, in the light of a sun, before a sky."""
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("sky")
    if bpy.app.version < (5, 0, 0):
        scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 10.0
    add_camera().location = (0.0, 0.0, 5.0)
    sun = link(bpy.data.lights.new("sun", "SUN"), "sun")
    sun.rotation_euler = (0.6, 0.4, 0.0)
    sun.data.energy = 3.0
    scene.render.engine = "CONIC"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 120, 80, 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.conic.samples = 1
    return scene


def crowd(kind):
    """An object of points that fill a cube evenly."""
    rng = np.random.default_rng(0)
    made = cloud(rng.uniform(-1.0, 1.0, (COUNT, 3)), rng.uniform(0.2, 0.6, COUNT) * COUNT ** (-1 / 3))
    surface, tree, output = material(kind)
    node(tree, kind, output.inputs["Surface"])
    paint(made, surface)
    return made


def rendered(path):
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return picture(path)


@pytest.mark.parametrize("placed", ["as it is", "stretched", "far away"])
@pytest.mark.parametrize("kind", ["BsdfDiffuse", "BsdfGlass"])
def test_a_crowd_is_rendered_as_with_a_tree(scene, tmp_path, monkeypatch, kind, placed):
    made, grids, better = crowd(kind), [], grid_packing.better_grid
    if placed == "stretched":
        made.scale, made.rotation_euler = (1.0, 0.5, 2.0), (0.3, 0.2, 0.1)
    elif placed == "far away":
        made.location = scene.camera.location = (3e4, -1e4, 0.0)
        scene.camera.location.z = 5.0
    pictures = []
    for choose in (lambda *of: grids.append(better(*of)) or grids[-1], lambda *of: None):
        monkeypatch.setattr(grid_packing, "better_grid", choose)
        pictures.append(rendered(tmp_path / f"{len(pictures)}.exr"))
    assert len(grids) == 1 and grids[0] is not None
    grid, tree = pictures
    assert np.ptp(grid[..., :3]) > 0.1, "something is to be seen"
    assert (np.abs(grid - tree) > 1e-3).any(axis=-1).mean() < 0.005
