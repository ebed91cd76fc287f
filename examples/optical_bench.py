# SPDX-License-Identifier: GPL-3.0-or-later
"""An optical bench: a ball lens focuses five beams, a prism spreads a sixth, a rod and a cone of glass stand before a
chart.

python examples/optical_bench.py --output build/optical_bench.png [--engine CYCLES]     with Blender as a module (bpy)
blender -b -P examples/optical_bench.py -- --output optical_bench.png

The lenses are exact spheres, cylinders and cones, so that what is seen through them is what an optician's formulas
say; the beams are thin glowing cylinders along the rays that Snell's law gives.
"""

import sys
from itertools import pairwise
from math import radians
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from examples.in_blender import arguments_given, empty_blender, finish, new_light, parser_of
from examples.painted_images import linear, studio
from examples.shader_trees import new_material, new_world, shader
from examples.stage import Stage, add_camera, new_image

HEIGHT = 1.2  # of the optical axis, over the table
BALL, BALL_RADIUS, BALL_INDEX = np.array((-0.9, 0.0, HEIGHT)), 0.55, 1.52
PRISM, PRISM_SIDE = np.array((2.55, 0.0, HEIGHT)), 1.0
#: Colours of the spread beam and the prism's index for each (Cauchy's formula for dense flint).
SPECTRUM = (
    ("ff2a12", 1.612),
    ("ff8a10", 1.619),
    ("ffe636", 1.625),
    ("3cff5a", 1.634),
    ("3490ff", 1.648),
    ("8a3cff", 1.66),
)
SOFTBOXES = ((-110, 55, 45, 8, 5.0), (60, 40, 12, 20, 4.0))


def main():
    options = parser_of(__file__, __doc__.splitlines()[0], size=(960, 420), samples=64).parse_args(arguments_given())
    empty_blender()
    finish(build_scene(), options)


def build_scene():
    """Build the picture in Blender's empty current scene, and return that."""
    stage = Stage()
    bench(stage)
    glass = {
        index: new_material(f"Glass {index}", shader("BsdfGlass", Roughness=0.0, IOR=index)) for index in (1.52, 1.63)
    }
    stage.place("Ball lens", stage.ball, glass[BALL_INDEX], BALL, BALL_RADIUS)
    stage.place("Rod lens", stage.drum, glass[BALL_INDEX], (-2.9, 0.1, HEIGHT), (0.32, 0.32, 0.7))
    stage.place(
        "Axicon", stage.cone, glass[BALL_INDEX], (0.95, 1.1, HEIGHT), (0.42, 0.42, 0.42), Euler((radians(90), 0, 0))
    )
    prism(glass[1.63])
    for x in (-2.9, BALL[0], PRISM[0]):
        post(stage, x)
    focused_beams(stage)
    spread_beam(stage)
    scene = bpy.context.scene
    sky = new_image("Laboratory", studio(linear("3a4046"), linear("15181c"), SOFTBOXES, height=128), is_float=True)
    painted = shader("TexEnvironment", image=sky, Vector=shader("TexCoord", "Generated"))
    scene.world = new_world("Laboratory", shader("Background", Color=painted, Strength=1.8))
    stage.collection.objects.link(new_light("POINT", (-2.0, -4.0, 5.0), 260.0, "fff4e2"))
    scene.camera = add_camera(stage, (0.55, -8.0, 2.0), (0.55, 0.4, 1.05), lens=38.0)
    scene.render.engine = "CONIC"
    scene.view_settings.view_transform = "Standard"
    scene.conic.max_depth = 14
    scene.conic.shadows = "TINTED"  # light comes through glass
    return scene


def bench(stage):
    """A dark table with a steel rail, and behind it a chart of squares and rings."""
    felt = new_material("Felt", shader("BsdfDiffuse", Color=(*linear("2b3036"), 1.0)))
    stage.place("Table", stage.square, felt, (0.0, 0.0, 0.0), (30.0, 30.0, 1.0))
    brushed = shader(
        "TexNoise", "Fac", Scale=60.0, Vector=shader("Mapping", Vector=shader("TexCoord", "Object"), Scale=(0.05, 1, 1))
    )
    steel = shader("MapRange", Value=brushed, To_Min=0.2, To_Max=0.45)
    metal = new_material(
        "Steel", shader("BsdfPrincipled", Base_Color=(0.6, 0.62, 0.65, 1.0), Metallic=1.0, Roughness=steel)
    )
    stage.place_rod("Rail", metal, (-4.6, 0.0, 0.1), (4.6, 0.0, 0.1), 0.1)
    squares = shader(
        "TexChecker",
        "Color",
        Vector=shader("TexCoord", "Object"),
        Scale=7.0,
        Color1=(*linear("e8e4d8"), 1.0),
        Color2=(*linear("27313c"), 1.0),
    )
    circles = shader(
        "TexWave", "Fac", Vector=shader("TexCoord", "Object"), wave_type="RINGS", rings_direction="Z", Scale=1.6
    )
    lines = shader("MapRange", Value=circles, From_Min=0.93, From_Max=0.99)
    chart = shader("MixRGB", Fac=lines, Color1=squares, Color2=(*linear("c8452f"), 1.0))
    board = new_material("Chart", shader("BsdfDiffuse", Color=chart))
    stage.place("Chart", stage.square, board, (-0.4, 3.6, 1.5), (4.4, 1.5, 1.0), Euler((radians(90.0), 0.0, 0.0)))


