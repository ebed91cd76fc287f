"""Skies against integrals of the same atmospheres in small steps, and against what is known of daylight."""

import numpy as np
import pytest

from addon.engine import sky
from addon.engine.sky import single
from addon.engine.sky.table import COLUMNS, ROWS, XYZ_TO_RGB, directions, elevations

DAY = {"altitude": 0.0, "air": 1.0, "aerosol": 1.0, "ozone": 1.0}
LUMINANCE = np.linalg.inv(XYZ_TO_RGB)[1]


def scattered_once(direction, sun, steps=400):
    """The colour of single scattering by sums of equal steps along both paths."""
    radius, top = 6360e3, 6420e3

    def densities(height):
        tent = np.maximum(1.0 - np.abs(height - 25e3) / 15e3, 0.0)
        return np.stack([np.exp(-height / 8e3), np.exp(-height / 1.2e3), tent], axis=-1)

    def path(origin, towards):
        along = origin @ towards
        length = -along + np.sqrt(along**2 - origin @ origin + top**2)
        middle = (np.arange(steps) + 0.5) / steps * length
        points = origin + middle[:, None] * towards
        return points, densities(np.linalg.norm(points, axis=-1) - radius), length / steps

    mu = direction @ sun
    phase = np.array(
        (
            3.0 / (16.0 * np.pi) * (1.0 + mu**2),
            3.0 * (1 - 0.76**2) * (1 + mu**2) / (8 * np.pi * (2 + 0.76**2) * (1 + 0.76**2 - 2 * 0.76 * mu) ** 1.5),
        )
    )
    scatters = np.stack([single._RAYLEIGH, np.full(21, 2e-5)])
    takes = np.stack([single._RAYLEIGH, np.full(21, 2.22e-5), single._OZONE])
    points, density, step = path(np.array((0.0, 0.0, radius + 1.0)), direction)
    before = np.cumsum(density, axis=0) * step
    total = np.zeros(21)
    for point, here, depth in zip(points, density, before, strict=True):
        _, beyond, stride = path(point, sun)
        reaches = np.exp(-(depth + beyond.sum(axis=0) * stride) @ takes)
        total += reaches * ((phase * here[:2]) @ scatters) * step
    return 20.0 * (total * single._SUNLIGHT) @ single._MATCHING @ XYZ_TO_RGB.T


@pytest.mark.parametrize("elevation", (0.2, 0.8))
@pytest.mark.parametrize("row, column", [(250, 127), (200, 60), (175, 100), (190, 3)])
def test_single_scattering(elevation, row, column):
    """Cycles takes 32 steps, and so do we: they lose some percent, more towards the horizon."""
    table = sky.single_scattering(elevation, **DAY)
    sun = np.array((np.cos(elevation), 0.0, np.sin(elevation)))
    direction = directions(elevations(np.array([row - 0.5])))[0, column]
    np.testing.assert_allclose(table[row, column], scattered_once(direction, sun), rtol=0.08)


def test_sunlight_is_the_solar_constant():
    """Of a black body's light of 5778 K 48.7% is between 370 and 790 nm."""
    assert 20.0 * single._SUNLIGHT.sum() == pytest.approx(0.487 * 1361.0, rel=0.01)


def test_the_disc_gives_the_sunlight_that_reaches_the_ground():
    for model in (sky.single_scattering_sun, sky.multiple_scattering_sun):
        lower, upper = model(1.2, 0.0047, 0.0, 1.0, 1.0, 1.0)
        illuminance = 683.0 * ((lower + upper) / 2.0 @ LUMINANCE) * 2.0 * np.pi * (1.0 - np.cos(0.0047))
        assert 6e4 < illuminance < 1.3e5  # lux
        assert (upper > lower).all() and lower[0] > lower[2]
        small, large = (model(1.2, size, 0.0, 1.0, 1.0, 1.0).mean(axis=0) for size in (0.002, 0.02))
        assert np.allclose(small / large, 100.0, rtol=1e-2)


def test_a_sun_that_has_set_is_black():
    assert not sky.single_scattering_sun(-0.1, 0.01, *DAY.values()).any()


@pytest.mark.parametrize("model", (sky.single_scattering, sky.multiple_scattering))
def test_a_blue_sky_that_reddens(model):
    noon, evening = (model(elevation, **DAY) for elevation in (1.0, 0.02))
    zenith, beside_sun = (250, 10), (ROWS // 2 + 3, COLUMNS // 2)
    assert noon.shape == (ROWS, COLUMNS, 3) and noon.dtype == np.float32 and np.isfinite(noon).all()
    assert noon[zenith][2] > 1.5 * noon[zenith][0]
    assert evening[beside_sun][0] > 2.0 * evening[beside_sun][2]
    assert np.array_equal(noon, noon[:, ::-1])
    without = model(1.0, **(DAY | {"air": 0.0, "aerosol": 0.0}))
    assert np.abs(without).max() < 1e-3


def test_a_horizon_sinks_with_altitude():
    assert sky.horizon(0.0) == 0.0
    assert np.degrees(sky.horizon(10000.0)) == pytest.approx(-3.2, abs=0.05)


def test_preetham():
    """Luminance at the zenith is what the paper gives, and brightest is where the sun is."""
    turbidity, elevation = 3.0, 0.7
    table = sky.preetham_table(elevation, turbidity)
    chi = (4.0 / 9.0 - turbidity / 120.0) * 2.0 * elevation
    kilocandela = (4.0453 * turbidity - 4.9710) * np.tan(chi) - 0.2155 * turbidity + 2.4192
    assert table[-1, 0] @ LUMINANCE == pytest.approx(0.06 * kilocandela, rel=0.02)
    above = table[ROWS // 2 + 40 :] @ LUMINANCE
    row, column = np.unravel_index(above.argmax(), above.shape)
    assert elevations(row + ROWS // 2 + 40) == pytest.approx(elevation, abs=0.05)
    assert column in (COLUMNS // 2 - 1, COLUMNS // 2)
