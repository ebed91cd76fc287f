"""Round outlines stay round however near they are looked at: the window is a 10,000th of the body's width."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine import Camera, Geometry, Instances, Material, Scene, Settings, Spheres, World, render

SIZE = 128
ZOOM = 1e-4
#: Of the eye from the middle of the body, in its widths as they are seen.
DISTANCE = 3.0


def matrix_of(linear, place):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, place
    return matrix


def turned(rng):
    return np.linalg.qr(rng.normal(size=(3, 3)))[0]


STRETCH = np.array([[0.9, 0.3, 0.0], [-0.2, 0.5, 0.1], [0.1, 0.0, 0.4]])
BODIES = {
    "sphere": np.eye(4),
    "sphere off the origin": matrix_of(2.0 * np.eye(3), (3.0, 4.0, 5.0)),
    "sphere far from the origin": matrix_of(np.eye(3), (5e3, -3e3, 2e3)),
    "ellipsoid": matrix_of(STRETCH, (0.0, 0.0, 0.0)),
    "ellipsoid off the origin": matrix_of(STRETCH, (3.0, 4.0, 5.0)),
    "ellipsoid far from the origin": matrix_of(STRETCH, (5e3, -3e3, 2e3)),
}
#: How far from the outline a pixel may be that is on the wrong side of it.
MOST_PIXELS = 0.5


def discriminant(matrix, eye, direction):
    """In float64, of rays (..., 3) with the unit sphere under a matrix: positive where they meet it."""
    inverse = np.linalg.inv(matrix)
    o, d = inverse[:3, :3] @ eye + inverse[:3, 3], direction @ inverse[:3, :3].T
    return (d @ o) ** 2 / np.sum(d * d, axis=-1) - (o @ o - 1.0)


def angle_of_edge(matrix, eye, towards, across):
    """How far from the direction `towards` to `across` the outline is seen."""
    inside, outside = 0.0, 0.5 * np.pi
    for _ in range(100):
        angle = (inside + outside) / 2.0
        hit = discriminant(matrix, eye, np.cos(angle) * towards + np.sin(angle) * across) > 0.0
        inside, outside = (angle, outside) if hit else (inside, angle)
    return inside


def view_of_edge(rng, matrix, shifted):
    """Eye (3,) and a camera there whose window is a small part of the outline; `shifted`: by the lens."""
    towards, across = turned(rng)[:2]
    width = 2.0 * np.linalg.norm(across @ matrix[:3, :3])  # of its parallel projection
    eye = matrix[:3, 3] - DISTANCE * width * towards
    angle = angle_of_edge(matrix, eye, towards, across)
    at_edge = np.cos(angle) * towards + np.sin(angle) * across
    half = ZOOM * np.tan(angle)
    camera = Camera.look_at(eye, eye + (towards if shifted else at_edge), up=rng.normal(size=3))
    x, y, z = camera.matrix[:3, :3].T @ at_edge
    return eye, replace(camera, window=(-x / z - half, -x / z + half, -y / z - half, -y / z + half))


def scene_of(name, camera):
    scene = Scene(camera=camera, world=World((0.0, 0.0, 0.0)), materials=[Material(diffuse=0.0, glow=1.0)])
    matrix = BODIES[name]
    if "sphere" in name:
        scene.add_spheres(matrix[:3, 3], matrix[0, 0])
    else:
        scene.instances.append(Instances(Geometry(Spheres(center=(0.0, 0.0, 0.0), radius=1.0)), matrix))
    return scene


@pytest.mark.parametrize("shifted", [False, True], ids=["turned", "shifted"])
@pytest.mark.parametrize("name", BODIES)
def test_outline_at_ten_thousand_times(device, name, shifted):
    """No pixel's centre is on the wrong side of the exact outline by half a pixel."""
    rng = np.random.default_rng(5)
    for _ in range(4):
        eye, camera = view_of_edge(rng, BODIES[name], shifted)
        picture = render(scene_of(name, camera), SIZE, SIZE, Settings(), device=device).pixels[..., 0] > 0.5
        left, right, bottom, top = camera.window
        share = (np.arange(SIZE) + 0.5) / SIZE
        x, y = np.meshgrid(left + share * (right - left), bottom + share * (top - bottom))
        exact = discriminant(BODIES[name], eye, np.stack([x, y, -np.ones_like(x)], axis=-1) @ camera.matrix[:3, :3].T)
        assert 0.3 < (exact > 0.0).mean() < 0.7
        pixels = np.abs(exact) / np.hypot(*np.gradient(exact))  # of each centre from the outline
        wrong = picture != (exact > 0.0)
        assert pixels[wrong].max(initial=0.0) < MOST_PIXELS
