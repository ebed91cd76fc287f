"""Pictures to files and back: which values are in the file, alpha, and errors."""

import numpy as np
import pytest
from PIL import Image

from addon.engine import ConicError, SceneError
from addon.engine.image_file import linear_to_srgb, read_image, srgb_to_linear, write_image


def picture(seed, alpha=True):
    """Premultiplied pixels (5, 7, 4) with values over 1 in them."""
    pixels = np.random.default_rng(seed).random((5, 7, 4), np.float32)
    if not alpha:
        pixels[..., 3] = 1.0
    pixels[..., :3] *= pixels[..., 3:]
    return pixels


def test_srgb_curve():
    # IEC 61966-2-1: mid-grey, the end of the linear part, and both ends.
    np.testing.assert_allclose(linear_to_srgb([0.0, 0.0031308, 0.2140411, 1.0]), [0.0, 0.0404499, 0.5, 1.0], atol=1e-6)
    np.testing.assert_allclose(linear_to_srgb([-1.0, 7.0, np.nan, np.inf]), [0.0, 1.0, 0.0, 1.0])
    values = np.linspace(0.0, 1.0, 1001)
    np.testing.assert_allclose(srgb_to_linear(linear_to_srgb(values)), values, atol=1e-7)


@pytest.mark.parametrize("alpha", [False, True])
def test_exr_gives_back_every_bit(tmp_path, alpha):
    pixels = picture(1, alpha) * np.float32(1000.0)
    pixels[..., 3] /= np.float32(1000.0)
    write_image(tmp_path / "a.exr", pixels)
    np.testing.assert_array_equal(read_image(tmp_path / "a.exr"), pixels)


@pytest.mark.parametrize("alpha, mode", [(False, "RGB"), (True, "RGBA")])
def test_png_has_straight_alpha_and_the_top_row_first(tmp_path, alpha, mode):
    pixels = picture(2, alpha)
    write_image(tmp_path / "a.png", pixels)
    with Image.open(tmp_path / "a.png") as file:
        assert file.mode == mode
        found = np.asarray(file) / 255.0
    top = pixels[-1, 3]
    np.testing.assert_allclose(found[0, 3, :3], linear_to_srgb(top[:3] / top[3]), atol=0.5 / 255 + 1e-6)
    np.testing.assert_allclose(read_image(tmp_path / "a.png"), pixels, atol=0.01)


def test_png_where_alpha_is_0(tmp_path):
    write_image(tmp_path / "a.png", np.zeros((2, 2, 4), np.float32))
    np.testing.assert_array_equal(read_image(tmp_path / "a.png"), 0.0)


def test_16_bit_grey_png(tmp_path):
    Image.fromarray(np.full((2, 3), 32768, np.uint16)).save(tmp_path / "a.png")
    expected = float(srgb_to_linear(np.float64(32768 / 65535)))
    np.testing.assert_allclose(read_image(tmp_path / "a.png")[0, 0], (expected,) * 3 + (1.0,), rtol=1e-6)


@pytest.mark.parametrize("name", ["a.png", "a.exr"])
def test_what_is_no_picture(tmp_path, name):
    with pytest.raises(SceneError, match="there is no such image file"):
        read_image(tmp_path / name)
    (tmp_path / name).write_text("no picture")
    with pytest.raises(SceneError, match="cannot be read as an image"):
        read_image(tmp_path / name)


def test_what_cannot_be_written(tmp_path):
    with pytest.raises(ConicError, match=r"not as \.tiff"):
        write_image(tmp_path / "a.tiff", picture(3))
    for name in ("a.png", "a.exr"):
        with pytest.raises(ConicError, match="cannot be written"):
            write_image(tmp_path / "none" / name, picture(3))
    assert list(tmp_path.iterdir()) == []
