"""Rough surfaces in pictures: the energy that single scattering by GGX keeps, by quadrature; no noise at one sample."""

import numpy as np
import pytest

from addon.engine import Camera, Light, Material, Scene, Settings, World, glass_energy, render
from addon.engine.expression import call, component, maximum
from addon.engine.packing import pack

from .probe import fresnel


def flat(material, cosine=1.0, world=1.0, lights=()):
    """An infinite plane of a single sheet, seen under an angle of this cosine everywhere."""
    eye = 5.0 * np.array([np.sqrt(1.0 - cosine**2), 0.0, cosine])
    camera = Camera.orthographic_at(eye, (0.0, 0.0, 0.0), 1e-3, up=(0.0, 1.0, 0.0), aspect=4.0 / 3.0)
    world = world if isinstance(world, World) else World((world,) * 3)
    scene = Scene(camera=camera, world=world, materials=[material], lights=list(lights))
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0)
    return scene


def seen_flat(device, material, cosine, world=1.0, lights=(), **settings):
    """Pixels (12, 16, 3) of it."""
    scene = flat(material, cosine, world, lights)
    settings = Settings(**{"samples": 64, "max_depth": 3, "weight_cutoff": 0.0} | settings)
    return render(scene, 16, 12, settings, device=device).pixels[..., :3].astype(np.float64)


def facets(alpha):
    """Normals (n, 3) and cosines such that a mean over them is an integral of D cos over the half sphere."""
    below, angle = np.meshgrid((np.arange(3000) + 0.5) / 3000, (np.arange(256) + 0.5) / 256 * 2.0 * np.pi)
    slope = alpha * np.sqrt(below / (1.0 - below))
    z = 1.0 / np.sqrt(1.0 + slope**2)
    return np.stack([slope * np.cos(angle) * z, slope * np.sin(angle) * z, z], axis=-1).reshape(-1, 3)


def hidden(cosine, alpha):
    """Smith's Lambda."""
    tangent = np.sqrt(np.maximum(1.0 - cosine**2, 0.0)) / np.maximum(np.abs(cosine), 1e-9)
    return (np.sqrt(1.0 + (alpha * tangent) ** 2) - 1.0) / 2.0


def kept(cosine, roughness, n_from=None, n_to=None):
    """(reflected, transmitted) share of light of a white surface, of a dielectric where there are indices."""
    alpha = roughness**2
    facet = facets(alpha)
    view = np.array([np.sqrt(1.0 - cosine**2), 0.0, cosine])
    cos_i = facet @ view
    faces = cos_i > 0.0
    mirrored = 2.0 * cos_i * facet[:, 2] - cosine
    share = fresnel(np.clip(cos_i, 0.0, 1.0), n_from, n_to) if n_from else 1.0

    def mean(cos_out, there, part):
        both_seen = 1.0 / (1.0 + hidden(cosine, alpha) + hidden(cos_out, alpha))
        return (part * both_seen * cos_i / (cosine * facet[:, 2]) * (there & faces)).mean()

    reflected = mean(mirrored, mirrored > 0.0, share)
    if not n_from:
        return reflected, 0.0
    eta = n_from / n_to
    root = 1.0 - eta**2 * (1.0 - cos_i**2)
    bent = -eta * cosine + (eta * cos_i - np.sqrt(np.maximum(root, 0.0))) * facet[:, 2]
    return reflected, mean(bent, (root > 0.0) & (bent < 0.0), 1.0 - share)


