# SPDX-License-Identifier: GPL-3.0-or-later
"""Conic as Blender sees it. Each method hands over: to a render session or a viewport session."""

import bpy

from . import gpu_thread, viewport
from .engine.devices import blender_gpu
from .render_session import render_layer
from .viewport import scenes
from .viewport.session import ViewportSession


class ConicRenderEngine(bpy.types.RenderEngine):
    """Ray-trace exact spheres, cylinders, cones, discs, planes and triangles"""

    bl_idname = "CONIC"
    bl_label = "Conic"
    bl_use_preview = True
    bl_use_gpu_context = bpy.app.background  # see gpu_thread
    bl_use_eevee_viewport = True  # Material Preview mode shows the stand-in meshes
    bl_use_shading_nodes_custom = False  # Blender's own shader nodes

    def __init__(self, *args, **kwargs):
        # Blender calls this twice on the same object, and makes short-lived ones just to ask for passes.
        super().__init__(*args, **kwargs)
        self.viewport = None
        self.reported = set()

    def update_render_passes(self, scene, view_layer):
        self.register_pass(scene, view_layer, "Combined", 4, "RGBA", "COLOR")

    def render(self, depsgraph):
        render_layer(self, depsgraph)

    def view_update(self, context, depsgraph):
        scenes.mark(depsgraph)

    def view_draw(self, context, depsgraph):
        self.viewport = self.viewport or ViewportSession(self)
        self.viewport.draw(context, depsgraph)


def register():
    bpy.utils.register_class(ConicRenderEngine)
    gpu_thread.register()
    viewport.register()


def unregister():
    bpy.utils.unregister_class(ConicRenderEngine)
    viewport.unregister()
    gpu_thread.unregister()
    blender_gpu.free_programs()  # as the display shader: Python would free them after Blender's end
