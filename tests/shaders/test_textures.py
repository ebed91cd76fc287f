"""Procedural textures against float64: hashes as they were published, noise corner by corner, cells by brute force.

That they are Blender's is what the table of comparisons with Cycles tests.
"""

from itertools import product

import numpy as np
import pytest

from . import harness

N = 4_000
MASK = np.uint64(0xFFFFFFFF)


@pytest.fixture
def places():
    """Places (n, 4) float32 of either sign, many cells wide."""
    return np.random.default_rng(7).uniform(-40.0, 40.0, (N, 4)).astype(np.float32)


def made(device, call, places, numbers=(0.0, 0.0, 0.0, 0.0), features=()):
    """What GLSL makes of places `a` and numbers `b`: value, color, position (n, 4) float64 each."""
    columns = [*places.T, *np.broadcast_to(numbers, (len(places), 4)).T]
    outputs = ("out_value", "out_color", "out_position")
    drawn = harness.run_values(
        device, "texture_frag.glsl", *columns, constants={"TEST_CALL": call}, outputs=outputs, features=features
    )
    return [result.astype(np.float64) for result in drawn]


def rotated(x, bits):
    return ((x << np.uint64(bits)) | (x >> np.uint64(32 - bits))) & MASK


def lookup3(*words):
    """Jenkins' hash of arrays of one to four words, in 64 bits."""
    words = [np.asarray(word, np.uint64) & MASK for word in words]
    start = np.uint64(0xDEADBEEF + 4 * len(words) + 13)
    state = [np.broadcast_to(start, words[0].shape).copy() for _ in range(3)]
    for i, word in enumerate(words[:3]):
        state[i] = (state[i] + word) & MASK
    if len(words) > 3:
        for turn, bits in enumerate((4, 6, 8, 16, 19, 4)):
            a, b, c = turn % 3, (turn + 1) % 3, (turn + 2) % 3
            state[a] = ((state[a] - state[c]) & MASK) ^ rotated(state[c], bits)
            state[c] = (state[c] + state[b]) & MASK
        state[0] = (state[0] + words[3]) & MASK
    for turn, bits in enumerate((14, 11, 25, 16, 4, 14, 24)):
        x, y = (turn + 2) % 3, (turn + 1) % 3
        state[x] = ((state[x] ^ state[y]) - rotated(state[y], bits)) & MASK
    return state[2]


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_lookup3(device, places, count):
    arguments = ", ".join(f"a.{axis * 4}" for axis in "xyzw"[:count])
    drawn, *_ = made(device, f"hash_numbers({arguments})", places)
    words = [column.view(np.uint32) for column in np.ascontiguousarray(places.T)[:count]]
    np.testing.assert_allclose(drawn, np.repeat(lookup3(*words)[:, None] / 2.0**32, 4, axis=1), atol=1e-6)


def pcg(cells):
    """PCG of whole numbers (n, 2 to 4) as numbers from 0 to 1, with the int32 arithmetic of Blender."""
    with np.errstate(over="ignore"):
        v = cells.astype(np.int32) * np.int32(1664525) + np.int32(1013904223)
        factors = {2: ((1, None), (0, None)), 3: ((1, 2), (2, 0), (0, 1)), 4: ((1, 3), (2, 0), (0, 1), (1, 2))}[
            v.shape[1]
        ]
        for last in (False, True):
            for axis, (i, k) in enumerate(factors):
                v[:, axis] += v[:, i] * (np.int32(1664525) if k is None else v[:, k])
            v = v if last else v ^ (v >> 16)
    return (v & np.int32(0x7FFFFFFF)) / 2147483647.0


@pytest.mark.parametrize("size", [2, 3, 4])
def test_pcg(device, places, size):
    fill = {2: ", 0.0, 0.0", 3: ", 0.0", 4: ""}[size]
    drawn, *_ = made(device, f"vec4(hash_pcg(ivec{size}(floor(a.{'xyzw'[:size]}))){fill})", places)
    np.testing.assert_allclose(drawn[:, :size], pcg(np.floor(places[:, :size])), atol=1e-6)


SCALES = {1: 0.25, 2: 0.6616, 3: 0.982, 4: 0.8344}


