"""The shadow catcher: for the camera only the shadows that others cast on it are there."""

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
    Triangles,
    Visibility,
    World,
    render,
)
from addon.engine.settings import SHADOWS

CATCHER = Visibility.ALL | Visibility.SHADOW_CATCHER
SKY = np.array((0.2, 0.4, 0.8))
DOWN, UP = (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)
SUN = Light.sun(UP, np.pi)
SLANTED = Light.sun((0.6, 0.0, 0.8), 0.5 * np.pi)


def square(size, height=0.0, material=0):
    """Two triangles at a height, facing up."""
    corners = np.array([(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0)]) * size
    corners[:, 2] = height
    return Triangles(p0=corners[[0, 0]], p1=corners[[1, 2]], p2=corners[[2, 3]], material=material)


def scene_with(floor, *lights, ball=True):
    """A floor that is a catcher, as an infinite plane or as an instance, and a ball over its middle."""
    scene = Scene(
        world=World(tuple(SKY)), materials=[Material(diffuse=(0.8, 0.5, 0.2)), Material(diffuse=0.0, glow=3.0)]
    )
    if floor == "plane":
        scene.add_plane((0.0, 0.0, 0.0), UP, 0, visibility=int(CATCHER))
    else:
        scene.instances.append(Instances(Geometry(square(20.0)), np.eye(4), (0,), visibility=CATCHER))
    if ball:
        scene.add_spheres((0.0, 0.0, 2.0), 1.0, 1)
    scene.lights += lights
    return scene


def pixel(device, scene, origin, direction=DOWN, **settings):
    scene.camera = Camera.orthographic_at(origin, np.add(origin, direction), 1e-3, up=(0.0, 1.0, 0.0))
    settings = Settings(**{"max_depth": 8, "weight_cutoff": 0.0, "film_transparent": True} | settings)
    return render(scene, 1, 1, settings, device=device).pixels[0, 0].astype(np.float64)


each_floor = pytest.mark.parametrize("floor", ["plane", "instance"])
IN_SHADOW, BESIDE = (0.0, 0.0, 0.5), (3.0, 0.0, 0.5)


@each_floor
@pytest.mark.parametrize("shadows", SHADOWS)
def test_shadow_over_either_film(device, floor, shadows):
    """Nothing but alpha over a transparent film; over an opaque one the sky behind, darkened."""
    settings = dict(shadows=shadows)
    scene = scene_with(floor, SUN)
    assert pixel(device, scene, IN_SHADOW, **settings) == pytest.approx([0.0, 0.0, 0.0, 1.0])
    assert pixel(device, scene, BESIDE, **settings) == pytest.approx([0.0] * 4)
    opaque = settings | {"film_transparent": False}
    assert pixel(device, scene, IN_SHADOW, **opaque) == pytest.approx([0.0, 0.0, 0.0, 1.0])
    assert pixel(device, scene, BESIDE, **opaque) == pytest.approx([*SKY, 1.0])


@each_floor
def test_half_shadow_of_two_lights(device, floor):
    """Overhead 1, slanted 0.5 * 0.8: where the ball hides the first, 0.4 / 1.4 of the light is left."""
    scene = scene_with(floor, SUN, SLANTED)
    left = 0.4 / 1.4
    assert pixel(device, scene, IN_SHADOW) == pytest.approx([0.0, 0.0, 0.0, 1.0 - left])
    assert pixel(device, scene, IN_SHADOW, film_transparent=False) == pytest.approx([*(left * SKY), 1.0])


@each_floor
def test_coloured_light(device, floor):
    """The mean of what is left of each channel; a channel without light is left as it is."""
    scene = scene_with(
        floor, Light.sun(UP, np.pi, (1.0, 0.0, 1.0)), Light.sun((0.6, 0.0, 0.8), 0.5 * np.pi, (0.0, 0.0, 1.0))
    )
    assert pixel(device, scene, IN_SHADOW)[3] == pytest.approx(1.0 - (0.0 + 1.0 + 0.4 / 1.4) / 3.0)


@each_floor
def test_lights_without_shadow_and_no_light(device, floor):
    """A light without shadow counts in both; where no light falls at all nothing is darkened."""
    filling = Light.sun((0.6, 0.0, 0.8), 0.5 * np.pi, shadow=False)
    assert pixel(device, scene_with(floor, SUN, filling), IN_SHADOW)[3] == pytest.approx(1.0 - 0.4 / 1.4)
    assert pixel(device, scene_with(floor, filling), IN_SHADOW) == pytest.approx([0.0] * 4)
    assert pixel(device, scene_with(floor), IN_SHADOW) == pytest.approx([0.0] * 4)
    assert pixel(device, scene_with(floor, Light.sun(DOWN, 1.0)), IN_SHADOW) == pytest.approx([0.0] * 4)


