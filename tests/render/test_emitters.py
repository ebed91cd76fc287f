"""Surfaces that glow light what is around them: irradiance against closed forms, no shadow of their own, no double
counting."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine import Camera, Light, Material, Scene, Settings, World, render
from addon.engine.expression import as_type, call, component
from addon.engine.primitives import Cones, Cylinders, Discs, Spheres, Triangles
from addon.engine.scene import Geometry, Instances, Visibility

GLOW = np.array([1.0, 2.0, 3.0])


def floor_under(*primitives, matrix=None, **glowing):
    """A white floor seen from close by at the origin, under things of a material that glows (number 1)."""
    shining = Material(**{"diffuse": 0.0, "glow": GLOW} | glowing)
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material(diffuse=1.0), shining])
    scene.camera = Camera.orthographic_at((0, 0, 1e-2), (0, 0, 0), 1e-3, up=(0, 1, 0))
    scene.add_plane((0, 0, 0), (0, 0, 1))
    for part in primitives if matrix is None else ():
        scene.add(part)
    if matrix is not None:
        scene.instances.append(Instances(Geometry(*primitives), matrix, (0, 1)))
    return scene


def lit(device, scene, samples=256):
    """What the floor returns of the light, (3,)."""
    return render(scene, 16, 16, Settings(samples=samples), device=device).pixels[..., :3].mean(axis=(0, 1))


def standing(linear=1.0, height=2.0):
    matrix = np.eye(4)
    matrix[:3, :3] *= linear
    matrix[2, 3] = height
    return matrix


@pytest.mark.parametrize("instanced", [False, True])
def test_balls(device, instanced):
    """As seen from the floor: (R / d)^2."""
    ball = Spheres(center=(0, 0, 0.0 if instanced else 2.0), radius=0.5, material=1)
    found = lit(device, floor_under(ball, matrix=standing() if instanced else None), 16)
    assert found == pytest.approx(GLOW * 0.25**2, rel=1e-3)


@pytest.mark.parametrize("facing", [1.0, -1.0])
def test_discs(device, facing):
    """Below the middle: R^2 / (R^2 + h^2), from both sides."""
    disc = Discs(center=(0, 0, 2), normal=(0, 0, facing), radius=0.5, material=1)
    assert lit(device, floor_under(disc), 64) == pytest.approx(GLOW * 0.25 / 4.25, rel=1e-3)
    for emission, shines in (("FRONT", facing < 0.0), ("BACK", facing > 0.0), ("NONE", False)):
        found = lit(device, floor_under(disc, emission=emission), 64)
        assert found == pytest.approx(GLOW * 0.25 / 4.25 * shines, rel=1e-3)


def summed(points, areas):
    """Irradiance over pi at the origin of surface elements: points (n, 3), normals times areas (n, 3)."""
    square = (points**2).sum(axis=1)
    cosines = np.abs((points * areas).sum(axis=1)) * np.maximum(points[:, 2], 0.0)
    return (cosines / square**2).sum() / np.pi


def grid(count=400):
    middle = (np.arange(count) + 0.5) / count
    return (axis.ravel() for axis in np.meshgrid(middle, middle))


def triangle_sum(corners):
    u, v = grid()
    turned = u + v > 1.0
    u, v = np.where(turned, 1.0 - u, u), np.where(turned, 1.0 - v, v)
    first, second = corners[1] - corners[0], corners[2] - corners[0]
    points = corners[0] + u[:, None] * first + v[:, None] * second
    return summed(points, np.tile(np.cross(first, second) / 2.0 / len(u), (len(u), 1)))


def test_triangles(device):
    corners = np.array([(-1.0, -1.0, 2.0), (2.0, -1.0, 2.0), (0.0, 1.5, 2.5)])
    triangle = Triangles(**dict(zip(("p0", "p1", "p2"), corners, strict=True)), material=1)
    assert lit(device, floor_under(triangle)) == pytest.approx(GLOW * triangle_sum(corners), rel=2e-3)


def outside(points, areas):
    """The elements of a convex surface, with outward areas, that the origin sees."""
    seen = (points * areas).sum(axis=1) < 0.0
    return summed(points[seen], areas[seen])


@pytest.mark.parametrize("radii", [(0.5, 0.5), (0.2, 0.6), (0.6, 0.0)])
@pytest.mark.parametrize("linear", [1.0, ((1.0, 0.2, 0.0), (0.0, 0.6, 0.0), (0.1, 0.0, 1.3))])
def test_sides_of_cylinders_and_cones(device, radii, linear):
    """Lying along x, stretched too."""
    r0, r1 = radii
    ends = {"base": (-1, 0, 0), "apex": (1, 0, 0), "material": 1}
    tube = Cylinders(radius=r0, **ends) if r0 == r1 else Cones(base_radius=r0, apex_radius=r1, **ends)
    matrix = standing(linear)
    along, around = grid(800)
    angle, radius = 2.0 * np.pi * around, r0 + (r1 - r0) * along
    outward = np.stack([0.0 * angle, np.cos(angle), np.sin(angle)], axis=1)
    points = np.stack([2.0 * along - 1.0, *(radius * outward[:, 1:].T)], axis=1) @ matrix[:3, :3].T + matrix[:3, 3]
    areas = (2.0 * outward - (r1 - r0) * np.array([1.0, 0.0, 0.0])) * (2.0 * np.pi * radius / len(angle))[:, None]
    areas = areas @ (np.linalg.det(matrix[:3, :3]) * np.linalg.inv(matrix[:3, :3]))
    expected = GLOW * outside(points, areas)
    assert lit(device, floor_under(tube, matrix=matrix), 1024) == pytest.approx(expected, rel=5e-3)


@pytest.mark.parametrize("mirrored", [False, True])
def test_ellipsoids(device, mirrored):
    matrix = standing(((1.5, 0.3, 0.0), (0.0, 0.5, 0.2), (0.1, 0.0, 0.8)), 2.5)
    matrix[:3, 0] *= -1.0 if mirrored else 1.0
    height, around = grid()
    z, angle = 1.0 - 2.0 * height, 2.0 * np.pi * around
    normals = np.stack([np.sqrt(1.0 - z * z) * np.cos(angle), np.sqrt(1.0 - z * z) * np.sin(angle), z], axis=1)
    cofactors = np.abs(np.linalg.det(matrix[:3, :3])) * np.linalg.inv(matrix[:3, :3])
    points = normals @ matrix[:3, :3].T + matrix[:3, 3]
    expected = GLOW * outside(points, normals @ cofactors * (4.0 * np.pi / len(z)))
    ball = Spheres(center=(0, 0, 0), radius=1.0, material=1)
    assert lit(device, floor_under(ball, matrix=matrix)) == pytest.approx(expected, rel=3e-3)


def test_all_around(device):
    """Within a ball that glows a white surface returns its radiance."""
    assert lit(device, floor_under(Spheres(center=(0, 0, 0), radius=5, material=1))) == pytest.approx(GLOW, rel=1e-2)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_scale_and_distance_from_the_origin_do_not_matter(device, scale):
    """What glows does not shade itself, however its place rounds."""
    scene = floor_under(Spheres(center=(0, 0, 2.0 * scale), radius=0.5 * scale, material=1))
    scene.camera = Camera.orthographic_at((0, 0, 1e-2 * scale), (0, 0, 0), 1e-3 * scale, up=(0, 1, 0))
    assert lit(device, scene, 16) == pytest.approx(GLOW * 0.25**2, rel=1e-3)


def test_glow_that_varies_is_seen_where_the_ray_ends(device):
    """A disc whose glow is its u, which grows from 0 to 1 over it: half the light, and what is in the way counts."""
    disc = Discs(center=(0, 0, 2), normal=(0, 0, 1), radius=0.5, material=1)
    scene = floor_under(disc, glow=as_type(component(call("point_uv"), 0), "vec3"))
    assert lit(device, scene) == pytest.approx(0.5 * 0.25 / 4.25, rel=2e-3)
    scene.add(Discs(center=(0, 0, 1), normal=(0, 0, 1), radius=0.5))
    assert (lit(device, scene) == 0.0).all()


def test_what_stands_before_it_shades(device):
    scene = floor_under(Discs(center=(0, 0, 2), normal=(0, 0, 1), radius=0.5, material=1))
    scene.add(Discs(center=(0, 0, 1), normal=(0, 0, 1), radius=0.5))
    assert (lit(device, scene) == 0.0).all()


def test_a_rough_mirror_sees_it_once(device):
    """Within what glows it returns all of the radiance: the rays that meet it bring it, it is no lamp to a mirror."""
    scene = floor_under(Spheres(center=(0, 0, 0), radius=50, material=1))
    scene.materials[0] = replace(Material.mirror(roughness=0.5), multiscatter=True)
    assert lit(device, scene) == pytest.approx(GLOW, rel=0.06)


def test_one_sample_has_no_light_of_what_glows(device):
    """Nor noise."""
    scene = floor_under(Discs(center=(0, 0, 2), normal=(0, 0, 1), radius=0.5, material=1))
    scene.add_light(Light.point((0, 0, 1), np.pi**2 * 4.0, shadow=False))
    pixels = render(scene, 8, 8, Settings(), device=device).pixels[..., :3]
    assert pixels == pytest.approx(np.ones_like(pixels), rel=1e-4)


def test_what_is_invisible_to_diffuse_rays_lights_nothing(device):
    scene = floor_under(Spheres(center=(0, 0, 0), radius=0.5, material=1), matrix=standing())
    scene.instances[0] = replace(scene.instances[0], visibility=Visibility.ALL & ~Visibility.DIFFUSE)
    assert (lit(device, scene, 4) == 0.0).all()
