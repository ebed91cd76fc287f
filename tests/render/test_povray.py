"""Pictures against POV-Ray: same scene, same light model, each primitive alone, and all together with mirror and glass.

Two pictures are made of each scene: one where every material glows in a colour of its own, which says what is seen
where, and the lit one, which is compared where both see the same.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from addon.engine import (
    Camera,
    Geometry,
    Instances,
    Light,
    Material,
    Scene,
    Settings,
    Spheres,
    Triangles,
    World,
    render,
)

from . import povray
from .compare import psnr, save_difference, silhouette_distance

SIZE = (200, 150)
SETTINGS = Settings(max_depth=8, weight_cutoff=0.0, shadows="TINTED")
DECIBELS = 40.0
TYPICAL_DIFFERENCE = 2e-4
RED = Material(diffuse=(0.75, 0.2, 0.1))


def scene_of(*materials, eye=(3.0, -5.0, 3.2), target=(0.0, 0.0, 0.6), angle=38.0):
    """A scene with these materials, two lights and a perspective camera that looks down at it."""
    camera = Camera.look_at(eye, target, angle=angle, aspect=SIZE[0] / SIZE[1])
    scene = Scene(camera=camera, world=World((0.10, 0.15, 0.25)), materials=list(materials))
    scene.add_light(Light.constant((4.0, -4.0, 6.0), (0.7, 0.7, 0.65)))
    scene.add_light(Light.sun((-2.0, -1.0, 2.0), 0.6))
    return scene


def identities(scene):
    """The scene with each material glowing in its own colour and nothing else: black, then steps of each channel."""
    codes = np.arange(1, len(scene.materials) + 1)
    steps = np.stack([codes % 4, codes // 4 % 4, codes // 16], axis=-1) / 4.0
    glowing = [Material(diffuse=0.0, reflect=0.0, transmit=0.0, glow=tuple(step)) for step in steps]
    return replace(scene, materials=glowing, world=World((0.0, 0.0, 0.0)), lights=[])


def seen(pixels):
    """Which material's colour is where, (h, w) int."""
    steps = np.rint(pixels[..., :3] * 4.0).astype(int)
    return steps @ (1, 4, 16)


def assert_same_picture(device, scene, name):
    """Silhouettes of all materials within a pixel, and the values where both see the same: by PSNR, and 95 of 100
    pixels equal to what float32 and 16-bit files leave. So a small error all over does not hide behind single pixels
    where a refracted ray or a shadow ray just passes an edge."""
    (ours, theirs), (our_ids, their_ids) = both(device, scene, identities(scene))
    our_ids, their_ids = seen(our_ids), seen(their_ids)
    for code in np.unique(np.concatenate([our_ids, their_ids])):
        distance = silhouette_distance(our_ids == code, their_ids == code)
        assert distance <= 1, f"{name}: the silhouette of material {code - 1} is {distance} pixels off"
    common = our_ids == their_ids
    assert common.mean() > 0.98, f"{name}: the pictures see the same in {common.mean():.1%} of the pixels only"
    ratio = psnr(ours, theirs, common)
    typical = np.quantile(np.abs(np.minimum(ours, 1.0) - theirs).max(axis=-1)[common], 0.95)
    if ratio < DECIBELS or typical > TYPICAL_DIFFERENCE:
        path = save_difference(f"povray_{name}", ours, theirs)
        pytest.fail(
            f"{name}: {ratio:.1f} dB, typical difference {typical:.2g}; ours, POV-Ray's, 16 x difference: {path}"
        )


def both(device, *scenes):
    """Pairs of pixels (h, w, 3), the engine's and POV-Ray's, which mostly waits as it starts: its runs go at once."""
    with ThreadPoolExecutor() as pool:
        theirs = [pool.submit(povray.render, scene, *SIZE, SETTINGS) for scene in scenes]
        ours = [render(scene, *SIZE, SETTINGS, device=device).pixels[..., :3] for scene in scenes]
        return [(our, their.result()) for our, their in zip(ours, theirs, strict=True)]


# Each primitive alone.

SHEAR = np.array([[1.1, 0.5, 0.0, 0.1], [0.0, 0.6, 0.3, 0.0], [0.0, 0.0, 0.8, 0.7], [0.0, 0.0, 0.0, 1.0]])


def plane(scene):
    scene.add_plane((0.0, 0.0, 0.0), (0.15, 0.1, 1.0))


