"""Eye rays, images by uv and the sky's mapping against numpy."""

import numpy as np
import pytest

from addon.engine import layout
from addon.engine.film import Film
from addon.engine.scene import EXTENSIONS, INTERPOLATIONS, Camera

from . import harness, shapes


class NoDevice:
    """What a film needs of a device to tell its raster."""

    def target(self, *size):
        return size


def eye_rays(device, camera, raster, pixels):
    matrix = np.asarray(camera.matrix, np.float64)
    frame = harness.frame_record(
        camera_origin=matrix[:3, 3],
        camera_right=matrix[:3, 0],
        camera_up=matrix[:3, 1],
        camera_forward=-matrix[:3, 2],
        orthographic=camera.orthographic,
        clip_start=camera.clip[0],
        clip_end=camera.clip[1],
        raster=raster,
    )
    zero = np.zeros(len(pixels))
    origin, direction = harness.run_values(
        device, "camera_frag.glsl", *pixels.T, *[zero] * 6, outputs=("out_origin", "out_direction"), frame=frame
    )
    return origin[:, :3], direction[:, :3], origin[:, 3]


CAMERAS = {
    "perspective": Camera.look_at((3.0, -5.0, 2.0), (0.1, 0.2, 0.3), angle=40.0, aspect=1.5, clip=(0.1, 100.0)),
    "off centre": Camera(np.eye(4), (-0.2, 0.7, -0.5, 0.1), clip=(0.0, 50.0)),
    "orthographic": Camera.orthographic_at((3.0, -5.0, 2.0), (0.0, 0.0, 0.0), 4.0, aspect=1.5, clip=(0.5, 20.0)),
}


@pytest.mark.parametrize("name", CAMERAS)
@pytest.mark.parametrize("border", [None, (10, 20, 40, 30)])
def test_eye_rays(device, name, border):
    """A ray meets the window where its pixel is, starts at the near plane and ends at the far one."""
    camera, size = CAMERAS[name], (120, 80)
    pixels = np.random.default_rng(0).uniform(0.0, 1.0, (2000, 2)) * (border[2:] if border else size)
    raster = Film(NoDevice(), *size, border=border).raster(0, camera.window)
    origin, direction, t_max = eye_rays(device, camera, raster, pixels)
    share = (pixels + (border[:2] if border else (0, 0))) / size  # of the whole frame, from the lower left corner
    left, right, bottom, top = camera.window
    window = np.stack([left + share[:, 0] * (right - left), bottom + share[:, 1] * (top - bottom)], axis=-1)
    world = np.asarray(camera.matrix)
    local_origin = (origin - world[:3, 3]) @ world[:3, :3]
    local_direction = direction @ world[:3, :3]
    assert np.abs(np.linalg.norm(direction, axis=-1) - 1.0).max() < 3e-7
    near, far = camera.clip
    assert np.allclose(-local_origin[:, 2], near, atol=3e-6)
    end = local_origin + t_max[:, None] * local_direction
    assert np.allclose(-end[:, 2], far, rtol=3e-6)
    if camera.orthographic:
        assert np.allclose(local_origin[:, :2], window, atol=3e-6)
        assert np.allclose(local_direction, [0.0, 0.0, -1.0], atol=1e-6)
    else:
        assert np.allclose(local_direction[:, :2] / -local_direction[:, 2:], window, atol=2e-6)
        assert np.allclose(local_origin[:, :2], window * near, atol=3e-6)


def test_sample_0_goes_through_the_centre_of_the_pixel(device):
    camera = CAMERAS["perspective"]
    raster = Film(NoDevice(), 3, 1).raster(0, camera.window)
    _, direction, _ = eye_rays(device, camera, raster, np.array([[1.5, 0.5]]))
    assert np.allclose(direction, -np.asarray(camera.matrix)[:3, 2], atol=1e-7)


