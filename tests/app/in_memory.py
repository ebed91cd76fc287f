# SPDX-License-Identifier: GPL-3.0-or-later
"""Run in Blender's window by test_memory.py: many edits and frames of a rendered view, and the memory after each.

blender --factory-startup --python tests/app/in_memory.py -- FOLDER EDITS FRAMES

Writes FOLDER/memory.json: {"edits": {"SOLID": [KiB, ...], "RENDERED": [...]}, "frames": {...},
"loads": number}: the process's resident memory after each edit and each frame, first in Solid view, which is Blender's
own share, and how often the rendered view has loaded something. With a software rasteriser the memory holds what is on
the GPU too. {"error": text} if it failed.
"""

import json
import math
import sys
import time
from pathlib import Path

import bpy
import numpy as np
from mathutils import Quaternion

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import addon
from addon.operators.nff_shapes import new_point_cloud
from addon.viewport import history
from tests.app.live_view import Screen, fill_window, run_in_window, view_parts

sys.dont_write_bytecode = True
FOLDER, EDITS, FRAMES = sys.argv[sys.argv.index("--") + 1 :]
FOLDER, EDITS, FRAMES = Path(FOLDER), int(EDITS), int(FRAMES)
SPHERES = 20_000  # in the cloud: what is kept of one reading of it is a MiB or more
TICK = 0.005  # seconds
DRAWS = 2  # redraws an edit: one reads the scene, one shows it
MOST = 60.0  # seconds for them

screen = Screen()
loads = []  # records of what the rendered view loaded


def resident():
    """KiB of the process's memory that are in use."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    raise RuntimeError("no VmRSS in /proc/self/status")


def build_scene():
    """A cloud, shapes, an instanced mesh, a textured material, and something that moves on each frame."""
    scene = bpy.context.scene
    scene.render.engine, scene.conic.preview_samples, scene.frame_end = "CONIC", 1, 250
    scene.render.preview_pixel_size = "2"  # redraws are faster, and a film is still a MiB
    rng = np.random.default_rng(0)
    center = rng.normal(scale=0.6, size=(SPHERES, 3)).astype(np.float32)
    cloud = new_point_cloud("Cloud", center, np.full(SPHERES, 0.02, np.float32), bpy.data.materials["Material"])
    scene.collection.objects.link(cloud)
    with bpy.context.temp_override(**view_parts()):
        bpy.ops.conic.sphere_add(location=(2.0, 0.0, 0.0))
        bpy.context.object.name = "Ball"
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=60, y_subdivisions=60, size=4.0, location=(0.0, 0.0, -1.0))
        grid = bpy.context.object
    grid.name = "Grid"
    wave = grid.modifiers.new("Wave", "WAVE")
    wave.height, wave.show_viewport = 0.2, False
    ball = bpy.data.objects["Ball"]
    for frame in (1, 125, 250):
        ball.location.y = math.sin(frame)
        ball.keyframe_insert("location", frame=frame)


def move(count):
    bpy.data.objects["Cube"].location.x = 0.01 * (count % 100)


def recolor(count):
    bsdf = bpy.data.materials["Material"].node_tree.nodes["Principled BSDF"]
    bsdf.inputs["Base Color"].default_value = (0.01 * (count % 100), 0.5, 0.2, 1.0)


def shake_cloud(count):
    cloud = bpy.data.objects["Cloud"].data
    places = np.empty(3 * SPHERES, np.float32)
    cloud.attributes["position"].data.foreach_get("vector", places)
    places += np.random.default_rng(count).normal(scale=0.002, size=len(places)).astype(np.float32)
    cloud.attributes["position"].data.foreach_set("vector", places)
    cloud.update_tag()


def shake_mesh(count):
    mesh = bpy.data.objects["Grid"].data
    mesh.vertices[count % len(mesh.vertices)].co.z += 0.01
    mesh.update()


def relight(count):
    bpy.data.lights["Light"].energy = 500.0 + count % 100


def hide(count):
    bpy.data.objects["Grid"].hide_viewport = not bpy.data.objects["Grid"].hide_viewport


def add_or_delete(count):
    """Another mesh, or one less."""
    known = bpy.data.objects.get("Copy")
    if known:
        mesh = known.data
        bpy.data.objects.remove(known)
        bpy.data.meshes.remove(mesh)
        return
    mesh = bpy.data.objects["Grid"].data.copy()
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Copy", mesh))


def turn(count):
    view_parts()["area"].spaces.active.region_3d.view_rotation = Quaternion((0, 0, 1), 0.1 * count) @ Quaternion(
        (1, 0, 0), 1.1
    )


def redo_world(count):
    background = bpy.context.scene.world.node_tree.nodes["Background"]
    background.inputs["Strength"].default_value = 0.5 + 0.005 * (count % 100)


CHANGES = [move, recolor, shake_cloud, shake_mesh, relight, hide, add_or_delete, turn, redo_world]


def drawn(times=DRAWS):
    """Wait for so many redraws."""
    for _ in range(times):
        before = screen.drawn
        view_parts()["area"].tag_redraw()
        start = time.monotonic()
        while screen.drawn == before:
            if time.monotonic() - start > MOST:
                raise TimeoutError("the window is not drawn")
            yield
    loads.extend(record for record in history.records if getattr(record, "change", None))
    history.records.clear()


def edits():
    """Memory after each edit."""
    found = []
    for count in range(EDITS):
        CHANGES[count % len(CHANGES)](count)
        yield from drawn()
        found.append(resident())
    return found


def playback():
    """Memory after each frame of the animation, a waving grid in it."""
    grid, found = bpy.data.objects["Grid"], []
    grid.hide_viewport, grid.modifiers["Wave"].show_viewport = False, True
    for frame in range(FRAMES):
        bpy.context.scene.frame_set(1 + frame % 250)
        yield from drawn()
        found.append(resident())
    grid.modifiers["Wave"].show_viewport = False
    return found


def steps():
    """The whole way."""
    yield from fill_window()
    build_scene()
    found = {"edits": {}, "frames": {}}
    for kind in ("SOLID", "RENDERED"):
        view_parts()["area"].spaces.active.shading.type = kind
        yield from drawn()
        yield from screen.rest(1.0, MOST)
        found["edits"][kind] = yield from edits()
        found["frames"][kind] = yield from playback()
    tell(found | {"loads": len(loads)})


def tell(found):
    temporary = FOLDER / "memory.part"
    temporary.write_text(json.dumps(found))
    temporary.rename(FOLDER / "memory.json")


addon.register()
run_in_window(steps(), TICK, lambda text: tell({"error": text}))
