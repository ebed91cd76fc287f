"""Images as records and texels: any number of them lies in one data texture, one after the other.

A texel is four floats. It holds one pixel of floats; or two of bytes, each as (red + 2^8 green + 2^16 blue, alpha); or,
where all are opaque, four of bytes: float32 holds whole numbers below 2^24, on any driver.
"""

import weakref

import numpy as np

from . import data_texture, layout, reference
from .arena import Arena
from .image import EXTENSIONS, INTERPOLATIONS
from .residency import ResidentImage, Upload, is_same

#: Bits of the field `coding`, as in GLSL.
_SRGB, _DIVIDED = 1, 2
#: Pixels that are packed at once, so that little memory is needed beside the texture.
_PIECE = 1 << 20


def pack_images(images, limit):
    """Records (n,) of `layout.IMAGE`, a data texture or None, and warnings for images of which `limit` texels fit.

    Where all of them together do not fit, the largest are reduced until they do; each that was is named in a warning.
    """
    records = layout.IMAGE.zeros(len(images))
    if not images:
        return records, None, []
    pixels, packings, warnings = _reduced(images, limit)
    starts = np.cumsum([0, *map(_texels, pixels, packings)])
    records["first"], records["first_high"] = reference.split_index(starts[:-1])
    records["height"], records["width"] = np.array([p.shape[:2] for p in pixels]).T
    records["interpolation"] = [INTERPOLATIONS.index(image.interpolation) for image in images]
    records["extension"] = [EXTENSIONS.index(image.extension) for image in images]
    records["packing"] = packings
    records["coding"] = [_SRGB * image.srgb + _DIVIDED * image.divided for image in images]
    texture = data_texture.zeros(int(starts[-1]))
    texels = texture.reshape(-1, 4)
    for first, picture, packing in zip(starts, pixels, packings, strict=False):
        _write(texels[first:], picture.reshape(-1, 4), packing)
    return records, texture, warnings


def add_images(images, limit, residency):
    """Make the images those of a `Residency`; the `Upload` of what was not there, None where there is nothing."""
    there = {id(resident.image() or resident): resident for resident in residency.images}  # some images are gone
    new = list({id(image): image for image in images if id(image) not in there}.values())
    if residency.reduced:  # what is reduced depends on all of them
        if is_same([resident.image for resident in residency.images], images):
            return None
        return _all_anew(images, limit, residency)
    records, texture, warnings = pack_images(new, limit)
    arena, count = residency.arenas["image"], _texels_of(records)
    start = arena.take(count)
    if warnings or arena.end > limit:
        return _all_anew(images, limit, residency)
    there |= {id(image): made for image, made in zip(new, _residents(new, records, start), strict=True)}
    for resident in {there[key] for key in there.keys() - set(map(id, images))}:
        arena.give_back(resident.first, resident.texels)
    residency.images = tuple(there[id(image)] for image in images)
    return Upload(start, texture, count) if new else None


def _all_anew(images, limit, residency):
    records, texture, warnings = pack_images(images, limit)
    arena = residency.arenas["image"] = Arena()
    arena.take(_texels_of(records))
    residency.images, residency.reduced = _residents(images, records, 0), tuple(warnings)
    return Upload(0, texture, arena.end, anew=True) if images else None


def _residents(images, records, start):
    """`ResidentImage`s of images whose texels lie from `start` on."""
    made = []
    for image, record in zip(images, records, strict=True):
        first = start + int(record["first"]) + (int(record["first_high"]) << reference.LOW_BITS)
        record["first"], record["first_high"] = reference.split_index(first)
        pixels = int(record["width"]) * int(record["height"])
        texels = _shared_texels(pixels, int(record["packing"]))
        made.append(ResidentImage(weakref.ref(image), record.copy(), first, texels))
    return tuple(made)


def _texels_of(records):
    pixels = zip(*(records[name].astype(int).tolist() for name in ("width", "height", "packing")), strict=True)
    return sum(_shared_texels(width * height, packing) for width, height, packing in pixels)


def _packing(pixels):
    """Base 2 logarithm of how many pixels share a texel."""
    if pixels.dtype != np.uint8:
        return 0
    return 2 if pixels[..., 3].min() == 255 else 1


def _texels(pixels, packing):
    return _shared_texels(pixels.shape[0] * pixels.shape[1], packing)


def _shared_texels(pixels, packing):
    """Texels of so many pixels."""
    return -(-pixels >> packing)


def _write(texels, pixels, packing):
    """Write pixels (n, 4) into the first rows of texels (m, 4)."""
    if packing == 0:
        texels[: len(pixels)] = pixels
        return
    flat = texels.reshape(-1)
    for first in range(0, len(pixels), _PIECE):
        piece = pixels[first : first + _PIECE]
        color = piece[:, 0] + (piece[:, 1].astype(np.int32) << 8) + (piece[:, 2].astype(np.int32) << 16)
        if packing == 2:
            flat[first : first + len(piece)] = color
        else:
            flat[2 * first : 2 * (first + len(piece)) : 2] = color
            flat[2 * first + 1 : 2 * (first + len(piece)) : 2] = piece[:, 3]


def _reduced(images, limit):
    """The images' pixels, the largest halved again and again until all their texels fit `limit`, how they are packed,
    and the warnings."""
    pixels, reduced = [image.pixels for image in images], set()
    packings = list(map(_packing, pixels))
    while sum(map(_texels, pixels, packings)) > limit:
        largest = max(range(len(pixels)), key=lambda i: _texels(pixels[i], packings[i]))
        reduced.add(largest)
        pixels[largest] = _halved(pixels[largest])
    warnings = []
    for i in sorted(reduced):
        (height, width), (rows, columns) = images[i].pixels.shape[:2], pixels[i].shape[:2]
        warnings.append(
            f"image {images[i].name!r} of {width} x {height} is too large for this device and was reduced to "
            f"{columns} x {rows}"
        )
    return pixels, packings, warnings


def _halved(pixels):
    """Half as many rows and columns, by averages; an odd last row or column goes into its neighbour."""
    kind = pixels.dtype
    for axis in (0, 1):
        size = pixels.shape[axis]
        if size > 1:
            starts = np.arange(0, size - size % 2, 2)
            counts = np.diff([*starts, size]).reshape((-1, 1, 1) if axis == 0 else (1, -1, 1))
            pixels = np.add.reduceat(pixels, starts, axis=axis, dtype=np.float32) / counts.astype(np.float32)
    return pixels if kind != np.uint8 else np.rint(pixels).astype(np.uint8)
