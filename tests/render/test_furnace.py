"""White furnaces: what a surface gives back where light of the same radiance comes from everywhere is no more than
that, and all of it where nothing is lost; and what it gives back of the light of lamps from all around."""

import numpy as np
import pytest

from addon.engine import Camera, Light, Material, Scene, Settings, World, render

from .probe import fresnel
from .test_roughness import kept, seen_flat

COSINES = (0.2, 0.6, 1.0)


def suns(count=48, side=1.0, seed=0):
    """Lamps evenly over the half sphere on a side, of which a white diffuse surface returns 1 in all."""
    rng = np.random.default_rng(seed)
    z, angle = (np.arange(count) + rng.uniform(size=count)) / count, 2.399963 * np.arange(count)
    flat = np.sqrt(1.0 - z * z)
    towards = np.stack([flat * np.cos(angle), flat * np.sin(angle), side * z], axis=-1)
    return [Light.sun(direction, 2.0 * np.pi / count) for direction in towards]


def under_lamps(device, material, cosine, side=1.0):
    """What a surface returns (3,) of lamps all over a half sphere, at one sample."""
    pixels = seen_flat(device, material, cosine, world=0.0, lights=suns(side=side), samples=1, max_depth=1)
    return pixels.mean(axis=(0, 1))


@pytest.mark.parametrize("cosine", COSINES)
@pytest.mark.parametrize("roughness", [0.0, 0.5])
def test_coat_over_black_mirrors_by_fresnel(device, cosine, roughness):
    material = Material(diffuse=0.0, coat=0.5, coat_ior=1.7, coat_roughness=roughness)
    expected = kept(cosine, roughness, 1.0, 1.7)[0] if roughness else float(fresnel(cosine, 1.0, 1.7))
    assert seen_flat(device, material, cosine).mean() == pytest.approx(0.5 * expected, abs=2e-3)


@pytest.mark.parametrize("cosine", COSINES)
def test_smooth_coat_over_a_white_mirror_loses_nothing(device, cosine):
    """Two sharp mirrors, one ray: no noise at any number of samples."""
    material = Material(diffuse=0.0, metallic=1.0, grazing=1.0, coat=1.0)
    for samples in (1, 4):
        assert seen_flat(device, material, cosine, samples=samples) == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("cosine", COSINES)
@pytest.mark.parametrize(("roughness", "coat_roughness"), [(0.0, 0.4), (0.5, 0.0), (0.4, 0.7)])
def test_two_mirrors_share_one_ray(device, cosine, roughness, coat_roughness):
    """The mean is the sum of both, though one ray is drawn; no pixel is brighter than it may be."""
    material = Material.metal(1.0, roughness=roughness)
    coated = Material(
        diffuse=0.0, metallic=1.0, grazing=1.0, roughness=roughness, coat=1.0, coat_roughness=coat_roughness
    )
    below = seen_flat(device, material, cosine).mean()
    coat = taken = float(fresnel(cosine, 1.0, 1.5))
    if coat_roughness:
        coat = kept(cosine, coat_roughness, 1.0, 1.5)[0]
        taken = coat / kept(cosine, coat_roughness)[0]  # what its facets lose to each other is taken too
    pixels = seen_flat(device, coated, cosine, samples=256)
    assert pixels.mean() == pytest.approx(coat + (1.0 - taken) * below, abs=4e-3 + 0.05 * coat), "its mean is a fit"
    assert pixels.mean() <= 1.0 + 2e-3


def test_two_mirrors_have_no_noise_at_one_sample(device):
    material = Material(diffuse=0.2, reflect=1.0, roughness=0.3, coat=1.0, coat_roughness=0.15, coat_ior=1.8)
    lamp = Light.sun((0.3, 0.2, 1.0), 2.0)
    assert np.ptp(seen_flat(device, material, 0.6, lights=[lamp], samples=1), axis=(0, 1)).max() < 1e-4


def test_tinted_coat_absorbs_along_its_depth(device):
    cosine, ior, tint = 0.4, 1.5, np.array([0.9, 0.5, 0.1])
    material = Material(diffuse=0.0, glow=1.0, coat=0.6, coat_ior=ior, coat_tint=tuple(tint))
    depth = 1.0 / np.sqrt(1.0 - (1.0 - cosine**2) / ior**2)
    share = 0.6 * float(fresnel(cosine, 1.0, ior))
    expected = (1.0 - share) * (0.4 + 0.6 * tint**depth)
    found = seen_flat(device, material, cosine, world=0.0, samples=1)[0, 0]
    assert found == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("cosine", COSINES)
