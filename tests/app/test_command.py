"""The application as a user runs it: a saved scene, rendered by a command of its own."""

import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

from tests.blender.pictures import picture

ROOT = Path(__file__).resolve().parents[2]
REGISTER = (
    f"import sys; sys.dont_write_bytecode = True; sys.path.insert(0, {str(ROOT)!r}); import addon; addon.register()"
)
WIDTH, HEIGHT = 48, 32


@pytest.fixture
def scene_file(registered, tmp_path):
    """Blender's startup scene, small, with an exact sphere that moves to the left; saved."""
    bpy.ops.wm.read_factory_settings(use_empty=False)
    scene = bpy.context.scene
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.ops.conic.sphere_add()
    for frame, x in ((1, 1.0), (2, -1.0)):
        bpy.context.object.location.x = x
        bpy.context.object.keyframe_insert("location", frame=frame)
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    scene.frame_start, scene.frame_end = 1, 2
    scene.conic.samples = 2
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def run_blender(path, *arguments):
    """Blender without a window on the file, with this one's GPU back end; what it said, the return code."""
    backend = sys.argv[sys.argv.index("--gpu-backend") :][:2]
    command = [bpy.app.binary_path, "-b", *backend, "--factory-startup", path, "--python-exit-code", "9"]
    command += ["--python-expr", REGISTER, "-E", "CONIC", "-o", path.parent / "out_####", *arguments]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=300)
    return done.returncode, done.stdout + done.stderr


def assert_shows_a_sphere(pixels):
    """A world that is not black, and before it something that a lamp lights."""
    assert pixels.shape[:2] == (HEIGHT, WIDTH)
    world = pixels[:, 0]
    assert world.min() > 0.0 and pixels.max() > 1.5 * world.max()


def written(folder):
    return sorted(path.name for path in folder.iterdir() if path.name.startswith("out_"))


def test_one_frame(scene_file):
    code, said = run_blender(scene_file, "-f", "1")
    assert code == 0, said
    assert written(scene_file.parent) == ["out_0001.png"] and "Traceback" not in said
    assert_shows_a_sphere(picture(scene_file.parent / "out_0001.png")[..., :3])


def test_an_animation(scene_file):
    code, said = run_blender(scene_file, "-a")
    assert code == 0, said
    assert written(scene_file.parent) == ["out_0001.png", "out_0002.png"] and "Traceback" not in said
    first, second = (picture(scene_file.parent / name)[..., :3] for name in written(scene_file.parent))
    for pixels in (first, second):
        assert_shows_a_sphere(pixels)
    assert np.abs(first - second).max() > 0.1, "the sphere moves"


def test_a_scene_that_cannot_be_rendered_writes_nothing(scene_file):
    bpy.context.scene.camera = bpy.data.objects["Light"]
    bpy.ops.wm.save_mainfile()
    _, said = run_blender(scene_file, "-a")
    assert not written(scene_file.parent) and "'Light' (light) is set as its camera" in said, said
