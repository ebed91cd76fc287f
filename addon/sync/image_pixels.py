# SPDX-License-Identifier: GPL-3.0-or-later
"""The pixels of Blender's images: of files, packed, generated, of a frame of a sequence, of a tile."""

import os
import re
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import bpy
import numpy as np

from .color_spaces import REC_709, color_space, working_space

#: Of bytes that shaders decode.
_SRGB = "sRGB"
#: Rows that are worked on at once, so that they stay in the processor's cache.
_ROWS = 16
#: From this on Cycles treats floats of Blender's as it treats bytes.
_FLOATS_MULTIPLIED = (5, 2, 0)
#: Nanoseconds since the epoch. Blender may have loaded a file before it was changed later than that.
_STARTED = time.time_ns()
_U32, _LANES = np.uint32, np.uint32(0x00FF00FF)
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
        if _multiplies_floats(image) and pixels.shape[2] == 4:
            with np.errstate(all="ignore"):
                pixels[..., :3] *= pixels[..., 3:]
        pixels = np.nan_to_num(pixels, copy=False, posinf=np.finfo(np.float32).max, neginf=0.0)
    else:
        pixels = _bytes(pixels)
    settings = image.colorspace_settings
    return Stored(_rgba(pixels), settings.name, settings.is_data, image.alpha_mode)


def _multiplies_floats(image):
    """Whether Cycles multiplies floats that it has from Blender, not from a file on the disk, by their alpha, whatever
    Blender has done to them."""
    is_on_disk = image.source != "GENERATED" and not image.is_dirty and not image.packed_file
    is_straight = image.alpha_mode == "STRAIGHT" and not image.colorspace_settings.is_data
    return bpy.app.version >= _FLOATS_MULTIPLIED and is_straight and not is_on_disk


def _bytes(pixels):
    """Pixels (h, w, channels) float32 in 0..1, which are overwritten, as uint8."""
    made = np.empty(pixels.shape, np.uint8)
    for first in range(0, len(pixels), _ROWS):
        rows = pixels[first : first + _ROWS]
        rows *= 255.0
        rows += 0.5
        made[first : first + _ROWS] = rows  # rounded down
    return made


def read_clean_file(image):
    """What the file of an image holds by now: Blender may have loaded it before it was changed."""
    path = file_path(image)
    state = None if image.is_dirty or image.packed_file else file_state(path)
    if image.has_data and state is not None and max(state.modified, state.changed) > _STARTED:
        return read_file(path, image)
    return read_image(image)


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


class FileState(NamedTuple):
    """What is the same for a file, by its path, while nobody writes it. Times are nanoseconds since the epoch."""

    path: str
    modified: int
    changed: int
    size: int


def file_state(path):
    """The `FileState` of a file; None where there is none."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return FileState(path, found.st_mtime_ns, found.st_ctime_ns, found.st_size)


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
    made = np.empty(pixels.shape, np.float32)
    step = len(pixels) if space.tables is None else _ROWS
    for first in range(0, len(pixels), step):
        rows, of = made[first : first + step], pixels[first : first + step]
        rows[..., :3] = space.decoded(of)
        rows[..., 3] = of[..., 3] / np.float32(255.0)
        if not straight:
            rows[..., :3] *= rows[..., 3:]
    return made


def _multiply(pixels):
    """Multiply colors (h, w, 4) uint8, contiguous, by their alpha in place, rounded down as in Cycles.

    Two channels at a time, 16 bits apart in the word of a pixel.
    """
    words = pixels.view("<u4")[..., 0]
    for first in range(0, len(words), _ROWS):
        rows = words[first : first + _ROWS]
        alpha = rows >> _U32(24)
        red_blue = _times(rows & _LANES, alpha)
        green = _times((rows >> _U32(8)) & _U32(0xFF), alpha)
        rows[...] = red_blue | (green << _U32(8)) | (alpha << _U32(24))


def _times(lanes, alpha):
    """The quotients by 255 of products, without a division: (x + 1 + x / 256) / 256 of each lane."""
    lanes *= alpha
    lanes += ((lanes >> _U32(8)) & _LANES) + _U32(0x00010001)
    lanes >>= _U32(8)
    lanes &= _LANES
    return lanes


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
