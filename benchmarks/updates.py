# SPDX-License-Identifier: GPL-3.0-or-later
"""What edits of a scene with many spheres and instances cost: `python -m benchmarks.updates [--spheres 1000000]`.

Printed are the processor's milliseconds in `LoadedScene.prepare` and `apply`, which is the GPU's part (Mesa's driver
works on the processor), and the bytes that were uploaded. All edits are made twice; the second counts: what compiles or
is prepared once is there by then.
"""

import argparse
import time
import weakref
from dataclasses import replace

import numpy as np

from addon.engine import Camera, Geometry, Instances, Light, LoadedScene, Material, Scene, Settings, Spheres
from addon.engine.devices.headless import HeadlessDevice


def made_scene(spheres, instances):
    rng = np.random.default_rng(0)
    center = rng.random((spheres, 3), np.float32) * 10.0
    radius = np.full(spheres, 3.0 * spheres ** (-1 / 3), np.float32)
    scene = Scene(camera=Camera.look_at((5, -12, 8), (5, 5, 5)), materials=[Material(), Material(diffuse=0.3)])
    scene.shapes = Geometry(Spheres(center=center, radius=radius), name="world")
    ball, matrices = Geometry(Spheres(center=[[0, 0, 0]], radius=0.2)), np.tile(np.eye(4), (instances, 1, 1))
    matrices[:, :3, 3] = rng.uniform(0.0, 10.0, (instances, 3))
    scene.instances = [Instances(ball, matrices)]
    scene.add_light(Light.sun((0.3, -0.5, 1.0), 2.0))
    return scene


def material(scene, rng):
    return replace(scene, materials=[scene.materials[0], Material(diffuse=rng.random())])


def light(scene, rng):
    return replace(scene, lights=[Light.sun((0.3, -0.5, 1.0), rng.random())])


def one_instance(scene, rng):
    matrices = scene.instances[0].matrices.copy()
    matrices[-1, :3, 3] = rng.uniform(0.0, 10.0, 3)
    return replace(scene, instances=[replace(scene.instances[0], matrices=matrices), *scene.instances[1:]])


def new_mesh(scene, rng):
    mesh = Geometry(Spheres(center=rng.random((100, 3)), radius=0.1))
    return replace(scene, instances=[*scene.instances, Instances(mesh, np.diag([1.0, 1.0, 2.0, 1.0]))])


def all_spheres(scene, rng):
    part = scene.shapes.parts[0][1]
    step = rng.normal(0.0, 0.1 * part.radius[0], part.center.shape).astype(np.float32)
    moved = Geometry(Spheres(center=part.center + step, radius=part.radius), name="world")
    moved.replaces = weakref.ref(scene.shapes)
    return replace(scene, shapes=moved)


def camera(scene, _):
    return replace(scene, camera=Camera.look_at((5, -13, 8), (5, 5, 5)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--spheres", type=int, default=1_000_000)
    parser.add_argument("--instances", type=int, default=1000)
    options = parser.parse_args()
    rng, loaded = np.random.default_rng(1), LoadedScene(HeadlessDevice())
    scene = made_scene(options.spheres, options.instances)

    def measured(name):
        start = time.process_time()
        update = loaded.prepare(scene, Settings())
        prepared = time.process_time()
        loaded.apply(update)
        done = time.process_time()
        what = str(update.change).removeprefix("Change.") if name != "first" else ""
        seconds = f"{1e3 * (prepared - start):10.1f}{1e3 * (done - prepared):10.1f}"
        print(f"{name:<14}{seconds}{sum(update.bytes.values()):>13,}  {what}", flush=True)

    print(f"{'edit':<14}{'prepare':>10}{'apply':>10}{'bytes':>13}  change")
    measured("first")
    for edit in (camera, material, light, one_instance, new_mesh, all_spheres):
        for _ in range(2):
            scene = edit(scene, rng)
            measured(edit.__name__)


if __name__ == "__main__":
    main()
