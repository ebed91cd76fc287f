# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures in files: PNG with display values (sRGB, straight alpha), EXR scene-linear and premultiplied."""

from importlib import import_module
from pathlib import Path

import numpy as np

from .errors import ConicError, SceneError
from .output_file import written_whole

#: The module that writes each kind of file, and how to get it.
_MODULES = {".png": ("PIL.Image", "Pillow"), ".exr": ("OpenEXR", "OpenEXR")}


def check_suffix(path):
    """The suffix of a picture's path in lower case; ConicError where it is none that can be written, or its
    module is missing."""
    suffix = Path(path).suffix.lower()
    if suffix not in _MODULES:
        raise ConicError(f"{path}: pictures are written as .png or .exr, not as {suffix or 'a name without suffix'}")
    _module(suffix)
    return suffix


def _module(suffix):
    module, package = _MODULES[suffix]
    try:
        return import_module(module)
    except ImportError:
        raise ConicError(
            f"{suffix} files need the Python package {package}; install it: python -m pip install {package}"
        ) from None


def linear_to_srgb(values):
    """Display values from linear ones (IEC 61966-2-1), each clamped to 0..1."""
    values = np.clip(np.nan_to_num(values), 0.0, 1.0)
    return np.where(values <= 0.0031308, 12.92 * values, 1.055 * values ** (1.0 / 2.4) - 0.055)


def srgb_to_linear(values):
    """Linear values from display values in 0..1 (IEC 61966-2-1)."""
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def write_image(path, pixels):
    """Write pixels (height, width, 4) float32, scene-linear, premultiplied, bottom row first, as .png (8
    bits) or .exr.

    The alpha channel is left out where it is 1 everywhere. Raises ConicError where the file cannot be
    written.
    """
    suffix = check_suffix(path)
    pixels = np.asarray(pixels, np.float32)[::-1]
    if (pixels[..., 3] >= 1.0).all():
        pixels = pixels[..., :3]
    with written_whole(path) as temporary:
        (_write_png if suffix == ".png" else _write_exr)(temporary, pixels)


def _write_png(path, pixels):
    color, alpha = pixels[..., :3], np.clip(pixels[..., 3:], 0.0, 1.0)
    if alpha.size:
        color = np.divide(color, alpha, out=np.zeros_like(color), where=alpha > 0.0)
    display = np.concatenate([linear_to_srgb(color), alpha], axis=-1)
    _module(".png").fromarray(np.round(255.0 * display).astype(np.uint8)).save(path)


def _write_exr(path, pixels):
    openexr = _module(".exr")
    header = {"compression": openexr.ZIP_COMPRESSION, "type": openexr.scanlineimage}
    channels = {"RGBA"[: pixels.shape[2]]: np.ascontiguousarray(pixels)}
    try:
        with openexr.File(header, channels) as file:
            file.write(str(path))
    except RuntimeError as error:  # OpenEXR's way to say that the system refuses
        raise OSError(str(error)) from None


def read_image(path):
    """Pixels (height, width, 4) float32 of a .png or .exr file: scene-linear, premultiplied, bottom row
    first.

    Raises SceneError where the file is missing or no such picture.
    """
    suffix = check_suffix(path)
    if not Path(path).is_file():
        raise SceneError(f"{path}: there is no such image file")
    try:
        pixels = (_read_png if suffix == ".png" else _read_exr)(path)
    except (OSError, ValueError, RuntimeError, KeyError) as error:
        raise SceneError(f"{path}: cannot be read as an image: {error}") from None
    return np.ascontiguousarray(pixels[::-1], np.float32)


def _read_png(path):
    with _module(".png").open(path) as file:
        if file.mode.startswith("I"):  # 16 bits of grey
            grey = np.asarray(file, np.float64)[..., None] / 65535.0
            display = np.concatenate([grey, grey, grey, np.ones_like(grey)], axis=-1)
        else:
            display = np.asarray(file.convert("RGBA"), np.float64) / 255.0
    return np.concatenate([srgb_to_linear(display[..., :3]) * display[..., 3:], display[..., 3:]], axis=-1)


def _read_exr(path):
    with _module(".exr").File(str(path)) as file:
        channels = file.channels()
        known = [name for name in ("RGBA", "RGB", "Y") if name in channels]
        if not known:
            raise ValueError(f"it has the channels {', '.join(channels)}, expected RGB, RGBA or Y")
        pixels = np.asarray(channels[known[0]].pixels, np.float32)
    if pixels.ndim == 2:
        pixels = np.repeat(pixels[..., None], 3, axis=-1)
    return pixels if pixels.shape[-1] == 4 else np.concatenate([pixels, np.ones_like(pixels[..., :1])], axis=-1)
