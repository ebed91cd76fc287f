"""Run in Blender's window: does what a test in another process asks for, see remote.py.

blender --factory-startup --python tests/app/in_remote.py -- FOLDER

Runs each FOLDER/request.py that appears, all in one namespace, and answers in FOLDER/reply.json: {"result": what the
script has left in the variable `result`} or {"error": text}.
"""

import json
import sys
import time
import traceback
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import addon

sys.dont_write_bytecode = True
FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
TICK = 0.02  # seconds

drawn = [time.monotonic()]  # when a 3D viewport was drawn last


def view_parts(number=0):
    """Window, area and region of a 3D viewport, for an override of the context."""
    window = bpy.context.window_manager.windows[0]
    areas = [area for area in window.screen.areas if area.type == "VIEW_3D"]
    regions = [region for region in areas[number].regions if region.type == "WINDOW"]
    return {"window": window, "area": areas[number], "region": regions[-1]}


def rested():
    """For how many seconds nothing was drawn."""
    return time.monotonic() - drawn[0]


namespace = {"bpy": bpy, "addon": addon, "view_parts": view_parts, "rested": rested}


def answer(request):
    """Run a script; what to reply."""
    namespace["result"] = None
    try:
        exec(request, namespace)
    except Exception:
        return {"error": traceback.format_exc()}
    return {"result": namespace["result"]}


def tick():
    """Look for a script; seconds until the next look."""
    request = FOLDER / "request.py"
    if request.exists():
        text = request.read_text()
        request.unlink()
        temporary = FOLDER / "reply.part"
        temporary.write_text(json.dumps(answer(text)))
        temporary.rename(FOLDER / "reply.json")
    return TICK


bpy.context.preferences.view.show_splash = False
bpy.context.preferences.view.smooth_view = 0
bpy.context.preferences.view.render_display_type = "NONE"
bpy.types.SpaceView3D.draw_handler_add(lambda: drawn.__setitem__(0, time.monotonic()), (), "WINDOW", "POST_PIXEL")
addon.register()
bpy.app.timers.register(tick, first_interval=1.0, persistent=True)
