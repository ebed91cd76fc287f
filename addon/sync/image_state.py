# SPDX-License-Identifier: GPL-3.0-or-later
"""What determines the pixels of an image.

Blender does not tell of all that changes an image: reloading one reports nothing. So what was read is known by what
determines it: the file as it is on the disk, the packed data, the settings. A painted image has nothing of the kind
and is read every time.
"""

import zlib

import bpy

from .color_spaces import working_space
from .image_pixels import file_path, file_state, tile_path
from .keys import original_key


def image_states(keys):
    """The state of Blender's images, see `image_state`, by `keys` (uid, path)."""
    images = {original_key(image): image for image in bpy.data.images}
    return {(uid, path): image_state(images[uid], path) for uid, path in keys if uid in images}


def changed_images(before, now):
    """The uids of the images whose pixels may be others than they were, by their `image_states` then and now."""
    return {key[0] for key, state in before.items() if state is None or state != now.get(key)}


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
