"""Pictures that Blender has written, read back."""

import bpy
import numpy as np


def picture(path):
    """The pixels (h, w, 4) of an image file, bottom row first."""
    image = bpy.data.images.load(str(path))
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)
