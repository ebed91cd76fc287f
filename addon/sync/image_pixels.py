# SPDX-License-Identifier: GPL-3.0-or-later
"""The pixels of Blender's images: of files, packed, generated, of a frame of a sequence, of a tile."""

import re
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np

from .color_spaces import REC_709, color_space, working_space

#: Of bytes that shaders decode.
_SRGB = "sRGB"
#: Rows that are worked on at once, so that little memory is needed beside the picture.
_ROWS = 256


_LAST_DIGITS = re.compile(r"\d+(?=\D*$)")


@dataclass(frozen=True)
class Stored:
    """Pixels (h, w, 4), float32 or uint8, as Blender stores them, and what they mean."""

    pixels: np.ndarray
    space: str
    is_data: bool
    alpha_mode: str

    @property
    def is_straight(self):
        """Whether colors have nothing to do with alpha."""
        return self.is_data or self.alpha_mode in ("NONE", "CHANNEL_PACKED")


@dataclass(frozen=True)
class Linear:
    """Pixels (h, w, 4): scene-linear float32, or uint8, with `srgb` of that space. Colors are multiplied by alpha
    unless `is_straight`. `instead`: the space that was taken in place of one that cannot be converted, else empty."""

    pixels: np.ndarray
    srgb: bool
    is_straight: bool
    instead: str = ""


def read_image(image):
    """What an image that has one picture stores; None where it has none."""
    width, height = image.size
    count = len(image.pixels) if width and height else 0
    if not count:
        return None
    flat = np.empty(count, np.float32)
    image.pixels.foreach_get(flat)
    pixels = flat.reshape(height, width, -1)
    if image.is_float:
        pixels = np.nan_to_num(pixels, copy=False, posinf=np.finfo(np.float32).max, neginf=0.0)
    else:
        pixels = _bytes(pixels)
    settings = image.colorspace_settings
    return Stored(_rgba(pixels), settings.name, settings.is_data, image.alpha_mode)


def _bytes(pixels):
    """Pixels (h, w, channels) float32 in 0..1, which are overwritten, as uint8."""
    made = np.empty(pixels.shape, np.uint8)
    for first in range(0, len(pixels), _ROWS):
        rows = pixels[first : first + _ROWS]
        rows *= 255.0
        made[first : first + _ROWS] = np.rint(rows, out=rows)
    return made


def read_file(path, like):
    """The same of a picture file, with the color space and the alpha of another image."""
    if not Path(path).is_file():
        return None
    with bpy.data.temp_data() as data:
        try:
            return _load(data, path, like)
        except RuntimeError:  # Blender's way to say that it is no picture
            return None


def _load(data, path, like):
    """A function of its own: no reference to an image may outlive its `temp_data`."""
    image = data.images.load(path)
    if like.colorspace_settings.name:  # else it was never looked at
        image.colorspace_settings.name = like.colorspace_settings.name
    image.alpha_mode = like.alpha_mode
    return read_image(image)


def read_tiles(image):
    """What is stored of the tiles of a UDIM image by number, from 0 on; None for one that cannot be read."""
    with TemporaryDirectory() as folder:
        return {tile.number - 1001: _read_tile(image, tile.number, folder) for tile in image.tiles}


def _read_tile(image, number, folder):
    path = tile_path(file_path(image), number)
    packed = next((file for file in image.packed_files if file.tile_number == number), None)
    if packed is not None:
        path = str(Path(folder) / f"{number}{Path(path).suffix}")
        Path(path).write_bytes(packed.packed_file.data)
    found = read_file(path, image)
    if found is None and number == image.tiles[0].number:
        return read_image(image)  # painted, and not saved yet
    return found


def file_path(image):
    """Where the file of an image is; of many, as the image names them."""
    return bpy.path.abspath(image.filepath, library=image.library)


def tile_path(path, number):
    """The file of tile `number`, from 1001 on, for a path with <UDIM> or <UVTILE>."""
    row, column = divmod(number - 1001, 10)
    return path.replace("<UDIM>", str(number)).replace("<UVTILE>", f"u{column + 1}_v{row + 1}")


def frame_path(image, user, frame):
    """The file of a sequence that an image user shows at a frame of the scene: the last digits of its name count."""
    number = frame - user.frame_start + 1
    if user.use_cyclic and user.frame_duration:
        number = (number - 1) % user.frame_duration + 1
    number = min(max(number, 1), user.frame_duration) + user.frame_offset
    path = Path(file_path(image))
    return str(path.with_name(_LAST_DIGITS.sub(lambda digits: f"{number:0{len(digits[0])}d}", path.stem) + path.suffix))


def to_linear(stored):
    """The `Linear` of what is `Stored`, whose pixels are overwritten."""
    pixels, straight = stored.pixels, stored.is_straight
    if stored.alpha_mode == "NONE":
        pixels[..., 3] = 255 if pixels.dtype == np.uint8 else 1.0
    if pixels.dtype == np.float32:  # Blender has converted and multiplied it
        return Linear(pixels, False, straight)
    srgb, instead = not stored.is_data, ""
    if srgb and (stored.space, working_space()) != (_SRGB, REC_709):
        try:
            space = color_space(stored.space, working_space())
        except (RuntimeError, TypeError):
            instead = _SRGB
        else:
            if not space.linear:
                return Linear(_decoded(pixels, space, straight), False, straight)
            srgb = False
    if not straight and pixels[..., 3].min() < 255:
        _multiply(pixels)
    return Linear(pixels, srgb, straight, instead)


def _decoded(pixels, space, straight):
    made = np.ones(pixels.shape, np.float32)
    made[..., :3] = space.decoded(pixels)
    made[..., 3] = pixels[..., 3] / np.float32(255.0)
    if not straight:
        made[..., :3] *= made[..., 3:]
    return made


def _multiply(pixels):
    """Multiply colors (h, w, 4) uint8 by their alpha in place, rounded down as in Cycles."""
    for first in range(0, len(pixels), _ROWS):
        rows = pixels[first : first + _ROWS]
        product = rows[..., :3].astype(np.uint16)
        product *= rows[..., 3:]
        rows[..., :3] = (product + np.uint16(1) + (product >> 8)) >> 8  # the quotient by 255, without a division


def _rgba(pixels):
    """(h, w, channels) of 1, 2, 3 or 4 channels as (h, w, 4)."""
    channels = pixels.shape[2]
    if channels == 4:
        return pixels
    rgba = np.full((*pixels.shape[:2], 4), 255 if pixels.dtype == np.uint8 else 1.0, pixels.dtype)
    rgba[..., :3] = pixels[..., :3] if channels == 3 else pixels[..., :1]
    if channels == 2:
        rgba[..., 3] = pixels[..., 1]
    return rgba
