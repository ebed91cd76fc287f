"""The world as a light against integrals in float64: its map, directions by chance, spherical harmonics."""

import numpy as np
import pytest

from addon.engine import layout
from addon.engine.world_light import WorldLight, directions, irradiance

from . import harness

SIDE = 64
UP = np.array([0.0, 0.0, 1.0])


def radiance_map(kind, side=SIDE):
    """A map (side, side, 3) of a world."""
    towards = directions(side)
    if kind == "white":
        return np.ones((side, side, 3))
    if kind == "gradient":
        return np.stack([1.0 + towards[..., 0], np.exp(towards[..., 1]), (1.0 + towards[..., 2]) ** 2], axis=-1)
    sun = np.array([0.48, 0.6, 0.64])
    sky = 0.2 + 0.1 * towards[..., 2:]
    return np.broadcast_to(sky, towards.shape) + 2000.0 * (towards @ sun > 0.999)[..., None]


def asked(device, light, normals, behind=0.0, u=None, share=None):
    """What `world_light_frag.glsl` says for normals (n, 3) and u (n, 2): four columns (n, 4) float64."""
    normals = np.broadcast_to(np.asarray(normals, np.float64), (len(normals) if u is None else len(u), 3))
    u = np.full((len(normals), 2), 0.5) if u is None else u
    frame = dict(light.frame)
    if share is not None:
        frame["world_cosine_share"] = share
    columns = harness.run_values(
        device,
        "world_light_frag.glsl",
        *u.T,
        *np.zeros((2, len(u))),
        *normals.T,
        np.full(len(u), behind),
        textures={"world_light": light.texels},
        features={"HAS_WORLD_LIGHT", "HAS_HEMISPHERE_LIGHT"},
        outputs=("out_direction", "out_bright", "out_hemisphere", "out_mapped"),
        frame=harness.frame_record(**frame),
    )
    return [column.astype(np.float64) for column in columns]


def grid(side):
    """Points (side^2, 2) in the middle of the cells of a square."""
    place = (np.arange(side) + 0.5) / side
    return np.stack(np.meshgrid(place, place), axis=-1).reshape(-1, 2)


def seen(radiance, towards):
    """The radiance (n, 3) of a map in directions (n, 3), by the formulas of the map turned round."""
    x, y, z = towards.T
    radius = np.sqrt(np.maximum(1.0 - np.abs(z), 0.0))
    turn = np.arctan2(np.abs(y), np.abs(x)) * 2.0 / np.pi
    place = np.stack([radius * (1.0 - turn), radius * turn])
    place = np.where(z < 0.0, 1.0 - place[::-1], place)
    column, row = np.clip((0.5 + 0.5 * np.copysign(place, [x, y])) * len(radiance), 0, len(radiance) - 1).astype(int)
    return radiance[row, column]


def some_directions(count, seed):
    towards = np.random.default_rng(seed).normal(size=(count, 3))
    return towards / np.linalg.norm(towards, axis=-1, keepdims=True)


def test_the_map_of_directions_has_an_inverse_and_equal_areas(device):
    towards = np.concatenate([some_directions(5000, 1), np.eye(3), -np.eye(3)])
    *_, mapped = asked(device, WorldLight.of_map(radiance_map("white")), towards)
    assert np.abs(mapped[:, :3] - towards).max() < 2e-6
    cells = directions(128)
    assert np.linalg.norm(cells, axis=-1) == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(np.einsum("yxi,yxj->ij", cells, cells) / 128**2, np.eye(3) / 3.0, atol=1e-4)
    assert np.abs(cells.mean(axis=(0, 1))).max() < 1e-12


@pytest.mark.parametrize("kind", ["white", "gradient"])
def test_bright_directions_are_as_dense_as_the_world_is_bright(device, kind):
    """Their moments are those of the luminance, twenty of them up to the third order."""
    radiance = radiance_map(kind)
    _, bright, *_ = asked(device, WorldLight.of_map(radiance), UP[None], u=grid(256))
    powers = np.array([p for p in np.ndindex(4, 4, 4) if sum(p) <= 3])
    luminance = (radiance @ (0.2126, 0.7152, 0.0722)).ravel()
    cells = directions(SIDE).reshape(-1, 1, 3)
    wanted = luminance @ np.prod(cells**powers, axis=-1) / luminance.sum()
    found = np.prod(bright[:, None, :3] ** powers, axis=-1).mean(axis=0)
    np.testing.assert_allclose(found, wanted, atol=3e-3)


