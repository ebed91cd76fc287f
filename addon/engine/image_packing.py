"""Images as records and texels: any number of them lies in one data texture, one after the other."""

import numpy as np

from . import layout
from .scene import EXTENSIONS, INTERPOLATIONS


def pack_images(images, limit):
    """Records (n,) of `layout.IMAGE`, texels (m, 4) float32 and warnings for images of which `limit` texels fit.

    Where all of them together do not fit, the largest are reduced until they do; each that was is named in a warning.
    """
    records = layout.IMAGE.zeros(len(images))
    if not images:
        return records, np.zeros((0, 4), np.float32), []
    pixels, warnings = _reduced(images, limit)
    starts = np.cumsum([0, *(p.shape[0] * p.shape[1] for p in pixels)])
    records["first"], records["first_high"] = layout.split_index(starts[:-1])
    records["height"], records["width"] = np.array([p.shape[:2] for p in pixels]).T
    records["interpolation"] = [INTERPOLATIONS.index(image.interpolation) for image in images]
    records["extension"] = [EXTENSIONS.index(image.extension) for image in images]
    return records, np.concatenate([p.reshape(-1, 4) for p in pixels]), warnings


def _reduced(images, limit):
    """The images' pixels, the largest halved again and again until all their texels fit `limit`, and the warnings."""
    pixels, reduced = [image.pixels for image in images], set()
    while sum(p.shape[0] * p.shape[1] for p in pixels) > limit:
        largest = max(range(len(pixels)), key=lambda i: pixels[i].size)
        reduced.add(largest)
        pixels[largest] = _halved(pixels[largest])
    warnings = []
    for i in sorted(reduced):
        (height, width), (rows, columns) = images[i].pixels.shape[:2], pixels[i].shape[:2]
        warnings.append(
            f"image {images[i].name!r} of {width} x {height} is too large for this device and was reduced to "
            f"{columns} x {rows}"
        )
    return pixels, warnings


def _halved(pixels):
    """Half as many rows and columns, by averages; an odd last row or column goes into its neighbour."""
    for axis in (0, 1):
        size = pixels.shape[axis]
        if size > 1:
            starts = np.arange(0, size - size % 2, 2)
            counts = np.diff([*starts, size]).reshape((-1, 1, 1) if axis == 0 else (1, -1, 1))
            pixels = np.add.reduceat(pixels, starts, axis=axis) / counts.astype(np.float32)
    return pixels