def gradient(hashed, way):
    """The slope (n,) that a corner's hash gives to the way (n, d) from it."""
    dimensions = way.shape[1]
    if dimensions == 1:
        return np.where(hashed & 8, -1.0, 1.0) * (1 + (hashed & 7)) * way[:, 0]
    h = (hashed & {2: 7, 3: 15, 4: 31}[dimensions]).astype(np.int64)
    x, y, z, w = (*way.T, *[None] * 4)[:4]
    if dimensions == 2:
        parts = [np.where(h < 4, x, y), 2.0 * np.where(h < 4, y, x)]
    elif dimensions == 3:
        parts = [np.where(h < 8, x, y), np.where(h < 4, y, np.where((h == 12) | (h == 14), x, z))]
    else:
        parts = [np.where(h < 24, x, y), np.where(h < 16, y, z), np.where(h < 8, z, w)]
    return sum(np.where(h & (1 << i), -part, part) for i, part in enumerate(parts))


def perlin(p):
    """Perlin's noise at places (n, d) float64: the corners' slopes, weighted."""
    cell = np.floor(p)
    within = p - cell
    faded = within**3 * (within * (6.0 * within - 15.0) + 10.0)
    total = 0.0
    for corner in product((0, 1), repeat=p.shape[1]):
        words = (cell + corner).astype(np.int64).astype(np.uint64)
        weight = np.prod(np.where(corner, faded, 1.0 - faded), axis=1)
        total = total + weight * gradient(lookup3(*words.T), within - corner)
    return SCALES[p.shape[1]] * total


CALLS = {1: "1d(a.w", 2: "2d(a.xy", 3: "3d(a.xyz", 4: "4d(a.xyz, a.w"}


def axes(places, dimensions):
    """The places (n, dimensions) that a function of so many takes."""
    return places[:, 3:] if dimensions == 1 else places[:, :dimensions]


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_octaves_of_noise(device, places, dimensions):
    """Their sum, as GLSL has it at a place and at those that the other channels look at: not the same ones."""
    call = f"vec4(noise_texture_{CALLS[dimensions]}, 1.0, 1.5, 0.6, 2.0, 0.0, 1.0, 0.0, NOISE_FBM, false, 3, color))"
    value, color, _ = made(device, call, places)
    p = axes(places, dimensions).astype(np.float64)
    octaves = perlin(p) + 0.6 * perlin(2.0 * p) + 0.5 * 0.36 * perlin(4.0 * p)
    np.testing.assert_allclose(value[:, 0], octaves, atol=5e-5)
    np.testing.assert_allclose(color[:, 0], octaves, atol=5e-5)
    assert np.abs(np.corrcoef(color[:, :3].T) - np.eye(3)).max() < 0.1
    assert color[:, :3].std(axis=0) == pytest.approx([octaves.std()] * 3, rel=0.1)


def neighbors(p, reach=2):
    """The points (m, n, d) of the cells around places (n, d), after Blender 5.0's hash."""
    cell = np.floor(p)
    offsets = product(range(-reach, reach + 1), repeat=p.shape[1])
    return np.stack([cell + offset + pcg(cell + offset) for offset in offsets])


def metric_length(way, metric):
    size = np.abs(way)
    exponents = {"EUCLIDEAN": 2.0, "MANHATTAN": 1.0, "MINKOWSKI": 3.0}
    if metric == "CHEBYCHEV":
        return size.max(axis=-1)
    return (size ** exponents[metric]).sum(axis=-1) ** (1.0 / exponents[metric])


def voronoi(dimensions, feature, metric="EUCLIDEAN"):
    numbers = (
        "1.0, 0.0, 0.5, 2.0, 1.0, 3.0, 1.0"  # scale, detail, roughness, lacunarity, smoothness, exponent, randomness
    )
    settings = f"VORONOI_{feature}, VORONOI_{metric}, false"
    return f"vec4(voronoi_texture_{CALLS[dimensions]}, {numbers}, {settings}, color, position))"


@pytest.mark.parametrize("metric", ["EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI"])
@pytest.mark.parametrize("dimensions", [2, 3, 4])
def test_nearest_points(device, places, dimensions, metric):
    """First and second among the cells that Blender looks at, those next to a place."""
    places = places[:1000]
    p = axes(places, dimensions).astype(np.float64)
    points = neighbors(p, reach=1)
    away = metric_length(points - p, metric)
    nearest = np.argsort(away, axis=0)[:2]
    for rank, feature in enumerate(("F1", "F2")):
        value, _, position = made(device, voronoi(dimensions, feature, metric), places)
        found = np.take_along_axis(points, nearest[rank][None, :, None], axis=0)[0]
        np.testing.assert_allclose(value[:, 0], np.sort(away, axis=0)[rank], atol=2e-5)
        clear = np.diff(np.sort(away, axis=0)[:3], axis=0).min(axis=0) > 1e-4
        np.testing.assert_allclose(position[clear, :dimensions], found[clear], atol=2e-5)


