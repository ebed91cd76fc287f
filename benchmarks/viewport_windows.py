# SPDX-License-Identifier: GPL-3.0-or-later
"""Run in the application by benchmarks.viewport: make the files, then open a window a scene that measures.

blender -b --factory-startup --python benchmarks/viewport_windows.py -- FOLDER OPTIONS_AS_JSON
"""

import json
import os
import sys
import time
from contextlib import nullcontext
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import addon
from addon.operators.nff_shapes import new_point_cloud
from tests.app.screen import blender_window, virtual_screen

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[1]
MOST = 3600.0  # seconds for all of a scene


def centers(count):
    """Places (count, 3) float32 near a wavy surface in a ball of radius 1: from afar they are its lumps and holes."""
    rng = np.random.default_rng(0)
    kept, found = [], 0
    while found < count:
        points = rng.uniform(-1.0, 1.0, (2 * count + 1000, 3)).astype(np.float32)
        x, y, z = (6.0 * points).T
        wave = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
        points = points[(np.abs(wave) < 0.35) & ((points * points).sum(axis=1) < 1.0)]
        kept.append(points)
        found += len(points)
    return np.concatenate(kept)[:count]


def radius(count):
    """Of so many spheres that fill the same share of the surface."""
    return 0.6 * count ** (-1.0 / 3.0)


def points(count):
    cloud = new_point_cloud(
        "Points", centers(count), np.full(count, radius(count), np.float32), paint("Warm", (0.8, 0.35, 0.1))
    )
    bpy.context.scene.collection.objects.link(cloud)


def objects(count):
    """So many sphere objects that share one mesh."""
    bpy.ops.conic.sphere_add()
    first = bpy.context.object
    first.data.materials.append(paint("Warm", (0.8, 0.35, 0.1)))
    scale = [radius(count) / max(first.dimensions) * 2.0] * 3
    for index, center in enumerate(centers(count).tolist()):
        obj = first if index == 0 else first.copy()
        obj.location, obj.scale = center, scale
        if index:
            bpy.context.scene.collection.objects.link(obj)


def instances(count):
    """So many instances of a ball of 80 triangles, made by geometry nodes."""
    mesh = bpy.data.meshes.new("Places")
    mesh.vertices.add(count)
    mesh.vertices.foreach_set("co", centers(count).ravel())
    tree = bpy.data.node_groups.new("Instances", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    kinds = "NodeGroupInput", "GeometryNodeMeshIcoSphere", "GeometryNodeSetMaterial", "GeometryNodeInstanceOnPoints"
    given, ball, painted, placed = (tree.nodes.new(kind) for kind in kinds)
    ball.inputs["Radius"].default_value, ball.inputs["Subdivisions"].default_value = radius(count), 2
    painted.inputs["Material"].default_value = paint("Warm", (0.8, 0.35, 0.1))
    tree.links.new(ball.outputs["Mesh"], painted.inputs["Geometry"])
    tree.links.new(given.outputs[0], placed.inputs["Points"])
    tree.links.new(painted.outputs["Geometry"], placed.inputs["Instance"])
    tree.links.new(placed.outputs["Instances"], tree.nodes.new("NodeGroupOutput").inputs[0])
    obj = bpy.data.objects.new("Instances", mesh)
    obj.modifiers.new("Instances", "NODES").node_group = tree
    bpy.context.scene.collection.objects.link(obj)


PARTS = {"points": points, "objects": objects, "instances": instances}


def paint(name, color):
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1.0)
    return material


def save_files(name, folder, engines, samples):
    """The scene, `name` as points_1e3, in a file for each engine."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    world = scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0):
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.05, 0.1, 0.25, 1.0)
    if name != "empty":
        kind, count = name.split("_")
        PARTS[kind](int(float(count)))
        sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
        sun.data.energy, sun.data.angle = 3.0, 0.0
        sun.rotation_euler = Vector((-0.5, 1.0, -2.0)).to_track_quat("-Z", "Y").to_euler()
        scene.collection.objects.link(sun)
        bpy.ops.conic.sphere_add(location=(0.0, 0.0, 1.25))
        ball = bpy.context.object
        ball.name, ball.scale = "Ball", (0.2, 0.2, 0.2)
        ball.data.materials.append(paint("Green", (0.1, 0.7, 0.2)))
    scene.conic.preview_samples = scene.eevee.taa_samples = scene.cycles.preview_samples = samples
    scene.cycles.use_preview_adaptive_sampling = scene.cycles.use_preview_denoising = False
    for engine in engines:
        scene.render.engine = engine
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / f"{name}-{engine}.blend"), copy=True, compress=False)


def measure(scene, folder, options):
    """Open a window and wait until it has measured everything of a scene."""
    display = "DISPLAY" in os.environ and not options["virtual"]
    screen = nullcontext((dict(os.environ), None)) if display else virtual_screen(folder, *options["size"])
    arguments = "--python", ROOT / "benchmarks/viewport_in_window.py", "--", folder, scene, options["rounds"] + 1
    end, log = folder / f"{scene}.end", folder / f"{scene}.log"
    for old in (end, folder / f"{scene}.jsonl"):
        old.unlink(missing_ok=True)
    with (
        screen as (environment, _),
        blender_window(environment, options["size"], log, *arguments, *options["engines"]) as process,
    ):
        limit = time.monotonic() + MOST
        while not end.exists():
            if process.poll() is not None or time.monotonic() > limit:
                sys.exit(f"{scene}: the window ended or hung; Blender said:\n{log.read_text()}")
            time.sleep(0.5)
    if end.read_text():
        sys.exit(f"{scene}: {end.read_text()}\nBlender said:\n{log.read_text()}")


folder, options = sys.argv[sys.argv.index("--") + 1 :]
folder, options = Path(folder), json.loads(options)
addon.register()
save_files("empty", folder, options["engines"], options["samples"])
for name in options["scenes"]:
    save_files(name, folder, options["engines"], options["samples"])
    measure(name, folder, options)
addon.unregister()
