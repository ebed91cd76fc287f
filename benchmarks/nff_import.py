"""How long File > Import > Neutral File Format takes: `python -m benchmarks.nff_import`. Seconds, once each.

`read`: the file into arrays; `import`: that, and from these Blender's objects; `sync`: the objects back into the
engine's scene.
"""

import tempfile
import time
from pathlib import Path

import bpy

import addon
from addon.engine.nff import read_nff, write_nff
from addon.sync.scene_sync import sync_scene
from examples.standard_scenes import balls, lattice, mount, tree

SCENES = {
    "balls 4": lambda: balls(4),
    "balls 5": lambda: balls(5),
    "balls 6": lambda: balls(6),
    "tree 11": lambda: tree(11),
    "mount 8": lambda: mount(8),
    "lattice 40": lambda: lattice(40),
}


def seconds(work):
    """How long `work()` takes, and what it returns."""
    started = time.perf_counter()
    result = work()
    return time.perf_counter() - started, result


def measure(name, path):
    """Print a row for the file at `path`."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    read, file = seconds(lambda: read_nff(path))
    imported, _ = seconds(lambda: bpy.ops.import_scene.nff(filepath=str(path)))
    depsgraph = bpy.context.evaluated_depsgraph_get()
    sync, _ = seconds(lambda: sync_scene(depsgraph, file.width, file.height, report=lambda level, message: None))
    counts = ", ".join(f"{count:,} {kind}s" for kind, count in file.scene.primitive_counts().items())
    print(f"{name:10} read {read:6.2f}  import {imported:6.2f}  sync {sync:6.2f}   {counts}")


if __name__ == "__main__":
    addon.register()
    with tempfile.TemporaryDirectory() as folder:
        for name, make in SCENES.items():
            path = Path(folder, f"{name}.nff")
            write_nff(make(), path, 512, 512)
            measure(name, path)
    addon.unregister()
