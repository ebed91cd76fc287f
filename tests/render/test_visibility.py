"""Which rays see an object, holes in the picture, and backs that are passed: single rays, values by hand."""

import numpy as np
import pytest

from addon.engine import (
    Camera,
    Geometry,
    Instances,
    Light,
    Material,
    Planes,
    Scene,
    Settings,
    Spheres,
    Triangles,
    Visibility,
    World,
    render,
)
from addon.engine.settings import SHADOWS

from .probe import along

SETTINGS = Settings(max_depth=8, weight_cutoff=0.0)
SKY = 0.25
DOWN, UP = (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)
FLOOR, GLOWING, MIRROR, BENDING, STRAIGHT = range(5)


def materials():
    """White floor, a thing that glows, a mirror, and panes that bend light or let it straight through."""
    pane = dict(diffuse=0.0, transmit=1.0, fresnel=False, bounds_body=False)
    return [
        Material(diffuse=1.0),
        Material(diffuse=0.0, glow=1.0),
        Material.mirror(),
        Material(**pane, ior=1.5),
        Material(**pane, ior=1.0),
    ]


def thing(kind, visibility, height=2.0, material=GLOWING):
    """Something over the floor that rays along Z meet, as an instance or as a plane."""
    if kind == "plane":
        return Planes(point=(0.0, 0.0, height), normal=UP, material=material, visibility=int(visibility))
    matrix = np.diag([1.0, 1.0, 0.5, 1.0])
    matrix[2, 3] = height
    sphere = Geometry(Spheres(center=(0.0, 0.0, 0.0), radius=1.0))
    return Instances(sphere, matrix, (material,), visibility=visibility)


def world(*things):
    """The things over a floor, under a sun that stands overhead."""
    scene = Scene(world=World((SKY,) * 3), materials=materials())
    scene.add_plane((0.0, 0.0, 0.0), UP, FLOOR)
    scene.add_light(Light.sun(UP, np.pi))
    for part in things:
        (scene.instances if isinstance(part, Instances) else scene.planes).append(part)
    return scene


def without(bit):
    return Visibility.ALL & ~bit


each_kind = pytest.mark.parametrize("kind", ["instance", "plane"])


@each_kind
def test_camera_rays(device, kind):
    """Without CAMERA the floor is seen where the thing stands, in its shadow."""
    for visibility, expected in ((Visibility.ALL, 1.0), (without(Visibility.CAMERA), 0.0)):
        scene = world(thing(kind, visibility))
        assert along(device, scene, (0.0, 0.0, 4.0), DOWN, SETTINGS) == pytest.approx(expected)


@each_kind
@pytest.mark.parametrize("shadows", SHADOWS)
def test_shadow_rays(device, kind, shadows):
    settings = Settings(max_depth=8, weight_cutoff=0.0, shadows=shadows)
    for visibility, expected in ((Visibility.ALL, 0.0), (without(Visibility.SHADOW), 1.0)):
        scene = world(thing(kind, visibility))
        assert along(device, scene, (0.0, 0.0, 1.0), DOWN, settings) == pytest.approx(expected)


@each_kind
def test_rays_from_a_mirror(device, kind):
    """Looking down past the thing into a mirror under it: the thing, or the sky behind it."""
    mirror = Planes(point=(0.0, 0.0, 0.5), normal=UP, material=MIRROR)
    for visibility, expected in (
        (Visibility.ALL, 1.0),
        (without(Visibility.GLOSSY), SKY),
        (Visibility.GLOSSY, 1.0),
        (without(Visibility.CAMERA | Visibility.TRANSMISSION), 1.0),
    ):
        scene = world(thing(kind, visibility), mirror)
        assert along(device, scene, (0.0, 0.0, 1.0), DOWN, SETTINGS) == pytest.approx(expected)