def reference_sample(pixels, uv, interpolation, extension):
    """Texel centres lie at (i + 1/2) / size, as in OpenGL and Blender."""
    height, width, _ = pixels.shape

    def texel(x, y):
        if extension == "REPEAT":
            return pixels[y % height, x % width]
        inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
        value = pixels[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)]
        return np.where(inside[:, None] | (extension == "EXTEND"), value, 0.0)

    position = uv * [width, height]
    if interpolation == "CLOSEST":
        return texel(*np.floor(position).astype(int).T)
    corner = np.floor(position - 0.5).astype(int)
    wx, wy = (position - 0.5 - corner).T[:, :, None]
    (x, y), one = corner.T, 1
    lower = texel(x, y) * (1 - wx) + texel(x + one, y) * wx
    upper = texel(x, y + one) * (1 - wx) + texel(x + one, y + one) * wx
    return lower * (1 - wy) + upper * wy


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
@pytest.mark.parametrize("extension", EXTENSIONS)
@pytest.mark.parametrize("size", [(1, 1), (7, 5), (64, 33)])
def test_images(device, interpolation, extension, size):
    """The second of two images, at uv in and far out of the picture."""
    rng = np.random.default_rng(1)
    pixels = rng.random((size[1], size[0], 4)).astype(np.float32)
    uv = shapes.single(np.concatenate([rng.uniform(0, 1, (5000, 2)), rng.uniform(-3, 4, (5000, 2))]))
    index = np.ones(len(uv))
    outputs = sample(device, [np.zeros((3, 4, 4), np.float32), pixels], interpolation, extension, index, uv)
    expected = reference_sample(pixels.astype(np.float64), uv, interpolation, extension)
    if interpolation == "CLOSEST":  # a texel's edge may fall to either side
        edge = np.abs(uv * size - np.round(uv * size)).min(axis=-1) < 1e-4
        assert np.allclose(outputs[0][~edge], expected[~edge], atol=1e-7)
        assert edge.mean() < 0.1
    else:
        assert np.abs(outputs[0] - expected).max() < 2e-5 * max(size)


def sample(device, pictures, interpolation, extension, index, uv, towards=None):
    images = layout.IMAGE.zeros(len(pictures))
    starts = np.cumsum([0, *(p.shape[0] * p.shape[1] for p in pictures)])
    images["first"], images["first_high"] = layout.split_index(starts[:-1])
    images["height"], images["width"] = np.array([p.shape[:2] for p in pictures]).T
    images["interpolation"], images["extension"] = INTERPOLATIONS.index(interpolation), EXTENSIONS.index(extension)
    texels = np.concatenate([p.reshape(-1, 4) for p in pictures])
    towards = np.broadcast_to([1.0, 0.0, 0.0] if towards is None else towards, (len(uv), 3))
    zero = np.zeros(len(uv))
    return harness.run_values(
        device,
        "image_frag.glsl",
        index,
        *uv.T,
        zero,
        *towards.T,
        zero,
        textures={"tables": harness.texels(images), "images": harness.texels(texels)},
        features={"HAS_WORLD_IMAGE"},
        outputs=("out_color", "out_sky", "out_radiance"),
        frame=harness.frame_record(world_color=[1.0, 2.0, 0.5], world_image=len(pictures) - 1),
    )


def test_the_sky_s_mapping(device):
    """The picture's centre is towards +X, its left half towards +Y, its upper edge is the zenith."""
    named = np.array([[1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1], [1, 0, 1]]) / [[1]] * 1.0
    picture = np.random.default_rng(2).random((8, 16, 4)).astype(np.float32)
    _, sky, _ = sample(device, [picture], "CLOSEST", "REPEAT", np.zeros(6), np.zeros((6, 2)), shapes.normalized(named))
    assert np.allclose(
        sky[:, :2], [[0.5, 0.5], [0.25, 0.5], [0.75, 0.5], [0.5, 1.0], [0.5, 0.0], [0.5, 0.75]], atol=1e-6
    )
    directions = shapes.unit_vectors(np.random.default_rng(3), 5000)
    uv = np.stack(
        [0.5 - np.arctan2(directions[:, 1], directions[:, 0]) / (2 * np.pi), np.arcsin(directions[:, 2]) / np.pi + 0.5],
        axis=-1,
    )
    _, sky, radiance = sample(
        device, [picture], "CLOSEST", "EXTEND", np.zeros(5000), np.zeros((5000, 2)), shapes.single(directions)
    )
    seam = np.abs(uv[:, 0] - 0.5) > 0.4999
    assert np.allclose(sky[~seam, :2], uv[~seam], atol=2e-6)
    expected = reference_sample(picture.astype(np.float64), sky[:, :2].astype(np.float64), "CLOSEST", "EXTEND")
    assert np.allclose(radiance[:, :3], expected[:, :3] * [1.0, 2.0, 0.5], atol=1e-6)