def post(stage, x):
    """A holder under an element."""
    black = bpy.data.materials.get("Anodized") or new_material(
        "Anodized", shader("BsdfPrincipled", Base_Color=(0.02, 0.02, 0.025, 1.0), Roughness=0.35)
    )
    stage.place_rod("Post", black, (x, 0.0, 0.1), (x, 0.0, 0.62), 0.06)
    stage.place("Base", stage.drum, black, (x, 0.0, 0.16), (0.28, 0.28, 0.06))


def prism(material):
    """A lying prism on an equilateral triangle, flat shaded."""
    angles = np.radians((90.0, 210.0, 330.0))
    corners = PRISM_SIDE / np.sqrt(3.0) * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    points = [(x, y, z) for y in (-0.4, 0.4) for x, z in corners]
    faces = [(0, 1, 2), (5, 4, 3), (3, 4, 1, 0), (4, 5, 2, 1), (5, 3, 0, 2)]
    mesh = bpy.data.meshes.new("Prism")
    mesh.from_pydata(points, [], faces)
    mesh.materials.append(material)
    made = bpy.data.objects.new("Prism", mesh)
    made.location = PRISM
    bpy.context.scene.collection.objects.link(made)


def beam(stage, color, points, radius=0.008):
    """A beam along points."""
    name = f"Beam {color}"
    light = bpy.data.materials.get(name) or new_material(
        name, shader("Emission", Color=(*linear(color), 1.0), Strength=3.0)
    )
    for base, apex in pairwise(points):
        stage.place_rod("Beam", light, base, apex, radius).visible_shadow = False


def refracted(direction, normal, eta):
    """Snell's law for unit vectors; `normal` against the ray, `eta` the index before over the one beyond."""
    cosine = -float(direction @ normal)
    root = np.sqrt(1.0 - eta**2 * (1.0 - cosine**2))
    return eta * direction + (eta * cosine - root) * normal


def focused_beams(stage):
    """Parallel beams through the ball lens to where they part behind their focus."""
    for offset in (-0.36, -0.18, 0.0, 0.18, 0.36):
        start, along = np.array((-4.4, 0.0, HEIGHT + offset)), np.array((1.0, 0.0, 0.0))
        points = [start]
        for eta, sign in ((1.0 / BALL_INDEX, 1.0), (BALL_INDEX, -1.0)):
            at = points[-1] + along * sphere_distance(points[-1], along, far=sign < 0.0)
            along = refracted(along, sign * (at - BALL) / BALL_RADIUS, eta)
            points.append(at)
        points.append(points[-1] + along * 1.35)
        beam(stage, "ff3020", points)


def sphere_distance(origin, along, far):
    """How far it is from a point to the near or far side of the ball lens."""
    across = origin - BALL
    b = float(across @ along)
    root = np.sqrt(b * b - float(across @ across) + BALL_RADIUS**2)
    return -b + root if far else -b - root


def spread_beam(stage):
    """A white beam that the prism takes apart."""
    height = PRISM_SIDE / (2.0 * np.sqrt(3.0))  # from its middle to a side
    entry = np.array((np.cos(radians(150.0)), 0.0, np.sin(radians(150.0))))
    leave = np.array((np.cos(radians(30.0)), 0.0, np.sin(radians(30.0))))
    inside = np.array((1.0, 0.0, 0.0))  # of the yellow light: symmetric, the least deviation
    along = -refracted(-inside, -entry, 1.625)
    at = PRISM + height * entry
    beam(stage, "ffffff", [at - 1.5 * along, at], 0.012)
    for color, index in SPECTRUM:
        direction = refracted(along, entry, 1.0 / index)
        end = at + direction * float((PRISM + height * leave - at) @ leave) / float(direction @ leave)
        out = refracted(direction, -leave, index)
        beam(stage, color, [at, end, end + 2.6 * out])


if __name__ == "__main__":
    main()
