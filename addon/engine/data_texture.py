"""Data textures: float32 RGBA, rows of a fixed width, records one after the other."""

import numpy as np

#: Texels per row of every data texture: a power of two, so that an address needs a mask and a shift only.
WIDTH_BITS = 12
WIDTH = 1 << WIDTH_BITS

#: Up to here float32 holds every integer.
EXACT = 1 << 24


def most_texels(max_texture_size):
    """How many texels a data texture can have on a device: GLSL counts them with 32 bits."""
    return min(WIDTH * max_texture_size, (1 << 31) - 1)


def next_start(texels):
    """The first texel from number `texels` on at which records may begin: one whose number float32 holds."""
    return texels if texels < EXACT else -(-texels // WIDTH) * WIDTH


def zeros(texels):
    """A data texture of zeros, float32 (height, width, 4), for at least one texel, in rows of the fixed width."""
    width = min(max(texels, 1), WIDTH)
    return np.zeros((-(-max(texels, 1) // width), width, 4), np.float32)


def records_of(texture, record, first=0):
    """A view of a data texture as an array (n,) of all records that it has room for from texel `first` on."""
    texels = texture.reshape(-1, 4)[first:]
    count = len(texels) // record.texels
    return texels[: count * record.texels].reshape(-1).view(record.dtype)
