"""Lamps, what glows and worlds as the camera, mirrors and glass see them.

Rough surfaces find such light by their rays and by directions chosen for lights: what counts twice or not at all shows
here. A glass ball stands in the way, which bends the former and lets the latter pass.
"""

from functools import partial
from math import pi, radians

import bpy

from tests.blender.building import add_camera, link, material

from .bsdfs import GREEN, glossy, principled
from .case import Node, Scene
from .lights import glow, mesh
from .worlds import new_world, panorama

_CLEAR = Node("BsdfGlass", Roughness=0.0, IOR=1.5, distribution="GGX")


def _ground_and_glass(shader, ball=(0.6, -1.0, 1.4)):
    """A ground of a shader, before a ball of glass."""
    camera = add_camera(lens=35.0)
    camera.location, camera.rotation_euler = (0.0, -7.0, 1.5), (pi / 2.0, 0.0, 0.0)
    bpy.ops.mesh.primitive_plane_add(size=14.0)
    ground = bpy.context.object
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6, radius=0.7, location=ball)
    bpy.context.object.data.shade_smooth()
    for obj, of_it in ((ground, shader), (bpy.context.object, _CLEAR)):
        made, tree, output = material()
        tree.links.new(of_it.build(tree), output.inputs["Surface"])
        obj.data.materials.append(made)


# Lamps that have an extent.


def _lamp(shader, kind, hidden_from=(), of_object=None, **settings):
    _ground_and_glass(shader)
    data = bpy.data.lights.new("lamp", kind)
    for name, value in ({"energy": 60.0, "color": (1.0, 0.8, 0.5)} | settings).items():
        setattr(data, name, value)
    facing = (-1.3 if kind == "SUN" else -1.2, 0.0, 0.0)
    made = link(data, "lamp", **{"location": (0.0, 2.5, 2.0), "rotation_euler": facing} | (of_object or {}))
    for rays in hidden_from:
        setattr(made, f"visible_{rays}", False)


def _seen(name, shader, *light, **settings):
    effort = {"samples": 256, "blocks": 2} if shader == _ROUGH else {"samples": 64, "blocks": 4}
    return Scene(name, build=partial(_lamp, shader, *light, **settings), few=0.2, **effort)


_BALL = {"shadow_soft_size": 0.6, "use_soft_falloff": False}
_LAMPS = {
    "soft ball": ("POINT", {"shadow_soft_size": 0.6}),
    "ball": ("POINT", _BALL),
    "spot": ("SPOT", {"shadow_soft_size": 0.5, "spot_size": radians(80.0), "spot_blend": 0.8}),
    "rectangle": ("AREA", {"shape": "RECTANGLE", "size": 1.0, "size_y": 1.8}),
    "ellipse": ("AREA", {"shape": "ELLIPSE", "size": 1.0, "size_y": 1.8}),
    "area of little spread": ("AREA", {"shape": "SQUARE", "size": 1.5, "spread": radians(70.0)}),
    "back of an area": ("AREA", {"shape": "SQUARE", "size": 1.5, "of_object": {"rotation_euler": (-0.6, 0.0, 0.0)}}),
    "sun": ("SUN", {"angle": radians(20.0), "energy": 3.0}),
}
_DIFFUSE = Node("BsdfDiffuse", Color=(0.2, 0.3, 0.5, 1.0))
#: Polished: a mirror alone shows little but the lamp.
_POLISHED = Node("MixShader", feed=(0.5, _DIFFUSE, glossy(Color=(0.8, 0.8, 0.8, 1.0), Roughness=0.0)))
_ROUGH = glossy(Color=(0.8, 0.8, 0.8, 1.0), Roughness=0.15)

_LIGHTS = [
    *(_seen(f"seen: {name}", _DIFFUSE, kind, **settings) for name, (kind, settings) in _LAMPS.items()),
    *(
        _seen(f"in a rough mirror: {name}", _ROUGH, _LAMPS[name][0], **_LAMPS[name][1])
        for name in ("soft ball", "rectangle", "area of little spread", "sun")
    ),
    *(
        _seen(f"hidden from {rays} rays: ball", _POLISHED, "POINT", hidden_from=(rays,), **_BALL)
        for rays in ("camera", "glossy", "transmission")
    ),
    _seen("hidden from glossy rays: sun", _POLISHED, "SUN", hidden_from=("glossy",), **_LAMPS["sun"][1]),
]


# What glows and worlds, in rough surfaces.


def _glowing(shader, make, **settings):
    _ground_and_glass(shader, ball=(-1.2, 0.0, 1.0))
    camera = bpy.context.scene.camera
    camera.location, camera.rotation_euler = (0.0, -7.0, 3.0), (1.25, 0.0, 0.0)
    if make:
        glow(make, seen=True, location=(1.0, 1.0, 2.6), **settings)
    else:
        new_world(panorama(sun=10.0))


_SHADERS = {
    "metal 0.15": principled(Metallic=1.0, Roughness=0.15),
    "plastic 0.4": principled(Base_Color=GREEN, Roughness=0.4),
    "coat 0.3": principled(Base_Color=(0.2, 0.1, 0.1, 1.0), Roughness=0.5, Coat_Weight=1.0, Coat_Roughness=0.3),
}
_GLOWS = {
    "ball": {"make": mesh("ico_sphere", subdivisions=6, radius=0.5), "strength": 12.0},
    "few triangles": {"make": mesh("cube", size=0.8), "strength": 20.0},
    "many triangles": {"make": mesh("monkey", size=1.2), "strength": 12.0},
    "image": {"make": mesh("plane", size=1.5), "texture": "TexChecker", "rotation_euler": (0.3, 0.2, 0.1)},
    "panorama": {"make": None},
}

_GLOWING = [
    Scene(
        f"{glowing} in {name}",
        build=partial(_glowing, shader, **settings),
        samples=64,
        blocks=4,
        few=0.2,
        total=0.03,
        brightest=4.0,  # what is mirrored through the ball, without end in both, is the noise of few pixels
    )
    for name, shader in _SHADERS.items()
    for glowing, settings in _GLOWS.items()
    if name == "plastic 0.4" or glowing in ("few triangles", "panorama")
]

CASES = [*_LIGHTS, *_GLOWING]
