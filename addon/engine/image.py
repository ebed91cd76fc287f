"""Pictures that shaders look up by uv."""

from dataclasses import dataclass

import numpy as np

from .errors import SceneError

#: In the order of their numbers in GLSL: 1, 2 x 2 and 4 x 4 pixels are mixed; CUBIC is the B-spline, which smooths.
INTERPOLATIONS = ("CLOSEST", "LINEAR", "CUBIC")
EXTENSIONS = ("REPEAT", "EXTEND", "CLIP", "MIRROR")


@dataclass(frozen=True, eq=False)
class Image:
    """Pixels (height, width, 3 or 4), bottom row first, colours multiplied by alpha.

    Either float32, scene-linear; or uint8, which take a quarter of the memory, or half where there is alpha, and with
    `srgb` are sRGB: these are mixed before they are decoded, as in Cycles. `divided`: what is looked up is the colour
    without its alpha. Two are equal only if they are one object: lists of images that are equal have the same pixels.
    """

    pixels: np.ndarray
    interpolation: str = "LINEAR"
    extension: str = "REPEAT"
    name: str = ""
    srgb: bool = False
    divided: bool = False

    def __post_init__(self):
        pixels = np.asarray(self.pixels)
        if pixels.ndim != 3 or pixels.shape[2] not in (3, 4) or 0 in pixels.shape:
            raise SceneError(f"image {self.name!r}: shape {pixels.shape}, expected (height, width, 3 or 4)")
        kind = np.uint8 if pixels.dtype == np.uint8 else np.float32
        if pixels.shape[2] == 3:
            opaque = np.full_like(pixels[..., :1], 255 if kind is np.uint8 else 1.0)
            pixels = np.concatenate([pixels, opaque], axis=-1)
        object.__setattr__(self, "pixels", np.ascontiguousarray(pixels, kind))
        if self.interpolation not in INTERPOLATIONS or self.extension not in EXTENSIONS:
            raise SceneError(
                f"image {self.name!r}: interpolation {self.interpolation!r} of {INTERPOLATIONS}, "
                f"extension {self.extension!r} of {EXTENSIONS}"
            )
