"""Images by uv, and the projections that give it, against numpy."""

import numpy as np
import pytest

from addon.engine.image import EXTENSIONS, INTERPOLATIONS, Image
from addon.engine.image_file import srgb_to_linear
from addon.engine.image_packing import pack_images

from . import harness, shapes

OUTPUTS = ("out_color", "out_tile", "out_round", "out_cube", "out_box")
PINK = (1.0, 0.0, 1.0, 1.0)


def drawn(device, images, index=0, uv=(0.0, 0.0), count=1, vector=(1.0, 0.0, 0.0), blend=0.0):
    """The outputs of `image_frag.glsl` by name for inputs (n, ...) that are broadcast."""
    uv, vector = (np.atleast_2d(a) for a in (uv, vector))
    n = max(len(uv), len(vector), np.size(blend))
    columns = [index, *uv.T, count, *vector.T, blend]
    records, texture, _ = pack_images(images, 1 << 20)
    found = harness.run_values(
        device,
        "image_frag.glsl",
        *(np.broadcast_to(c, n) for c in columns),
        textures={"tables": harness.texels(records), "images": texture},
        outputs=OUTPUTS,
    )
    return dict(zip(OUTPUTS, found, strict=True))


def weights(interpolation, fraction):
    """Offsets of the texels that are mixed from the one at or before a place, and their weights (n, taps)."""
    t = fraction[:, None]
    if interpolation == "CLOSEST":
        return [0], np.ones_like(t)
    if interpolation == "LINEAR":
        return [0, 1], np.concatenate([1 - t, t], axis=1)
    cubic = (1 - t) ** 3 / 6, (3 * t**3 - 6 * t**2 + 4) / 6, (-3 * t**3 + 3 * t**2 + 3 * t + 1) / 6, t**3 / 6
    return [-1, 0, 1, 2], np.concatenate(cubic, axis=1)


def wrapped(place, size, extension):
    if extension == "REPEAT":
        return place % size
    if extension == "MIRROR":
        return np.where(place % (2 * size) < size, place % size, size - 1 - place % size)
    return np.clip(place, 0, size - 1)


def reference(pixels, uv, interpolation, extension):
    """Texel centres lie at (i + 1/2) / size, as in OpenGL and Blender."""
    height, width, _ = pixels.shape
    position = uv * [width, height] - (0.0 if interpolation == "CLOSEST" else 0.5)
    corner = np.floor(position).astype(int)
    (columns, wx), (rows, wy) = (weights(interpolation, f) for f in (position - corner).T)
    total = np.zeros((len(uv), 4))
    for i, column in enumerate(columns):
        for j, row in enumerate(rows):
            x, y = (corner + np.array((column, row))).T
            texel = pixels[wrapped(y, height, extension), wrapped(x, width, extension)]
            if extension == "CLIP":
                texel = np.where(((x >= 0) & (x < width) & (y >= 0) & (y < height))[:, None], texel, 0.0)
            total += (wx[:, i] * wy[:, j])[:, None] * texel
    return total


def places(rng, count=4000):
    return shapes.single(np.concatenate([rng.uniform(0, 1, (count, 2)), rng.uniform(-3, 4, (count, 2))]))


@pytest.mark.parametrize("kind", ("float", "bytes", "opaque"))
@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
@pytest.mark.parametrize("extension", EXTENSIONS)
@pytest.mark.parametrize("size", [(1, 1), (7, 5), (64, 33)])
def test_images(device, interpolation, extension, size, kind):
    """The second of two images, at uv in and far out of the picture."""
    rng = np.random.default_rng(1)
    pixels = rng.integers(0, 256, (size[1], size[0], 4)).astype(np.uint8)
    pixels[..., 3] = 255 if kind == "opaque" else rng.integers(0, 255, pixels.shape[:2])
    values = pixels / np.float64(255.0)
    uv = places(rng)
    images = [Image(pixels if kind != "float" else values, interpolation, extension)]
    images.insert(0, Image(np.zeros((3, 4, 4), np.uint8)))
    color = drawn(device, images, 1, uv)["out_color"]
    expected = reference(values, uv, interpolation, extension)
    if interpolation == "CLOSEST":  # a texel's edge may fall to either side
        edge = np.abs(uv * size - np.round(uv * size)).min(axis=-1) < 1e-4
        assert np.allclose(color[~edge], expected[~edge], atol=1e-6)
        assert edge.mean() < 0.1
    else:
        assert np.abs(color - expected).max() < 2e-5 * max(size)


@pytest.mark.parametrize("srgb", (False, True))
@pytest.mark.parametrize("divided", (False, True))
def test_what_is_mixed_is_divided_by_alpha_and_decoded(device, srgb, divided):
    rng = np.random.default_rng(2)
    pixels = rng.integers(1, 256, (6, 9, 4)).astype(np.uint8)
    pixels[2:4, 3:6] = 0
    pixels[..., :3] = np.minimum(pixels[..., :3], pixels[..., 3:])
    uv = places(rng)
    expected = reference(pixels / np.float64(255.0), uv, "LINEAR", "REPEAT")
    color, alpha = expected[:, :3], expected[:, 3:]
    if divided:
        color = color / np.where(alpha > 0.0, alpha, 1.0)
    color = srgb_to_linear(np.maximum(color, 0.0)) if srgb else color
    found = drawn(device, [Image(pixels, srgb=srgb, divided=divided)], uv=uv)["out_color"]
    assert np.allclose(found[:, 3:], alpha, atol=1e-4)
    clear = alpha[:, 0] > 0.02
    assert np.allclose(found[clear, :3], color[clear], atol=2e-3)


