"""The texture `tables`: records of what there are few of, those of a name after the other."""

import numpy as np

from . import data_texture
from .plan import check_texels
from .residency import Upload


def lay_out(records, limit):
    """Where the arrays of `records` by name lie, a slice of texels each, and their `Upload`. Raises SceneError where
    they are more than `limit` texels."""
    slices, end = {}, 0
    for name, array in records.items():
        first = data_texture.next_start(end)
        end = first + array.nbytes // 16
        slices[name] = slice(first, end)
    check_texels(end, limit, "materials, lights, planes and images")
    texture = data_texture.zeros(end)
    for name, array in records.items():
        texture.reshape(-1, 4)[slices[name]] = array.view(np.float32).reshape(-1, 4)
    return slices, Upload(0, texture, end, anew=True)