@each_floor
def test_catchers_cast_no_shadow_on_catchers(device, floor):
    """Theirs are in the footage already: only where another thing adds to them is it darker."""
    scene = scene_with(floor, SUN, SLANTED, ball=False)
    roof = Instances(Geometry(square(1.0, 2.0)), np.eye(4), (0,), visibility=CATCHER)
    scene.instances.append(roof)
    assert pixel(device, scene, IN_SHADOW) == pytest.approx([0.0] * 4)
    scene.add_spheres(np.array((0.6, 0.0, 0.8)), 0.2, 1)  # in the slanted light, from the point under the roof
    assert pixel(device, scene, (0.0, 0.0, 0.5)) == pytest.approx([0.0, 0.0, 0.0, 1.0])
    scene.instances[-1] = Instances(roof.geometry, np.eye(4), (0,))  # as a thing like others
    assert pixel(device, scene, (0.5, 0.0, 0.5))[3] == pytest.approx(1.0 / 1.4)


@each_floor
def test_the_catcher_hides_what_is_behind_it(device, floor):
    """As the ground in the footage does."""
    scene = scene_with(floor, SUN)
    scene.add_spheres((3.0, 0.0, -2.0), 1.0, 1)
    assert pixel(device, scene, BESIDE) == pytest.approx([0.0] * 4)
    assert pixel(device, scene, (0.0, 0.0, 5.0)) == pytest.approx([3.0, 3.0, 3.0, 1.0])  # and nothing before it


@each_floor
def test_other_rays_see_the_surface(device, floor):
    """A mirror shows the same floor, whether it is a catcher or not."""

    def mirrored(visibility):
        scene = scene_with(floor, SLANTED)
        if floor == "plane":
            (plane,) = scene.planes
            scene.planes[0] = plane._with({"visibility": np.array([visibility], np.int32)})
        else:
            scene.instances[0] = Instances(scene.instances[0].geometry, np.eye(4), (0,), visibility=visibility)
        scene.add_discs((5.0, 0.0, 3.0), (1.0, 0.0, -1.0), 1.0, scene.add_material(Material.mirror()))
        return pixel(device, scene, (8.0, 0.0, 3.0), (-1.0, 0.0, 0.0))

    assert mirrored(int(CATCHER)) == pytest.approx(mirrored(int(Visibility.ALL)), abs=1e-6)
    assert mirrored(int(CATCHER)) == pytest.approx([0.4 * 0.8, 0.4 * 0.5, 0.4 * 0.2, 1.0])


def test_through_a_tinted_pane(device):
    """The pane's share of the sky, times what the shadow leaves; what the pane gives off itself stays."""
    color = np.array((0.9, 0.6, 0.3))
    scene = scene_with("plane", SUN, SLANTED)
    pane = Material(diffuse=0.0, transmit=tuple(color), glow=0.1, ior=1.0, fresnel=False, bounds_body=False)
    scene.add_plane((0.0, 0.0, 0.4), UP, scene.add_material(pane), visibility=int(Visibility.CAMERA))
    expected = [0.1, 0.1, 0.1, 1.0 - color.mean() * 0.4 / 1.4]
    assert pixel(device, scene, IN_SHADOW) == pytest.approx(expected)


def test_picture_of_a_ball_on_a_catcher(device):
    """Composed over its sky, the transparent picture is the opaque one."""
    scene = scene_with("plane", SUN, SLANTED)
    scene.add_spheres((1.5, 1.0, 0.4), 0.4, 0)
    scene.camera = Camera.look_at((4.0, -6.0, 4.0), (0.0, 0.0, 0.7), angle=50.0, aspect=4.0 / 3.0)
    over, opaque = (
        render(scene, 96, 72, Settings(film_transparent=transparent), device=device).pixels.astype(np.float64)
        for transparent in (True, False)
    )
    composed = over[..., :3] + (1.0 - over[..., 3:]) * SKY
    assert np.abs(composed - opaque[..., :3]).max() < 1e-5
    assert (opaque[..., 3] == 1.0).all()
    assert len(np.unique(np.round(over[..., 3], 3))) >= 4, "no, half and whole shadow"
