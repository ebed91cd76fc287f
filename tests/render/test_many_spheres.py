"""Glass, absorbing and textured spheres among a hundred thousand in one geometry: as if they stood alone."""

import numpy as np
import pytest

from addon.engine import Camera, Geometry, Image, Instances, Light, Material, Scene, Settings, Spheres, World, render
from addon.engine.material import surface_image

SETTINGS = Settings(max_depth=12, weight_cutoff=0.0, shadows="TINTED")
SIZE = (96, 72)
COUNT = 100_000
ROOM = 6.0


def empty_room():
    """A camera in a room of dim walls (a sphere seen from within, which nothing outside shines into) and a lamp."""
    scene = Scene(world=World((9.0, 0.0, 9.0)))
    scene.camera = Camera.look_at((0.0, -4.5, 0.6), (0.0, 0.0, 0.0), angle=36.0, aspect=4.0 / 3.0)
    v, u = np.mgrid[:32, :64]
    checks = (u // 4 + v // 4) % 2
    scene.add_image(Image(np.stack([checks, u / 64.0, v / 32.0], axis=-1), interpolation="CLOSEST"))
    textured = dict(diffuse=surface_image(0))
    scene.materials = [
        Material(diffuse=(0.6, 0.5, 0.4), glow=0.2),
        Material.glass(),
        Material.glass((0.9, 1.0, 0.95), ior=1.33, absorption=(0.3, 1.0, 2.0)),
        Material(**textured),
        Material(**textured, reflect=1.0),
        Material(diffuse=0.0, glow=50.0),
    ]
    scene.add_light(Light.point((2.0, -3.0, 4.0), 900.0))
    return scene


def special(rng):
    """The room's wall and seven spheres that are seen in it, some of them turned, one within another."""
    center = [
        (0, 0, 0),
        (-1.3, 0.2, 0.3),
        (-1.3, 0.2, 0.3),
        (1.2, 0.4, -0.2),
        (0.4, -1.2, -0.6),
        (-0.5, 1.4, 1.0),
        (0.7, 0.9, 1.0),
        (0, -0.2, 0),
    ]
    radius = [-ROOM, 0.6, 0.25, 0.55, 0.3, 0.5, 0.35, 0.5]
    material = [0, 2, 1, 3, 1, 4, 3, 1]
    return Spheres(
        center=np.array(center, float),
        radius=radius,
        material=material,
        pole=rng.normal(size=(8, 3)),
        meridian=rng.normal(size=(8, 3)),
    )


def crowd(rng, among):
    """`among` at random places of COUNT spheres that stand outside the room and glow."""
    n = COUNT - len(among)
    direction = rng.normal(size=(n, 3))
    away = direction / np.linalg.norm(direction, axis=-1, keepdims=True) * rng.uniform(ROOM + 0.5, 40.0, (n, 1))
    others = Spheres(center=away, radius=rng.uniform(0.01, 0.4, n), material=rng.choice([5, 1, 2, 3], n))
    return Spheres.concatenate([others, among]).take(rng.permutation(COUNT))


@pytest.mark.parametrize("instanced", [False, True], ids=["in world space", "instanced"])
def test_special_spheres_in_a_crowd(device, instanced):
    rng = np.random.default_rng(4)
    shown = special(rng)
    pictures = []
    for part in (shown, crowd(rng, shown)):
        scene = empty_room()
        if instanced:
            turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
            matrix = np.eye(4)
            matrix[:3, :3] = turn
            moved = part._with({name: getattr(part, name) @ turn for name in ("center", "pole", "meridian")})
            scene.instances.append(Instances(Geometry(moved), matrix, None))
        else:
            scene.add(part)
        pictures.append(render(scene, *SIZE, SETTINGS, device=device).pixels[..., :3])
    alone, among = pictures
    assert alone.max() < 9.0, "nothing outside the room is seen"
    assert np.ptp(alone, axis=(0, 1)).min() > 0.3 and len(np.unique(alone.round(3))) > 500
    # Another program, since many more things glow: it rounds otherwise, which the edges of the checks can show.
    assert (np.abs(among - alone).max(axis=-1) > 1e-5).sum() <= 3


def test_the_crowd_alone_is_another_picture(device):
    """Without the room's wall the crowd is seen: the test above could fail."""
    rng = np.random.default_rng(4)
    shown = special(rng)
    scene = empty_room()
    scene.add(crowd(rng, shown.take(np.arange(1, 8))))
    pixels = render(scene, *SIZE, SETTINGS, device=device).pixels
    assert (pixels[..., :3].max(axis=-1) > 40.0).mean() > 0.05
