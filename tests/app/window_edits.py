# SPDX-License-Identifier: GPL-3.0-or-later
"""Random edits of settings and views, undo, renders, files."""

import bpy
from mathutils import Euler, Quaternion

from tests.app.live_view import view_parts
from tests.app.torture_edits import edit, operate, spaces

ENGINES = ["CYCLES", "BLENDER_WORKBENCH", "BLENDER_EEVEE"]
RENDER_TICKS = 2000  # at most, of the timer that runs the edits


# Settings


@edit(4)
def setting(edits):
    scene = bpy.context.scene
    way = edits.random.choice(
        ["samples", "depth", "pixel_size", "transparent", "outlines", "flat", "exposure", "filter"]
    )
    if way == "samples":
        scene.conic.preview_samples = edits.random.randint(1, 3)
    elif way == "depth":
        scene.conic.max_depth = edits.random.randint(1, 6)
    elif way == "pixel_size":
        scene.render.preview_pixel_size = edits.random.choice(["AUTO", "1", "2", "4"])
    elif way == "transparent":
        scene.render.film_transparent = not scene.render.film_transparent
    elif way == "exposure":
        scene.view_settings.exposure = edits.number(-1.0, 1.0)
    elif way == "filter":
        scene.render.filter_size = edits.number(0.1, 2.0)
    else:
        names = [name for name in ("use_outlines", "use_flat", "use_depth_cue") if hasattr(scene.conic, name)]
        if names:
            name = edits.random.choice(names)
            setattr(scene.conic, name, not getattr(scene.conic, name))
            return name
    return way


# Views


@edit(10)
def look(edits):
    view = edits.random.choice(spaces()).region_3d
    view.view_perspective = edits.random.choice(["PERSP", "PERSP", "PERSP", "ORTHO", "CAMERA"])
    view.view_rotation = (
        Quaternion((0, 0, 1), edits.number(0.0, 6.0)) @ Euler((edits.number(0.3, 2.0), 0.0, 0.0)).to_quaternion()
    )
    view.view_distance, view.view_location = edits.number(3.0, 14.0), edits.vector(0.7)
    view.view_camera_zoom, view.view_camera_offset = edits.number(-20.0, 40.0), (edits.number(-0.2, 0.2), 0.0)
    return view.view_perspective


@edit(2)
def lens(edits):
    space = edits.random.choice(spaces())
    space.lens, space.clip_start, space.clip_end = edits.number(20, 90), edits.random.choice([0.01, 2.0]), 200.0
    return "lens"


@edit(3)
def local_view(edits):
    obj = edits.object("MESH", "POINTCLOUD")
    if obj and obj.name in bpy.context.view_layer.objects and obj.visible_get():
        obj.select_set(True)
    return f"local view {operate(bpy.ops.view3d.localview, frame_selected=False)}"


@edit(2)
def show_types(edits):
    space = edits.random.choice(spaces())
    way = f"show_object_viewport_{edits.random.choice(['mesh', 'light', 'pointcloud', 'empty'])}"
    setattr(space, way, not getattr(space, way))
    return way


@edit(3)
def border(edits):
    low, high = sorted([edits.random.random(), edits.random.random()])
    for owner, prefix in ((edits.random.choice(spaces()), "render_"), (bpy.context.scene.render, "")):
        if edits.random.random() < 0.5:
            setattr(owner, f"use_{prefix or 'render_'}border" if prefix else "use_border", edits.random.random() < 0.5)
            for axis in "xy":
                setattr(owner, f"{prefix}border_min_{axis}", low)
                setattr(owner, f"{prefix}border_max_{axis}", high)
    return f"{low:.2f} to {high:.2f}"


@edit(3)
def split_or_close(edits):
    """Another viewport, or one less; sometimes four at once."""
    screen = bpy.context.window_manager.windows[0].screen
    areas = [area for area in screen.areas if area.type == "VIEW_3D"]
    way = edits.random.choice(["split", "close", "quad"])
    if way == "split" and len(areas) < 3:
        operate(bpy.ops.screen.area_split, direction=edits.random.choice(["VERTICAL", "HORIZONTAL"]), factor=0.4)
    elif way == "close" and len(areas) > 1:
        with bpy.context.temp_override(area=min(areas, key=lambda area: area.width * area.height)):
            bpy.ops.screen.area_close()
    elif way == "quad":
        operate(bpy.ops.screen.region_quadview)
    yield
    return way


@edit(2)
def other_editor(edits):
    """A viewport is another editor for a while."""
    area = view_parts()["area"]
    area.type = edits.random.choice(["IMAGE_EDITOR", "NODE_EDITOR", "TEXT_EDITOR"])
    yield
    area.type = "VIEW_3D"
    return "an editor of another type and back"


@edit(3)
def shading(edits):
    space = edits.random.choice(spaces())
    space.shading.type = edits.random.choices(["SOLID", "WIREFRAME", "MATERIAL"], [3, 3, 1])[0]
    kind = space.shading.type
    yield
    for space in spaces():
        space.shading.type = "RENDERED"
    return kind


@edit(2)
def engine(edits):
    scene = bpy.context.scene
    kind = scene.render.engine = edits.random.choices(ENGINES, [3, 3, 1])[0]
    yield
    bpy.context.scene.render.engine = "CONIC"
    return kind


# Undo, render, files


@edit(8)
def undo(edits):
    way = edits.random.choice([bpy.ops.ed.undo, bpy.ops.ed.undo, bpy.ops.ed.redo])
    times = edits.random.randint(1, 3)
    for _ in range(times):
        try:
            operate(way)
        except RuntimeError:  # nothing is left to be undone
            return "nothing left"
        yield
    return f"{way.idname_py()} {times}"


@edit(2)
def render(edits):
    """F12, and turning the view while it renders. No edits: Blender does not promise that scripts may make them then,
    and with any engine written in Python that takes a second for it the next undo can crash."""
    if bpy.context.scene.camera:
        operate(bpy.ops.render.render, "INVOKE_DEFAULT")
        yield
    for _ in range(RENDER_TICKS):
        if not bpy.app.is_job_running("RENDER"):
            return "F12"
        look(edits)
        yield
    raise TimeoutError("a render of 160 x 90 pixels did not end")


@edit(1)
def open_file(edits):
    path, ui = str(edits.folder / "saved.blend"), edits.random.random() < 0.3
    bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
    yield
    bpy.ops.wm.open_mainfile(filepath=path, load_ui=ui)
    yield
    return f"with its window: {ui}"


@edit(0.5)
def disable_and_enable(edits):
    import addon

    addon.unregister()
    yield
    addon.register()
    bpy.context.scene.render.engine = "CONIC"
    return "the add-on"


#: After these a view begins anew: a stale picture would be gone.
FORGETTING = {shading, engine, undo, open_file, disable_and_enable}
