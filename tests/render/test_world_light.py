"""The world as a light: white furnaces, closed forms of what hides it, ambient occlusion, no noise in one sample."""

import numpy as np
import pytest

from addon.engine import Camera, Image, Material, Scene, SceneError, Session, Settings, World, render, world_light
from addon.engine.expression import Parameter, call, combine, component, maximum
from addon.engine.visibility import Visibility

UP = (0.0, 0.0, 1.0)
HEMISPHERE = Settings(world_light="HEMISPHERE")


def floor(world, *, wall=None, window=1e-3, height=20.0):
    """A white floor seen straight from above where x = y = 0, and a black wall at x = -`wall`, without end."""
    scene = Scene(world=world, materials=[Material(diffuse=1.0), Material(diffuse=0.0)])
    scene.camera = Camera.orthographic_at((0, 0, height), (0, 0, 0), window, up=(0, 1, 0))
    scene.add_plane((0, 0, 0), UP)
    if wall is not None:
        scene.add_plane((-wall, 0, 0), (1, 0, 0), 1)
    return scene


def white(**settings):
    return World((1.0, 1.0, 1.0), lights=True, **settings)


def slope():
    """A world of the radiance 1 + z, of which a surface with the normal n gets 1 + 2 z / 3."""
    return World(component(call("point_position"), 2) + 1.0, lights=True)


def light(device, scene, settings, size=8):
    return render(scene, size, size, settings, device=device).pixels[..., :3].astype(np.float64)


@pytest.mark.parametrize("settings", [Settings(), Settings(samples=4), HEMISPHERE], ids=["one", "four", "hemisphere"])
def test_a_white_ball_disappears_in_a_white_world(device, settings):
    scene = Scene(world=white(), materials=[Material(diffuse=1.0)])
    scene.camera = Camera.look_at((0, -5, 1), (0, 0, 0), angle=30)
    scene.add_spheres((0, 0, 0), 1.0)
    np.testing.assert_allclose(light(device, scene, settings, 32), 1.0, atol=1e-3)
    scene.world = World((1.0, 1.0, 1.0))
    assert light(device, scene, settings, 32).min() == 0.0


def test_a_world_that_is_the_same_everywhere_is_known_before_it_is_seen(device):
    """Rays towards it do not ask its color; the picture is that of a world whose color has to be asked."""
    pictures = []
    unknown = maximum(component(call("point_position"), 2), 2.0) * 0.35  # it is 0.7, which cannot be told
    clear = Material(diffuse=0.0, transmit=0.4, ior=1.0)
    for red in (0.7, unknown):
        scene = Scene(world=World(combine(red, 0.5, 0.2), lights=True))
        scene.materials = [Material(diffuse=0.6, reflect=0.5, roughness=0.4), clear]
        scene.camera = Camera.look_at((0, -5, 3), (0, 0, 0), angle=40)
        scene.add_spheres([(-0.6, 0, 0), (0.7, 0.2, 0)], 0.6, [0, 1])
        scene.add_plane((0, 0, -0.7), UP)
        pictures.append(light(device, scene, Settings(samples=4, shadows="TRANSPARENT"), 32))
    np.testing.assert_allclose(*pictures, atol=1e-5)
    assert np.ptp(pictures[0]) > 0.3
    scene.world = World(combine(-0.7, 0.5, 0.2), lights=True)
    assert light(device, scene, Settings(samples=4), 32)[..., 0].max() == 0.0, "no light is negative"


@pytest.mark.parametrize("z", [1.0, 0.0, -1.0, 0.6])
def test_light_of_a_sloping_world(device, z):
    scene = Scene(world=slope(), materials=[Material(diffuse=1.0)])
    normal = np.array([np.sqrt(1.0 - z * z), 0.0, z])
    scene.camera = Camera.orthographic_at(normal, (0, 0, 0), 1e-3, up=(0, 1, 0))
    scene.add_plane((0, 0, 0), normal)
    wanted = 1.0 + 2.0 / 3.0 * z
    np.testing.assert_allclose(light(device, scene, Settings()), wanted, rtol=1e-3)
    sampled = light(device, scene, Settings(samples=64))
    assert sampled.mean() == pytest.approx(wanted, rel=0.005)
    assert sampled.std() < 0.1 * wanted


