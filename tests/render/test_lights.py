"""Pictures of lights with extent: energy, shadows, no noise in one sample."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine import Camera, Light, Material, Scene, Settings, World, render
from addon.engine.visibility import Visibility

UP = (0.0, 0.0, 1.0)


def floor_under(light, *spheres, window=2.0):
    """A white floor seen straight from above, and what stands on it, under one light that is not seen itself."""
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material(diffuse=1.0), Material(diffuse=0.0)])
    scene.camera = Camera.orthographic_at((0, 0, 50), (0, 0, 0), window, up=(0, 1, 0))
    scene.add_plane((0, 0, 0), UP)
    for center, radius in spheres:
        scene.add_spheres(center, radius, 1)
    scene.add_light(replace(light, visibility=Visibility.ALL & ~Visibility.CAMERA))
    return scene


@pytest.mark.parametrize("samples", [64, 256])
def test_irradiance_below_an_area_light_converges_to_its_form_factor(device, samples):
    """A disc of radius 1, 1 above the floor: F = 1/2 below its middle. Errors fall faster than with random samples."""
    light = Light.area((0, 0, 1), (2, 0, 0), (0, 2, 0), np.pi**2, shape="ELLIPSE", direction=(0, 0, -1))
    scene = floor_under(light, window=1e-3)
    pixels = render(scene, 16, 16, Settings(samples=samples), device=device).pixels[..., 0]
    assert pixels.mean() == pytest.approx(0.5, rel=0.002)
    assert pixels.std() < 0.5 / samples**0.75


@pytest.mark.parametrize("kind", ["sun", "disc"])
def test_width_of_a_soft_shadow(device, kind):
    """What stands 1 above the floor under a light seen under a slope of 0.1 to both sides: its edge fades over 0.2."""
    light = {
        "sun": Light.sun(UP, np.pi, angle=2.0 * np.arctan(0.1)),
        "disc": Light.area((0, 0, 5), (0.8, 0, 0), (0, 0.8, 0), 1.0, shape="ELLIPSE", direction=(0, 0, -1)),
    }[kind]
    scene = floor_under(light)
    scene.add_discs((-50.0, 0, 1), UP, 50.0, 1)  # its edge passes x = 0 nearly straight

    def lit(x):
        scene.camera = Camera.orthographic_at((x, 0, 0.9), (x, 0, 0), 1e-4, up=(0, 1, 0))
        return render(scene, 8, 8, Settings(samples=64), device=device).pixels[..., 0].mean()

    bright = lit(0.12)
    assert lit(-0.12) == 0.0 < lit(-0.08) < 0.1 * bright
    assert 0.9 * bright < lit(0.08) < bright
    assert lit(0.0) == pytest.approx(0.5 * bright, rel=0.05)


LIGHTS = {
    "ball": Light.point((0.5, 0.5, 3), 100.0, radius=0.5),
    "soft ball": Light.point((0.5, 0.5, 3), 100.0, radius=0.5, soft=True),
    "spot": Light.spot((0.5, 0.5, 3), (-0.1, -0.1, -1), 100.0, 0.7, 0.5, radius=0.2),
    "area": Light.area((0.5, 0.5, 3), (1, 0, 0), (0, -1, 0), 100.0),
    "spread": Light.area((0.2, 0.1, 3), (1, 0, 0), (0, -1, 0), 100.0, spread=0.6),
    "sun": Light.sun((0.2, 0.1, 1), 3.0, angle=0.2),
}


@pytest.mark.parametrize("name", LIGHTS)
def test_one_sample_is_without_noise_and_near_the_truth(device, name):
    """One sample: neighbours alike, and all in all as bright as many samples."""
    scene = floor_under(LIGHTS[name])
    one, many = (render(scene, 48, 48, Settings(samples=samples), device=device).pixels[..., 0] for samples in (1, 256))
    assert np.abs(np.diff(one, 2, axis=0)).max() < 0.1 * one.max(), "smooth"
    assert one.mean() == pytest.approx(many.mean(), rel=0.2)


def test_the_cone_of_a_stretched_spot_is_an_ellipse(device):
    """One whose space is twice as long along y: cone and floor meet in an ellipse of 1 x 2, hard without blend."""
    axes = np.diag([1.0, 0.5, -1.0])
    light = Light.spot((0, 0, 2), None, 100.0, 2.0 * np.arctan(0.5), axes=axes)
    pixels = render(floor_under(light, window=6.0), 60, 60, Settings(), device=device).pixels[..., 0]
    y, x = (np.mgrid[:60, :60] + 0.5) / 10.0 - 3.0
    inside = x**2 + (y / 2.0) ** 2
    clear = np.abs(inside - 1.0) > 0.1
    assert ((pixels > 0.0) == (inside < 1.0))[clear].all()


def test_lights_of_all_kinds_add_up(device):
    """Each is sampled for itself: the picture of many is the sum of the pictures of each."""
    scene = floor_under(LIGHTS["ball"], ((0.2, 0.0, 0.5), 0.3))
    settings = Settings(samples=128)
    total = np.zeros((24, 24))
    for light in (*LIGHTS.values(), Light.constant((1, 2, 3), 0.3)):
        scene.lights = [light]
        total += render(scene, 24, 24, settings, device=device).pixels[..., 0]
    scene.lights = [*LIGHTS.values(), Light.constant((1, 2, 3), 0.3)]
    together = render(scene, 24, 24, settings, device=device).pixels[..., 0]
    assert together.mean() == pytest.approx(total.mean(), rel=0.005)
    assert np.median(np.abs(together - total) / np.maximum(total, 1e-3)) < 0.05


def test_shadows_can_be_left_out(device):
    scene = floor_under(replace(LIGHTS["area"], shadow=False), ((0.5, 0.5, 1.0), 0.3))
    hidden = render(scene, 24, 24, Settings(samples=4), device=device).pixels[..., 0]
    scene.lights = [LIGHTS["area"]]
    assert render(scene, 24, 24, Settings(samples=4), device=device).pixels[..., 0].sum() < 0.9 * hidden.sum()
