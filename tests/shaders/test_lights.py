"""Samples in the square, and lights of every shape: what they give in the mean against closed forms in float64."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine import Light
from addon.engine.light_packing import pack_lights

from . import harness, shapes

COLOR = np.array([1.0, 2.0, 3.0])


def samples(device, pixel_x, pixel_y, index, dimension):
    """`sampling_2d` (n, 2) for columns that are broadcast to n."""
    columns = [column.ravel() for column in np.broadcast_arrays(pixel_x, pixel_y, index, dimension)]
    zero = np.zeros(len(columns[0]))
    (found,) = harness.run_values(device, "sampling_frag.glsl", *columns, *[zero] * 4)
    return found[:, :2].astype(np.float64)


@pytest.mark.parametrize("pixel", [(0, 0), (1, 0), (0, 1), (1919, 1079)])
@pytest.mark.parametrize("dimension", [0, 1, 77])
def test_the_first_samples_are_stratified_in_every_way(device, pixel, dimension):
    """One of 2^n samples in each of the boxes of 2^-k by 2^(k-n), for all k: a (0, n, 2) net."""
    for n in (4, 8):
        found = samples(device, *pixel, np.arange(1 << n), dimension)
        assert (found >= 0.0).all() and (found < 1.0).all()
        for k in range(n + 1):
            boxes = (found * [1 << k, 1 << (n - k)]).astype(int)
            assert len(np.unique(boxes, axis=0)) == 1 << n, (n, k)


def test_pixels_and_dimensions_are_independent(device):
    """Over 4096 pixels: a sample is anywhere, whatever it is elsewhere; 0.08 is five standard deviations."""
    x, y = (axis.ravel() for axis in np.mgrid[:64, :64])
    here = samples(device, x, y, 5, 2)
    assert np.histogram2d(*here.T, bins=4, range=[(0, 1), (0, 1)])[0] == pytest.approx(256, rel=0.3)
    others = [samples(device, x + 1, y, 5, 2), samples(device, x, y + 1, 5, 2), samples(device, x, y, 5, 3)]
    for other in others:
        assert np.abs(np.corrcoef(np.column_stack([here, other]).T)[:2, 2:]).max() < 0.08
    assert not np.array_equal(here, samples(device, x, y, 5, 3))


def seen(device, light, points, u=None):
    """Radiance (n, 3), range (n,), direction (n, 3), position (n, 3) of a light from points (n, 3), by `u` (n, 2) or
    from its middle."""
    records, extents = pack_lights([light], np.zeros(3))
    points = np.asarray(points, np.float64)
    u_columns = np.zeros((2, len(points))) if u is None else u.T
    radiance, direction, position = harness.run_values(
        device,
        "light_shape_frag.glsl",
        np.zeros(len(points)),
        *u_columns,
        np.full(len(points), u is not None),
        *points.T,
        textures={"tables": harness.texels(records, extents)},
        features={"HAS_LIGHT_SHAPES"},
        outputs=("out_radiance", "out_direction", "out_position"),
        frame=harness.frame_record(light_shape_first=records.nbytes // 16),
    )
    values = radiance[:, :3], radiance[:, 3], direction[:, :3], position[:, :3]
    return tuple(value.astype(np.float64) for value in values)


def irradiance(device, light, point, normal, count=128):
    """What a light gives a surface at a point in the mean, over pi, (3,)."""
    u = (np.stack(np.meshgrid(*[np.arange(count)] * 2), axis=-1).reshape(-1, 2) + 0.5) / count
    radiance, _, direction, _ = seen(device, light, np.tile(point, (len(u), 1)), u)
    return (radiance * np.maximum(direction @ np.asarray(normal, np.float64), 0.0)[:, None]).mean(axis=0)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
@pytest.mark.parametrize("radius", [1e-3, 0.5, 0.99])
def test_balls(device, radius, scale):
    """Outside, facing it: as of a point (a soft one: of its disc); inside: radiance from everywhere."""
    center, watts = np.array([0.3, -0.2, 0.9]) * scale, np.pi**2 * 4.0 * scale**2
    ball = Light.point(center, watts, COLOR, radius=radius * scale)
    facing = np.array([0.48, 0.6, -0.64])
    point = center - facing * scale
    assert irradiance(device, ball, point, facing) == pytest.approx(COLOR, rel=2e-3)
    soft = replace(ball, soft=True)
    assert irradiance(device, soft, point, facing) == pytest.approx(COLOR / (1.0 + radius**2), rel=2e-3)
    for light, expected in ((ball, COLOR), (soft, COLOR / (1.0 + radius**2))):
        assert seen(device, light, [point])[0][0] == pytest.approx(expected, rel=1e-5)
    within = center + 0.9 * radius * scale * facing
    for normal in (facing, -facing):
        assert irradiance(device, ball, within, normal) == pytest.approx(COLOR / radius**2, rel=1e-2)


def test_samples_lie_on_the_ball_s_side_that_is_seen(device):
    rng = np.random.default_rng(0)
    ball = Light.point((1.0, 2.0, 3.0), 1.0, radius=0.7)
    points = shapes.single(rng.normal(size=(4000, 3)) * 10.0)
    u = rng.uniform(size=(4000, 2))
    _, distance, direction, position = seen(device, ball, points, u)
    outward = position - ball.position
    assert np.linalg.norm(outward, axis=-1) == pytest.approx(0.7, rel=1e-5)
    assert np.allclose(points + distance[:, None] * direction, position, atol=1e-5)
    outside = np.linalg.norm(points - ball.position, axis=-1) > 0.7
    assert ((outward * direction).sum(axis=-1)[outside] < 2e-3).all() and outside.sum() > 3900


@pytest.mark.parametrize("angle", [1e-3, 0.2, 2.0, 3.1])
def test_suns(device, angle):
    towards = np.array([0.6, 0.0, 0.8])
    sun = Light.sun(towards, np.pi, COLOR, angle=angle)
    assert irradiance(device, sun, (5.0, 6.0, 7.0), towards) == pytest.approx(COLOR, rel=2e-3)
    u = np.random.default_rng(1).uniform(size=(1000, 2))
    radiance, distance, direction, _ = seen(device, sun, np.zeros((1000, 3)), u)
    # Of the same radiance everywhere: L = E / (pi sin^2 h), over a solid angle of 2 pi (1 - cos h).
    expected = COLOR / np.sin(angle / 2.0) ** 2 * 2.0 * (2.0 * np.sin(angle / 4.0) ** 2)
    assert radiance == pytest.approx(np.tile(expected, (1000, 1)), rel=1e-4) and (distance > 1e29).all()
    off = 2.0 * np.arcsin(np.minimum(np.linalg.norm(direction - towards, axis=-1) / 2.0, 1.0))
    assert off.max() == pytest.approx(angle / 2.0, rel=0.01) and off.max() < angle / 2.0 * (1 + 1e-3) + 1e-6
    assert (seen(device, sun, np.zeros((1, 3)))[0] == np.float32(sun.color)).all()


def corner_factor(a, b):
    """Form factor from a point to a rectangle a x b at distance 1, parallel to it, with a corner straight above; odd in
    both (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3)."""
    x, y = np.sqrt(1.0 + a * a), np.sqrt(1.0 + b * b)
    return (a / x * np.arctan(b / x) + b / y * np.arctan(a / y)) / (2.0 * np.pi)


@pytest.mark.parametrize("place", [(0.0, 0.0), (0.9, -0.4), (3.0, 2.0)])
@pytest.mark.parametrize("sides", [(1.0, 1.0), (0.2, 3.0), (1e-3, 1e-3)])
def test_rectangles_give_what_their_form_factor_says(device, sides, place):
    height, (width, depth) = 0.8, sides
    light = Light.area((*place, height), (width, 0, 0), (0, depth, 0), np.pi, COLOR, direction=(0, 0, -1))
    x0, x1 = ((place[0] + side * width / 2.0) / height for side in (-1.0, 1.0))
    y0, y1 = ((place[1] + side * depth / 2.0) / height for side in (-1.0, 1.0))
    factor = corner_factor(x1, y1) - corner_factor(x0, y1) - corner_factor(x1, y0) + corner_factor(x0, y0)
    radiance = COLOR / (width * depth)  # watts / (pi area)
    assert irradiance(device, light, (0, 0, 0), (0, 0, 1)) == pytest.approx(radiance * factor, rel=2e-3)
    assert (seen(device, light, [(0.0, 0.0, 2 * height)])[0] == 0.0).all(), "it shines to one side"


@pytest.mark.parametrize("radius", [0.01, 0.5, 3.0])
def test_discs_give_what_their_form_factor_says(device, radius):
    height = 1.3
    side = 2.0 * radius
    light = Light.area((1, 2, 3), (0, side, 0), (0, 0, side), np.pi, COLOR, shape="ELLIPSE")
    expected = COLOR / (np.pi * radius**2) * radius**2 / (radius**2 + height**2)
    assert irradiance(device, light, (1 + height, 2, 3), (-1, 0, 0)) == pytest.approx(expected, rel=2e-3)
    assert seen(device, light, [(1 + height, 2.0, 3.0)])[0][0] == pytest.approx(expected, rel=1e-5), "the middle's too"


@pytest.mark.parametrize("spread", [np.pi, 2.0, 1.0, 0.1])
@pytest.mark.parametrize("shape", ["RECTANGLE", "ELLIPSE"])
def test_area_lights_give_off_their_watts(device, shape, spread):
    """All that goes through a plane close to a light of any spread, however it is stretched: its watts."""
    light = Light.area((0, 0, 0), (2.0, 0, 0), (0.6, 0.5, 0), np.pi, COLOR, shape=shape, spread=spread)
    light = replace(light, axes=((1.0, 0.0, 0.0), (0.0, 0.25, 0.0), (0.0, 0.0, 1.0)))
    rng = np.random.default_rng(2)
    # The watts of pi: through a plane at height h, places chosen as evenly bright light would fall on it.
    count, height = 400_000, 0.5
    u, tangent = rng.uniform(size=(count, 2)), np.tan(np.minimum(spread / 2.0, 1.5))
    reach = height * tangent + np.array([1.0, 0.25])
    points = np.column_stack([rng.uniform(-1.0, 1.0, (count, 2)) * reach, np.full(count, height)])
    if spread > 1.5:  # far places matter: measured by direction instead
        z = rng.uniform(np.cos(min(spread / 2.0, np.pi / 2.0)), 1.0, count)
        azimuth = rng.uniform(0.0, 2.0 * np.pi, count)
        across = np.sqrt(1.0 - z * z)
        distance = 300.0
        points = distance * np.column_stack([across * np.cos(azimuth), across * np.sin(azimuth), z])
        radiance, *_ = seen(device, light, points, u)
        watts = np.pi * radiance.mean(axis=0) * 2.0 * np.pi * (1.0 - np.cos(spread / 2.0)) * distance**2
    else:
        radiance, _, direction, _ = seen(device, light, points, u)
        watts = np.pi * (radiance * -direction[:, 2:]).mean(axis=0) * 4.0 * reach.prod()
    assert watts == pytest.approx(np.pi * COLOR, rel=0.02)


def test_spots_are_cones_of_cycles_form(device):
    """Smooth in the cosine, between the cone's edge and a part of the way to its axis, in round space."""
    rng = np.random.default_rng(3)
    axes = rng.normal(size=(3, 3))
    angle, blend = 2.0, 0.3
    spot = Light.spot((1, 2, 3), None, 4.0 * np.pi**2, angle, blend, COLOR, axes=axes)
    points = shapes.single(rng.normal(size=(5000, 3)) * 3.0 + [1, 2, 3])
    radiance, distance, _, _ = seen(device, spot, points)
    offset = points - [1, 2, 3]
    local = offset @ axes.T
    cosine, edge = local[:, 2] / np.linalg.norm(local, axis=-1), np.cos(angle / 2.0)
    x = np.clip((cosine - edge) / ((1.0 - edge) * blend), 0.0, 1.0)
    expected = (3.0 * x**2 - 2.0 * x**3)[:, None] * COLOR / (offset**2).sum(axis=-1, keepdims=True)
    assert np.allclose(radiance, expected, rtol=1e-3, atol=1e-5 / distance[:, None] ** 2)
    assert 0.05 < np.mean((x > 0.0) & (x < 1.0)) and np.mean(x == 1.0) > 0.05
    hard, _, _, _ = seen(device, replace(spot, blend=0.0), points)
    clear = np.abs(cosine - edge) > 1e-5
    assert ((hard[:, 0] > 0.0) == (cosine > edge))[clear].all()


@pytest.mark.parametrize("kind", ["point", "spot", "area"])
def test_what_does_not_fall_off_is_as_bright_everywhere_as_at_distance_1(device, kind):
    light = {
        "point": Light.point((0, 0, 0), 1.0, COLOR, radius=0.1),
        "spot": Light.spot((0, 0, 0), (0, 0, 1), 1.0, 1.0, 0.5, COLOR),
        "area": Light.area((0, 0, 0), (1e-3, 0, 0), (0, 1e-3, 0), 1.0, COLOR),
    }[kind]
    radiance, *_ = seen(device, replace(light, falls_off=False), [(0, 0, 1.0), (0, 0, 5.0), (0, 0, 1e3)])
    assert radiance == pytest.approx(np.tile(light.color, (3, 1)), rel=1e-4)
