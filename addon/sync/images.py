# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of Blender as engine images, each read once, whatever nodes use it, and again where it changed."""

from dataclasses import dataclass

import numpy as np

from ..engine.expression import Parameter, call
from ..engine.image import Image
from .image_cache import ImageCache
from .image_pixels import Linear, file_path, frame_path, read_clean_file, read_file, read_tiles, to_linear
from .keys import original_key

#: Cycles' color for images that are missing.
MISSING = (1.0, 0.0, 1.0)
_INTERPOLATIONS = {"Closest": "CLOSEST", "Linear": "LINEAR", "Cubic": "CUBIC", "Smart": "CUBIC"}
_MISSING_TILE = Linear(np.array((255, 0, 255, 255), np.uint8).reshape(1, 1, 4), False, True)


@dataclass(frozen=True)
class Picture:
    """An image of the scene by its number, an int Parameter; or the tiles from there on, `count` of them."""

    number: Parameter
    count: Parameter | None = None

    def color(self, uv):
        """The color and alpha at an Expression of uv, as an Expression."""
        if self.count is None:
            return call("image_sample", self.number, uv)
        return call("image_sample_tiled", self.number, self.count, uv)


class Images:
    """The images of a scene at a frame. `cache`: the `ImageCache` of what was read before."""

    def __init__(self, scene, frame=1, cache=None):
        self._scene, self._frame, self._cache = scene, frame, cache or ImageCache()
        self._read, self._pictures = {}, {}

    def picture(self, node, warn, *, divided=False):
        """The `Picture` of an image or environment texture node; None where it is missing.

        `warn` takes what there is to report. `divided`: the color is to be had without its alpha.
        """
        if node.image is None:
            warn("it has no image; pink is used instead")
            return None
        key = self._key(node)
        if key not in self._read:
            self._read[key] = self._reading(node.image, key[1], warn)
        tiles = self._read[key].known
        if not tiles:
            return None
        sampling = {
            "name": node.image.name,
            "interpolation": _INTERPOLATIONS.get(node.interpolation, "LINEAR"),
            "extension": getattr(node, "extension", "REPEAT"),  # a panorama has none
            "divided": divided and not any(tile.is_straight for tile in tiles.values()),
        }
        key = (*key, *sampling.values())
        if key not in self._pictures:
            self._pictures[key] = self._add(node.image, self._sampled(self._read[key[:2]], sampling))
        return self._pictures[key]

    def table(self, key, make):
        """The `Picture` of what `make` gives, pixels (h, w, 3 or 4) float32, mixed linearly and repeated; made once for
        a key."""
        if key not in self._pictures:
            made = self._cache.table(key, lambda: Image(make(), name=key[0]))
            self._pictures[key] = Picture(Parameter(self._scene.add_image(made), "int"))
        return self._pictures[key]

    def _add(self, image, tiles):
        """Add the engine's images of tiles; their `Picture`."""
        number = len(self._scene.images)
        for tile in tiles:
            self._scene.add_image(tile)
        tiled = Parameter(len(tiles), "int") if image.source == "TILED" else None
        return Picture(Parameter(number, "int"), tiled)

    def _sampled(self, reading, sampling):
        """The engine's images of the tiles of a `Reading`, the same as before where there were some."""
        key = tuple(sampling.values())
        if key not in reading.images:
            tiles = reading.known
            numbered = (tiles.get(number, _MISSING_TILE) for number in range(max(tiles) + 1))
            reading.images[key] = tuple(Image(tile.pixels, srgb=tile.srgb, **sampling) for tile in numbered)
        return reading.images[key]

    def _reading(self, image, path, warn):
        """The `Reading` of an image; what of it cannot be read is reported."""
        if image.source == "MOVIE":
            warn(f"of image {image.name!r}, a movie, only the first frame is rendered")
        reading = self._cache.image(image, path, lambda: _linear_tiles(image, path))
        lost = [1001 + number for number, tile in reading.tiles.items() if tile is None]
        if lost:
            self._report_lost(image, path, lost if len(lost) < len(reading.tiles) else (), warn)
        self._report_spaces(image, reading.known, warn)
        return reading

    def _report_lost(self, image, path, tiles, warn):
        """Report an image that cannot be read, or those `tiles` of it."""
        what = f"image {image.name!r}"
        if tiles:
            what = f"{'tile' if len(tiles) == 1 else 'tiles'} {', '.join(map(str, tiles))} of {what}"
        place = path or image.filepath
        warn(f"{what}{f' ({place})' if place else ''} cannot be read; pink is used instead")

    def _report_spaces(self, image, tiles, warn):
        for instead in {tile.instead for tile in tiles.values() if tile.instead}:
            space = image.colorspace_settings.name
            warn(f"image {image.name!r} is read as {instead}, not as {space}")

    def _key(self, node):
        """What tells the pixels of a node's image: the image, and the file of what is moving."""
        image, path = node.image, ""
        if image.source == "SEQUENCE":
            path = frame_path(image, node.image_user, self._frame)
        elif image.source == "MOVIE":
            path = file_path(image)
        return original_key(image), path


def _linear_tiles(image, path):
    """The `Linear` by number of the tiles of an image, of most one; None for those that cannot be read."""
    if image.source == "TILED":
        tiles = read_tiles(image)
    else:
        tiles = {0: read_file(path, image) if path else read_clean_file(image)}
    return {number: None if stored is None else to_linear(stored) for number, stored in tiles.items()}
