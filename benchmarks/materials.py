# SPDX-License-Identifier: GPL-3.0-or-later
"""What many materials cost: `python -m benchmarks.materials`, with a Python that has bpy.

Each row is a Blender file of so many different materials on as many balls, made from the same fourteen kinds of node
trees with random constants, or all of different structure. Printed are, medians of three processes without a shader
cache:

    programs  GLSL programs, and the lines of the fragment shader that holds them all
    compile   seconds of the driver, the first tiny draw included
    draw      seconds of the first sample of 320 x 180 pixels
    changed   programs compiled anew after every constant of every material was changed
"""

import argparse
import json
import os
import statistics
import subprocess
import sys

ROWS = {"1 plain": (1, 1), "14 kinds": (14, 14), "100 of 14 kinds": (100, 14), "100 different": (100, 100)}


def kinds():
    """Functions of a random generator, each the surface of one kind of node tree."""
    from examples.shader_trees import ramp, shader

    def color(rng):
        return (*rng.random(3), 1.0)

    def texture(kind, output, rng, **settings):
        return shader(kind, output, Vector=shader("TexCoord", "Object"), Scale=rng.uniform(1.0, 9.0), **settings)

    def plastic(rng, **inputs):
        return shader("BsdfPrincipled", **{"Base_Color": color(rng), "Roughness": rng.uniform(0.1, 0.9)} | inputs)

    def mixed(rng, factor, first, second):
        return shader("MixShader", input_0=factor, input_1=first, input_2=second)

    def noise(rng):
        return texture("TexNoise", "Fac", rng, Detail=3.0)

    return (
        plastic,
        lambda rng: shader("BsdfDiffuse", Color=color(rng)),
        lambda rng: plastic(rng, Base_Color=ramp(noise(rng), (0.3, rng.random(3)), (0.7, rng.random(3)))),
        lambda rng: plastic(rng, Normal=shader("Bump", Height=noise(rng), Strength=rng.random())),
        lambda rng: plastic(rng, Base_Color=texture("TexVoronoi", "Color", rng)),
        lambda rng: plastic(rng, Roughness=texture("TexVoronoi", "Distance", rng)),
        lambda rng: plastic(rng, Base_Color=texture("TexChecker", "Color", rng, Color1=color(rng), Color2=color(rng))),
        lambda rng: plastic(rng, Base_Color=texture("TexBrick", "Color", rng, Color1=color(rng), Mortar=color(rng))),
        lambda rng: plastic(rng, Base_Color=texture("TexMagic", "Color", rng)),
        lambda rng: plastic(rng, Metallic=1.0, Roughness=texture("TexWave", "Fac", rng, Distortion=rng.random())),
        lambda rng: shader("BsdfGlass", Color=color(rng), IOR=rng.uniform(1.2, 1.8)),
        lambda rng: mixed(
            rng, shader("Fresnel", IOR=rng.uniform(1.2, 1.8)), shader("BsdfDiffuse", Color=color(rng)), plastic(rng)
        ),
        lambda rng: mixed(rng, noise(rng), plastic(rng), shader("BsdfTranslucent", Color=color(rng))),
        lambda rng: shader("Emission", Color=color(rng), Strength=rng.random()),
    )


def measure(name):
    """The row of one process, as JSON."""
    import bpy
    import numpy as np

    from addon.engine.devices.headless import HeadlessDevice
    from addon.engine.session import Session
    from addon.engine.settings import Settings
    from addon.sync.scene_sync import sync_scene
    from examples.in_blender import empty_blender, new_light
    from examples.shader_trees import new_material
    from examples.stage import Stage, add_camera

    count, structures = ROWS[name]
    rng = np.random.default_rng(7)
    empty_blender()
    stage, made = Stage(), kinds()
    side = int(np.ceil(np.sqrt(count)))
    for number in range(count):
        surface = made[number % len(made)](rng)
        if structures > len(made):
            surface = varied(surface, number, rng)
        place = (number % side - side / 2.0, number // side - side / 2.0, 0.0)
        stage.place(f"ball {number}", stage.ball, new_material(f"material {number}", surface), place, 0.45)
    stage.collection.objects.link(new_light("SUN", (1.0, -2.0, 4.0), 3.0, "ffffff"))
    bpy.context.scene.camera = add_camera(stage, (0.0, -0.6 * side - 1.0, 1.2 * side + 1.0), (0.0, 0.0, 0.0))

    def loaded():
        depsgraph = bpy.context.evaluated_depsgraph_get()
        session.load(sync_scene(depsgraph, 320, 180, report=lambda *message: None), Settings())
        session.start(320, 180)
        while session.step(1.0):
            pass

    session = Session(HeadlessDevice())
    loaded()
    seconds = dict(session.statistics()["seconds"])
    source = session.loaded.drawn.source
    programs = _count_programs(session.loaded.drawn.packed.programs)
    change_constants(rng)
    loaded()
    row = {
        "programs": programs,
        "lines": source.text.count("\n"),
        "compile": seconds["compile"],
        "draw": seconds["trace"],
        "changed": int(session.loaded.drawn.source != source),
    }
    print(json.dumps(row))


def _count_programs(text):
    """The largest number that a text compares `program` with."""
    import re

    return max(map(int, re.findall(r"program [=<]= (\d+)", text)), default=0)


def varied(surface, number, rng):
    """A surface under a chain of Math nodes of its own, which nothing else has."""
    from examples.shader_trees import shader

    operations = ("ADD", "MULTIPLY", "SINE", "MINIMUM", "POWER")
    value = shader("LayerWeight", "Facing", Blend=0.4)
    for _ in range(4):
        value = shader("Math", operation=operations[number % 5], input_0=value, input_1=rng.random())
        number //= 5
    return shader("MixShader", input_0=value, input_1=surface, input_2=shader("BsdfDiffuse"))


def change_constants(rng):
    """Give every number and colour of every material another value."""
    import bpy

    for material in bpy.data.materials:
        for node in material.node_tree.nodes:
            for socket in node.inputs:
                if socket.type == "VALUE" and not socket.is_linked:
                    socket.default_value = rng.uniform(0.05, 1.0)
                elif socket.type == "RGBA" and not socket.is_linked:
                    socket.default_value = (*rng.random(3), 1.0)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--row", choices=ROWS, help="measure this one in this process")
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    if options.row:
        measure(options.row)
        return
    columns = "programs", "lines", "compile", "draw", "changed"
    print(f"{'materials':<18}" + "".join(f"{name:>10}" for name in columns))
    for name in ROWS:
        command = [sys.executable, "-m", "benchmarks.materials", "--row", name]
        environment = os.environ | {"MESA_SHADER_CACHE_DISABLE": "true", "MESA_GLSL_CACHE_DISABLE": "true"}
        runs = [
            json.loads(
                subprocess.run(
                    command, env=environment, check=True, capture_output=True, text=True
                ).stdout.splitlines()[-1]
            )
            for _ in range(options.repeat)
        ]
        middle = {column: statistics.median(run[column] for run in runs) for column in columns}
        print(f"{name:<18}" + "".join(f"{middle[column]:>10.4g}" for column in columns), flush=True)


if __name__ == "__main__":
    main()
