"""The path tracer as fragments and as a compute program, on Blender's GPU: renders, and the viewport's pictures."""

import bpy
import gpu
import numpy as np
import pytest

from addon import statistics
from addon.engine import entries
from addon.engine.devices.blender_gpu import BlenderDevice
from tests.blender.pictures import picture
from tests.blender.viewport.stand_in import StandIn, mark

WIDTH, HEIGHT = 93, 61  # tiles end within work groups

needs_context = pytest.mark.skipif(not hasattr(gpu, "init"), reason="no GPU context outside of a render before 5.2")


@pytest.fixture
def scene():
    """A mirroring sphere on a plane below a large lamp, from the side."""
    scene = bpy.context.scene
    bpy.ops.object.camera_add(location=(0.0, -8.0, 4.0), rotation=(1.1, 0.0, 0.0))
    scene.camera = bpy.context.object
    bpy.ops.conic.sphere_add()
    bpy.ops.conic.plane_add(location=(0.0, 0.0, -1.0))
    bpy.ops.object.light_add(type="POINT", radius=0.7, location=(3.0, -3.0, 4.0))
    bpy.context.object.data.energy = 900.0
    scene.render.engine = "CONIC"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.conic.samples = scene.conic.preview_samples = 3
    return scene


def rendered(path):
    """The pixels of a final render."""
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return picture(path)


def assert_same(compute, fragment):
    assert np.ptp(fragment[..., :3]) > 0.05, "something is to be seen"
    if "llvmpipe" in statistics.latest().device:
        assert np.array_equal(compute, fragment)
    else:
        assert ((np.abs(compute - fragment) > 1e-3).any(axis=-1)).mean() < 0.01


@pytest.mark.parametrize("outlines", [False, True])
def test_renders_are_the_same(scene, tmp_path, outlines):
    scene.conic.use_outlines = outlines
    pictures = {}
    for entry in ("FRAGMENT", "COMPUTE"):
        scene.conic.entry = entry
        pictures[entry] = rendered(tmp_path / f"{entry}.exr")
        assert statistics.latest().entry == entry
    assert_same(pictures["COMPUTE"], pictures["FRAGMENT"])


def test_automatic_on_a_software_rasteriser(scene, tmp_path, monkeypatch):
    monkeypatch.setattr(entries, "_measured", {})
    rendered(tmp_path / "automatic.exr")
    latest = statistics.latest()
    assert latest.entry == entries._measured[latest.device]
    assert latest.entry == "FRAGMENT" or "llvmpipe" not in latest.device


@needs_context
def test_the_probe_draws_the_same_with_both():
    gpu.init()
    _, pictures = entries.probe(BlenderDevice())
    assert 1.0 < pictures["FRAGMENT"][..., 3].mean() < 4.0
    assert np.mean(np.abs(pictures["FRAGMENT"] - pictures["COMPUTE"]) > 1e-2) < 0.01


@needs_context
def test_viewports_show_the_same(scene):
    """Coarse pictures while the view moves, finer ones, samples and lines; then the other entry."""
    scene.conic.use_outlines = True
    bpy.app.handlers.depsgraph_update_post.append(mark)
    view = StandIn((WIDTH, HEIGHT))
    try:
        shown = {}
        for entry in ("FRAGMENT", "COMPUTE", "FRAGMENT", "COMPUTE"):
            scene.conic.entry = entry
            view.look_from(1.5)
            view.redraw()
            view.look_from(0.3)
            pixels = view.settle()
            assert not view.session.error and view.session.scene.loaded.drawn.entry == entry
            assert np.array_equal(shown.setdefault(entry, pixels), pixels)
        assert_same(shown["COMPUTE"], shown["FRAGMENT"])
    finally:
        view.close()  # what the GPU holds goes before Blender does
        bpy.app.handlers.depsgraph_update_post.remove(mark)