@pytest.mark.parametrize("roughness", [0.05, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("cosine", [0.15, 0.6, 1.0])
def test_rough_mirror_in_a_furnace(device, roughness, cosine):
    """No more than comes in, and what single scattering keeps."""
    pixels = seen_flat(device, Material.mirror(roughness=roughness), cosine)
    assert pixels.max() <= 1.0 + 1e-5
    assert pixels.mean() == pytest.approx(kept(cosine, roughness)[0], abs=4e-3)


@pytest.mark.parametrize("roughness", [0.3, 0.6, 1.0])
@pytest.mark.parametrize("cosine", [0.3, 0.6, 1.0])
def test_multiscatter_mirror_gives_back_all(device, roughness, cosine):
    """A white one all, by the fit of what is lost; a colored one less than that."""
    white, red = (
        Material(diffuse=0.0, reflect=color, roughness=roughness, fresnel=False, multiscatter=True)
        for color in (1.0, (0.8, 0.2, 0.0))
    )
    assert seen_flat(device, white, cosine).mean() == pytest.approx(1.0, abs=0.05)
    once = kept(cosine, roughness)[0]
    r, g, b = seen_flat(device, red, cosine).mean(axis=(0, 1))
    assert 0.8 * once - 4e-3 < r < 0.8 and 0.2 * once - 4e-3 < g < 0.2 and b == 0.0
    assert r / g > 3.99, "each bounce makes it more saturated"


@pytest.mark.parametrize("roughness", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("cosine", [0.2, 0.7, 1.0])
def test_rough_glass_in_a_furnace(device, roughness, cosine):
    glass = {"diffuse": 0.0, "reflect": 1.0, "transmit": 1.0, "ior": 1.5, "bounds_body": False}
    rough = {"roughness": roughness, "transmit_roughness": roughness}
    reflected, transmitted = kept(cosine, roughness, 1.0, 1.5)
    pixels = seen_flat(device, Material(**glass, **rough), cosine)
    assert pixels.max() <= 1.0 + 5e-3, "but for rays that stand for others"
    assert pixels.mean() == pytest.approx(reflected + transmitted, abs=6e-3)
    pixels = seen_flat(device, Material(**{**glass, "transmit": 0.0}, **rough), cosine)
    assert pixels.mean() == pytest.approx(reflected, abs=2e-3), "the mirror alone"


@pytest.mark.parametrize("roughness", [0.0, 0.05, 0.4, 0.8])
def test_rough_rays_that_bring_little_are_followed_now_and_then(device, roughness):
    """As many everywhere; they bring what all would, in the mean. Where little else is returned most are followed."""
    varnish = Material(diffuse=1.0, reflect=1.0, ior=1.5, roughness=roughness)
    settings = Settings(samples=64, max_depth=2, count_rays=True)
    picture = render(flat(varnish), 32, 24, settings, device=device)
    expected = kept(1.0, roughness, 1.0, 1.5)[0] if roughness else 0.04
    rays = picture.statistics["rays"]
    followed = min(2.0 * 0.04 / (1.04 * max(roughness, 1e-3)), 1.0)
    assert followed / 1.5 < rays["reflect"] / rays["eye_hit"] < followed * 1.5, "the nearest power of 2"
    pixels = picture.pixels[..., 0].astype(np.float64)
    assert pixels.mean() == pytest.approx(expected, rel=0.02)
    assert np.abs(pixels - expected).max() < 0.03
    black = Material(diffuse=0.0, reflect=1.0, ior=1.5, roughness=roughness)
    rays = render(flat(black), 32, 24, settings, device=device).statistics["rays"]
    assert rays["reflect"] / rays["eye_hit"] > 0.6


@pytest.mark.parametrize("roughness", [0.2, 0.5, 0.8, 1.0])
@pytest.mark.parametrize("cosine", [0.2, 0.7, 1.0])
@pytest.mark.parametrize(("before", "beyond"), [(1.0, 1.5), (1.5, 1.0), (1.0, 2.4)])
def test_what_glass_keeps_is_the_integral(roughness, cosine, before, beyond):
    """The table that shaders take it from, against facets drawn by their own density instead of as they are seen."""
    once = sum(kept(cosine, roughness, before, beyond))
    assert glass_energy.kept([cosine], roughness**2, before / beyond)[0] == pytest.approx(once, abs=0.015)


@pytest.mark.parametrize("roughness", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("cosine", [0.2, 0.7, 1.0])
def test_multiscatter_glass_gives_back_all(device, roughness, cosine):
    """Clear glass all, from both sides; a colored one less, its mirror alone what is its own."""
    glass = {"diffuse": 0.0, "reflect": 1.0, "ior": 1.5, "roughness": roughness, "transmit_roughness": roughness}
    for ior in (1.5, 1.0 / 1.5):
        clear = Material(**glass | {"ior": ior}, transmit=1.0, bounds_body=False, multiscatter=True)
        assert seen_flat(device, clear, cosine).mean() == pytest.approx(1.0, abs=0.02)
    plain, clear = (
        Material(**glass, transmit=1.0, bounds_body=False, multiscatter=multiscatter) for multiscatter in (0.0, 1.0)
    )
    once = [seen_flat(device, material, cosine, samples=1) for material in (plain, clear)]
    np.testing.assert_allclose(*once, atol=2e-3, err_msg="it is drawn as smooth in a picture of one sample")
    for weight in (0.5, 0.1):
        mixed = Material(
            **glass | {"reflect": weight}, transmit=weight, bounds_body=False, multiscatter=1.0, body=weight
        )
        assert seen_flat(device, mixed, cosine).mean() == pytest.approx(weight, rel=0.03)
    colored = Material(**glass, transmit=(1.0, 0.6, 0.2), bounds_body=False, multiscatter=True)
    reflected, transmitted = kept(cosine, roughness, 1.0, 1.5)
    red, green, blue = seen_flat(device, colored, cosine).mean(axis=(0, 1))
    assert reflected + 0.6 * transmitted - 5e-3 < green < red
    assert reflected + 0.2 * transmitted - 5e-3 < blue < green


@pytest.mark.parametrize("roughness", [0.3, 0.6, 1.0])
@pytest.mark.parametrize("cosine", [0.3, 0.6, 1.0])
def test_multiscatter_varnish_over_white_gives_back_all(device, roughness, cosine):
    """What it takes from the diffuse body below is what it returns."""
    varnished = Material(diffuse=1.0, reflect=1.0, ior=1.5, roughness=roughness, multiscatter=True)
    lit = seen_flat(device, varnished, cosine, world=World((1.0, 1.0, 1.0), lights=True), samples=256)
    assert lit.mean() == pytest.approx(1.0, abs=0.012)


def test_metal_grows_to_white_and_is_tinted_near_82_degrees(device):
    """Smooth, so that the cosine is known."""
    metal = Material.metal((0.9, 0.6, 0.2), edge=(1.0, 0.5, 0.1))
    assert seen_flat(device, metal, 1.0, samples=1)[0, 0] == pytest.approx((0.9, 0.6, 0.2), abs=1e-5)
    schlick = np.array([0.9, 0.6, 0.2]) + (1.0 - np.array([0.9, 0.6, 0.2])) * (6.0 / 7.0) ** 5
    assert seen_flat(device, metal, 1.0 / 7.0, samples=1)[0, 0] == pytest.approx(schlick * (1.0, 0.5, 0.1), abs=1e-4)
    assert seen_flat(device, metal, 1e-3, samples=1)[0, 0] == pytest.approx((1.0, 1.0, 1.0), abs=2e-2)


@pytest.mark.parametrize("roughness", [0.0, 0.2, 0.4, 0.7])
@pytest.mark.parametrize("make", [Material.metal, Material.plastic])
def test_one_sample_has_no_noise(device, make, roughness):
    """All pixels of a plane are the same; in a furnace a mirror that is too rough for one ray fades."""
    material = make((0.5, 0.5, 0.5), roughness=roughness)
    lamp = Light.sun((0.3, 0.2, 1.0), 2.0)
    assert np.ptp(seen_flat(device, material, 0.6, lights=[lamp], samples=1), axis=(0, 1)).max() < 1e-4
    mirror = Material.mirror(roughness=roughness)
    x = np.clip((0.5 - roughness) / 0.4, 0.0, 1.0)
    assert seen_flat(device, mirror, 0.6, samples=1)[0, 0, 0] == pytest.approx(x * x * (3.0 - 2.0 * x), abs=1e-5)


def test_rough_rays_of_rough_rays_are_followed_alike_everywhere(device):
    """In a corner: blocks of pixels that decide as one come to the same light, the more samples the closer."""
    scene = Scene(world=World((1.0, 1.0, 1.0)))
    scene.materials = [Material(diffuse=0.8, reflect=1.0, ior=1.5, roughness=0.5)]
    scene.camera = Camera.orthographic_at((1.0, 3.0, 4.0), (1.0, 0.0, 0.0), 1e-3, up=(0.0, 0.0, 1.0))
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0)
    scene.add_plane((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0)
    spread = []
    for samples in (16, 1024):
        settings = Settings(samples=samples, max_depth=8, weight_cutoff=0.0)
        pixels = render(scene, 64, 64, settings, device=device).pixels[..., 0].astype(np.float64)
        spread.append(pixels.reshape(8, 8, 8, 8).mean(axis=(1, 3)).std() / pixels.mean())
    assert spread[0] < 0.2
    assert spread[1] < 0.03


def test_another_seed_has_other_noise(device):
    """The same twice, none in common with another, and none at one sample."""
    scene = flat(Material.mirror(roughness=0.5), 0.4, World(maximum(component(call("point_position"), 1) + 0.5, 0.0)))
    seeds = (0, 0, 1, 2, 2**31 - 1)
    pictures = [render(scene, 32, 24, Settings(samples=2, seed=seed), device=device).pixels[..., 0] for seed in seeds]
    assert np.array_equal(*pictures[:2])
    noise = np.array([picture - picture.mean() for picture in pictures[1:]], np.float64).reshape(4, -1)
    assert np.abs(np.corrcoef(noise) - np.eye(4)).max() < 0.15
    assert np.ptp([picture.mean() for picture in pictures]) < 0.05 * pictures[0].mean()
    once, again = (render(scene, 32, 24, Settings(seed=seed), device=device).pixels for seed in (0, 1))
    assert np.array_equal(once, again)


def test_highlight_of_a_sun_is_the_formula(device):
    """pi D G F / 4 cos_view, in units of a white diffuse surface: a coat's and a metal's, at one sample and at many."""
    cosine, alpha, towards = 0.6, 0.3**2, np.array([-0.5, 0.3, 0.8]) / np.linalg.norm([-0.5, 0.3, 0.8])
    view = np.array([np.sqrt(1.0 - cosine**2), 0.0, cosine])
    facet = (view + towards) / np.linalg.norm(view + towards)
    density = alpha**2 / (np.pi * (facet[2] ** 2 * (alpha**2 - 1.0) + 1.0) ** 2)
    shadowed = 1.0 + hidden(cosine, alpha) + hidden(towards[2], alpha)
    share = density / (4.0 * cosine * shadowed) * 2.0
    lamp = Light.sun(towards, 2.0)
    coat = Material(diffuse=0.0, reflect=1.0, ior=1.5, roughness=0.3)
    metal = Material.metal((0.9, 0.6, 0.2), roughness=0.3)
    schlick = np.array([0.9, 0.6, 0.2]) + (1.0 - np.array([0.9, 0.6, 0.2])) * (1.0 - facet @ view) ** 5
    for material, reflectance in ((coat, fresnel(facet @ view, 1.0, 1.5)), (metal, schlick)):
        pixels = seen_flat(device, material, cosine, world=0.0, lights=[lamp], samples=2)
        assert pixels[0, 0] == pytest.approx(share * reflectance * np.ones(3), rel=1e-3)


def test_smooth_scenes_do_not_pay():
    """Nor do their programs carry what rough ones need."""
    scene = Scene(camera=Camera.look_at((0.0, -4.0, 0.0), (0.0, 0.0, 0.0)), materials=[Material.plastic(0.5)])
    scene.add_spheres((0.0, 0.0, 0.0), 1.0)
    assert not {"HAS_ROUGHNESS", "HAS_METALS"} & set(pack(scene, 4096).features)
    scene.materials = [Material.metal(0.5, roughness=0.2)]
    assert {"HAS_ROUGHNESS", "HAS_METALS"} <= set(pack(scene, 4096).features)
