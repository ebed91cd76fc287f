"""Every geometry of Blender in the application's window: F12 and the rendered view show what a render without a
window does. The pictures stay in build/app-pictures."""

import shutil
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

from examples import every_geometry
from tests.app.screen import blender_window, save_picture, virtual_screen, wait_for
from tests.blender.pictures import picture

ROOT = Path(__file__).resolve().parents[2]
SIZE = 640, 480  # the smallest window that Blender opens
COLUMNS = 5

pytestmark = pytest.mark.skipif(not shutil.which("Xvfb"), reason="Xvfb, a virtual screen, is not installed")


@pytest.fixture(scope="module")
def pictures(registered, tmp_path_factory):
    """The picture (h, w, 3) of each way to it: background, f12, viewport."""
    folder = ROOT / "build" / "app-pictures" / sys.argv[sys.argv.index("--gpu-backend") + 1]
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    file = tmp_path_factory.mktemp("window") / "geometry.blend"
    save_scene(file)
    bpy.context.scene.render.filepath = str(folder / "background.png")
    bpy.ops.render.render(write_still=True)
    save_picture(show_in_window(file, folder), folder / "viewport.png")
    return {path.stem: picture(path)[..., :3] for path in sorted(folder.glob("*.png"))}


def save_scene(file):
    """All geometries, small and with few samples, in a file."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = every_geometry.build_scene(COLUMNS)
    for obj in bpy.data.objects:
        obj.use_fake_user = not obj.users_collection  # a particle system does not keep the object that it shows
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.dither_intensity = 0.0
    scene.view_settings.view_transform = "Standard"
    scene.conic.samples = scene.conic.preview_samples = 2
    bpy.ops.wm.save_as_mainfile(filepath=str(file))


def show_in_window(file, folder):
    """Have in_window.py render the file to `folder`/f12.png; what the viewport then shows, (h, w, 3)."""
    script, log = Path(__file__).with_name("in_window.py"), file.with_suffix(".log")
    with (
        virtual_screen(file.parent, *SIZE) as (environment, pixels),
        blender_window(environment, SIZE, log, file, "--python", script, "--", file.parent) as process,
    ):
        state = wait_for(file.parent / "state.json", process, log)
        screen = pixels()
    shutil.copy(file.parent / "f12.png", folder)
    x, y, width, height = state["region"]
    assert (width, height) == SIZE, "the view fills the window"
    return screen[y : y + height, x : x + width]


def is_object(pixels):
    """Where something stands before the grey room, (h, w) bool: all objects have a hue."""
    return pixels.max(axis=-1) - pixels.min(axis=-1) > 0.08


@pytest.mark.parametrize("way", ["f12", "viewport"])
def test_the_window_shows_what_the_background_renders(pictures, way):
    shown, expected = pictures[way], pictures["background"]
    masks = is_object(shown), is_object(expected)
    # Blender's viewport also shows the object that a vertex or face instancer copies, a render does not.
    assert (masks[0] != masks[1]).mean() < 0.002, "every shape is in its place"
    difference = np.abs(shown - expected).max(axis=-1)
    assert (difference > 3 / 255).mean() < 0.005
    assert difference.mean() < 1 / 255


def test_every_geometry_is_seen(pictures):
    mask = is_object(pictures["background"])
    height, width = mask.shape
    rows = -(-len(every_geometry.BUILDERS) // COLUMNS)
    seen = mask[: rows * (height // rows), : COLUMNS * (width // COLUMNS)]
    cells = seen.reshape(rows, height // rows, COLUMNS, width // COLUMNS).sum(axis=(1, 3))
    assert cells.min() > 100, cells
