"""Mirror, refraction, absorption, media and lights against their formulas in float64 and values that are known."""

import numpy as np
import pytest

from addon.engine import layout
from addon.engine.scene import LightKind

from . import harness, shapes

N = 20_000


def interfaces(device, cos_i, eta, azimuth=0.0, length=1.0, absorption=(0.0, 0.0, 0.0)):
    """Reflectance, cosine beyond, mirrored, refracted and absorbed, and the incoming direction in float64."""
    columns = [np.broadcast_to(c, np.shape(cos_i)) for c in (cos_i, eta, azimuth, length, *absorption, 0.0)]
    outputs = ("out_fresnel", "out_mirrored", "out_refracted", "out_absorbed")
    fresnel, mirrored, refracted, absorbed = harness.run_values(device, "optics_frag.glsl", *columns, outputs=outputs)
    return fresnel[:, 0], fresnel[:, 1], mirrored[:, :3], refracted[:, :3], absorbed[:, :3]


def exact_fresnel(cos_i, eta):
    """Unpolarised reflectance by the angles, Fresnel's own form: sin^2 and tan^2 of their sum and difference."""
    i = np.arccos(np.clip(cos_i, 0.0, 1.0))
    sine = eta * np.sin(i)
    t = np.arcsin(np.minimum(sine, 1.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        reflectance = 0.5 * (np.sin(i - t) ** 2 / np.sin(i + t) ** 2 + np.tan(i - t) ** 2 / np.tan(i + t) ** 2)
    return np.where(sine >= 1.0, 1.0, np.where(i < 1e-6, ((1.0 - eta) / (1.0 + eta)) ** 2, reflectance))


def test_metals_reflect_by_their_complex_index(device):
    """Without extinction as dielectrics."""
    rng = np.random.default_rng(7)
    cosine = shapes.single(rng.uniform(0.02, 1.0, N))
    index, extinction = (shapes.single(rng.uniform(low, 4.0, (3, N))) for low in (0.1, 0.0))
    extinction[2], index[2] = 0.0, np.maximum(index[2], 1.0)
    (found,) = harness.run_values(device, "conductor_frag.glsl", cosine, *index, *extinction, np.zeros(N))
    inside = np.sqrt((index + 1j * extinction) ** 2 - (1.0 - cosine**2))
    along = (index + 1j * extinction) ** 2 * cosine
    amplitudes = (cosine - inside) / (cosine + inside), (along - inside) / (along + inside)
    exact = sum(np.abs(a) ** 2 for a in amplitudes) / 2.0
    assert np.abs(found[:, :3] - exact.T).max() < 2e-4, "where a root nearly vanishes"
    assert np.abs(found[:, 2] - exact_fresnel(cosine, 1.0 / index[2])).max() < 2e-4


def test_fresnel_is_exact(device):
    rng = np.random.default_rng(0)
    cos_i, eta = shapes.single(rng.uniform(0.0, 1.0, N)), shapes.single(shapes.log_uniform(rng, 0.2, 5.0, N))
    reflectance, cos_t, _, _, _ = interfaces(device, cos_i, eta)
    exact = exact_fresnel(cos_i, eta)
    # At the critical angle the cosine is the root of a difference: rounding of 1 gives 2^-12.
    critical = np.abs(eta**2 * (1.0 - cos_i**2) - 1.0)
    tolerance = 2e-6 + 2e-6 / np.sqrt(critical + 1e-7)
    assert (np.abs(reflectance - exact) < tolerance).all()
    assert ((reflectance >= 0.0) & (reflectance <= 1.0)).all()
    total = eta**2 * (1.0 - cos_i**2) > 1.0 + 1e-6
    assert (reflectance[total] == 1.0).all() and (cos_t[total] == 0.0).all() and total.sum() > 1000


@pytest.mark.parametrize("index", [1.1, 1.33, 1.5, 2.4])
def test_normal_incidence_and_brewster_s_angle(device, index):
    brewster = np.cos(np.arctan(index))
    reflectance, *_ = interfaces(device, np.array([1.0, brewster, 1.0]), np.array([1.0 / index, 1.0 / index, index]))
    normal = ((1.0 - index) / (1.0 + index)) ** 2
    assert reflectance[[0, 2]] == pytest.approx(normal, abs=1e-7)
    # No light in the plane of incidence: half of r_s^2, which is cos^2(2 brewster) then.
    assert reflectance[1] == pytest.approx(0.5 * np.cos(2.0 * np.arctan(index)) ** 2, abs=1e-6)


def test_equal_indices_neither_bend_nor_reflect(device):
    cos_i = np.geomspace(1e-6, 1.0, 1000)
    reflectance, cos_t, _, refracted, _ = interfaces(device, cos_i, 1.0)
    assert (reflectance < 1e-9).all(), "down to the last grazing ray"
    assert np.allclose(cos_t, cos_i, rtol=1e-5)
    assert np.allclose(refracted, np.stack([np.sqrt(1 - cos_i**2), 0 * cos_i, -cos_i], axis=-1), atol=1e-6)


def test_refraction_obeys_snell(device):
    rng = np.random.default_rng(1)
    cos_i, eta = shapes.single(rng.uniform(0.001, 1.0, N)), shapes.single(shapes.log_uniform(rng, 0.2, 5.0, N))
    azimuth = shapes.single(rng.uniform(0.0, 2.0 * np.pi, N))
    _, _, mirrored, refracted, _ = interfaces(device, cos_i, eta, azimuth)
    sine = np.sqrt(1.0 - cos_i**2)
    flat = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1) * sine[:, None]
    assert np.allclose(mirrored, np.column_stack([flat, cos_i]), atol=2e-6)
    through = eta * sine < 0.9999
    assert np.allclose(refracted[through, :2], (flat * eta[:, None])[through], atol=3e-6)
    assert (refracted[through, 2] < 0.0).all()
    assert np.abs(np.linalg.norm(refracted[through], axis=-1) - 1.0).max() < 1e-6


def test_energy_is_kept_in_both_directions(device):
    """The reflectance is the same from both sides along the same path, so that R + T = 1 holds for either."""
    rng = np.random.default_rng(2)
    cos_i, eta = shapes.single(rng.uniform(0.05, 1.0, N)), shapes.single(rng.uniform(0.3, 0.95, N))
    there, cos_t, *_ = interfaces(device, cos_i, eta)
    back, cos_back, *_ = interfaces(device, cos_t.astype(np.float64), shapes.single(1.0 / eta))
    assert np.allclose(there, back, atol=1e-4), np.abs(there - back).max()
    assert np.allclose(cos_back, cos_i, atol=1e-4)


def test_absorption_is_exponential(device):
    rng = np.random.default_rng(3)
    absorption = rng.uniform(0.0, 3.0, (3, N))
    length = shapes.log_uniform(rng, 1e-4, 1e1, N)
    *_, absorbed = interfaces(device, np.ones(N), 1.0, 0.0, length, absorption)
    assert np.allclose(absorbed, np.exp(-absorption.T * length[:, None]), rtol=1e-5, atol=1e-30)
    *_, absorbed = interfaces(device, np.ones(1), 1.0, 0.0, 1e30)
    assert (absorbed == 1.0).all(), "nothing is absorbed where nothing absorbs"


def test_media_are_a_stack_of_bodies(device):
    """Random walks through bodies, against a Python list of four; index and absorption are the innermost body's."""
    rng = np.random.default_rng(4)
    steps = rng.integers(-5, 6, (3000, 8))
    materials = layout.MATERIAL.zeros(5)
    materials["ior"], materials["absorption"] = 1.1 + np.arange(5) / 10.0, np.arange(15).reshape(5, 3)
    media, inside = harness.run_values(
        device,
        "medium_frag.glsl",
        *steps.T,
        textures={"tables": harness.texels(materials)},
        outputs=("out_media", "out_inside"),
    )
    for walk, found, around in zip(steps, media.astype(int), inside, strict=True):
        bodies = []
        for step in walk:
            if step > 0:
                bodies = [step - 1, *bodies][:4]
            elif step < 0 and bodies:
                bodies.remove(-step - 1 if -step - 1 in bodies else bodies[0])
        assert found.tolist() == bodies + [-1] * (4 - len(bodies)), walk
        expected = materials[bodies[0]] if bodies else None
        assert around[3] == np.float32(expected["ior"] if bodies else 1.0)
        assert (around[:3] == (expected["absorption"] if bodies else 0.0)).all()


@pytest.mark.parametrize("kind", [LightKind.POINT, LightKind.CONSTANT, LightKind.SUN])
def test_lights(device, kind):
    """Fall-off with the square for POINT, none for CONSTANT and SUN; direction and distance."""
    rng = np.random.default_rng(5)
    light = layout.LIGHT.zeros(1)
    light["position"], light["kind"], light["color"] = [0.6, 0.0, 0.8], kind, [1.0, 2.0, 3.0]
    points = shapes.single(rng.normal(size=(2000, 3)) * shapes.log_uniform(rng, 1e-3, 1e4, 2000)[:, None])
    zero = np.zeros(2000)
    radiance, direction = harness.run_values(
        device,
        "light_frag.glsl",
        *[zero] * 4,
        *points.T,
        textures={"tables": harness.texels(light)},
        outputs=("out_radiance", "out_direction"),
    )
    to_light = np.float32([0.6, 0.0, 0.8]).astype(np.float64) - points
    distance = np.linalg.norm(to_light, axis=-1)
    if kind == LightKind.SUN:
        assert (radiance[:, :3] == [1.0, 2.0, 3.0]).all() and (radiance[:, 3] > 1e29).all()
        assert np.allclose(direction[:, :3], [0.6, 0.0, 0.8])
        return
    falloff = 1.0 / distance**2 if kind == LightKind.POINT else np.ones(2000)
    assert np.allclose(radiance[:, :3], falloff[:, None] * [1.0, 2.0, 3.0], rtol=2e-6)
    assert np.allclose(radiance[:, 3], distance, rtol=1e-6)
    assert np.allclose(direction[:, :3], to_light / distance[:, None], atol=1e-6)