def sun_world(scene, side=256):
    """A panorama that is dark but for a few texels; the irradiance over pi of a floor, by sums over them."""
    pixels = np.full((side // 2, side, 3), 0.02, np.float32)
    pixels[100:102, 40:43] = 5e3
    scene.world = World((1.0, 1.0, 1.0), image=scene.add_image(Image(pixels, interpolation="CLOSEST")), lights=True,
                        detail=side)  # fmt: skip
    height = (np.arange(side // 2) + 0.5) / (side // 2) * np.pi - np.pi / 2.0
    weight = np.maximum(np.sin(height), 0.0) * np.cos(height) * (np.pi / (side // 2)) * (2.0 * np.pi / side)
    return float((pixels[..., 0] * weight[:, None]).sum() / np.pi)


def test_a_small_sun_in_a_panorama_is_found(device):
    scene = floor(None)
    wanted = sun_world(scene)
    pixels = light(device, scene, Settings(samples=64), 32)
    assert pixels.mean() == pytest.approx(wanted, rel=0.015)
    assert pixels.std() < 0.15 * wanted


def test_a_wall_takes_half_of_the_world(device):
    """Of a floor all directions to one side end in a wall without end, however far it is."""
    for distance in (0.01, 100.0):
        pixels = light(device, floor(white(), wall=distance), Settings(samples=256))
        assert pixels.mean() == pytest.approx(0.5, abs=0.003)
        assert light(device, floor(white(), wall=distance), HEMISPHERE) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("factor", [1.0, 0.4])
@pytest.mark.parametrize("ratio", [0.1, 0.5, 0.9])
def test_ambient_occlusion_by_a_wall(device, ratio, factor):
    """Chosen by the cosine, directions are even on the disc below them: the wall takes a segment of it."""
    scene = floor(white(), wall=2.0 * ratio)
    hidden = factor * (np.arccos(ratio) - ratio * np.sqrt(1.0 - ratio**2)) / np.pi
    settings = {"world_light": "HEMISPHERE", "use_ao": True, "ao_distance": 2.0, "ao_factor": factor}
    assert light(device, scene, Settings(samples=256, **settings)).mean() == pytest.approx(1.0 - hidden, abs=0.003)
    once = light(device, scene, Settings(**settings))
    assert once == pytest.approx(1.0 - hidden, abs=0.07)
    assert np.ptp(once) == 0.0, "no noise"
    forever = light(device, scene, Settings(samples=256, **settings | {"ao_distance": 0.0})).mean()
    assert forever == pytest.approx(1.0 - 0.5 * factor, abs=0.003)


@pytest.mark.parametrize("samples", [1, 4])
def test_settings_that_light_nothing(device, samples):
    for settings, world in (
        (Settings(samples=samples, world_light="NONE"), white()),
        (Settings(samples=samples), World((1.0, 1.0, 1.0))),
        (Settings(samples=samples), World((0.0, 0.0, 0.0), lights=True)),
    ):
        assert light(device, floor(world), settings).max() == 0.0


@pytest.mark.parametrize("samples", [1, 64])
@pytest.mark.parametrize("make", [Material.mirror, Material.metal], ids=["mirror", "metal"])
def test_mirrors_see_the_world_by_their_own_rays_alone(device, make, samples):
    """Rough ones too: what they get of it is the same whether it lights or not."""
    scene = floor(slope())
    scene.materials = [make((0.8, 0.7, 0.6), roughness=0.05 if samples == 1 else 0.4)]
    seen = light(device, scene, Settings(samples=samples))
    scene.world = World(scene.world.color)
    np.testing.assert_allclose(seen, light(device, scene, Settings(samples=samples)), rtol=1e-5)


def test_which_rays_see_the_world(device):
    """The camera past the floor, a mirror, a glass pane."""
    for hidden, materials in (
        (Visibility.CAMERA, None),
        (Visibility.GLOSSY, Material.mirror()),
        (Visibility.TRANSMISSION, Material.glass()),
    ):
        for visibility, wanted in ((Visibility.ALL, True), (Visibility.ALL & ~hidden, False)):
            scene = Scene(world=World((1.0, 1.0, 1.0), visibility=visibility), materials=[materials or Material()])
            scene.camera = Camera.orthographic_at((0, 0, 5), (0, 0, 0), 1e-3, up=(0, 1, 0))
            if materials:
                scene.add_discs((0, 0, 0), UP, 1.0)
                scene.add_discs((0, 0, -1), (0, 0, -1), 1.0)
            pixels = render(scene, 4, 4, Settings(), device=device).pixels
            assert pixels[..., 3] == pytest.approx(1.0)
            assert (pixels[..., 0] > 0.5).all() == wanted, hidden


def test_a_shadow_catcher_is_as_dark_as_what_others_hide_of_the_world(device):
    """Close below a large ball little of the world is left, far from it all."""
    ground = Settings(samples=64, film_transparent=True)
    found = []
    for x in (0.0, 30.0):
        scene = Scene(world=white(), materials=[Material(diffuse=0.5)])
        scene.camera = Camera.orthographic_at((x, 0, 0.05), (x, 0, 0), 1e-3, up=(0, 1, 0))
        scene.add_plane((0, 0, 0), UP, visibility=Visibility.ALL | Visibility.SHADOW_CATCHER)
        scene.add_spheres((0, 0, 1.1), 1.0)
        found.append(render(scene, 8, 8, ground, device=device).pixels[..., 3].mean())
    assert found[0] == pytest.approx(1.0 / 1.1**2, abs=0.01), "the ball's share of the disc of directions"
    assert found[1] < 0.01


def test_settings_out_of_range_are_named():
    for name, value in {"world_light": "ALL", "ao_distance": -1.0, "ao_factor": 1.5}.items():
        with pytest.raises(SceneError, match=name):
            Settings(**{name: value})


def test_the_map_is_drawn_when_the_world_changes_and_no_program_is_made_anew(device, monkeypatch):
    drawn, programs = [], set()
    draw = world_light._draw_map
    monkeypatch.setattr(world_light, "_draw_map", lambda *arguments: drawn.append(1) or draw(*arguments))
    session = Session(device)
    for strength, radius, maps in ((1.0, 1.0, 1), (1.0, 2.0, 1), (0.5, 2.0, 2)):
        scene = Scene(materials=[Material(diffuse=1.0)])
        scene.camera = Camera.look_at((0, -5, 1), (0, 0, 0))
        scene.add_spheres((0, 0, 0), radius)
        height = component(call("point_position"), 2) + 1.0
        scene.world = World(height * Parameter(strength), lights=True)
        session.load(scene, Settings(samples=2))
        programs.add(session.loaded.drawn.program)
        assert len(drawn) == maps
    session.free()
    assert len(programs) == 1
