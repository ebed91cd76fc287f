"""Open Blender's window with Conic selected, the rendered view, and the render settings: for a look, not a test.

blender --factory-startup --python tests/app/gui_interface.py [-- CONTEXT]

CONTEXT is the tab of the Properties editor, RENDER unless given: RENDER, OBJECT, MATERIAL, DATA, WORLD.
"""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import addon

TAB = sys.argv[sys.argv.index("--") + 1] if "--" in sys.argv else "RENDER"


def glass():
    """A material of clear glass."""
    material = bpy.data.materials.new("Glass")
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    bsdf = material.node_tree.nodes["Principled BSDF"]
    bsdf.inputs["Transmission Weight"].default_value = 1.0
    bsdf.inputs["Roughness"].default_value = 0.0
    return material


def fill_scene():
    """The startup scene with a floor, a stretched glass sphere and a cone."""
    bpy.ops.conic.plane_add(location=(0.0, 0.0, -1.0))
    bpy.ops.conic.cone_add(location=(-2.0, -1.0, 0.0), radius2=0.3)
    bpy.ops.conic.sphere_add(location=(2.0, -1.0, 0.3))
    bpy.context.object.scale.z = 1.3
    bpy.context.object.data.materials.append(glass())


def show():
    """The rendered view and the wanted tab."""
    for area in bpy.context.screen.areas:
        if area.type == "VIEW_3D":
            area.spaces.active.shading.type = "RENDERED"
        elif area.type == "PROPERTIES":
            area.spaces.active.context = TAB


bpy.context.preferences.view.show_splash = False
addon.register()
bpy.context.scene.render.engine = "CONIC"
fill_scene()
bpy.app.timers.register(show, first_interval=1.0)
