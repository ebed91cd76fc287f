"""Lights of every type, and what glows, on a floor and a ball: direct light, soft shadows included."""

from functools import partial
from math import radians

import bpy
import numpy as np

from tests.blender.building import add_camera, link, material, node

from .case import Node, Scene

COLOR = (0.8, 0.7, 0.6, 1.0)
#: Where what glows stands: over the floor, beside the ball.
ABOVE = (1.5, -0.8, 3.2)


def floor_and_ball(shader=None):
    """A floor and a smooth exact ball of a shader (a Node), by default diffuse; the ball."""
    camera = add_camera(lens=40.0)
    camera.location, camera.rotation_euler = (0.0, -7.0, 3.5), (1.13, 0.0, 0.0)
    made, tree, output = material()
    tree.links.new((shader or Node("BsdfDiffuse", Color=COLOR)).build(tree), output.inputs["Surface"])
    bpy.ops.mesh.primitive_plane_add(size=30.0)
    bpy.context.object.data.materials.append(made)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6, radius=1.0, location=(0.0, 0.0, 1.3))
    ball = bpy.context.object
    ball.data.materials.append(made)
    ball.data.shade_smooth()
    return ball


def add_light(kind, of_object=None, falloff=None, **settings):
    """`falloff`: the output of a Light Falloff node that feeds its strength. Cycles shows the camera lights that have
    an extent."""
    data = bpy.data.lights.new("light", kind)
    if falloff:
        if bpy.app.version < (5, 2, 0):
            data.use_nodes = True
        emission = next(n for n in data.node_tree.nodes if n.type == "EMISSION")
        node(data.node_tree, "LightFalloff", emission.inputs["Strength"], falloff, Strength=1.0)
    for name, value in ({"energy": 400.0, "color": (1.0, 0.9, 0.7)} | settings).items():
        setattr(data, name, value)
    placing = {"location": (2.0, -1.5, 4.0), "rotation_euler": (0.35, 0.4, 0.3), "visible_camera": False}
    return link(data, **placing | (of_object or {}))


def _lit(kind, **settings):
    floor_and_ball()
    add_light(kind, **settings)


def _light(name, kind, since=(), **settings):
    return Scene(name, build=partial(_lit, kind, **settings), samples=64, blocks=2, few=0.1, since=since)


_SOFT, _HARD = {"shadow_soft_size": 0.8}, {"shadow_soft_size": 0.0}
_BALL = _SOFT | {"use_soft_falloff": False}
_LONG, _WIDE = {"shape": "RECTANGLE", "size": 0.5, "size_y": 2.0}, {"scale": (2.0, 1.0, 1.0)}
#: What lights got in Blender 4.5.
_NEW = {"since": (4, 5)}

_LIGHTS = [
    _light("point", "POINT", **_HARD),
    _light("ball", "POINT", **_BALL, of_object=_WIDE),
    _light("soft ball", "POINT", **_SOFT),
    _light("soft ball through the floor", "POINT", shadow_soft_size=1.0, of_object={"location": (2.0, 0.5, 0.3)}),
    _light("around everything", "POINT", shadow_soft_size=20.0, use_soft_falloff=False),
    _light("not normalized ball", "POINT", **_SOFT, **_NEW, normalize=False, energy=80.0),
    _light("cool ball", "POINT", **_SOFT, **_NEW, use_temperature=True, temperature=9000.0),
    _light("spot", "SPOT", **_HARD, spot_blend=0.0, spot_size=0.7),
    _light("blended spot", "SPOT", **_HARD, spot_blend=0.6, spot_size=0.8),
    _light("spot ball", "SPOT", **_BALL, spot_blend=0.3),
    _light("soft spot ball", "SPOT", **_SOFT, spot_blend=1.0),
    _light("stretched spot", "SPOT", **_HARD, spot_blend=0.4, of_object={"scale": (1.0, 2.0, 1.5)}),
    _light("widest spot", "SPOT", **_HARD, spot_size=radians(180.0)),
    _light("exposed spot", "SPOT", **_HARD, **_NEW, exposure=1.5),
    _light("square", "AREA", shape="SQUARE", size=1.5),
    _light("rectangle", "AREA", **_LONG, of_object={"scale": (1.0, 1.5, 1.0)}),
    _light("mirrored rectangle", "AREA", **_LONG, of_object={"scale": (-1.0, 1.0, 1.0)}),
    _light("disk", "AREA", shape="DISK", size=2.0),
    _light("ellipse", "AREA", shape="ELLIPSE", size=3.0, size_y=1.0),
    _light("rectangle of little spread", "AREA", shape="RECTANGLE", size=3.0, size_y=1.0, spread=radians(60.0)),
    _light("disk of little spread", "AREA", shape="DISK", size=2.0, spread=radians(60.0)),
    _light("ellipse of hardly any spread", "AREA", shape="ELLIPSE", size=5.0, size_y=3.0, spread=radians(5.0)),
    _light(
        "not normalized area",
        "AREA",
        **_NEW,
        size=1.5,
        normalize=False,
        energy=300.0,
        of_object=_WIDE,
    ),
    _light("exposed area", "AREA", **_NEW, size=1.0, exposure=-1.0),
    _light("warm area", "AREA", **_NEW, size=1.0, use_temperature=True, temperature=3000.0),
    _light("area without shadow", "AREA", size=1.0, use_shadow=False),
    _light("ball that does not fall off", "POINT", shadow_soft_size=1.0, energy=15.0, falloff="Constant"),
    _light("spot that does not fall off", "SPOT", spot_blend=0.5, energy=15.0, falloff="Constant"),
    _light("area that does not fall off", "AREA", size=2.0, energy=15.0, falloff="Constant"),
    _light("sun", "SUN", angle=0.0, energy=3.0),
    _light("soft sun", "SUN", angle=radians(10.0), energy=3.0),
    _light("half a sky", "SUN", angle=radians(150.0), energy=3.0),
    _light("warm sun", "SUN", **_NEW, angle=0.0, energy=3.0, use_temperature=True, temperature=2500.0),
    _light("not normalized sun", "SUN", **_NEW, angle=radians(10.0), energy=300.0, normalize=False),
]