def triangle(scene):
    scene.add_triangles((-1.5, -0.5, 0.1), (1.6, -0.8, 0.3), (0.2, 1.0, 1.8))


def smooth_triangles(scene):
    """A roof whose ridge is smoothed, and a triangle with different normals, of length 1 as POV-Ray makes them."""
    normals = [
        (0.0, -0.6, 1.0),
        (-0.6, 0.0, 1.0),
        (0.6, 0.0, 1.0),
        (-0.5, -0.5, 1.0),
        (0.9, -0.2, 0.5),
        (0.1, -0.9, 0.6),
    ]
    ridge, left, right, a, b, c = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    scene.add_triangles(
        [(-1.5, -1.0, 0.3), (0.0, -1.0, 1.2), (0.2, 0.8, 0.2)],
        [(0.0, -1.0, 1.2), (1.4, -1.0, 0.2), (1.6, 0.9, 0.6)],
        [(-1.2, 1.0, 0.6), (-1.2, 1.0, 0.6), (0.4, 0.5, 1.9)],
        n0=[left, ridge, a],
        n1=[ridge, right, b],
        n2=[left, left, c],
    )


def sphere(scene):
    scene.add_spheres((0.0, 0.0, 0.7), 1.1)


def ellipsoid(scene):
    """A sphere that is sheared and stretched: an instance."""
    scene.instances.append(Instances(Geometry(Spheres(center=(0.0, 0.0, 0.0), radius=1.0)), SHEAR))


def disc(scene):
    scene.add_discs((0.0, 0.0, 0.6), (0.5, -0.4, 0.7), 1.3)


def cylinder_side(scene):
    """Open, so that its inside is seen too."""
    scene.add_cylinders((-0.4, 0.3, 0.0), (0.3, -0.2, 1.3), 0.9, caps=False)


def cone_side(scene):
    scene.add_cones((0.3, 0.0, 1.8), (-0.2, 0.2, 0.0), 1.0, caps=False)


def truncated_cone_side(scene):
    scene.add_cones((0.0, 0.0, 0.0), (0.2, -0.3, 1.3), 0.6, 1.1, caps=False)


def cylinder(scene):
    scene.add_cylinders((-0.8, 0.0, 0.3), (0.8, 0.2, 0.9), 0.7)


def cone(scene):
    scene.add_cones((0.0, 0.0, 0.0), (0.3, 0.1, 1.7), 1.1)


def truncated_cone(scene):
    scene.add_cones((0.3, 0.2, 0.0), (-0.2, -0.2, 1.4), 1.1, 0.5)


def solids_in_instances(scene):
    """A stretched and sheared frustum and cylinder: elliptic, with their caps."""
    inner = Scene()
    inner.add_cones((-0.9, 0.0, -0.6), (-0.9, 0.0, 0.7), 0.8, 0.3)
    inner.add_cylinders((0.7, -0.2, -0.7), (0.9, 0.2, 0.6), 0.5)
    scene.instances.append(Instances(inner.shapes, SHEAR))


ALONE = (
    plane,
    triangle,
    smooth_triangles,
    sphere,
    ellipsoid,
    disc,
    cylinder_side,
    cone_side,
    truncated_cone_side,
    cylinder,
    cone,
    truncated_cone,
    solids_in_instances,
)


@pytest.mark.parametrize("build", ALONE, ids=lambda build: build.__name__)
def test_primitive_alone(device, build):
    scene = scene_of(RED)
    build(scene)
    assert_same_picture(device, scene, build.__name__)


@pytest.mark.parametrize("build", ALONE, ids=lambda build: build.__name__)
def test_mirrored_primitive(device, build):
    """The normals again, where errors of a thousandth already show: a mirror over a floor."""
    scene = scene_of(Material.mirror((0.9, 0.8, 0.7)), RED)
    build(scene)
    scene.add_plane((0.0, 0.0, -0.8), (0.0, 0.0, 1.0), material=1)
    assert_same_picture(device, scene, f"mirrored_{build.__name__}")


# Glass, media, cameras, lights.

FLOOR = Material(diffuse=(0.7, 0.7, 0.7))


def stage(*materials, **camera):
    """Material 0 is the floor's; a red and a green ball stand behind, to be seen through things."""
    scene = scene_of(FLOOR, RED, Material(diffuse=(0.1, 0.6, 0.2)), *materials, **camera)
    scene.add_plane((0.0, 0.0, -0.001), (0.0, 0.0, 1.0))
    scene.add_spheres([(-2.2, 1.5, 0.6), (0.2, 2.4, 0.8)], [0.6, 0.8], [1, 2])
    return scene


