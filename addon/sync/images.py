# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of Blender as engine images: scene-linear, premultiplied alpha, bottom row first."""

import numpy as np

from ..engine.scene import Image
from .keys import original_key
from .values import MISSING, Value

_INTERPOLATION = {"Closest": "CLOSEST"}
_EXTENSION = {"REPEAT": "REPEAT", "EXTEND": "EXTEND", "CLIP": "CLIP"}
#: Colour spaces of byte images whose values are already linear, or are no colours at all.
_LINEAR = ("Non-Color", "Raw", "Linear", "Linear Rec.709", "Working Space", "scene_linear")
_NO_ALPHA = ("NONE", "CHANNEL_PACKED")


class Images:
    """The images of a scene: each of Blender's is read once, whatever materials use it."""

    def __init__(self, scene, reports):
        self._scene, self._reports = scene, reports
        self._pixels = {}
        self._indices = {}

    def value(self, node, user, *, keep_straight=False):
        """The image of an image or environment texture node as a `Value`; pink where it is missing.

        `user` names for the report what it is used in. `keep_straight`: the node's alpha is used too, so that its
        colour is not multiplied by it.
        """
        image = node.image
        if image is None:
            self._reports.warn(f"{user}: node {node.name!r} has no image; pink is used instead")
            return Value(MISSING)
        extension = getattr(node, "extension", "")  # a panorama has none
        key = original_key(image), node.interpolation, extension, keep_straight
        if key not in self._indices:
            pixels = self._read(image, user, keep_straight)
            self._indices[key] = None if pixels is None else self._add(pixels, node, image, user)
        return self._indices[key] or Value(MISSING)

    def _add(self, pixels, node, image, user):
        extension = getattr(node, "extension", "REPEAT")
        if extension not in _EXTENSION:
            self._reports.warn(
                f"{user}: image {image.name!r} is repeated, extension {extension.title()} is not rendered"
            )
        index = self._scene.add_image(
            Image(
                pixels,
                interpolation=_INTERPOLATION.get(node.interpolation, "LINEAR"),
                extension=_EXTENSION.get(extension, "REPEAT"),
                name=image.name,
            )
        )
        mean = pixels.mean(axis=1)[:, :3].mean(axis=0, dtype=np.float64)
        return Value((1.0, 1.0, 1.0), index, mean=tuple(np.nan_to_num(mean)))

    def _read(self, image, user, keep_straight):
        """Pixels (h, w, 4) float32 of a Blender image, or None, reported, where there are none."""
        key = (original_key(image), keep_straight)
        if key not in self._pixels:
            self._pixels[key] = self._decoded(image, user, keep_straight)
        return self._pixels[key]

    def _decoded(self, image, user, keep_straight):
        width, height = image.size
        count = len(image.pixels) if width and height else 0
        if not count:
            where = f" ({image.filepath})" if image.filepath else ""
            self._reports.warn(f"{user}: image {image.name!r}{where} cannot be read; pink is used instead")
            return None
        if image.source in ("TILED", "SEQUENCE", "MOVIE"):
            only = "its first tile" if image.source == "TILED" else "one frame of it"
            self._reports.warn(f"{user}: of image {image.name!r} only {only} is rendered")
        pixels = np.empty(count, np.float32)
        image.pixels.foreach_get(pixels)
        pixels = _rgba(pixels.reshape(height, width, -1))
        if image.is_float:
            return np.nan_to_num(pixels, copy=False, posinf=np.finfo(np.float32).max, neginf=0.0)
        space = image.colorspace_settings.name
        if space not in (*_LINEAR, "sRGB"):
            self._reports.warn(f"{user}: image {image.name!r} is read as sRGB, not as {space}")
        if space not in _LINEAR:
            _decode_srgb(pixels)
        straight = keep_straight or space == "Non-Color" or image.alpha_mode in _NO_ALPHA
        if not straight and pixels[..., 3].min() < 1.0:
            pixels[..., :3] *= pixels[..., 3:]
        return pixels


def _rgba(pixels):
    """(h, w, channels) of 1, 2, 3 or 4 channels as (h, w, 4)."""
    channels = pixels.shape[2]
    if channels == 4:
        return pixels
    rgba = np.ones((*pixels.shape[:2], 4), np.float32)
    rgba[..., :3] = pixels[..., :3] if channels == 3 else pixels[..., :1]
    if channels == 2:
        rgba[..., 3] = pixels[..., 1]
    return rgba


def _decode_srgb(pixels):
    """Decode the colours (h, w, 4) of a byte image in place (IEC 61966-2-1); its 256 values need no power each."""
    encoded = np.arange(256) / 255.0
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4).astype(np.float32)
    alpha = pixels[..., 3].copy()
    np.multiply(pixels, 255.0, out=pixels)
    np.take(linear, np.rint(pixels, out=pixels).astype(np.uint8), out=pixels, mode="clip")
    pixels[..., 3] = alpha
