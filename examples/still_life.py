# SPDX-License-Identifier: GPL-3.0-or-later
"""A still life: glass, metals, china and wood on a table, lit by a photographer's studio alone.

python examples/still_life.py --output build/still_life.png [--engine CYCLES]     with Blender as a module (bpy)
blender -b -P examples/still_life.py -- --output still_life.png

Nothing is tessellated: the table is a disc, the bottle, goblet and pots are spheres, cylinders and cones. All light
comes from the sky, an image that is painted here.
"""

import sys
from math import radians
from pathlib import Path

import bpy
from mathutils import Euler

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from examples.in_blender import arguments_given, empty_blender, finish, parser_of
from examples.painted_images import linear, studio
from examples.shader_trees import new_material, new_world, ramp, shader
from examples.stage import Stage, add_camera, new_image

#: longitude, latitude, half width, half height in degrees, radiance
SOFTBOXES = ((-140, 42, 20, 15, 22.0), (-25, 38, 12, 24, 14.0), (95, 60, 35, 9, 6.0))


def main():
    options = parser_of(__file__, __doc__.splitlines()[0], size=(720, 480), samples=64).parse_args(arguments_given())
    empty_blender()
    finish(build_scene(), options)


def build_scene():
    """Build the picture in Blender's empty current scene, and return that."""
    stage = Stage()
    table(stage)
    metals(stage)
    glasses(stage)
    china(stage)
    scene = bpy.context.scene
    scene.world = sky()
    scene.camera = add_camera(stage, (0.2, -7.4, 3.0), (-0.1, 0.0, 0.55), lens=50.0)
    scene.render.engine = "CONIC"
    scene.view_settings.view_transform = "Standard"
    scene.conic.max_depth = 12
    scene.conic.shadows = "TINTED"  # light comes through glass
    return scene


def sky():
    pixels = studio(linear("8d99a3"), linear("39424d"), SOFTBOXES, height=256)
    turned = shader("Mapping", Vector=shader("TexCoord", "Generated"), Rotation=(0.0, 0.0, radians(12.0)))
    painted = shader("TexEnvironment", image=new_image("Studio", pixels, is_float=True), Vector=turned)
    return new_world("Studio", shader("Background", Color=painted, Strength=1.0))


def principled(name, color, **inputs):
    base = color if not isinstance(color, str) else (*linear(color), 1.0)
    return new_material(name, shader("BsdfPrincipled", Base_Color=base, **inputs))


def wood():
    """Rings of dark and light, disturbed, under varnish."""
    place = shader("Mapping", Vector=shader("TexCoord", "Object"), Scale=(0.9, 0.14, 0.9), Rotation=(0.0, 0.0, 0.4))
    rings = shader(
        "TexWave", "Fac", Vector=place, wave_type="RINGS", Scale=2.4, Distortion=5.0, Detail=3.0, Detail_Scale=1.3
    )
    color = ramp(rings, (0.0, linear("4a2a16")), (0.55, linear("7a4a28")), (1.0, linear("93602f")))
    return principled("Wood", color, Roughness=0.35, Coat_Weight=0.5, Coat_Roughness=0.05)


def table(stage):
    stage.place("Table", stage.disc, wood(), (0.0, 0.6, 0.0), 4.4)


def metals(stage):
    gold = shader("BsdfMetallic", Base_Color=(*linear("ffd98a"), 1.0), Edge_Tint=(1.0, 0.95, 0.8, 1.0), Roughness=0.12)
    if not hasattr(bpy.types, "ShaderNodeBsdfMetallic"):  # before Blender 4.3
        gold = shader("BsdfPrincipled", Base_Color=(*linear("ffd98a"), 1.0), Metallic=1.0, Roughness=0.12)
    stage.place("Gold ball", stage.ball, new_material("Gold", gold), (-1.75, -0.55, 0.45), 0.45)
    chrome = principled("Chrome", "f2f4f6", Metallic=1.0, Roughness=0.0)
    stage.place("Chrome ball", stage.ball, chrome, (-0.55, 1.35, 0.8), 0.8)
    scratches = shader("TexNoise", "Fac", Vector=shader("TexCoord", "Object"), Scale=9.0, Detail=4.0)
    roughness = shader("MapRange", Value=scratches, To_Min=0.15, To_Max=0.55)
    copper = principled("Copper", "e8936b", Metallic=1.0, Roughness=roughness)
    stage.place("Copper pot", stage.drum, copper, (1.95, 1.05, 0.5), (0.55, 0.55, 0.5))
    stage.place("Lid", stage.ball, copper, (1.95, 1.05, 1.06), 0.1)
    brass = principled("Brass", "d9b25f", Metallic=1.0, Roughness=0.3)
    stage.place("Brass cone", stage.cone, brass, (-2.6, 0.9, 0.55), (0.42, 0.42, 0.55))


def glasses(stage):
    clear = new_material("Glass", shader("BsdfGlass", Roughness=0.0, IOR=1.5))
    stage.place("Glass ball", stage.ball, clear, (0.1, -1.15, 0.42), 0.42)
    amber = shader("VolumeAbsorption", Color=(*linear("f2a340"), 1.0), Density=2.2)
    bottled = new_material("Amber", shader("BsdfGlass", Roughness=0.0, IOR=1.45), amber)
    stage.place("Amber ball", stage.ball, bottled, (0.95, -0.55, 0.3), 0.3)
    frosted = new_material("Frosted", shader("BsdfGlass", Color=(0.85, 0.95, 0.97, 1.0), Roughness=0.25, IOR=1.45))
    stage.place("Frosted rod", stage.drum, frosted, (0.75, 0.75, 0.62), (0.32, 0.32, 0.62))
    cobalt = shader("VolumeAbsorption", Color=(*linear("3c6ff0"), 1.0), Density=3.0)
    blue = new_material("Cobalt", shader("BsdfGlass", Roughness=0.0, IOR=1.52), cobalt)
    stage.place("Cobalt cone", stage.cone, blue, (1.75, -0.75, 0.5), (0.36, 0.36, 0.5))


def china(stage):
    glaze = principled("China", "e9e6df", Roughness=0.45, Coat_Weight=1.0, Coat_Roughness=0.02)
    stage.place("Plate", stage.drum, glaze, (-0.75, -1.3, 0.03), (0.62, 0.62, 0.03))
    peel = shader("TexNoise", "Fac", Vector=shader("TexCoord", "Object"), Scale=24.0, Detail=2.0)
    dimples = shader("Bump", Height=peel, Strength=0.35, Distance=0.06)
    orange = principled("Orange", "e8791c", Roughness=0.4, Normal=dimples)
    stage.place("Orange", stage.ball, orange, (-0.92, -1.35, 0.34), 0.28, Euler((0.3, 0.2, 0.0)))
    speckles = shader("TexVoronoi", "Distance", Vector=shader("TexCoord", "Object"), Scale=14.0)
    shell = ramp(speckles, (0.12, linear("6d5a49")), (0.2, linear("e2d3bd")), interpolation="EASE")
    egg = principled("Egg", shell, Roughness=0.5)
    stage.place("Egg", stage.ball, egg, (-0.47, -1.2, 0.25), (0.19, 0.26, 0.19), Euler((0.0, 0.0, 0.6)))


if __name__ == "__main__":
    main()