@each_kind
@pytest.mark.parametrize("pane", [BENDING, STRAIGHT])
def test_rays_through_a_pane(device, kind, pane):
    """What is bent is a transmission ray; what passes straight stays a camera ray."""
    through = Visibility.TRANSMISSION if pane == BENDING else Visibility.CAMERA
    sheet = Planes(point=(0.0, 0.0, 5.0), normal=UP, material=pane, visibility=int(without(Visibility.SHADOW)))
    for visibility, expected in ((Visibility.ALL, 1.0), (through, 1.0), (without(through), 0.0)):
        scene = world(thing(kind, visibility | Visibility.SHADOW), sheet)
        assert along(device, scene, (0.0, 0.0, 6.0), DOWN, SETTINGS) == pytest.approx(expected)


def rgba(device, scene, origin, direction, *, transparent=False):
    """The pixel (4,) of one ray."""
    up = (0.0, 1.0, 0.0)
    scene.camera = Camera.orthographic_at(origin, np.add(origin, direction), 1e-3, up=up)
    settings = Settings(max_depth=8, weight_cutoff=0.0, film_transparent=transparent)
    return render(scene, 1, 1, settings, device=device).pixels[0, 0].astype(np.float64)


HOLDOUT = Visibility.ALL | Visibility.HOLDOUT


@each_kind
@pytest.mark.parametrize("transparent", [False, True])
def test_a_holdout_is_a_hole(device, kind, transparent):
    """Black with alpha 0 over either film, and it casts its shadow; beside it the floor is as it is."""
    scene = world(thing(kind, HOLDOUT))
    hole = rgba(device, scene, (0.0, 0.0, 4.0), DOWN, transparent=transparent)
    assert hole == pytest.approx([0.0, 0.0, 0.0, 0.0])
    under = rgba(device, scene, (0.0, 0.0, 1.0), DOWN, transparent=transparent)
    assert under == pytest.approx([0.0, 0.0, 0.0, 1.0])
    if kind == "instance":
        beside = rgba(device, scene, (3.0, 0.0, 4.0), DOWN, transparent=transparent)
        assert beside == pytest.approx([1.0, 1.0, 1.0, 1.0])


@each_kind
def test_other_rays_see_a_holdout_as_it_is(device, kind):
    mirror = Planes(point=(0.0, 0.0, 0.5), normal=UP, material=MIRROR)
    assert rgba(device, world(thing(kind, HOLDOUT), mirror), (0.0, 0.0, 1.0), DOWN) == pytest.approx([1.0] * 4)
    for pane, expected in ((BENDING, 1.0), (STRAIGHT, 0.0)):
        sheet = Planes(point=(0.0, 0.0, 5.0), normal=UP, material=pane)
        assert rgba(device, world(thing(kind, HOLDOUT), sheet), (0.0, 0.0, 6.0), DOWN) == pytest.approx([expected] * 4)


def test_a_holdout_through_a_tinted_pane(device):
    """The pane takes its share, the hole what is left of each channel; what the pane reflects is there."""
    scene = world(thing("plane", HOLDOUT))
    color = np.array((0.9, 0.6, 0.3))
    scene.materials[STRAIGHT] = Material(diffuse=0.0, transmit=color, glow=0.1, ior=1.0, fresnel=False)
    scene.add_plane((0.0, 0.0, 5.0), UP, STRAIGHT)
    assert rgba(device, scene, (0.0, 0.0, 6.0), DOWN) == pytest.approx([0.1, 0.1, 0.1, 1.0 - color.mean()])


def test_what_a_holdout_lets_straight_through_is_no_hole(device):
    """As a transparent surface in Cycles: the hole is as deep as what it does not transmit."""
    color = np.array((0.2, 0.4, 0.6))
    for ior, expected in ((1.0, [*color, color.mean()]), (1.5, [0.0] * 4)):
        scene = world(thing("plane", HOLDOUT))
        scene.materials[GLOWING] = Material(diffuse=0.0, glow=1.0, transmit=color, ior=ior, fresnel=False)
        scene.add_plane((0.0, 0.0, 1.0), UP, scene.add_material(Material(diffuse=0.0, glow=1.0)))
        assert rgba(device, scene, (0.0, 0.0, 4.0), DOWN) == pytest.approx(expected)


