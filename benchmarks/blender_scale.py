# SPDX-License-Identifier: GPL-3.0-or-later
"""Large scenes through Blender, from F12 to the first picture, part by part: `python -m benchmarks.blender_scale`.

    python -m benchmarks.blender_scale [--parts points_1e7 ...] [--size 640 360]

It needs a Python that has bpy. Each part is a scene in a process of its own, rendered twice: by an engine that draws
nothing, which gives what Blender itself takes, and by Conic with one sample a pixel. Printed are seconds:

    blender   Blender's own evaluation and handling, by the empty engine
    read      from the depsgraph to Conic's scene
    tree      boxes, sorting, the tree and its records
    upload    textures; with a software driver a copy
    compile   the shader's; a driver that remembers it makes this short
    draw      the first sample of all pixels
    total     of the render operator, Blender's share included

and, in MiB, the process's peak above the peak with the empty engine, and what is on the GPU. With a software driver
the GPU's memory is the process's too.
"""

import argparse
import subprocess
import sys
import time

import bpy
import numpy as np
from mathutils import Vector

from addon import statistics
from addon.operators.nff_shapes import new_point_cloud
from benchmarks.spheres import Memory
from examples.every_geometry import NodeTree, link, out_of_sight, prototype, vertices
from examples.in_blender import empty_blender
from examples.standard_scenes import balls

LATTICE = 103


def points(count):
    """Spheres of like size in a cube of side 2, a tenth of it by volume."""
    rng = np.random.default_rng(0)
    center = rng.random((count, 3), np.float32) * np.float32(2.0) - np.float32(1.0)
    radius = rng.uniform(0.2, 0.7, count).astype(np.float32) * np.float32(count ** (-1 / 3))
    show(new_point_cloud("points", center, radius, paint()))


def sphereflake(depth):
    """The balls of the Standard Procedural Databases as one point cloud."""
    spheres = next(part for _, part in balls(depth).shapes.kinds() if part.kind == "sphere")
    show(new_point_cloud("sphereflake", spheres.center, spheres.radius, paint()))


def lattice(side):
    """A sphere on each of side^3 places and a cylinder to each neighbour: a mesh of edges with a strand radius."""
    index = np.arange(side**3).reshape(side, side, side)
    pairs = [(index[:-1], index[1:]), (index[:, :-1], index[:, 1:]), (index[:, :, :-1], index[:, :, 1:])]
    edges = np.concatenate([np.stack([a.ravel(), b.ravel()], axis=1) for a, b in pairs])
    mesh = vertices(np.stack(np.unravel_index(index.ravel(), index.shape), axis=1) * (2.0 / (side - 1)) - 1.0)
    mesh.edges.add(len(edges))
    mesh.edges.foreach_set("vertices", edges.astype(np.int32).ravel())
    mesh.materials.append(paint())
    link(mesh, "lattice").conic.strand_radius = 0.2 / side


def instances(count, kind):
    """Copies by geometry nodes, scaled at random, of an object: a sphere or a monkey."""
    copied = prototype(kind, paint(), size=1.0)
    rng = np.random.default_rng(0)
    tree = NodeTree("copies")
    info = tree.node("ObjectInfo", {"Object": out_of_sight(copied), "As Instance": True})
    made = tree.node(
        "InstanceOnPoints",
        {"Points": tree.geometry, "Instance": info.outputs["Geometry"], "Scale": tree.attribute("size")},
    )
    size = rng.uniform(0.2, 0.5, count) * count ** (-1 / 3)
    tree.on(link(vertices(rng.random((count, 3)) * 2.0 - 1.0, size=size), "copies"), made.outputs[0])


PARTS = {
    "points_1e6": lambda: points(1_000_000),
    "points_1e7": lambda: points(10_000_000),
    "sphereflake_66430": lambda: sphereflake(5),
    "sphereflake_597871": lambda: sphereflake(6),
    "lattice": lambda: lattice(LATTICE),
    "spheres_1e5": lambda: instances(100_000, "sphere"),
    "spheres_1e6": lambda: instances(1_000_000, "sphere"),
    "monkeys_1e5": lambda: instances(100_000, "monkey"),
    "monkeys_1e6": lambda: instances(1_000_000, "monkey"),
}


def show(obj):
    bpy.context.scene.collection.objects.link(obj)


def paint():
    material = bpy.data.materials.new("Paint")
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.7, 0.5, 0.3, 1.0)
    return material


def add_camera_and_sun():
    scene = bpy.context.scene
    scene.camera = link(bpy.data.cameras.new("Camera"), "Camera")
    scene.camera.location = (3.0, -4.2, 2.3)
    scene.camera.rotation_euler = (-scene.camera.location).to_track_quat("-Z", "Y").to_euler()
    sun = link(bpy.data.lights.new("Sun", "SUN"), "Sun")
    sun.data.energy, sun.data.angle = 3.0, 0.0
    sun.rotation_euler = Vector((-0.5, 1.0, -2.0)).to_track_quat("-Z", "Y").to_euler()


class NothingEngine(bpy.types.RenderEngine):
    """Draws nothing, so that a render costs what Blender itself takes."""

    bl_idname = "CONIC_BENCHMARK_NOTHING"
    bl_label = "Nothing"

    def render(self, depsgraph):
        self.end_result(self.begin_result(0, 0, self.resolution_x, self.resolution_y))


def rendered(engine):
    """Seconds and peak memory of a render by one engine."""
    bpy.context.scene.render.engine = engine
    with Memory() as memory:
        started = time.perf_counter()
        bpy.ops.render.render()
        return time.perf_counter() - started, memory


def measure(part, size):
    """Print one line."""
    empty_blender()
    bpy.utils.register_class(NothingEngine)
    add_camera_and_sun()
    PARTS[part]()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.conic.samples = 1
    own, own_memory = rendered(NothingEngine.bl_idname)
    total, memory = rendered("CONIC")
    bpy.utils.unregister_class(NothingEngine)
    found = statistics.latest()
    if found is None:
        sys.exit(f"{part}: the render failed")
    stages = [found.seconds[stage] for stage in ("read", "build", "upload", "compile", "trace")]
    row = "".join(f"{seconds:9.2f}" for seconds in (own, *stages, total))
    above = (memory.peak - own_memory.peak) / 2**20
    print(f"{part:20}{row}{above:9.0f}{found.gpu_total / 2**20:9.0f}  {statistics.primitives_text(found.primitives)}")
    parts = {name: seconds for of_stage in found.parts.values() for name, seconds in of_stage.items()}
    print(f"{'':22}{', '.join(f'{name} {seconds:.2f}' for name, seconds in parts.items())}", flush=True)


def main():
    parser = argparse.ArgumentParser(prog="python -m benchmarks.blender_scale", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--size", type=int, nargs=2, default=(640, 360), metavar=("W", "H"))
    parser.add_argument("--here", action="store_true", help="measure the one part in this process")
    arguments = parser.parse_args()
    if arguments.here:
        measure(arguments.parts[0], arguments.size)
        return
    columns = ("blender", "read", "tree", "upload", "compile", "draw", "total", "peak", "GPU")
    print(f"Blender {bpy.app.version_string}, {arguments.size[0]} x {arguments.size[1]}")
    print(f"{'':20}{''.join(f'{name:>9}' for name in columns)}", flush=True)
    for part in arguments.parts:
        size = [str(pixels) for pixels in arguments.size]
        command = [sys.executable, "-m", "benchmarks.blender_scale", "--here", "--parts", part, "--size", *size]
        subprocess.run(command, check=False)


if __name__ == "__main__":
    main()