def _collection_of(*objects, state="INCLUDE"):
    made = bpy.data.collections.new("linked")
    for obj in objects:
        made.objects.link(obj)
    for entry in made.collection_objects:
        entry.light_linking.link_state = state
    return made


def _linked(role, state):
    """A lamp of certain objects, and a sun of all."""
    ball = floor_and_ball()
    light = add_light("POINT", **_BALL)
    add_light("SUN", energy=0.3, angle=0.0)
    setattr(light.light_linking, f"{role}_collection", _collection_of(ball, state=state))


def _linked_deeply():
    """A lamp of the objects of a collection in a collection."""
    ball = floor_and_ball()
    outer = bpy.data.collections.new("outer")
    outer.children.link(_collection_of(ball))
    add_light("POINT", **_HARD).light_linking.receiver_collection = outer


#: What both diffuse and glossy rays light.
_BOTH = Node(
    "MixShader",
    feed=(0.5, Node("BsdfDiffuse", Color=COLOR), Node("BsdfAnisotropic", distribution="GGX", Roughness=0.4)),
)


def _hidden_from(rays):
    floor_and_ball(_BOTH)
    setattr(add_light("POINT", **_HARD), f"visible_{rays}", False)
    # A mirror's reflection in another is lit too.
    bpy.context.scene.cycles.max_bounces = 0
    bpy.context.scene.conic.max_depth = 1


_SEEN = [
    *(
        Scene(f"linking: {role} {state}", build=partial(_linked, role, state), samples=128, blocks=2)
        for role in ("receiver", "blocker")
        for state in ("INCLUDE", "EXCLUDE")
    ),
    Scene("linking: a collection in a collection", build=_linked_deeply),
    *(Scene(f"hidden from {rays} rays", build=partial(_hidden_from, rays)) for rays in ("diffuse", "glossy")),
]


def _shining(strength, texture=None, **sampling):
    made, tree, output = material()
    emission = node(tree, "Emission", output.inputs["Surface"], Color=(1.0, 0.8, 0.5, 1.0), Strength=strength)
    if texture:
        node(tree, texture, emission.inputs["Color"], "Color", Scale=6.0)
    for name, value in sampling.items():
        setattr(made.cycles, name, value)
    return made


def _glowing(make, **settings):
    floor_and_ball()
    glow(make, **settings)


def glow(make, strength=8.0, texture=None, sampling="AUTO", seen=False, **placing):
    """Let a new object glow; `sampling`: Cycles' setting; `seen`: by the camera too."""
    obj = make()
    obj.data.materials.clear()
    obj.data.materials.append(_shining(strength, texture, emission_sampling=sampling))
    obj.visible_camera = seen
    for name, value in placing.items():
        setattr(obj, name, value)


def mesh(kind, **settings):
    def make():
        getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**settings)
        return bpy.context.object

    return make


def _balls():
    """More than are all asked: copies of one ball, by size and place."""
    first = _BALL_MESH()
    first.data.shade_smooth()
    rng = np.random.default_rng(1)
    for x, y, z in rng.uniform((-3.0, -3.0, 2.5), (3.0, 3.0, 4.0), (20, 3)):
        copy = link(first.data, location=(x, y, z), visible_camera=False)
        copy.scale = [rng.uniform(0.3, 1.5)] * 3
    first.location = (0.0, 0.0, 5.0)
    return first


_BALL_MESH = mesh("uv_sphere", segments=64, ring_count=32, radius=0.4)
_CYLINDER = mesh("cylinder", vertices=128, radius=0.2, depth=2.0)
_STRETCHED = {"scale": (2.0, 0.7, 1.2), "rotation_euler": (0.4, 0.3, 0.2)}


def _glow(name, make, *, location=ABOVE, **settings):
    build = partial(_glowing, make, location=location, **settings)
    return Scene(f"glowing {name}", build=build, blocks=4)


_GLOWING = [
    _glow("ball", _BALL_MESH),
    _glow("ball on the floor", _BALL_MESH, location=(1.8, -0.5, 0.3)),
    _glow("ellipsoid", _BALL_MESH, **_STRETCHED),
    _glow("cylinder", _CYLINDER, rotation_euler=(0.5, 1.2, 0.0)),
    _glow("cone", mesh("cone", vertices=128, radius1=0.6, depth=1.0)),
    _glow("disc", mesh("circle", vertices=128, radius=0.6, fill_type="NGON")),
    _glow("mesh", mesh("monkey", size=1.5)),
    _glow("image of itself", mesh("plane", size=2.0), texture="TexChecker"),
    _glow("many balls", _balls, location=(0.0, 0.0, 5.0), strength=2.0),
    _glow("front alone", mesh("plane", size=1.5), sampling="FRONT", rotation_euler=(3.1, 0.0, 0.0)),
]

CASES = [*_LIGHTS, *_SEEN, *_GLOWING]