@pytest.mark.parametrize("dimensions", [2, 3])
def test_edges_and_balls(device, places, dimensions):
    """From the plane halfway between two points, and from the nearest point to the next one."""
    p = axes(places, dimensions).astype(np.float64)
    points = neighbors(p, reach=1)
    away = np.linalg.norm(points - p, axis=-1)
    nearest = np.take_along_axis(points, away.argmin(axis=0)[None, :, None], axis=0)[0]
    across = points - nearest
    length = np.linalg.norm(across, axis=-1)
    with np.errstate(invalid="ignore"):
        planes = ((0.5 * (points + nearest) - p) * across).sum(axis=-1) / length
    edge = np.where(length > 0.01, planes, np.inf).min(axis=0)
    value, *_ = made(device, voronoi(dimensions, "EDGE"), places)
    np.testing.assert_allclose(value[:, 0], edge, atol=5e-5)
    others = np.linalg.norm(neighbors(nearest, reach=1) - nearest, axis=-1)
    value, *_ = made(device, voronoi(dimensions, "RADIUS"), places)
    np.testing.assert_allclose(value[:, 0], 0.5 * np.sort(others, axis=0)[1], atol=5e-5)


def test_smooth_cells_are_close_to_sharp_ones(device, places):
    """They differ most where points are equally far; with no smoothness they are the same."""
    sharp, *_ = made(device, voronoi(3, "F1"), places)
    smooth, *_ = made(device, voronoi(3, "SMOOTH_F1").replace("2.0, 1.0,", "2.0, 0.05,"), places)
    none, *_ = made(device, voronoi(3, "SMOOTH_F1").replace("2.0, 1.0,", "2.0, 0.0,"), places)
    np.testing.assert_allclose(none, sharp, atol=1e-6)
    assert 1e-4 < (sharp - smooth)[:, 0].max() < 0.05 and (smooth - sharp).max() < 1e-5


def test_old_hash_scatters_other_points(device, places):
    new, *_ = made(device, voronoi(3, "F1"), places)
    old, *_ = made(device, voronoi(3, "F1").replace("_texture_", "_lookup3_"), places, features={"VORONOI_LOOKUP3"})
    assert abs(new[:, 0].mean() - old[:, 0].mean()) < 0.02
    assert abs(np.corrcoef(new[:, 0], old[:, 0])[0, 1]) < 0.1


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_nothing_is_computed_of_zeros(device, dimensions):
    """What a material without the texture passes: all zero, and so are the results."""
    nothing = np.zeros((8, 4), np.float32)
    zeros = "0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0"
    for name, results in (("noise", "0, false, 0, color"), ("voronoi", "0, 0, false, color, position")):
        call = f"vec4({name}_texture_{CALLS[dimensions]}, {zeros}, {results}))"
        assert not any(result.any() for result in made(device, call, nothing))


@pytest.mark.parametrize("dimensions", [2, 3])
def test_gabor_noise_is_even(device, places, dimensions):
    """Its mean is 1/2, its deviation that of waves of random phases; phase and intensity are those of its phasor."""
    direction = {2: "0.6", 3: "vec3(0.6, 0.0, 0.8)"}[dimensions]
    call = f"vec4(gabor_texture_{CALLS[dimensions]}, 1.0, 2.0, 1.0, {direction}, 8, color.x, color.y))"
    value, color, _ = made(device, call, places)
    r = np.linspace(0.0, 1.0, 10_001)
    bell = np.exp(-np.pi * r**2) * (0.5 + 0.5 * np.cos(np.pi * r**2))
    variance = 8 * 0.5 * np.trapezoid(bell**2 * {2: 2.0 * np.pi * r, 3: 4.0 * np.pi * r**2}[dimensions], r)
    deviation = np.sqrt(variance) / (12.0 * {2: 1.0, 3: 2.0**-0.25}[dimensions])
    assert value[:, 0].mean() == pytest.approx(0.5, abs=0.01)
    assert value[:, 0].std() == pytest.approx(deviation, rel=0.05)
    phase, intensity = 2.0 * np.pi * (color[:, 0] - 0.5), color[:, 1]
    np.testing.assert_allclose(intensity * np.sin(phase), 2.0 * value[:, 0] - 1.0, atol=1e-5)
