"""Run in Blender's window by test_window.py: render the opened file as F12 does, then show its camera's view rendered.

blender --factory-startup FILE.blend --python tests/app/in_window.py -- FOLDER

Writes FOLDER/f12.png, then, once the view has come to rest, FOLDER/state.json: {"region": [x, y, width, height]} in
pixels from the window's lower left, or {"error": text}. It does not close the window.
"""

import math
import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import addon
from tests.app.live_view import fill_window, run_in_window, tell, view_parts

sys.dont_write_bytecode = True
FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
TICK = 0.2  # seconds
REST = 2.0  # without a redraw: the picture is done

draws = []  # when the rendered view was drawn


def steps():
    """The whole way; each yield waits for one tick."""
    bpy.context.preferences.view.render_display_type = "NONE"
    scene = bpy.context.scene
    scene.render.filepath = str(FOLDER / "f12.png")
    done = []
    bpy.app.handlers.render_write.append(lambda *_: done.append(True))
    bpy.app.handlers.render_cancel.append(lambda *_: done.append(False))
    yield
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
        bpy.ops.render.render("INVOKE_DEFAULT", write_still=True)
    while not done:
        yield
    if not done[0]:
        raise RuntimeError("the render was cancelled")
    yield from show_camera_view()
    while not draws or time.monotonic() - draws[-1] < REST:
        yield
    region = view_parts()["region"]
    tell(FOLDER / "state.json", region=[region.x, region.y, region.width, region.height])


def show_camera_view():
    """Fill the window with what the camera sees, rendered, pixel by pixel."""
    yield from fill_window()
    space = view_parts()["area"].spaces.active
    space.region_3d.view_perspective = "CAMERA"
    space.region_3d.view_camera_offset = 0.0, 0.0
    space.region_3d.view_camera_zoom = 100.0 - 50.0 * math.sqrt(2.0)  # the picture as large as the region
    yield
    bpy.types.SpaceView3D.draw_handler_add(lambda: draws.append(time.monotonic()), (), "WINDOW", "POST_PIXEL")
    space.shading.type = "RENDERED"


addon.register()
run_in_window(steps(), TICK, lambda text: tell(FOLDER / "state.json", error=text))
