"""BSDFs, under lamps and a grey world: a ball and a tilted plane.

Lamps are not seen through two rough surfaces, which is noise for hours in both engines.
"""

from functools import partial

import bpy
import numpy as np

from tests.blender.building import add_camera, link, material

from .case import Node, Scene

GOLD, GREEN, RED, BLUE = (0.9, 0.6, 0.2, 1.0), (0.2, 0.5, 0.3, 1.0), (0.8, 0.2, 0.1, 1.0), (0.2, 0.4, 0.9, 1.0)
BLACK, WHITE, GRAY = (0.0, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 1.0), (0.8, 0.8, 0.8, 1.0)

#: What tells Cycles' closures apart: without caustics of several bounces, without light that comes from elsewhere.
principled = partial(Node, "BsdfPrincipled", distribution="GGX")
glossy = partial(Node, "BsdfAnisotropic", distribution="GGX")  # the Glossy BSDF under its name of all versions
diffuse, translucent = partial(Node, "BsdfDiffuse"), partial(Node, "BsdfTranslucent")


def mixed(factor, a, b):
    """Mix Shader, whose shader inputs share a name; `factor` a number or a Node."""
    return Node("MixShader", feed=(factor, a, b))


def added(a, b):
    return Node("AddShader", feed=(a, b))


def built(shader, light, ball=True, volume=None):
    """A tilted plane, and where light does not go through it a smooth ball, of a shader in a light."""
    camera = add_camera(lens=50.0)
    camera.location, camera.rotation_euler = (0.0, -8.0, 0.0), (np.pi / 2.0, 0.0, 0.0)
    made, tree, output = material()
    tree.links.new(shader.build(tree), output.inputs["Surface"])
    if volume:
        tree.links.new(volume.build(tree), output.inputs["Volume"])
    if ball:
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6, radius=1.0, location=(-1.1, 0.0, 0.0))
        bpy.context.object.data.materials.append(made)
        bpy.context.object.data.shade_smooth()
    bpy.ops.mesh.primitive_plane_add(size=2.0, location=(1.3, 0.0, 0.0), rotation=(0.9, 0.3, 0.0))
    bpy.context.object.data.materials.append(made)
    light()


def lamp(location=(2.0, -5.0, 3.0)):
    data = bpy.data.lights.new("lamp", "POINT")
    data.energy, data.color, data.shadow_soft_size = 600.0, (1.0, 0.9, 0.7), 0.0
    link(data, "lamp", location=location)


def area():
    data = bpy.data.lights.new("area", "AREA")
    data.energy, data.size = 300.0, 1.5
    link(data, "area", location=(2.0, -5.0, 3.0), rotation_euler=(1.1, 0.0, 0.4), visible_camera=False)


def gray_world():
    world = bpy.data.worlds.new("gray")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.5, 0.5, 1.0)
    bpy.context.scene.world = world


def seen_world():
    """A world that is seen through what is transparent too."""
    gray_world()
    bpy.context.scene.render.film_transparent = False


lamp_behind = partial(lamp, (0.8, 6.0, -0.5))


_WORDS = {lamp: "lamp", area: "area light", lamp_behind: "lamp behind", gray_world: "world", seen_world: "world behind"}


def _in(light, name, shader, ball=True, volume=None, few=0.15, **settings):
    build = partial(built, shader, light, ball, volume)
    return Scene(f"{name}, {_WORDS[light]}", build=build, few=few, **settings)


#: A number and a color that vary over both shapes.
FACING = Node("LayerWeight", "Facing", Blend=0.4)
BETWEEN = Node("MapRange", feed=(FACING, 0.0, 1.0, 0.2, 0.8))
COLORFUL = Node("Mix", data_type="RGBA", feed=(FACING, GOLD, BLUE))
BUMPS = Node("Bump", Strength=0.7, Distance=0.3, Height=Node("TexNoise", 0, Scale=1.5, Detail=0.0))