def cube(center, half):
    """The corners p0, p1, p2 of twelve triangles, outward counter-clockwise."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float) * half + center
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([(a, b, c) for a, b, c, _ in quads] + [(a, c, d) for a, _, c, d in quads])
    return {f"p{i}": corners[faces[:, i]] for i in range(3)}


def glass_sphere(scene):
    scene.add_spheres((0.2, 0.0, 1.0), 0.95, 3)


def glass_cylinder(scene):
    scene.add_cylinders((0.2, 0.0, 0.1), (0.3, 0.2, 1.6), 0.8, 3)


def glass_cone(scene):
    scene.add_cones((0.2, 0.0, 0.1), (0.2, 0.1, 1.9), 1.0, 0.3, 3)


def glass_cube(scene):
    scene.add_triangles(**cube((0.2, 0.0, 0.8), (0.7, 0.5, 0.7)), material=3)


def glass_ellipsoid(scene):
    geometry = Geometry(Spheres(center=(0.0, 0.0, 0.2), radius=1.0))
    scene.instances.append(Instances(geometry, SHEAR, (3,)))


BODIES = (glass_sphere, glass_cylinder, glass_cone, glass_cube, glass_ellipsoid)


@pytest.mark.parametrize("build", BODIES, ids=lambda build: build.__name__)
def test_glass(device, build):
    """Fresnel, refraction, total internal reflection, and the tinted shadow of coloured glass."""
    scene = stage(Material.glass((0.9, 0.7, 0.4)))
    build(scene)
    assert_same_picture(device, scene, build.__name__)


@pytest.mark.parametrize("build", BODIES, ids=lambda build: build.__name__)
def test_absorption(device, build):
    """Beer and Lambert along refracted rays and shadow rays."""
    material = Material(diffuse=0.0, transmit=1.0, fresnel=False, ior=1.3, absorption=(0.1, 0.5, 1.2))
    scene = stage(material)
    build(scene)
    assert_same_picture(device, scene, f"absorbing_{build.__name__}")


def test_nested_media(device):
    """A ball of water in a ball of glass that also holds a bubble: each surface between two media.

    Without Fresnel: for the reflection where a ray leaves a body within a body, POV-Ray 3.7 takes 1 for the relative
    index. Its refraction there is right.
    """
    scene = stage(*(Material(diffuse=0.0, transmit=1.0, fresnel=False, ior=ior) for ior in (1.5, 1.33, 1.0003)))
    scene.add_spheres([(0.2, 0.0, 1.0), (0.5, 0.0, 0.9), (-0.35, 0.0, 1.1)], [0.95, 0.5, 0.25], [3, 4, 5])
    assert_same_picture(device, scene, "nested_media")


def test_constant_shares(device):
    """The paper's colour class without Fresnel: constant shares of mirror and refraction, both at total reflection."""
    scene = stage(Material(diffuse=0.0, reflect=0.2, transmit=0.8, fresnel=False, ior=1.5))
    glass_cylinder(scene)
    assert_same_picture(device, scene, "constant_shares")


def test_coat_and_highlight(device):
    """A diffuse body under a Fresnel coat, a Phong highlight, and a surface that glows."""
    scene = stage(
        Material.plastic((0.1, 0.3, 0.7)),
        Material(diffuse=(0.2, 0.2, 0.2), highlight=0.5, shine=20.0),
        Material(diffuse=(0.2, 0.3, 0.1), glow=(0.2, 0.1, 0.05)),
    )
    scene.add_spheres([(0.0, 0.0, 0.8), (1.4, 0.6, 0.5)], [0.8, 0.5], [3, 4])
    scene.add_cones((-1.1, -0.8, 0.0), (-1.1, -0.8, 0.9), 0.5, material=5)
    assert_same_picture(device, scene, "coat_and_highlight")


