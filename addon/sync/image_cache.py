# SPDX-License-Identifier: GPL-3.0-or-later
"""What was read of images, kept from one reading of the scene to the next.

Blender does not tell of all that changes an image: reloading one reports nothing. So what is kept is known by what
determines the pixels: the file as it is on the disk, the packed data, the settings. A painted image has nothing of the
kind and is read every time.
"""

import zlib
from dataclasses import dataclass, field

import numpy as np

from .color_spaces import working_space
from .image_pixels import file_path, file_state, tile_path
from .keys import original_key


@dataclass
class Reading:
    """The `Linear` by number of the tiles of an image, None for those that cannot be read. `images`: the engine's
    images of them by how they are sampled: where nothing changed, the same objects in every scene."""

    tiles: dict
    images: dict = field(default_factory=dict)

    @property
    def known(self):
        """The tiles that could be read."""
        return {number: tile for number, tile in self.tiles.items() if tile is not None}

    def equals(self, other):
        """Whether the pixels are the same as those of another reading."""
        return self.tiles.keys() == other.tiles.keys() and all(
            _equal(tile, other.tiles[number]) for number, tile in self.tiles.items()
        )


def _equal(a, b):
    if a is None or b is None:
        return a is b
    meanings = [(tile.srgb, tile.is_straight, tile.instead, tile.pixels.dtype) for tile in (a, b)]
    return meanings[0] == meanings[1] and np.array_equal(a.pixels, b.pixels)


class ImageCache:
    """What was read of images by what determines it. One for a session; each reading of a scene ends with `finish`."""

    def __init__(self):
        self._kept, self._used = {}, {}

    def image(self, image, path, read):
        """The `Reading` of an image, of the file `path` of one that is moving; `read` makes the tiles of one.

        Those of a painted image stay the same object while its pixels are the same.
        """
        uid = original_key(image)
        state = image_state(image, path)
        if state is not None:
            return self._get((uid, path, state), lambda: Reading(read()))
        key, made = (uid, path, "painted"), Reading(read())
        before = self._kept.get(key)
        self._kept[key] = before if before is not None and before.equals(made) else made
        return self._get(key, None)

    def table(self, key, make):
        """What `make` gives for a key that determines it, and the working space."""
        return self._get(("table", working_space(), *key), make)

    def _get(self, key, make):
        if key not in self._kept:
            self._kept[key] = make()
        self._used[key] = self._kept[key]
        return self._kept[key]

    def forget(self, image):
        """Blender says that an image changed: read it anew."""
        uid = original_key(image)
        self._kept = {key: reading for key, reading in self._kept.items() if key[0] != uid}

    def finish(self):
        """A scene is read: drop what it did not use."""
        self._kept, self._used = self._used, {}


def image_state(image, path=""):
    """What determines the pixels of an image, of the file `path` of one that is moving, beside which image it is; None
    where nothing does that is known without looking at them."""
    if image.is_dirty:
        return None
    space = image.colorspace_settings
    if not space.name:  # it was never looked at
        len(image.pixels)
    content = _content(image, path)
    if content is None:
        return None
    return image.source, space.name, space.is_data, image.alpha_mode, working_space(), content


def _content(image, path):
    if path:
        return file_state(path)
    if image.source == "GENERATED":
        color = tuple(image.generated_color)
        return image.generated_type, tuple(image.size), image.use_generated_float, color
    if image.source == "TILED":
        return _tiles_content(image)
    if image.source != "FILE":
        return None
    return _packed_content(image.packed_file) if image.packed_file else file_state(file_path(image))


def _tiles_content(image):
    """Tiles may be missing, but for the first, of which Blender may have pixels all the same."""
    packed = {file.tile_number: file.packed_file for file in image.packed_files}
    path, states = file_path(image), []
    for number in (tile.number for tile in image.tiles):
        state = _packed_content(packed[number]) if number in packed else file_state(tile_path(path, number))
        states.append((number, state))
    return tuple(states) if states[0][1] is not None else None


def _packed_content(packed):
    """Painting and packing again may give as many bytes as before."""
    return packed.size, zlib.crc32(packed.data)
