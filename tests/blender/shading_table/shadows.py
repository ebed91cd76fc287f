"""Shadows of what is transparent, of glass, and of what is both. The camera sees nothing but the floor they fall on."""

from functools import partial

import bpy

from tests.blender.building import add_camera, link, material

from .bsdfs import BLUE, GOLD, GRAY, GREEN, RED, added, diffuse, glossy, mixed, principled
from .case import Node, Scene

_GLASS = partial(Node, "BsdfGlass", distribution="GGX", Roughness=0.0, IOR=1.5)
_CLEAR = partial(Node, "BsdfTransparent")
_CHECKER = Node("TexChecker", "Fac", Vector=Node("TexCoord", "UV"), Scale=4.0)
_WAVES = Node("TexNoise", "Color", Vector=Node("TexCoord", "Object"), Scale=1.3, Detail=0.0)


def _shaded(shader, obj):
    made, tree, output = material()
    tree.links.new(shader.build(tree), output.inputs["Surface"])
    obj.data.materials.append(made)
    return tree, output


def _floor(shader):
    bpy.ops.mesh.primitive_plane_add(size=8.0)
    _shaded(shader, bpy.context.object)
    camera = add_camera(type="ORTHO", ortho_scale=5.0)
    camera.location, camera.rotation_euler = (0.0, -4.0, 6.0), (0.58, 0.0, 0.0)


def _unseen(shader, location, ball, volume=None):
    if ball:
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6, radius=1.1, location=location)
        bpy.context.object.data.shade_smooth()
    else:
        bpy.ops.mesh.primitive_plane_add(size=2.4, location=location, rotation=(0.1, 0.2, 0.3))
    bpy.context.object.visible_camera = False
    tree, output = _shaded(shader, bpy.context.object)
    if volume:
        tree.links.new(volume.build(tree), output.inputs["Volume"])


def _built(light, shader, ball=True, floor=None, **settings):
    _floor(floor or diffuse(Color=GRAY))
    _unseen(shader, (0.0, 0.0, 1.5), ball, **settings)
    light()


def _sheets(light, *shaders):
    _floor(diffuse(Color=GRAY))
    for i, shader in enumerate(shaders):
        _unseen(shader, (0.6 * i - 0.3, 0.2 * i, 1.0 + 0.5 * i), False)
    light()


def _sun():
    data = bpy.data.lights.new("sun", "SUN")
    data.energy, data.angle = 2.0, 0.0
    link(data, "sun", rotation_euler=(0.3, 0.2, 0.0))


def _point():
    data = bpy.data.lights.new("lamp", "POINT")
    data.energy, data.shadow_soft_size = 300.0, 0.0
    link(data, "lamp", location=(0.7, 0.5, 4.5))


def _area():
    data = bpy.data.lights.new("area", "AREA")
    data.energy, data.size = 200.0, 1.0
    link(data, "area", location=(0.3, 1.5, 3.5), rotation_euler=(-0.2, 0.0, 0.0), visible_camera=False)


def _world():
    world = bpy.context.scene.world = bpy.data.worlds.new("world")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.6, 0.7, 1.0)


_LIGHTS = {_sun: "sun", _point: "lamp", _area: "area light", _world: "world"}


def _under(light, name, shader, few=0.1, samples=32, **settings):
    of_case = {k: settings.pop(k) for k in ("blocks", "total") if k in settings}
    build = partial(_built, light, shader, **settings)
    return Scene(f"shadow of {name}, {_LIGHTS[light]}", build=build, few=few, samples=samples, **of_case)


_BY_TEXTURE = principled(Base_Color=GREEN, Alpha=_CHECKER)
_HALF = principled(Base_Color=RED, Alpha=0.5)
_COLORED = _CLEAR(Color=BLUE)
#: Of which half is not bent.
_MIXED = mixed(0.4, _GLASS(Color=GOLD), _COLORED)

CASES = [
    _under(_sun, "an opaque ball", principled(Base_Color=GREEN)),
    _under(_sun, "a checker of alpha", _BY_TEXTURE, ball=False),
    _under(_point, "a checker of alpha", _BY_TEXTURE, ball=False),
    _under(_sun, "a half transparent ball", _HALF),
    _under(_point, "a half transparent ball", _HALF),
    _under(_area, "a half transparent ball", _HALF, samples=256, blocks=2),
    _under(_world, "a half transparent ball", _HALF, samples=256, blocks=4),
    _under(_sun, "a glass ball", _GLASS()),
    _under(_point, "a pane of colored glass", _GLASS(Color=BLUE), ball=False),
    _under(_sun, "glass of principled", principled(Base_Color=BLUE, Transmission_Weight=1.0, Roughness=0.0, Alpha=0.4)),
    _under(_sun, "a mix of glass and transparent", _MIXED),
    _under(_point, "a sum of glass and transparent", added(_COLORED, _GLASS(Color=GRAY)), ball=False),
    _under(_sun, "a transparent texture", _CLEAR(Color=_WAVES), ball=False),
    _under(_sun, "a mix by a texture", mixed(_CHECKER, _GLASS(), _CLEAR()), ball=False),
    _under(
        _sun,
        "a mix by direction",
        mixed(Node("LayerWeight", "Facing", Blend=0.5), _CLEAR(), glossy(Color=GRAY, Roughness=0.2)),
    ),
    _under(
        _sun,
        "a clear body that absorbs",
        _CLEAR(),
        volume=Node("VolumeAbsorption", Color=GOLD, Density=0.6),
    ),
    _under(
        _area,
        "half a pane on a rough floor",
        _HALF,
        ball=False,
        floor=glossy(Color=GRAY, Roughness=0.25),
        samples=256,
        blocks=2,
    ),
    Scene(
        "shadow of three sheets, sun",
        build=partial(_sheets, _sun, _HALF, _COLORED, _BY_TEXTURE),
        few=0.1,
        samples=32,
    ),
]