def _rough():
    """Roughness in every light. No highlight of few pixels, narrower than the light, which Conic samples by the light
    alone: noise."""
    metal = partial(principled, Base_Color=GOLD, Metallic=1.0)
    tinted, tan = (0.2, 0.5, 0.8, 1.0), (0.8, 0.6, 0.4, 1.0)
    multiscatter = {"distribution": "MULTI_GGX"}
    opaque = {
        "glossy 0.2": glossy(Color=tan, Roughness=0.2),
        "glossy 0.5": glossy(Color=tan, Roughness=0.5),
        "metal 0.3": metal(Roughness=0.3),
        "tinted metal 0.3": metal(Roughness=0.3, Specular_Tint=tinted),
        "multiscatter glossy 0.6": glossy(Color=GOLD, Roughness=0.6, **multiscatter),
        "multiscatter metal 0.5": metal(Roughness=0.5, Specular_Tint=tinted, **multiscatter),
        "multiscatter metal 1.0": metal(Roughness=1.0, **multiscatter),
        "multiscatter plastic 0.5": principled(Base_Color=GREEN, Roughness=0.5, **multiscatter),
        "multiscatter plastic 0.9": principled(Base_Color=GREEN, Roughness=0.9, **multiscatter),
        "plastic 0.4": principled(Base_Color=GREEN, Roughness=0.4),
        "black plastic 0.4": principled(Base_Color=BLACK, Roughness=0.4),
        "specular plastic 0.4": principled(Base_Color=GREEN, Roughness=0.4, Specular_IOR_Level=1.0),
    }
    bluish = {"Color": (0.9, 0.9, 1.0, 1.0), "Roughness": 0.3}
    clear = {
        "glass 0.3": Node("BsdfGlass", distribution="GGX", IOR=1.5, **bluish),
        "multiscatter glass 0.3": Node("BsdfGlass", IOR=1.5, **bluish, **multiscatter),
        "multiscatter glass 0.7": Node("BsdfGlass", IOR=1.5, **bluish | {"Roughness": 0.7}, **multiscatter),
        "multiscatter glass of principled 0.5": principled(
            Base_Color=(0.8, 0.9, 1.0, 1.0), Transmission_Weight=1.0, Roughness=0.5, IOR=1.4, **multiscatter
        ),
        "glass of principled 0.3": principled(
            Base_Color=(0.8, 0.9, 1.0, 1.0), Transmission_Weight=1.0, Roughness=0.3, IOR=1.4
        ),
        "refraction 0.3": Node("BsdfRefraction", distribution="GGX", IOR=1.4, **bluish),
    }
    for name, shader in opaque.items():
        yield _in(lamp, name, shader)
        yield _in(gray_world, name, shader, blocks=2)
        if name in ("glossy 0.5", "metal 0.3", "multiscatter metal 0.5", "plastic 0.4"):
            yield _in(area, name, shader, blocks=2)
    for name, shader in clear.items():
        yield _in(gray_world, name, shader, blocks=2)
        for light in (lamp, area, lamp_behind) if "glass" in name else (lamp_behind,):
            yield _in(light, name, shader, ball=False, blocks=2 if light == area else 1)


def _varying():
    """Every input of the Principled BSDF that is rendered, where it varies over the surface."""
    for name, shader in {
        "base color": principled(Base_Color=COLORFUL),
        "metallic": principled(Base_Color=GOLD, Metallic=FACING, Roughness=0.4),
        "roughness": principled(Base_Color=GREEN, Roughness=BETWEEN),
        "index": principled(Base_Color=BLACK, Roughness=0.4, IOR=Node("Math", operation="ADD", feed=(FACING, 1.0))),
        "alpha": principled(Base_Color=GREEN, Roughness=0.4, Alpha=FACING),
        "specular level": principled(Base_Color=BLACK, Roughness=0.4, Specular_IOR_Level=FACING),
        "specular tint": principled(Base_Color=BLACK, Roughness=0.4, Specular_Tint=COLORFUL),
        "coat": principled(Base_Color=GREEN, Roughness=0.6, Coat_Weight=FACING, Coat_Roughness=0.3),
        "coat roughness": principled(Base_Color=BLACK, Roughness=0.8, Coat_Weight=1.0, Coat_Roughness=BETWEEN),
        "coat tint": principled(Base_Color=WHITE, Coat_Weight=1.0, Coat_Roughness=0.4, Coat_Tint=COLORFUL),
        "coat index": principled(
            Base_Color=BLACK,
            Coat_Weight=1.0,
            Coat_Roughness=0.4,
            Coat_IOR=Node("Math", operation="ADD", feed=(FACING, 1.0)),
        ),
        "emission": principled(Base_Color=BLACK, Emission_Color=COLORFUL, Emission_Strength=FACING),
        "normal": principled(Base_Color=GREEN, Roughness=0.4, Normal=BUMPS),
    }.items():
        yield _in(lamp, f"varying {name}", shader)
    rough = principled(Base_Color=WHITE, Diffuse_Roughness=FACING)
    yield _in(lamp, "varying diffuse roughness", rough, since=(4, 3))
    clear = principled(Base_Color=BLUE, Transmission_Weight=FACING, Roughness=0.0)
    yield _in(gray_world, "varying transmission", clear, samples=128, blocks=2)


def _instead():
    """What is rendered as something else, and says so."""
    reason = "it is not rendered, and what is used instead is told"
    told = {"told": "instead", "tolerance": 99.0, "few": 1.0, "total": 99.0, "reason": reason}
    for kind in ("SubsurfaceScattering", "BsdfSheen"):
        yield _in(lamp, kind, Node(kind), **told)
    told["told"] = "not rendered"
    for name in ("Subsurface_Weight", "Sheen_Weight", "Anisotropic"):
        yield _in(lamp, name, principled(Base_Color=GREEN, Roughness=0.4, **{name: 0.5}), **told)


