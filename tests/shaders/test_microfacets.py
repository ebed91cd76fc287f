"""Microfacets against their formulas in float64, each quantity by a way that the shader does not take."""

import numpy as np
import pytest

from . import harness, shapes

N = 40_000
ALPHAS = (0.001, 0.04, 0.25, 1.0)


def facets(device, alpha, cosine, azimuth=0.0, u=(0.5, 0.5), light=(0.0, 0.0, 1.0), eta=0.75):
    """Sampled normals (n, 3) in the frame of the surface's, and the other outputs of the test program."""
    columns = (alpha, cosine, azimuth, *u, *light)
    count = max(np.size(c) for c in columns)
    columns = [np.broadcast_to(c, count) for c in columns]
    constants = {"TEST_ETA": f"{eta:.9f}"}
    outputs = ("out_facet", "out_light", "out_mean")
    return harness.run_values(device, "microfacet_frag.glsl", *columns, constants=constants, outputs=outputs)


def directions(rng, count, side=1.0):
    """Unit vectors (3, count) evenly over the half sphere."""
    z, angle = rng.uniform(0.02, 1.0, count), rng.uniform(0.0, 2.0 * np.pi, count)
    flat = np.sqrt(1.0 - z * z)
    return shapes.single(np.stack([flat * np.cos(angle), flat * np.sin(angle), side * z]))


def density(cosine, alpha):
    """D by the tangent, as Walter et al. write it."""
    tangent = np.tan(np.arccos(np.clip(cosine, 0.0, 1.0)))
    return alpha**2 / (np.pi * cosine**4 * (alpha**2 + tangent**2) ** 2)


def seen(cosine, alpha):
    """1 + Lambda, 1 / G1."""
    tangent = np.tan(np.arccos(np.clip(np.abs(cosine), 0.0, 1.0)))
    return (1.0 + np.sqrt(1.0 + (alpha * tangent) ** 2)) / 2.0


@pytest.mark.parametrize("alpha", ALPHAS)
def test_density_and_its_integral(device, alpha):
    """D, whose projection integrates to 1, down to the smallest angles that matter."""
    sine = np.geomspace(1e-3 * alpha, 1.0, N)[:-1]
    cosine = np.sqrt(1.0 - sine**2)
    *_, mean = facets(device, alpha, 0.5, light=(sine, 0.0, cosine))
    exact = density(cosine, alpha)
    assert np.allclose(mean[:, 1], exact, rtol=max(2e-5, 1e-7 / alpha**2)), np.abs(mean[:, 1] / exact - 1.0).max()
    total = np.trapezoid(mean[:, 1].astype(np.float64) * 2.0 * np.pi * sine, sine)  # D cos over dsin^2 / 2 cos
    assert total == pytest.approx(1.0, abs=2e-3 + 1e-3 * alpha)


@pytest.mark.parametrize("alpha", ALPHAS)
@pytest.mark.parametrize("cosine", [0.05, 0.4, 1.0])
def test_sampled_normals_are_those_that_are_seen(device, alpha, cosine):
    """Their distribution in slope, by moments of the visible normals integrated over the half sphere."""
    u = (np.arange(N) + 0.5) / N, np.mod(np.arange(N) * 0.6180339887498949, 1.0)
    sampled, *_ = facets(device, alpha, cosine, 0.0, u)
    assert np.allclose(np.linalg.norm(sampled[:, :3], axis=1), 1.0, atol=1e-6)
    # Of all facets of GGX the share `below` lies within a slope, so that the smallest lobe is resolved as the widest.
    below, angle = np.meshgrid((np.arange(4000) + 0.5) / 4000, (np.arange(400) + 0.5) / 400 * 2.0 * np.pi)
    slope = alpha * np.sqrt(below / (1.0 - below))
    # A facet is larger than its projection: what is seen of it is divided by its cosine.
    weight = np.maximum(slope * np.cos(angle) * np.sqrt(1.0 - cosine**2) + cosine, 0.0)
    weight *= 1.0 / weight.sum()
    facet = sampled.T.astype(np.float64)
    slope_found = np.hypot(facet[0], facet[1]) / facet[2] / alpha
    below_found = slope_found**2 / (1.0 + slope_found**2)
    across = np.hypot(facet[0], facet[1])
    for power in (1, 4):
        assert (below_found**power).mean() == pytest.approx((below**power * weight).sum(), abs=4e-3)
        assert (facet[0] / across * below_found**power).mean() == pytest.approx(
            (np.cos(angle) * below**power * weight).sum(), abs=4e-3
        )
        assert np.abs(facet[1] / across * below_found**power).mean() == pytest.approx(
            (np.abs(np.sin(angle)) * below**power * weight).sum(), abs=4e-3
        )


@pytest.mark.parametrize("alpha", ALPHAS)
def test_mirrored_light_is_that_of_the_formula_and_reciprocal(device, alpha):
    rng = np.random.default_rng(1)
    view, light = directions(rng, N), directions(rng, N)
    azimuth = np.arctan2(view[1], view[0])
    _, shares, _ = facets(device, alpha, view[2], azimuth, light=light)
    _, back, _ = facets(device, alpha, light[2], np.arctan2(light[1], light[0]), light=view)
    facet = (view + light) / np.linalg.norm(view + light, axis=0)
    shadowed = seen(view[2], alpha) + seen(light[2], alpha) - 1.0
    exact = np.pi * density(facet[2], alpha) / (4.0 * view[2] * shadowed)
    assert np.allclose(shares[:, 0], exact, rtol=2e-3), "D G / 4 cos cos, times cos and pi"
    assert np.allclose(shares[:, 0] * view[2], back[:, 0] * light[2], rtol=2e-3)
    assert np.allclose(shares[:, 2], seen(view[2], alpha) / shadowed, rtol=1e-4)


