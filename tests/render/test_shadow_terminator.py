"""Smooth meshes of few faces: lit as the surface that they stand for, while what is in the light casts its shadow."""

import numpy as np
import pytest

from addon.engine import Camera, Geometry, Instances, Light, Material, Scene, Settings, Triangles, World, render

SUNS = [(1.0, -0.2, 0.5), (1.0, 0.3, 0.2), (0.2, -1.0, 1.0), (-0.9, -0.5, 0.1), (0.1, -0.1, 1.0)]
SIZE = 96
HEIGHT = 2.4


def smooth_sphere(segments=8, rings=6):
    """The mesh of a unit sphere with its exact normals at the vertices."""
    theta, phi = np.linspace(0.0, np.pi, rings + 1)[:, None], np.arange(segments + 1) * 2.0 * np.pi / segments
    grid = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta) + 0.0 * phi], axis=-1)
    a, b, c, d = (
        grid[rows, columns]
        for rows in (slice(None, -1), slice(1, None))
        for columns in (slice(None, -1), slice(1, None))
    )
    p = [np.concatenate([x[:-1].reshape(-1, 3), y[1:].reshape(-1, 3)]) for x, y in ((a, a), (c, d), (d, b))]
    return Triangles(**{f"p{i}": p[i] for i in range(3)}, **{f"n{i}": p[i] for i in range(3)})


def scene_of(mesh, *lights, matrix=None):
    """The mesh white under lights, from -Y."""
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material(diffuse=1.0)], lights=list(lights))
    scene.camera = Camera.orthographic_at((0.0, -9.0, 0.0), (0.0, 0.0, 0.0), HEIGHT)
    if matrix is None:
        scene.add(mesh)
    else:
        scene.instances.append(Instances(Geometry(mesh), matrix))
    return scene


def seen(mesh):
    """Of the pixels of the picture, in float64: which see the mesh (h, w), and the interpolated normals there."""
    z, x = (np.mgrid[:SIZE, :SIZE] + 0.5) / SIZE * HEIGHT - HEIGHT / 2.0
    depth, normals = np.full((SIZE, SIZE), np.inf), np.zeros((SIZE, SIZE, 3))
    for row in range(len(mesh)):
        p, n = (np.array([getattr(mesh, f"{name}{i}")[row] for i in range(3)]) for name in "pn")
        edges = p[1:, [0, 2]] - p[0, [0, 2]]
        if abs(np.linalg.det(edges)) < 1e-9:
            continue
        uv = np.stack([x - p[0, 0], z - p[0, 2]], axis=-1) @ np.linalg.inv(edges)
        weights = np.concatenate([1.0 - uv.sum(axis=-1, keepdims=True), uv], axis=-1)
        y = weights @ p[:, 1]
        nearer = (weights >= 0.0).all(axis=-1) & (y < depth)
        depth[nearer], normals[nearer] = y[nearer], (weights @ n)[nearer]
    covered = np.isfinite(depth)
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    return covered, normals / np.where(length > 0.0, length, 1.0)


@pytest.mark.parametrize("sun", SUNS)
@pytest.mark.parametrize("segments, rings", [(8, 6), (5, 4), (24, 16)])
def test_a_coarse_sphere_is_lit_as_its_normals_say(device, sun, segments, rings):
    mesh = smooth_sphere(segments, rings)
    light = np.array(sun) / np.linalg.norm(sun)
    picture = render(scene_of(mesh, Light.sun(sun, np.pi)), SIZE, SIZE, Settings(), device=device).pixels[..., 0]
    covered, normals = seen(mesh)
    expected = np.maximum(normals @ light, 0.0)
    lit = covered & (expected > 1e-3)
    assert lit.sum() > 500
    wrong = np.abs(picture - expected)[lit] > 1e-3
    assert wrong.mean() < 2e-3, f"{wrong.sum()} of {lit.sum()} pixels; their faces' edges may take some"
    assert (picture[covered & (normals @ light < -1e-6)] == 0.0).all(), "no light on the far side"