@pytest.mark.parametrize("roughness", [0.0, 0.3, 1.0])
def test_rough_diffuse_loses_nothing(device, cosine, roughness):
    """White gives back all, what is colored no more than its color."""
    white = under_lamps(device, Material(diffuse=1.0, diffuse_roughness=roughness), cosine)
    assert white == pytest.approx(1.0, abs=0.02)
    color = np.array([0.8, 0.4, 0.1])
    found = under_lamps(device, Material(diffuse=tuple(color), diffuse_roughness=roughness), cosine)
    assert (found <= 1.02 * color).all() and (found >= 0.7 * color).all()


@pytest.mark.parametrize("cosine", COSINES)
def test_translucent_returns_what_comes_from_behind(device, cosine):
    material = Material(diffuse=0.0, translucent=(0.9, 0.5, 0.1))
    assert under_lamps(device, material, cosine, side=-1.0) == pytest.approx((0.9, 0.5, 0.1), abs=0.01)
    assert under_lamps(device, material, cosine, side=1.0) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("cosine", COSINES)
@pytest.mark.parametrize("roughness", [0.3, 0.6])
@pytest.mark.parametrize("coat", [0.0, 1.0])
def test_plastic_under_lamps_gives_back_no_more_than_comes(device, cosine, roughness, coat):
    """A white body under a mirror, under a coat: what one takes another does not get."""
    material = Material(diffuse=1.0, reflect=1.0, roughness=roughness, coat=coat, coat_roughness=0.5)
    found = under_lamps(device, material, cosine)
    assert (found < 1.03).all() and (found > 0.85).all()


@pytest.mark.parametrize("seed", range(6))
def test_any_sum_of_lobes_in_a_furnace(device, seed):
    """All shares of a white body: what goes through, is mirrored by metal, surface and coat, in one material."""
    rng = np.random.default_rng(seed)
    metal, cosine = rng.uniform(0.0, 1.0), rng.uniform(0.15, 1.0)
    rough, coat_rough = rng.uniform(0.0, 1.0, 2)
    material = Material(
        diffuse=0.0,
        reflect=1.0 - metal,
        transmit=1.0 - metal,
        metallic=metal,
        grazing=metal,
        roughness=rough,
        transmit_roughness=rough,
        multiscatter=True,
        coat=rng.uniform(0.0, 1.0),
        coat_roughness=coat_rough,
        bounds_body=False,
    )
    mean = seen_flat(device, material, cosine, samples=256).mean()
    assert 0.75 < mean < 1.02


def test_a_bent_normal_mirrors_off_the_surface(device):
    """Normals of any direction, below the horizon too: a mirror returns all in a furnace, and lamps add no more."""
    rng = np.random.default_rng(3)
    for normal in rng.normal(size=(8, 3)) + np.array([0.0, 0.0, 0.7]):
        material = Material(diffuse=0.0, metallic=1.0, grazing=1.0, normal=tuple(normal))
        assert seen_flat(device, material, 0.3, samples=1)[0, 0] == pytest.approx(1.0, abs=1e-5)
        bumpy = Material(diffuse=1.0, normal=tuple(normal))
        assert under_lamps(device, bumpy, 0.6).max() < 1.02


def test_a_bent_normal_turns_the_diffuse_light(device):
    """Where no bump is in the way: a lamp nearly straight above."""
    towards = np.array([0.1, 0.0, 1.0]) / np.hypot(0.1, 1.0)
    normal = np.array([0.3, 0.0, 1.0])
    material = Material(diffuse=1.0, normal=tuple(normal))
    found = seen_flat(device, material, 1.0, world=0.0, lights=[Light.sun(towards, np.pi)], samples=1)[0, 0]
    assert found == pytest.approx(towards @ normal / np.linalg.norm(normal), abs=1e-5)


def test_holdout_cuts_out_a_share(device):
    camera = Camera.orthographic_at((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), 1.0, up=(0.0, 1.0, 0.0))
    scene = Scene(
        camera=camera, world=World((1.0, 1.0, 1.0)), materials=[Material(diffuse=0.0, glow=0.5, holdout=0.25)]
    )
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0)
    pixels = render(scene, 4, 4, Settings(samples=1), device=device).pixels
    assert pixels == pytest.approx(np.broadcast_to((0.5, 0.5, 0.5, 0.75), (4, 4, 4)), abs=1e-6)
