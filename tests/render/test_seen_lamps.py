"""Lamps with extent as rays meet them: their radiance in closed form, and that none of their light counts twice."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine import Camera, Light, Material, Scene, Settings, Spheres, World, render
from addon.engine.visibility import Visibility

UP = (0.0, 0.0, 1.0)
WATTS = 30.0
LAMPS = {
    "ball": (Light.point((0, 0, 3), WATTS, radius=0.5), WATTS / (4.0 * np.pi**2 * 0.5**2)),
    "soft ball": (Light.point((0, 0, 3), WATTS, radius=0.5, soft=True), WATTS / (4.0 * np.pi**2 * 0.5**2)),
    "square": (Light.area((0, 0, 3), (0, 1, 0), (1, 0, 0), WATTS), WATTS / np.pi),
    "ellipse": (Light.area((0, 0, 3), (0, 1, 0), (2, 0, 0), WATTS, shape="ELLIPSE"), WATTS / np.pi / (np.pi / 2.0)),
    "spot": (Light.spot((0, 0, 3), (0, 0, -1), WATTS, 1.0, radius=0.5), WATTS / (4.0 * np.pi**2 * 0.5**2)),
    "sun": (Light.sun(UP, 2.0, angle=0.2), 2.0 / (np.pi * np.sin(0.1) ** 2)),
}


def looking_up(lamp):
    """Nothing but a lamp above the eye."""
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material(diffuse=0.0)], lights=[lamp])
    scene.camera = Camera.orthographic_at((0, 0, 0), UP, 1e-3, up=(0, 1, 0))
    return scene


def middle(device, scene, samples=1):
    return render(scene, 4, 4, Settings(samples=samples), device=device).pixels[1, 1, :3].astype(np.float64)


@pytest.mark.parametrize("name", LAMPS)
def test_radiance(device, name):
    lamp, radiance = LAMPS[name]
    assert middle(device, looking_up(lamp)) == pytest.approx(np.full(3, radiance), rel=1e-4)


@pytest.mark.parametrize("name", LAMPS)
def test_what_hides_a_lamp(device, name):
    lamp, _ = LAMPS[name]
    assert middle(device, looking_up(replace(lamp, visibility=Visibility.ALL & ~Visibility.CAMERA))).max() == 0.0
    before = looking_up(lamp)
    before.add_spheres((0, 0, 1.5), 0.2)
    assert middle(device, before).max() == 0.0
    if name in ("square", "ellipse"):
        assert middle(device, looking_up(replace(lamp, axes=(*lamp.axes[:2], UP)))).max() == 0.0, "its back"


def test_a_lamp_is_in_no_rays_way(device):
    """What glows behind it is added, as in Cycles."""
    lamp, radiance = LAMPS["ball"]
    scene = looking_up(lamp)
    scene.materials.append(Material(diffuse=0.0, glow=7.0))
    scene.add_discs((0, 0, 5), (0, 0, -1), 1.0, 1)
    assert middle(device, scene)[0] == pytest.approx(radiance + 7.0, rel=1e-4)


def floor_of_metal(lamp, roughness):
    lamp = replace(lamp, visibility=Visibility.ALL & ~Visibility.CAMERA)
    metal = Material.metal((0.9, 0.9, 0.9), roughness=roughness)
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[metal], lights=[lamp])
    scene.camera = Camera.orthographic_at((5, 0, 2), (3, 0, 0), 4.0, up=(0, 1, 0))
    scene.add_plane((0, 0, 0), UP)
    return scene


def light(device, scene, samples=512):
    return render(scene, 8, 8, Settings(samples=samples), device=device).pixels[..., 0]


@pytest.mark.parametrize("roughness", [0.3, 0.9])
@pytest.mark.parametrize("name", LAMPS)
def test_lamps_count_once_in_rough_mirrors(device, name, roughness):
    """As much light as where they are asked for it alone, as those without shadows are; one sample is a highlight."""
    both, alone = (floor_of_metal(replace(LAMPS[name][0], shadow=shadow), roughness) for shadow in (True, False))
    np.testing.assert_allclose(light(device, both, 1), light(device, alone, 1), rtol=1e-4)
    assert light(device, both).mean() == pytest.approx(light(device, alone).mean(), rel=0.02)


@pytest.mark.parametrize("name", ["ball", "soft ball", "square", "ellipse"])
def test_a_rough_mirror_blurs_what_a_smooth_one_shows(device, name):
    """All of it, where it is hardly rough; asked alone that would be noise."""
    smooth, rough = (light(device, floor_of_metal(LAMPS[name][0], roughness)).mean() for roughness in (0.0, 0.05))
    assert rough == pytest.approx(smooth, rel=0.01)


def test_more_than_are_looked_for(device):
    scene = Scene(materials=[Material()], lights=[Light.point((x, 0, 3), 1.0, radius=0.1) for x in range(70)])
    scene.camera = Camera.look_at((0, -5, 1), (0, 0, 0))
    scene.add(Spheres(center=(0, 0, 0), radius=1.0, material=0))
    assert any("64 of the lights" in warning for warning in render(scene, 4, 4, Settings(), device=device).warnings)


def test_only_what_glows_and_one_sample_is_told(device):
    scene = Scene(materials=[Material(), Material(glow=1.0)])
    scene.camera = Camera.look_at((0, -5, 1), (0, 0, 0))
    scene.add_spheres([(0, 0, 0), (0, 0, 3)], 0.5, [0, 1])
    for samples, told in ((1, True), (2, False)):
        warnings = render(scene, 4, 4, Settings(samples=samples), device=device).warnings
        assert any("more than one sample" in warning for warning in warnings) == told
