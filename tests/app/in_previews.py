"""Run in Blender's window by test_previews.py: show the previews of a material, a world and a light in turn.

blender --factory-startup --python tests/app/in_previews.py -- FOLDER

For each tab of the Properties editor that it shows, it writes FOLDER/TAB.json when the preview has come to rest, {} or
{"error": text}, and goes on when FOLDER/TAB.seen is there. It does not close the window.
"""

import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import addon
from tests.app.live_view import run_in_window, tell

sys.dont_write_bytecode = True
FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
TICK = 0.2  # seconds
REST = 3.0  # without a preview being rendered: it is done
TABS = "MATERIAL", "WORLD", "DATA"
OPEN = ("MATERIAL_PT_preview", "CONIC_WORLD_PT_preview", "DATA_PT_preview")
CLOSED = (
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
    "CONIC_LIGHT_PT_light",
)  # they show colors of their own


def set_panels():
    """Open the previews and close the panels above them: only a panel that was never drawn can be told so."""
    for names, options in ((OPEN, set()), (CLOSED, {"DEFAULT_CLOSED"})):
        for name in names:
            panel = getattr(bpy.types, name)
            bpy.utils.unregister_class(panel)
            panel.bl_options = options
            bpy.utils.register_class(panel)


def fill_scene():
    """A red material, a green world, a blue light."""
    material, world, light = bpy.data.materials["Material"], bpy.data.worlds["World"], bpy.data.lights["Light"]
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.8, 0.02, 0.02, 1.0)
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.02, 0.6, 0.02, 1.0)
    light.color, light.energy = (0.02, 0.05, 1.0), 200.0


def steps():
    """The whole way; each yield waits for one tick."""
    bpy.context.scene.render.engine = "CONIC"
    set_panels()
    fill_scene()
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    area.type = "PROPERTIES"
    for tab in TABS:
        window.view_layer.objects.active = bpy.data.objects["Light" if tab == "DATA" else "Cube"]
        yield
        area.spaces.active.context = tab
        rests_since = time.monotonic()
        while time.monotonic() - rests_since < REST:
            area.tag_redraw()
            yield
            if bpy.app.is_job_running("RENDER_PREVIEW"):
                rests_since = time.monotonic()
        tell(FOLDER / f"{tab}.json")
        while not (FOLDER / f"{tab}.seen").exists():
            yield


def failed(text):
    for tab in TABS:
        tell(FOLDER / f"{tab}.json", error=text)


bpy.context.preferences.view.show_splash = False
addon.register()
run_in_window(steps(), TICK, failed)
