"""How long reading a Blender scene takes: `python -m benchmarks.sync [THOUSANDS]`, in an environment that has bpy.

Seconds by part, the best of three, for so many thousand instances made by geometry nodes, of a sphere that is
recognised and of a mesh; the same by Blender's iterator; a point cloud; and ten thousand objects.
"""

import sys

import bpy

import addon
from addon.sync import instancing
from addon.sync.scene_sync import SyncStatistics, sync_scene
from tests.blender.building import GeometryNodes, add_camera, link, quad, with_nodes


def instances(thousands, mesh):
    nodes = GeometryNodes()
    grid = nodes.add("MeshGrid", Vertices_X=1000, Vertices_Y=thousands, Size_X=1000.0, Size_Y=float(thousands))
    turned = {"Instance": nodes.add(mesh), "Rotation": nodes.add("InputPosition")}
    nodes.output(nodes.add("InstanceOnPoints", Points=grid, **turned))
    with_nodes(nodes)


def points(thousands):
    nodes = GeometryNodes()
    nodes.output(nodes.add("Points", Count=thousands * 1000, Position=nodes.add("InputPosition")))
    with_nodes(nodes)


def objects(thousands):
    data = quad().data
    for i in range(thousands * 1000 - 1):
        link(data, "copy", location=(i, 0.0, 0.0))


def measure(name, build, iterate=False):
    """Print the seconds that a scene takes, part by part."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    add_camera()
    build()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    geometry_sets = instancing.has_geometry_sets
    instancing.has_geometry_sets = (lambda: False) if iterate else geometry_sets
    runs = []
    for _ in range(3):
        statistics = SyncStatistics()
        sync_scene(depsgraph, 640, 480, report=print, statistics=statistics)
        runs.append(statistics.seconds)
    instancing.has_geometry_sets = geometry_sets
    best = min(runs, key=lambda seconds: sum(seconds.values()))
    parts = "  ".join(f"{part} {spent:7.3f}" for part, spent in best.items())
    print(f"{name:<42} {sum(best.values()):7.3f} s   {parts}")


def main(thousands):
    addon.register()
    print(f"Blender {bpy.app.version_string}")
    for name, mesh in {"sphere, recognized": "MeshUVSphere", "cube": "MeshCube"}.items():
        for iterate in (False, True):
            how = "by the iterator" if iterate else "whole"
            measure(f"{thousands * 1000:,} x {name}, {how}", lambda mesh=mesh: instances(thousands, mesh), iterate)
    measure(f"{thousands * 1000:,} points", lambda: points(thousands))
    measure("10,000 objects", lambda: objects(10))
    addon.unregister()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