@pytest.mark.parametrize("eta", [1.0 / 1.5, 1.5])
@pytest.mark.parametrize("alpha", [0.04, 0.25, 1.0])
@pytest.mark.parametrize("cosine", [0.3, 0.9])
def test_light_agrees_with_sampled_rays(device, alpha, eta, cosine):
    """The evaluated lobes integrate to the mean weight of sampled directions, mirrored and refracted."""
    rng = np.random.default_rng(2)
    count = 400_000
    u = (np.arange(count) + 0.5) / count, np.mod(np.arange(count) * 0.6180339887498949, 1.0)
    sampled, *_ = facets(device, alpha, cosine, 0.0, u, eta=eta)
    facet = sampled[:, :3].astype(np.float64)
    view = np.array([np.sqrt(1.0 - cosine**2), 0.0, cosine])
    cos_i = facet @ view
    mirrored = 2.0 * cos_i[:, None] * facet - view
    root = 1.0 - eta**2 * (1.0 - cos_i**2)
    bent = -eta * view + (eta * cos_i - np.sqrt(np.maximum(root, 0.0)))[:, None] * facet
    for column, out, there in ((0, mirrored, mirrored[:, 2] > 0.0), (1, bent, (root > 0.0) & (bent[:, 2] < 0.0))):
        weight = seen(cosine, alpha) / (seen(cosine, alpha) + seen(np.where(there, out[:, 2], 1.0), alpha) - 1.0)
        expected = (weight * there).mean()
        light = directions(rng, count, 1.0 if column == 0 else -1.0)
        light[2] = (np.arange(count) + 0.5) / count * (1.0 if column == 0 else -1.0)
        light[:2] *= np.sqrt(1.0 - light[2] ** 2) / np.linalg.norm(light[:2], axis=0)
        _, shares, _ = facets(device, alpha, cosine, light=light, eta=eta)
        values = shares[:, column].astype(np.float64) * 2.0  # times 2 pi over pi
        error = 4.0 * values.std() / np.sqrt(count)
        assert values.mean() == pytest.approx(expected, abs=error + 2e-3)


@pytest.mark.parametrize("index", [1.33, 1.5, 2.0])
def test_mean_reflectance_of_facets(device, index):
    """The fit, within a twentieth of the mean of Fresnel's reflectance over the facets that reflect."""
    u = (np.arange(N) + 0.5) / N, np.mod(np.arange(N) * 0.6180339887498949, 1.0)
    for alpha in (0.01, 0.04, 0.16, 0.36, 0.64, 1.0):
        for cosine in (0.1, 0.3, 0.5, 0.7, 1.0):
            sampled, _, mean = facets(device, alpha, cosine, 0.0, u)
            facet = sampled[:, :3].astype(np.float64)
            cos_i = facet @ [np.sqrt(1.0 - cosine**2), 0.0, cosine]
            out = 2.0 * cos_i * facet[:, 2] - cosine
            weight = np.where(out > 0.0, 1.0 / (seen(cosine, alpha) + seen(np.maximum(out, 1e-9), alpha) - 1.0), 0.0)
            exact = (weight * dielectric(cos_i, index)).sum() / weight.sum()
            assert dielectric(float(mean[0, 0]), index) == pytest.approx(exact, rel=0.05), (alpha, cosine)


def test_light_lost_between_facets(device):
    """The fits against the mean weight of sampled directions, and its mean over the half sphere."""
    u = (np.arange(N) + 0.5) / N, np.mod(np.arange(N) * 0.6180339887498949, 1.0)
    errors = []
    for alpha in np.array([0.1, 0.3, 0.5, 0.6, 0.8, 1.0]) ** 2:
        exact, cosines = [], (np.arange(16) + 0.5) / 16
        for cosine in cosines:
            sampled, _, fits = facets(device, alpha, cosine, 0.0, u)
            facet = sampled[:, :3].astype(np.float64)
            out = 2.0 * (facet @ [np.sqrt(1.0 - cosine**2), 0.0, cosine]) * facet[:, 2] - cosine
            first = seen(cosine, alpha)
            weight = np.where(out > 0.0, first / (first + seen(np.maximum(out, 1e-9), alpha) - 1.0), 0.0)
            exact.append(1.0 - weight.mean())
            errors.append(fits[0, 2] - exact[-1])
        assert fits[0, 3] == pytest.approx(2.0 * np.mean(exact * cosines), abs=4e-3), alpha
    assert np.abs(errors).max() < 0.035 and np.sqrt(np.mean(np.square(errors))) < 0.012


def dielectric(cosine, index):
    """Unpolarised reflectance from outside."""
    inside = np.sqrt(index**2 - 1.0 + np.square(cosine))
    s, p = (cosine - inside) / (cosine + inside), (index**2 * cosine - inside) / (index**2 * cosine + inside)
    return (s**2 + p**2) / 2.0
