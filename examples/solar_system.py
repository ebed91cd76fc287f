# SPDX-License-Identifier: GPL-3.0-or-later
"""The solar system: exact spheres with procedural textures, lit by the sun in their middle; neither sizes nor distances
are to scale.

python examples/solar_system.py --output build/solar_system.png [--engine CYCLES]     with Blender as a module (bpy)
blender -b -P examples/solar_system.py -- --output solar_system.png
"""

import sys
from math import radians
from pathlib import Path

import bpy
from mathutils import Euler

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from examples.in_blender import arguments_given, empty_blender, finish, parser_of
from examples.painted_images import globe, linear
from examples.shader_trees import new_material, new_world, ramp, shader
from examples.stage import Stage, add_camera, new_image

SUN = (-7.4, -2.2, 1.0)
#: name, place, radius, tilt of the axis in degrees; all stand farther back than the sun, so that their bright side is
# seen
PLANETS = (
    ("Mercury", (-5.3, 1.2, 0.9), 0.16, 0.0),
    ("Venus", (-4.4, 0.4, -0.7), 0.36, 3.0),
    ("Earth", (-3.1, 1.0, 0.45), 0.42, 23.4),
    ("Mars", (-2.0, 0.2, -0.65), 0.27, 25.2),
    ("Jupiter", (-0.1, 2.4, 0.4), 1.25, 3.1),
    ("Saturn", (3.3, 2.0, 0.1), 0.95, 24.0),
    ("Uranus", (5.4, 1.4, -1.0), 0.5, 82.0),
    ("Neptune", (6.3, 2.0, 0.8), 0.48, 28.3),
)


def main():
    options = parser_of(__file__, __doc__.splitlines()[0], size=(960, 480), samples=32).parse_args(arguments_given())
    empty_blender()
    finish(build_scene(), options)


def build_scene():
    """Build the picture in Blender's empty current scene, and return that."""
    stage = Stage()
    stage.place("Sun", stage.ball, sun(), SUN, 2.2).visible_shadow = False  # the light comes from within
    light = bpy.data.lights.new("Sunlight", "POINT")
    light.energy, light.color, light.shadow_soft_size = 5200.0, linear("fff0d8"), 0.0
    lamp = bpy.data.objects.new("Sunlight", light)
    lamp.location = SUN
    stage.collection.objects.link(lamp)
    for name, at, radius, tilt in PLANETS:
        turn = Euler((radians(0.8 * tilt), radians(-0.6 * tilt), 0.0))
        stage.place(name, stage.ball, MATERIALS[name](), at, radius, turn)
        if name == "Saturn":
            stage.place("Rings", stage.disc, rings(), at, 2.3 * radius, turn)
        if name == "Earth":
            moon = rocky("Moon", "8d8a86", "c9c6c0", 9.0)
            stage.place("Moon", stage.ball, moon, (at[0] + 0.62, at[1], at[2] + 0.3), 0.11)
    scene = bpy.context.scene
    scene.world = stars()
    scene.camera = add_camera(stage, (-0.6, -15.0, 1.6), (-0.6, 1.0, 0.0), lens=36.0)
    scene.render.engine = "CONIC"
    scene.view_settings.view_transform = "Standard"
    return scene


def coordinates(**mapping):
    return shader("Mapping", Vector=shader("TexCoord", "Object"), **mapping)


def noise(scale, detail=6.0, output="Fac", **inputs):
    return shader("TexNoise", output, Scale=scale, Detail=detail, **{"Vector": coordinates()} | inputs)


def surface(name, color, **inputs):
    base = color if not isinstance(color, str) else (*linear(color), 1.0)
    return new_material(name, shader("BsdfPrincipled", Base_Color=base, **{"Roughness": 0.9} | inputs))


def sun():
    grains = ramp(noise(7.0), (0.3, linear("ff7a18")), (0.55, linear("ffb347")), (0.8, linear("fff3c4")))
    limb = shader("LayerWeight", "Facing", Blend=0.35)
    strength = shader("MapRange", Value=limb, To_Min=2.2, To_Max=0.7)
    return new_material("Sun", shader("Emission", Color=grains, Strength=strength))


