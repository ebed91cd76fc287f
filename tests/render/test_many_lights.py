"""Many lights: chosen by chance they add up to all of them, without chance the picture is smooth and near; light
linking and the light paths that see a light."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine import Camera, Light, Material, Scene, Session, Settings, World, light_packing, render
from addon.engine.primitives import Spheres
from addon.engine.scene import Geometry, Instances, Visibility
from addon.engine.visibility import GROUPS


def hall(count, seed=0):
    """A floor with balls under lights of all kinds."""
    rng = np.random.default_rng(seed)
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material(diffuse=0.8)])
    scene.camera = Camera.look_at((0.0, -9.0, 6.0), (0.0, 0.0, 0.0))
    scene.add_plane((0, 0, 0), (0, 0, 1))
    scene.add_spheres(np.column_stack([rng.uniform(-4.0, 4.0, (12, 2)), np.full(12, 0.5)]), 0.5)
    for number, (x, y, z) in enumerate(rng.uniform((-6.0, -6.0, 1.5), (6.0, 6.0, 4.0), (count, 3))):
        watts, color = 3000.0 / count, rng.uniform(0.3, 1.0, 3)
        light = Light.point((x, y, z), watts, color, radius=0.05 * (number % 2))
        if number % 5 == 0:
            light = Light.area((x, y, z), (0.5, 0, 0), (0, -0.5, 0), watts, color)
        elif number % 7 == 0:
            light = Light.spot((x, y, z), (0.3, 0.1, -1.0), watts, 1.5, 0.5, color)
        elif number % 11 == 0:
            light = Light.sun(np.add(rng.normal(size=3), (0.0, 0.0, 2.0)), 3.0 / count, color, angle=0.1)
        scene.add_light(replace(light, visibility=light.visibility & ~Visibility.CAMERA))
    return scene


def drawn(scene, samples, device, size=32):
    return render(scene, size, size, Settings(samples=samples), device=device).pixels[..., :3].astype(np.float64)


@pytest.fixture
def all_asked(monkeypatch):
    """A function that renders with a loop over all lights."""

    def draw(*arguments):
        with monkeypatch.context() as patch:
            patch.setattr(light_packing, "FEW_LIGHTS", 1 << 30)
            return drawn(*arguments)

    return draw


def squares(pixels):
    return pixels.reshape(8, 4, 8, 4, 3).mean(axis=(1, 3))


@pytest.mark.parametrize("count", [9, 150])
def test_what_is_chosen_by_chance_adds_up_to_all(device, all_asked, count):
    scene = hall(count)
    found, truth = drawn(scene, 256, device), all_asked(scene, 64, device)
    assert found.mean() == pytest.approx(truth.mean(), rel=0.003)
    assert np.median(np.abs(squares(found) - squares(truth)) / squares(truth)) < 0.01


@pytest.mark.parametrize(
    "count, median, mean", [(9, 1e-6, 1e-6), (40, 1e-6, 1e-6), (300, 0.02, 0.01), (900, 0.03, 0.01)]
)
def test_one_sample_is_near_all(device, all_asked, count, median, mean):
    scene = hall(count)
    found, truth = drawn(scene, 1, device, 64), all_asked(scene, 1, device, 64)
    assert np.median(np.abs(found - truth) / np.maximum(truth, 1e-6)) < median
    assert found.mean() == pytest.approx(truth.mean(), rel=mean)


def test_one_sample_is_without_noise(device):
    """A floor alone, far from the lights: neighbours alike."""
    scene = hall(300)
    scene.shapes = Geometry(name="world")
    scene.camera = Camera.orthographic_at((0, 0, 1), (0, 0, 0), 4.0, up=(0, 1, 0))
    found = drawn(scene, 1, device, 64).sum(axis=-1)
    assert np.abs(np.diff(found, 2, axis=0)).max() < 0.05 * found.max()


@pytest.mark.parametrize("samples, most", [(1, 150.0), (2, 4.0)])
def test_a_surface_casts_few_shadow_rays(device, samples, most):
    session = Session(device)
    session.load(hall(1000), Settings(samples=samples, count_rays=True))
    session.start(24, 24)
    while session.step(60.0):
        pass
    rays = session.statistics()["rays"]
    session.free()
    assert 1.0 < rays["shadow"] / rays["eye_hit"] < most


def test_what_glows_leaves_a_picture_of_one_sample_as_it_is(device):
    scene = hall(4)
    lamps_alone = drawn(scene, 1, device)
    scene.materials.append(Material(diffuse=0.0, glow=90.0))
    places = np.column_stack([np.linspace(-5, 5, 30), np.full(30, -20.0), np.full(30, 3.0)])  # behind the eye
    scene.add_spheres(places, 0.2, 1)
    assert np.allclose(drawn(scene, 1, device), lamps_alone, rtol=1e-5)
    assert drawn(scene, 64, device).sum() > 1.02 * drawn(hall(4), 64, device).sum()


def linked(receivers=0, blockers=0, groups=0):
    """A white floor from above, half of it under a ball that is in `groups`, and a lamp right above."""
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material(diffuse=1.0)])
    scene.camera = Camera.orthographic_at((0, 0, 50), (0, 0, 0), 4.0, up=(0, 1, 0))
    scene.add_plane((0, 0, 0), (0, 0, 1))
    ball = Geometry(Spheres(center=(1, 0, 1), radius=0.5))
    visibility = Visibility.ALL | Visibility(groups)
    scene.instances.append(Instances(ball, np.eye(4), (0,), visibility=visibility))
    scene.add_light(replace(Light.sun((0, 0, 1), np.pi), receivers=receivers, blockers=blockers))
    return scene


@pytest.mark.parametrize("number", [0, 9, GROUPS - 1])
def test_groups_say_what_is_lit_and_what_shades(device, number):
    bit = int(Visibility.group(number))

    def shown(**options):
        pixels = drawn(linked(**options), 1, device, 16)[..., 0]
        return pixels[8, 2], pixels[8, 11]  # floor, ball

    assert shown() == pytest.approx((1.0, 1.0), rel=0.1)
    assert shown(receivers=bit) == (0.0, 0.0)
    assert shown(receivers=bit, groups=bit) == pytest.approx((0.0, 1.0), rel=0.1)
    other = int(Visibility.group(3))
    assert shown(receivers=bit, groups=other) == (0.0, 0.0)

    def shaded(**options):
        scene = linked(**options)
        scene.lights = [replace(scene.lights[0], position=(-0.8, 0.0, 0.6))]
        return drawn(scene, 1, device, 16)[8, 15, 0]  # behind the ball

    assert shaded() == 0.0 and shaded(blockers=bit) > 0.5
    assert shaded(blockers=bit, groups=bit) == 0.0 and shaded(blockers=bit, groups=other) > 0.5


def test_shapes_of_the_world_are_in_no_group(device):
    """They have no instance to say so."""
    scene = linked(blockers=int(Visibility.group(2)))
    scene.instances = []
    scene.add_spheres((1, 0, 1), 0.5)
    scene.lights = [replace(scene.lights[0], position=(-0.8, 0.0, 0.6))]
    assert drawn(scene, 1, device, 16)[8, 15, 0] > 0.5


def test_a_light_is_seen_by_some_ways_of_a_surface_alone(device):
    """A rough mirror with a diffuse body: the two add up."""
    scene = linked()
    scene.materials[0] = Material(diffuse=0.5, reflect=0.5, roughness=0.5, fresnel=False)
    light, parts = scene.lights[0], []
    for visibility in (Visibility.DIFFUSE, Visibility.GLOSSY, Visibility.TRANSMISSION, Visibility.ALL):
        scene.lights = [replace(light, visibility=visibility)]
        parts.append(drawn(scene, 1, device, 16))
    diffuse, glossy, transmitted, all_of_it = parts
    assert np.allclose(diffuse + glossy, all_of_it, rtol=1e-4) and (transmitted == 0.0).all()
    assert diffuse.max() > 0.1 and glossy.max() > 0.1