def everything():
    """All kinds together, with mirror, glass, coat and absorption, over a floor that mirrors a little."""
    scene = stage(
        Material.mirror((0.9, 0.9, 0.85)),
        Material.glass((0.95, 0.9, 0.8)),
        Material.plastic((0.1, 0.3, 0.7)),
        Material(diffuse=0.0, transmit=1.0, fresnel=False, ior=1.1, absorption=(0.2, 0.6, 1.0)),
        Material(diffuse=(0.7, 0.6, 0.2)),
    )
    scene.materials[0] = Material(diffuse=(0.6, 0.6, 0.6), reflect=0.15, fresnel=False)
    scene.add_spheres([(-0.9, 0.6, 0.7), (0.7, -0.6, 0.6)], [0.7, 0.6], [3, 4])
    scene.add_cylinders(
        [(1.6, 0.4, 0.0), (-1.5, -1.2, 0.3)], [(1.6, 0.4, 1.1), (-0.7, -1.6, 0.5)], 0.3, material=[5, 7]
    )
    scene.add_cylinders((-2.4, 0.0, 0.0), (-2.4, 0.0, 0.7), 0.35, material=7, caps=False)
    scene.add_cones((-0.3, -1.9, 0.0), (-0.3, -1.9, 0.8), 0.4, material=5)
    scene.add_cones((0.6, 1.1, 0.02), (0.6, 1.1, 1.2), 0.4, 0.2, 6)
    scene.add_discs((1.5, -1.9, 0.3), (0.3, -0.3, 1.0), 0.4, 7)
    scene.add_triangles((0.4, 0.3, 1.9), (1.2, 0.9, 1.5), (0.2, 1.3, 1.7), material=5)
    inner = Geometry(Spheres(center=(0.0, 0.0, 0.0), radius=0.5), Triangles(**cube((0.0, 0.0, 0.9), 0.3), material=1))
    scene.instances.append(Instances(inner, SHEAR @ np.diag([0.7, 0.7, 0.7, 1.0]), (5, 7)))
    return scene


def test_everything(device):
    scene = everything()
    scene.lights[0] = Light.point((4.0, -4.0, 6.0), 1800.0, (1.0, 0.95, 0.9))
    assert_same_picture(device, scene, "everything")


def test_everything_in_parallel(device):
    """The same through an orthographic camera."""
    scene = everything()
    scene.camera = Camera.orthographic_at((3.0, -5.0, 3.2), (0.0, 0.0, 0.5), 4.2, aspect=SIZE[0] / SIZE[1])
    assert_same_picture(device, scene, "everything_in_parallel")


@pytest.mark.parametrize("seed", [1, 2])
def test_crowd(device, seed):
    """120 shapes of all kinds at random, so that the tree is deep: they cross each other, hence none is transparent."""
    random = np.random.default_rng(seed)
    scene = scene_of(
        FLOOR, RED, Material.mirror((0.9, 0.9, 0.9)), Material.plastic((0.1, 0.3, 0.7)), target=(0, 0, 0.4)
    )
    scene.add_plane((0.0, 0.0, -0.9), (0.1, 0.0, 1.0))

    def row(count=20):
        low, high = (-1.6, -1.6, -0.6), (1.6, 1.6, 1.5)
        return random.uniform(low, high, (count, 3)), random.uniform(0.05, 0.3, count), random.integers(0, 4, count)

    center, radius, material = row()
    scene.add_spheres(center, radius, material)
    center, radius, material = row()
    scene.add_discs(center, random.normal(size=(20, 3)), radius, material)
    center, radius, material = row()
    scene.add_cylinders(center, center + random.normal(0.0, 0.4, (20, 3)), radius / 2.0, material)
    center, radius, material = row()
    scene.add_cones(center, center + random.normal(0.0, 0.4, (20, 3)), radius, random.uniform(0.0, 0.2, 20), material)
    center, radius, material = row(40)
    scene.add_triangles(center, *(center + random.normal(0.0, 0.3, (2, 40, 3))), material)
    assert_same_picture(device, scene, f"crowd_{seed}")


def test_shifted_camera(device):
    """A window that is not centred on the view."""
    scene = everything()
    left, right, bottom, top = scene.camera.window
    scene.camera = replace(scene.camera, window=(left + 0.1, right + 0.1, bottom - 0.05, top - 0.05))
    assert_same_picture(device, scene, "shifted_camera")


def test_povray_missing_is_an_error(monkeypatch):
    """Nothing is skipped silently."""
    monkeypatch.setenv("PATH", "")
    with pytest.raises(FileNotFoundError, match="apt-get install povray"):
        povray.render(scene_of(RED), *SIZE, SETTINGS)


def test_what_povray_cannot_say_is_refused():
    scene = stage(Material.glass(absorption=(1.0, 0.0, 0.0)))
    with pytest.raises(povray.NotInPovrayError, match="absorb"):
        povray.scene_text(scene, SETTINGS)