def rocky(name, low, high, scale):
    """Dark and light ground with craters."""
    color = ramp(noise(scale, 8.0), (0.35, linear(low)), (0.65, linear(high)))
    craters = shader("TexVoronoi", "Distance", Vector=coordinates(), Scale=scale)
    rough = shader("Bump", Height=craters, Strength=0.5, Distance=0.1)
    return surface(name, color, Normal=rough)


def banded(name, scale, distortion, *stops):
    """Belts along the parallels, stirred by noise."""
    belts = shader(
        "TexWave",
        "Fac",
        Vector=coordinates(),
        bands_direction="Z",
        wave_profile="SIN",
        Scale=scale,
        Distortion=distortion,
        Detail=4.0,
        Detail_Scale=2.5,
        Detail_Roughness=0.6,
    )
    return surface(name, ramp(belts, *((at, linear(code)) for at, code in stops)))


def earth():
    image = new_image("Earth", globe(512), is_float=False)
    ground = shader("TexImage", "Color", image=image, Vector=shader("TexCoord", "UV"))
    clouds = shader("MapRange", Value=noise(3.0, 9.0, Distortion=0.6), From_Min=0.52, From_Max=0.68)
    painted = shader("MixRGB", Fac=clouds, Color1=ground, Color2=(0.95, 0.95, 0.95, 1.0))
    return surface("Earth", painted, Roughness=0.6)


def rings():
    """Rings by the distance from the middle, with gaps that are seen through."""
    radius = shader("VectorMath", "Value", operation="LENGTH", input_0=shader("TexCoord", "Object"))
    grooves = shader("TexNoise", "Fac", noise_dimensions="1D", W=radius, Scale=22.0, Detail=4.0)
    color = ramp(grooves, (0.3, linear("8f7d62")), (0.7, linear("e0cfae")))
    inside = ramp(
        radius, (0.0, (0, 0, 0)), (0.56, (1, 1, 1)), (0.84, (0, 0, 0)), (0.87, (1, 1, 1)), interpolation="CONSTANT"
    )
    alpha = shader("Math", operation="MULTIPLY", input_0=inside, input_1=grooves, use_clamp=True)
    return new_material("Rings", shader("BsdfPrincipled", Base_Color=color, Alpha=alpha, Roughness=1.0))


def stars():
    """White points of different brightness, and a faint band."""
    towards = shader("TexCoord", "Generated")
    cells = shader("TexVoronoi", "Distance", Vector=towards, Scale=90.0)
    points = shader("MapRange", Value=cells, From_Min=0.0, From_Max=0.09, To_Min=1.0, To_Max=0.0)
    sharp = shader("Math", operation="POWER", input_0=points, input_1=3.0)
    band = shader("TexNoise", "Fac", Vector=towards, Scale=2.5, Detail=6.0)
    haze = ramp(band, (0.5, linear("020308")), (0.75, linear("141a2c")))
    both = shader("MixRGB", blend_type="ADD", Fac=1.0, Color1=haze, Color2=sharp)
    return new_world("Stars", shader("Background", Color=both, Strength=1.0))


MATERIALS = {
    "Mercury": lambda: rocky("Mercury", "5d5550", "a39a90", 11.0),
    "Venus": lambda: banded("Venus", 1.2, 9.0, (0.0, "c9a063"), (0.5, "e8cf9a"), (1.0, "f3e3bd")),
    "Earth": earth,
    "Mars": lambda: rocky("Mars", "7a3218", "d0713d", 6.0),
    "Jupiter": lambda: banded(
        "Jupiter", 1.7, 2.2, (0.0, "8f5f3f"), (0.3, "d9b48a"), (0.55, "f0e2cd"), (0.8, "c08a5c"), (1.0, "efe0cc")
    ),
    "Saturn": lambda: banded("Saturn", 1.9, 0.6, (0.0, "b89762"), (0.5, "e3cc9b"), (1.0, "f0e2be")),
    "Uranus": lambda: banded("Uranus", 0.6, 0.4, (0.0, "9fd3d6"), (1.0, "c8ecec")),
    "Neptune": lambda: banded("Neptune", 1.0, 3.0, (0.0, "2746a8"), (0.7, "4672d8"), (1.0, "9dbcf5")),
}


if __name__ == "__main__":
    main()