def sheets(count, **culling):
    """`count` discs over each other that face up and glow, over the floor."""
    scene = world()
    scene.materials[GLOWING] = Material(diffuse=0.0, glow=1.0, **culling)
    scene.add_discs([(0.0, 0.0, 1.0 + 0.1 * i) for i in range(count)], UP, 0.5, GLOWING)
    return scene


def test_culled_backs_are_passed(device):
    """From below the sky is seen through any number of backs, at any depth; from above the topmost sheet."""
    shallow = Settings(max_depth=1)
    assert along(device, sheets(20), (0.0, 0.0, 0.5), UP, shallow) == pytest.approx(1.0)
    assert along(device, sheets(20, cull_back=True), (0.0, 0.0, 0.5), UP, shallow) == pytest.approx(SKY)
    assert along(device, sheets(20, cull_back=True), (0.0, 0.0, 9.0), DOWN, shallow) == pytest.approx(1.0)


@pytest.mark.parametrize("shadows", SHADOWS)
def test_culled_shadows(device, shadows):
    """The side that the light sees counts, as in EEVEE: only sheets that turn their back to it cast no shadow."""
    settings = Settings(max_depth=8, weight_cutoff=0.0, shadows=shadows)
    for facing, culling, expected in (
        (UP, {"cull_back_shadow": True}, 0.0),
        (DOWN, {"cull_back_shadow": True}, 1.0),
        (DOWN, {"cull_back": True}, 0.0),
        (DOWN, {}, 0.0),
    ):
        scene = world()
        scene.materials[GLOWING] = Material(**culling)
        scene.add_discs([(0.0, 0.0, 1.0 + 0.1 * i) for i in range(5)], facing, 0.5, GLOWING)
        assert along(device, scene, (0.0, 0.0, 0.5), DOWN, settings) == pytest.approx(expected), (facing, culling)
    scene.add_spheres((0.0, 0.0, 3.0), 0.5, FLOOR)  # what is not culled still stops the light behind what is
    scene.materials[GLOWING] = Material(cull_back_shadow=True)
    assert along(device, scene, (0.0, 0.0, 0.5), DOWN, settings) == pytest.approx(0.0)


def test_culling_and_absorption(device):
    """A culled back is no border: the way through a body that holds it is absorbed as one."""
    absorption = np.array((0.1, 0.4, 0.9))
    body = Material(diffuse=0.0, transmit=1.0, ior=1.0, absorption=tuple(absorption))
    inner = Material(diffuse=0.0, transmit=0.5, ior=1.3, absorption=(9.0, 9.0, 9.0), cull_back=True)
    scene = Scene(world=World((1.0, 1.0, 1.0)), materials=[body, inner])
    scene.add_spheres((0.0, 0.0, 0.0), 1.0, 0)
    scene.add_discs((0.0, 0.0, 0.2), UP, 0.5, 1)
    assert along(device, scene, (0.0, 0.0, -3.0), UP, SETTINGS) == pytest.approx(np.exp(-2.0 * absorption), rel=1e-5)


def test_a_mirrored_instance_keeps_its_front(device):
    """Backs are told by the geometry's own outside, however the instance is turned over."""
    cube = Triangles(p0=(-1.0, -1.0, 0.0), p1=(1.0, -1.0, 0.0), p2=(0.0, 1.0, 0.0), material=0)
    for matrix in (np.eye(4), np.diag([-1.0, 1.0, 1.0, 1.0]), np.diag([1.0, -2.0, 1.0, 1.0])):
        scene = Scene(world=World((SKY,) * 3), materials=[Material(diffuse=0.0, glow=1.0, cull_back=True)])
        scene.instances.append(Instances(Geometry(cube), matrix))
        assert along(device, scene, (0.0, 0.0, 1.0), DOWN, SETTINGS) == pytest.approx(1.0)
        assert along(device, scene, (0.0, 0.0, -1.0), UP, SETTINGS) == pytest.approx(SKY)