def test_point_light_and_instance(device):
    """The same under a stretched, mirrored instance, lit from near: no pixel that faces the light is dark."""
    matrix = np.array([[-1.0, 0.2, 0.0, 0.1], [0.0, 0.8, 0.1, 0.0], [0.1, 0.0, 0.9, 0.0], [0.0, 0.0, 0.0, 1.0]])
    position = np.array((2.0, -1.5, 1.5))
    scene = scene_of(smooth_sphere(), Light.constant(position, shadow=True), matrix=matrix)
    shadowed = render(scene, SIZE, SIZE, device=device).pixels[..., 0]
    scene.lights = [Light.constant(position, shadow=False)]
    everywhere = render(scene, SIZE, SIZE, device=device).pixels[..., 0]
    facing = everywhere > 2e-2
    assert facing.sum() > 1000
    assert (shadowed[facing] == 0.0).mean() < 2e-3


def test_shadows_of_others_stay(device):
    """A ball close to the mesh casts the shadow that it would cast on the flat faces: only where those look away from
    the light may a little of it be lost."""
    sun = (0.4, -1.0, 0.8)
    light = np.array(sun) / np.linalg.norm(sun)
    scene = scene_of(smooth_sphere(), Light.sun(sun, np.pi))
    alone = render(scene, SIZE, SIZE, device=device).pixels[..., 0]
    scene.add_spheres(1.7 * light, 0.25)
    shadowed = render(scene, SIZE, SIZE, device=device).pixels[..., 0]
    z, x = (np.mgrid[:SIZE, :SIZE] + 0.5) / SIZE * HEIGHT - HEIGHT / 2.0
    # Where a ray from the camera meets the unit ball; the mesh lies up to 0.13 within it.
    point = np.stack([x, -np.sqrt(np.maximum(1.0 - x**2 - z**2, 0.0)), z], axis=-1)
    offset = point - (point @ light)[..., None] * light
    under = np.linalg.norm(offset, axis=-1) < 0.1
    assert under.sum() > 20
    assert (shadowed[under] == 0.0).all() and (alone[under] > 0.5).all()


@pytest.mark.parametrize("thickness", [1e-3, 1e-1])
def test_no_light_leaks_through_a_thin_body(device, thickness):
    """A plate whose normals are smooth over its edges: light from behind does not come through its front."""
    mesh = thin_plate(thickness)
    scene = scene_of(mesh, Light.sun((0.3, 1.0, 0.2), np.pi))
    dark = render(scene, SIZE, SIZE, device=device).pixels[..., 0]
    x, z = (np.mgrid[:SIZE, :SIZE][::-1] + 0.5) / SIZE * HEIGHT - HEIGHT / 2.0
    within = np.maximum(np.abs(x), np.abs(z)) < 0.5
    assert (dark[within] == 0.0).all()
    # Nor does the sun on the other side light the plate's back through a second sheet right before it.
    scene = scene_of(mesh, Light.sun((0.0, -1.0, 0.0), np.pi))
    scene.add_discs((0.0, -thickness, 0.0), (0.0, -1.0, 0.0), 3.0, scene.add_material(Material(diffuse=0.0)))
    scene.camera = Camera.orthographic_at((0.0, -0.75 * thickness, 0.0), (0.0, 0.0, 0.0), HEIGHT)
    assert (render(scene, SIZE, SIZE, device=device).pixels[..., 0][within] == 0.0).all()


def thin_plate(thickness):
    """A closed box of +-0.8 across and a thickness along Y, its normals those of a cube shaded smooth."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    quads = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
    faces = corners[np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])]
    points, normals = faces * (0.8, thickness / 2.0, 0.8), faces / np.sqrt(3.0)
    return Triangles(**{f"p{i}": points[:, i] for i in range(3)}, **{f"n{i}": normals[:, i] for i in range(3)})