def test_a_value_that_is_not_finite_harms_nothing(device):
    uv = np.array([[np.nan, 0.5], [np.inf, 0.5], [-np.inf, np.nan], [1e30, 0.5]])
    for extension in EXTENSIONS:
        assert drawn(device, [Image(np.ones((4, 4, 3)), extension=extension)], uv=uv)["out_color"].shape == (4, 4)


def test_tiles(device):
    """Each unit square has its picture, ten in a row; beyond them pink is seen."""
    rng = np.random.default_rng(3)
    images = [Image(np.full((2, 2, 3), 0.01 * i), "CLOSEST") for i in range(12)]
    uv = shapes.single(rng.uniform([-0.9, -0.9], [12.0, 4.0], (4000, 2)))
    found = drawn(device, images, 0, uv, 12)["out_tile"]
    x, y = np.trunc(uv).astype(int).T
    number = np.where((x < 10) & (10 * y + x < 12), 10 * y + x, -1)
    assert set(number.tolist()) == {-1, *range(12)}
    assert np.allclose(found[number < 0], PINK)
    assert np.allclose(found[number >= 0, 0], 0.01 * number[number >= 0], atol=1e-6)


def some_image():
    return [Image(np.zeros((1, 1, 3)))]


def test_equirectangular(device):
    """The picture's centre is towards +X, its left half towards +Y, its upper edge is the zenith."""
    named = np.array([[1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1], [1, 0, 1], [0, 0, 0]]) * 1.0
    uv = drawn(device, some_image(), vector=named)["out_round"][:, :2]
    expected = [[0.5, 0.5], [0.25, 0.5], [0.75, 0.5], [0.5, 1.0], [0.5, 0.0], [0.5, 0.75]]
    assert np.allclose(uv[:6], expected, atol=1e-6) and np.isfinite(uv).all()
    directions = shapes.single(shapes.unit_vectors(np.random.default_rng(3), 5000))
    uv = drawn(device, some_image(), vector=3.0 * directions)["out_round"][:, :2]
    longitude, latitude = np.arctan2(directions[:, 1], directions[:, 0]), np.arcsin(directions[:, 2])
    expected = np.stack([0.5 - longitude / (2 * np.pi), latitude / np.pi + 0.5], axis=-1)
    assert np.allclose(uv, expected, atol=3e-6)


def test_mirror_ball(device):
    """What a ball reflects towards an eye at -Y far away is seen where its normal lies halfway."""
    directions = shapes.unit_vectors(np.random.default_rng(4), 5000)
    normal = shapes.normalized(directions + np.array((0.0, -1.0, 0.0)))
    uv = drawn(device, some_image(), vector=2.0 * directions)["out_round"][:, 2:]
    known = directions[:, 1] < 0.99
    assert np.allclose(uv[known], 0.5 + 0.5 * normal[known][:, [0, 2]], atol=2e-5)


def test_sphere_and_tube(device):
    rng = np.random.default_rng(5)
    longitude, latitude = rng.uniform(-np.pi, np.pi, 3000), rng.uniform(-1.57, 1.57, 3000)
    globe = np.stack(
        [np.cos(latitude) * np.sin(longitude), np.cos(latitude) * np.cos(longitude), np.sin(latitude)], axis=-1
    )
    found = drawn(device, some_image(), vector=0.5 + 0.5 * globe)["out_cube"]
    u = 0.5 - longitude / (2 * np.pi)
    assert np.allclose(found[:, 0], u, atol=2e-4) and np.allclose(found[:, 1], latitude / np.pi + 0.5, atol=1e-5)
    assert np.allclose(found[:, 2], u, atol=2e-4) and np.allclose(found[:, 3], 0.5 + 0.5 * globe[:, 2], atol=1e-6)


def test_box(device):
    """Shares add up to 1, are continuous, and are those of the nearest sides alone where nothing is blended."""
    rng = np.random.default_rng(6)
    normal = shapes.unit_vectors(rng, 20000)
    sharp = drawn(device, some_image(), vector=normal, blend=0.0)["out_box"][:, :3]
    assert np.array_equal(sharp.argmax(axis=1), np.abs(normal).argmax(axis=1)) and np.all(sharp.max(axis=1) == 1.0)
    for blend in (0.2, 0.6, 1.0):
        share = drawn(device, some_image(), vector=normal, blend=blend)["out_box"][:, :3]
        assert np.allclose(share.sum(axis=1), 1.0, atol=1e-5) and share.min() > -1e-5
        near = shapes.normalized(normal + 1e-4 * rng.normal(size=normal.shape))
        other = drawn(device, some_image(), vector=near, blend=blend)["out_box"][:, :3]
        assert np.abs(share - other).max() < 0.01
    axes = drawn(device, some_image(), vector=np.eye(3), blend=0.6)["out_box"][:, :3]
    assert np.allclose(axes, np.eye(3))
