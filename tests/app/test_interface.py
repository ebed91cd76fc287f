"""Conic in the application: in the menu of render engines, and F12 with whichever GPU back end runs this."""

import bpy
import numpy as np
import pytest

from tests.blender.pictures import picture


@pytest.fixture
def startup(registered):
    """Blender's startup scene, small, with Conic as its render engine."""
    bpy.ops.wm.read_factory_settings(use_empty=False)
    scene = bpy.context.scene
    scene.render.engine = "CONIC"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 96, 54, 100
    scene.conic.samples = 2
    return scene


def test_conic_is_in_the_menu_of_render_engines():
    with pytest.raises(TypeError, match="'CONIC'"):  # the message lists the menu's entries
        bpy.context.scene.render.engine = "NO_SUCH_ENGINE"
    engines = bpy.types.RenderEngine.__subclasses__()
    assert [engine.bl_label for engine in engines if getattr(engine, "bl_idname", "") == "CONIC"] == ["Conic"]


def test_f12_of_the_startup_scene(startup, tmp_path):
    startup.render.filepath = str(tmp_path / "startup.png")
    assert bpy.ops.render.render(write_still=True) == {"FINISHED"}
    pixels = picture(startup.render.filepath)
    assert pixels.shape == (54, 96, 4)
    cube, corner = pixels[20:34, 40:56, :3], pixels[50:, :8, :3]
    assert cube.max() > 2.0 * corner.mean() > 0.0
    assert np.isfinite(pixels).all() and (pixels[..., 3] == 1.0).all()


def test_an_exact_sphere_is_round_and_its_stand_in_is_not_seen(startup, tmp_path):
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.ops.conic.sphere_add()
    shapes = {}
    for kind in ("SPHERE", "MESH"):
        bpy.context.object.conic.primitive = kind
        startup.render.film_transparent = True
        startup.render.filepath = str(tmp_path / f"{kind}.png")
        startup.render.resolution_x, startup.render.resolution_y = 384, 216
        bpy.ops.render.render(write_still=True)
        shapes[kind] = picture(startup.render.filepath)[..., 3] > 0.5
    assert not (shapes["MESH"] & ~shapes["SPHERE"]).any(), "the stand-in is inscribed"
    assert (shapes["SPHERE"] & ~shapes["MESH"]).any(), "the sphere is rounder than it"


def test_animation(startup, tmp_path):
    startup.frame_start, startup.frame_end = 1, 2
    startup.render.filepath = str(tmp_path / "frame_")
    bpy.ops.render.render(animation=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["frame_0001.png", "frame_0002.png"]
