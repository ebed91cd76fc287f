# SPDX-License-Identifier: GPL-3.0-or-later
"""From the color spaces of image files to scene-linear.

Python has no way to Blender's OpenColorIO but one: a file of floats is converted when it is loaded. So colors go
through a small file of floats once for each space; most are a curve a channel and a matrix, and three tables serve.
"""

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np

#: What "scene-linear" is unless the user has chosen otherwise.
REC_709 = "Linear Rec.709"
#: Where curves and a matrix must agree with Blender: of a color in 0..1.
_TOLERANCE = 1e-3
_WIDTH = 4096


@dataclass(frozen=True)
class ColorSpace:
    """A color space of bytes. `linear`: its values are scene-linear as they are. `tables` (3, 256, 3): what each value
    of each channel adds to the color; None where a space is not made of such."""

    name: str
    linear: bool
    tables: np.ndarray | None

    def decoded(self, pixels):
        """Scene-linear colors (h, w, 3) float32 of pixels (h, w, 3 or more) uint8."""
        if self.tables is None:
            return _through_a_file(pixels[..., :3].reshape(-1, 3) / np.float32(255.0), self.name).reshape(
                *pixels.shape[:2], 3
            )
        red, green, blue = (np.take(table, pixels[..., i], axis=0) for i, table in enumerate(self.tables))
        red += green
        red += blue
        return red


def working_space():
    """The name of the space that "scene-linear" is."""
    settings = getattr(bpy.data, "colorspace", None)
    return settings.working_space if settings else REC_709


def from_rec_709():
    """The matrix (3, 3) by which rows of linear Rec. 709 become scene-linear."""
    if working_space() == REC_709:
        return np.eye(3)
    return color_space(REC_709, working_space()).tables[:, 255].astype(np.float64)


@cache
def color_space(name, _working_space):
    """The `ColorSpace` of a name of Blender's. Raises RuntimeError where Blender cannot convert it."""
    values = np.arange(256, dtype=np.float32) / np.float32(255.0)
    axes = [np.outer(values, np.eye(3, dtype=np.float32)[i]) for i in range(3)]
    some = np.random.default_rng(0).integers(0, 256, (256, 3))
    found = _through_a_file(np.concatenate([*axes, values[some]]), name)
    tables = found[:768].reshape(3, 256, 3).copy()
    tables[1:] -= tables[0, 0]
    if np.abs(sum(tables[i][some[:, i]] for i in range(3)) - found[768:]).max() > _TOLERANCE:
        return ColorSpace(name, False, None)
    straight = np.stack(axes)
    return ColorSpace(name, bool(np.abs(tables - straight).max() < 1e-5), tables)


def _through_a_file(colors, name):
    """Colors (n, 3) float32 of a space as scene-linear ones."""
    rows = -(-len(colors) // _WIDTH)
    pixels = np.ones((rows * _WIDTH, 4), np.float32)
    pixels[: len(colors), :3] = colors
    with TemporaryDirectory() as folder, bpy.data.temp_data() as data:
        _convert(data, str(Path(folder) / "colors.exr"), pixels, rows, name)
    return pixels[: len(colors), :3]


def _convert(data, path, pixels, rows, name):
    """Save pixels and load them again as of another space. A function of its own: no reference to an image may outlive
    its `temp_data`."""
    saved = data.images.new("colors", _WIDTH, rows, float_buffer=True, is_data=True)
    saved.pixels.foreach_set(pixels.reshape(-1))
    saved.filepath_raw, saved.file_format = path, "OPEN_EXR"
    saved.save()
    loaded = data.images.load(path)
    loaded.colorspace_settings.name = name
    loaded.pixels.foreach_get(pixels.reshape(-1))
