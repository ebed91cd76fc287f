"""Worlds: what the camera sees of them, and the light that they throw on a floor and a ball."""

from functools import partial

import bpy
import numpy as np
from mathutils import Vector

from tests.blender.building import add_camera, image, link, mesh_of

from .case import Node, Scene
from .images import MULTIPLE, SINGLE, from_file, picture
from .lights import COLOR, floor_and_ball

GENERATED = Node("TexCoord", "Generated")


def turned(*angles):
    return Node("Mapping", Rotation=angles, Vector=GENERATED)


def new_world(color, strength=1.0, hidden_from=()):
    """A world of a color: a Node, (r, g, b, a), or a function of (tree, socket) that feeds the socket."""
    made = bpy.context.scene.world = bpy.data.worlds.new("world")
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    background = next(n for n in made.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Strength"].default_value = strength
    socket = background.inputs["Color"]
    if isinstance(color, Node):
        made.cycles.sampling_method, made.cycles.sample_map_resolution = "MANUAL", 512  # Cycles' own choice takes long
        made.node_tree.links.new(color.build(made.node_tree), socket)
    elif callable(color):
        color(made.node_tree, socket)
    else:
        socket.default_value = color
    for rays in hidden_from:
        setattr(made.cycles_visibility, rays, False)


# What a camera sees.


def _seen(color):
    """The view of a camera with a wide angle."""
    camera = add_camera(lens=14.0)
    camera.location, camera.rotation_euler = (0.3, 0.1, 0.2), (1.7, 0.2, 0.7)
    new_world(color)
    bpy.context.scene.world.cycles.sampling_method = "NONE"  # nothing is lit
    bpy.context.scene.render.film_transparent = False


def _sun_seen(kind, elevation):
    """A view of a sun, much larger than ours."""
    _seen(Node("TexSky", sky_type=kind, sun_elevation=elevation, sun_rotation=0.7, sun_size=0.2))
    across = np.cos(elevation)
    camera = bpy.context.scene.camera
    towards = Vector((across * np.sin(0.7), across * np.cos(0.7), np.sin(elevation)))
    camera.rotation_euler = towards.to_track_quat("-Z", "Y").to_euler()
    camera.data.lens = 160.0


_environment = partial(picture, kind="TexEnvironment", vector=None)
_NOISE = Node("TexNoise", "Color", Vector=GENERATED, Scale=2.0, Detail=1.0)
_RAMP = Node("ValToRGB", Fac=Node("SeparateXYZ", "Z", Vector=GENERATED))

_SEEN = [
    *(
        Scene(f"seen: {name}", build=partial(_seen, color), samples=16)
        for name, color in {
            "environment": _environment(),
            "environment turned": picture(kind="TexEnvironment", vector=turned(0.4, 0.3, 1.1)),
            "environment of floats": _environment(partial(from_file, "w.exr", "OPEN_EXR")),
            "mirror ball": _environment(projection="MIRROR_BALL"),
            "noise": _NOISE,
            "gradient by a ramp": _RAMP,
        }.items()
    ),
    *(
        Scene(f"seen: sun of {kind.lower()} {height}", build=partial(_sun_seen, kind, height), samples=32, **settings)
        for kind, settings in (*((k, {"few": 0.15} | s) for k, s in SINGLE), (MULTIPLE, {"since": (5, 0)}))
        for height in (0.5, 0.05)
    ),
]


# Its light.


def panorama(sky=0.2, sun=900.0, vector=None):
    """A high-contrast sky with a sun of half a degree and a half, as floats."""

    def make():
        height, width = 256, 512
        pixels = np.ones((height, width, 4), np.float32)
        pixels[..., :3] = sky * np.linspace(0.2, 1.0, height)[:, None, None] * (0.6, 0.8, 1.0)
        pixels[200:202, 150:152, :3] = sun * np.array([1.0, 0.9, 0.7])
        made = image(pixels, "sky", float_buffer=True)
        made.pack()
        return made

    return picture(make, kind="TexEnvironment", vector=vector)


def _lights(color, shader=None, wall=False, hidden_from=("camera",), strength=1.0):
    """The floor and the ball in the light of a world, of which a wall hides a half."""
    ball = floor_and_ball()
    new_world(color, strength, hidden_from)
    if shader:
        made = bpy.data.materials.new("of the ball")
        if bpy.app.version < (5, 0, 0):
            made.use_nodes = True
        made.node_tree.links.new(shader.build(made.node_tree), made.node_tree.get_output_node("CYCLES").inputs[0])
        ball.data.materials[0] = made
    if wall:
        mesh = mesh_of([(-3, -20, 0), (-3, 20, 0), (-3, 20, 40), (-3, -20, 40)], [(0, 1, 2, 3)])
        link(mesh, "wall").data.materials.append(bpy.data.materials["material"])


def _light(name, color, since=(), until=(99,), **settings):
    build = partial(_lights, color, **settings)
    samples = 128 if "sky" in name else 64
    return Scene(f"light of {name}", build=build, samples=samples, blocks=4, since=since, until=until)


def _sky(kind, **settings):
    return Node("TexSky", sky_type=kind, **settings)


_BLUE = (0.3, 0.6, 0.9, 1.0)
#: Red to +X, green to +Y, blue upwards.
_GRADIENT = Node("VectorMath", operation="MULTIPLY_ADD", feed=(GENERATED, (0.5,) * 3, (0.5,) * 3))
_ROUGH = Node("BsdfAnisotropic", Color=COLOR, Roughness=0.3, distribution="GGX")
_LOW_SUN = {"sun_elevation": 0.5, "sun_rotation": 2.0}

_LIGHT = [
    _light("a color", _BLUE, strength=1.5),
    _light("a color, behind a wall", _BLUE, wall=True),
    _light("a gradient", _GRADIENT),
    _light("noise", _NOISE),
    _light("a panorama", panorama(), strength=0.7),
    _light("a sun in the dark", panorama(sky=0.001)),
    _light("a panorama without a sun", panorama(sun=0.2)),
    _light("a panorama turned about all axes", panorama(vector=turned(0.3, -0.4, 2.0))),
    *(_light(f"a sky {kind.lower()}", _sky(kind, **_LOW_SUN), strength=0.1, **since) for kind, since in SINGLE),
    _light("a sky multiple_scattering", _sky(MULTIPLE, **_LOW_SUN), strength=0.1, since=(5, 0)),
    _light("a sky preetham", _sky("PREETHAM", sun_direction=(0.5, 0.3, 0.4), turbidity=3.0)),
    _light("a panorama, on a rough mirror too", panorama(sun=2.0), shader=_ROUGH, hidden_from=()),
    _light("a panorama, hidden from glossy rays", panorama(sun=2.0), shader=_ROUGH, hidden_from=("glossy",)),
]

CASES = [*_SEEN, *_LIGHT]