#: Rough facets and a lamp that is a point have no noise.
CASES = [
    *_rough(),
    *_varying(),
    *_instead(),
    _in(seen_world, "transparent", Node("BsdfTransparent", Color=GREEN)),
    _in(
        gray_world,
        "glass with absorption",
        Node("BsdfGlass", Roughness=0.0, IOR=1.4),
        volume=Node("VolumeAbsorption", Color=GOLD, Density=1.5),
    ),
    _in(
        seen_world,
        "clear with absorption",
        Node("BsdfTransparent"),
        volume=Node("VolumeAbsorption", Color=GOLD, Density=1.5),
    ),
    _in(lamp, "diffuse", diffuse(Color=GREEN)),
    _in(lamp, "rough diffuse 0.5", diffuse(Color=GREEN, Roughness=0.5), since=(4, 3)),
    _in(lamp, "rough diffuse 1", diffuse(Color=WHITE, Roughness=1.0), since=(4, 3)),
    _in(lamp, "rough diffuse of principled", principled(Base_Color=RED, Diffuse_Roughness=0.7), since=(4, 3)),
    _in(lamp, "bumpy diffuse", diffuse(Color=GREEN, Normal=BUMPS)),
    _in(lamp_behind, "translucent", translucent(Color=RED), ball=False),
    _in(
        lamp,
        "translucent from the front",
        mixed(0.5, translucent(Color=RED), diffuse(Color=BLUE)),
        ball=False,
    ),
    _in(
        lamp,
        "mix of diffuse and glossy",
        mixed(0.3, diffuse(Color=GREEN), glossy(Color=GOLD, Roughness=0.4)),
    ),
    _in(lamp, "varying mix", mixed(FACING, diffuse(Color=GREEN), glossy(Color=GOLD, Roughness=0.4))),
    _in(
        lamp,
        "mix by Fresnel",
        mixed(Node("Fresnel", IOR=1.6), diffuse(Color=GREEN), glossy(Color=WHITE, Roughness=0.3)),
    ),
    _in(lamp, "sum", added(diffuse(Color=GREEN), glossy(Color=GOLD, Roughness=0.4))),
    _in(lamp, "half metallic", principled(Base_Color=GOLD, Metallic=0.5, Roughness=0.4)),
    _in(lamp, "specular tint", principled(Base_Color=GREEN, Roughness=0.4, Specular_Tint=RED)),
    _in(lamp, "specular level", principled(Base_Color=GREEN, Roughness=0.4, Specular_IOR_Level=0.9)),
    _in(lamp, "coat 0.3", principled(Base_Color=GREEN, Roughness=0.7, Coat_Weight=1.0, Coat_Roughness=0.3)),
    _in(
        lamp,
        "coated metal",
        principled(Base_Color=GOLD, Metallic=1.0, Roughness=0.5, Coat_Weight=0.7, Coat_Roughness=0.2, Coat_IOR=1.7),
    ),
    _in(
        lamp,
        "tinted coat",
        principled(Base_Color=GRAY, Roughness=0.6, Coat_Weight=1.0, Coat_Roughness=0.3, Coat_Tint=RED),
    ),
    _in(
        lamp,
        "coat over emission",
        principled(Base_Color=BLACK, Emission_Color=BLUE, Emission_Strength=0.2, Coat_Weight=1.0, Coat_IOR=2.0),
    ),
    _in(lamp, "half transparent plastic", principled(Base_Color=GREEN, Roughness=0.4, Alpha=0.6)),
    _in(
        lamp,
        "Metallic, F82",
        Node("BsdfMetallic", distribution="GGX", Roughness=0.4, Base_Color=GOLD, Edge_Tint=RED),
        since=(4, 3),
    ),
    _in(
        lamp,
        "Metallic, conductor",
        Node("BsdfMetallic", distribution="GGX", fresnel_type="PHYSICAL_CONDUCTOR", Roughness=0.4),
        since=(4, 3),
    ),
    _in(
        gray_world,
        "sharp coat over metal",
        principled(Base_Color=GOLD, Metallic=1.0, Roughness=0.5, Coat_Weight=1.0),
        samples=128,
    ),
    _in(
        gray_world,
        "rough coat over metal",
        principled(Base_Color=GOLD, Metallic=1.0, Roughness=0.2, Coat_Weight=1.0, Coat_Roughness=0.4),
    ),
    _in(gray_world, "half glass", principled(Base_Color=BLUE, Metallic=0.5, Transmission_Weight=1.0, Roughness=0.0)),
    _in(
        gray_world,
        "glossy and glass",
        mixed(0.4, Node("BsdfGlass", Color=BLUE, Roughness=0.0), glossy(Color=GOLD, Roughness=0.0)),
    ),
    _in(
        gray_world,
        "transparent metal",
        principled(Base_Color=GOLD, Metallic=1.0, Roughness=0.3, Alpha=0.5),
        samples=256,
    ),
    _in(
        gray_world,
        "glass or transparent",
        mixed(
            Node("Math", operation="GREATER_THAN", feed=(FACING, 0.3)),
            Node("BsdfGlass", Color=BLUE, Roughness=0.0),
            Node("BsdfTransparent", Color=GRAY),
        ),
    ),
]