@pytest.mark.parametrize("behind", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("share", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("kind", ["white", "gradient", "sun"])
def test_the_mean_over_directions_is_the_irradiance(device, kind, share, behind):
    """For surfaces that face any way: white from the front, half as white from behind."""
    radiance, u = radiance_map(kind), grid(256)
    light = WorldLight.of_map(radiance)
    cells, flat = directions(SIDE).reshape(-1, 3), radiance.reshape(-1, 3)
    for normal in some_directions(4, 3):
        direction, *_ = asked(device, light, normal[None], behind, u, share)
        cosine = direction[:, :3] @ normal
        arriving = seen(radiance, direction[:, :3])[:, 1] * direction[:, 3]
        front = np.mean(arriving * np.maximum(cosine, 0.0))
        back = np.mean(arriving * np.maximum(-cosine, 0.0))
        wanted = [4.0 * np.mean(flat[:, 1] * np.maximum(side * (cells @ normal), 0.0)) for side in (1.0, -1.0)]
        near = 0.02 * sum(wanted) + (0.5 * max(wanted) if kind == "sun" and share == 1.0 else 0.0)
        if behind < 1.0 or share < 1.0:
            assert front == pytest.approx(wanted[0], abs=near)
        if behind > 0.0 or share < 1.0:
            assert back == pytest.approx(wanted[1], abs=near)


def test_a_white_world_has_no_noise_and_a_sun_little(device):
    u = grid(64)
    white = WorldLight.of_map(radiance_map("white"))
    assert white.frame["world_cosine_share"] == 1.0
    direction, *_ = asked(device, white, UP[None], u=u)
    assert direction[:, 3] * direction[:, 2] == pytest.approx(1.0, rel=1e-4)
    sun = WorldLight.of_map(radiance_map("sun"))
    spread = []
    for share in (None, 1.0):
        direction, *_ = asked(device, sun, UP[None], u=u, share=share)
        light = seen(radiance_map("sun"), direction[:, :3])[:, 1]
        arriving = light * direction[:, 3] * np.maximum(direction[:, 2], 0.0)
        spread.append(arriving.std() / arriving.mean())
    assert spread[0] < 0.9 < 10.0 < spread[1]


@pytest.mark.parametrize("kind", ["white", "gradient", "sun"])
def test_the_hemisphere_is_the_projection_on_spherical_harmonics(device, kind):
    """Against sums of the nine real harmonics over the map, and the convolution's factors 1, 2/3, 1/4."""
    radiance, normals = radiance_map(kind), some_directions(200, 5)
    *_, hemisphere, _ = asked(device, WorldLight.of_map(radiance), normals)

    def harmonics(d):
        x, y, z = np.moveaxis(d, -1, 0)
        one = np.full_like(x, 0.282094791773878)
        linear = [0.488602511902920 * a for a in (y, z, x)]
        mixed = [1.092548430592079 * a for a in (x * y, y * z, x * z)]
        return np.stack(
            [one, *linear, *mixed, 0.315391565252520 * (3 * z * z - 1), 0.546274215296040 * (x * x - y * y)]
        )

    projected = np.einsum("kyx,yxc->kc", harmonics(directions(SIDE)), radiance) * 4.0 * np.pi / SIDE**2
    factors = np.array([1.0] + [2.0 / 3.0] * 3 + [0.25] * 5)
    wanted = np.einsum("kn,kc,k->nc", harmonics(normals), projected, factors)
    np.testing.assert_allclose(hemisphere[:, :3], np.maximum(wanted, 0.0), rtol=1e-4, atol=1e-5 * wanted.max())


def test_the_hemisphere_of_a_smooth_world_is_its_irradiance(device):
    radiance, normals = radiance_map("gradient", 128), some_directions(50, 6)
    *_, hemisphere, _ = asked(device, WorldLight.of_map(radiance), normals)
    cosine = np.maximum(normals @ directions(128).reshape(-1, 3).T, 0.0)
    wanted = 4.0 * cosine @ radiance.reshape(-1, 3) / 128**2
    np.testing.assert_allclose(hemisphere[:, :3], wanted, rtol=0.03)


def test_a_black_world_is_known_as_such():
    assert WorldLight.of_map(np.zeros((8, 8, 3))).is_black
    assert not WorldLight.of_map(np.full((8, 8, 3), 1e-6)).is_black
    assert set(irradiance(np.ones((8, 8, 3)))) <= {field.name for field in layout.FRAME.fields}
