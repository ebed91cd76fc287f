"""The same scene small, large and far away gives the same picture."""

import numpy as np
import pytest

from addon.engine.primitives import Spheres, Triangles
from addon.engine.scene import Camera, Geometry, Instances, Light, Material, Scene, World
from addon.engine.session import render
from addon.engine.settings import Settings

SIZE = 96


def everything(scale=1.0, offset=(0.0, 0.0, 0.0)):
    """All kinds of shapes, a mirror, glass, an ellipsoid and a mesh on a plane, 4 `scale` across at `offset`."""
    at = np.asarray(offset, np.float64)

    def place(*point):
        return [at + scale * np.array(point)]

    scene = Scene(
        camera=Camera.look_at(place(1.0, -6.0, 2.5)[0], place(0, 0, 0.4)[0], angle=40.0),
        world=World((0.2, 0.3, 0.5)),
        materials=[
            Material(diffuse=(0.8, 0.3, 0.2)),
            Material.mirror((0.9, 0.9, 0.9)),
            Material.glass(absorption=np.array([0.5, 0.1, 0.3]) / scale),
            Material.plastic((0.2, 0.6, 0.3)),
        ],
        lights=[Light.point(place(2.0, -3.0, 4.0)[0], 400.0 * scale**2), Light.sun((-0.5, -0.3, 1.0), 1.0)],
    )
    scene.add_spheres(place(-1.2, 0.3, 0.6), 0.6 * scale, 1)
    scene.add_spheres(place(0.0, -1.2, 0.5), 0.5 * scale, 2)
    scene.add_cylinders(place(1.3, 0.4, 0.0), place(1.3, 0.4, 1.2), 0.4 * scale, 3)
    scene.add_cones(place(0.1, 0.9, 0.0), place(0.1, 0.9, 1.6), 0.5 * scale, 0.1 * scale, 0)
    scene.add_plane(place(0, 0, 0), [[0, 0, 1.0]], 0, tile=scale)
    matrix = np.diag([0.3 * scale, 0.5 * scale, 0.2 * scale, 1.0])
    matrix[:3, 3] = place(1.0, -1.0, 0.2)[0]
    scene.instances.append(Instances(Geometry(Spheres(center=[[0, 0, 0]], radius=[1.0])), matrix, (3,), "ellipsoid"))
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    mesh = Geometry(Triangles(**{f"p{i}": corners[faces[:, i]] for i in range(3)}))
    matrix = np.diag([0.7 * scale] * 3 + [1.0])
    matrix[:3, 3] = place(-0.9, -1.6, 0.0)[0]
    scene.instances.append(Instances(mesh, matrix, (0,), "mesh"))
    return scene


@pytest.fixture(scope="module")
def at_home(device):
    return picture(device)


def picture(device, *where):
    return render(everything(*where), SIZE, SIZE, Settings(max_depth=6), device=device).pixels


def assert_same_picture(found, expected):
    """Everywhere but where an edge falls to the other side of a pixel's centre."""
    assert np.isfinite(found).all()
    difference = np.abs(found - expected).max(axis=-1)
    assert (difference > 1e-3 * (1.0 + np.abs(expected).max(axis=-1))).mean() < 0.01, (difference > 1e-3).mean()
    assert np.median(difference) < 1e-5


def test_the_picture_shows_something(at_home):
    assert np.ptp(at_home[..., :3]) > 0.5 and len(np.unique(at_home[..., 0])) > SIZE * SIZE / 4


@pytest.mark.parametrize("scale", [1e-4, 1e-2, 1e2, 1e5])
def test_every_scale(device, at_home, scale):
    assert_same_picture(picture(device, scale), at_home)


@pytest.mark.parametrize("away", [1e4, 1e6, 1e8])
def test_far_away(device, at_home, away):
    assert_same_picture(picture(device, 1.0, (away, -away, away / 2.0)), at_home)
