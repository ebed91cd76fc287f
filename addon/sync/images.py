# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of Blender as engine images, each read once, whatever nodes use it, and again where it changed."""

from dataclasses import dataclass

import numpy as np

from ..engine.expression import Parameter, call
from ..engine.image import Image
from .color_spaces import working_space
from .image_pixels import Linear, file_path, frame_path, read_clean_file, read_file, read_tiles, to_linear
from .keys import original_key
from .memory import Memory
from .places import Places
from .reports import Reports

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


#: The token of what depends on the frame.
FRAME = "frame"


def image_places():
    """The `Places` of engine Images."""
    return Places(Image(np.zeros((1, 1, 4), np.uint8), name="vacant"))


class Images:
    """The images of a scene at a frame. `places`: the `Places` of engine Images, those of earlier reads too. `asked`:
    the numbers of all that were asked for, in order; `keys`: (uid, path) of what was read."""

    def __init__(self, frame=1, memory=None, places=None):
        self._frame = frame
        self._memory = memory or Memory(Reports(lambda level, message: None))
        self._places = image_places() if places is None else places
        self.asked, self.keys = [], set()

    def picture(self, node, warn, *, divided=False):
        """The `Picture` of an image or environment texture node; None where it is missing.

        `warn` takes what there is to report, and what of that is said once. `divided`: the color is to be had without
        its alpha.
        """
        if node.image is None:
            warn("it has no image; pink is used instead")
            return None
        image_key = self._key(node)
        tiles, notes = self._memory.get(("image", *image_key), lambda previous: self._read(node, image_key, previous))
        for note in notes:
            warn(note, (image_key, note))
        if not tiles:
            return None
        sampling = {
            "name": node.image.name,
            "interpolation": _INTERPOLATIONS.get(node.interpolation, "LINEAR"),
            "extension": getattr(node, "extension", "REPEAT"),  # a panorama has none
            "divided": divided and not any(tile.is_straight for tile in tiles.values()),
        }
        return self._numbered(
            ("picture", *image_key, *sampling.values()), tiles, lambda: _images(node.image, tiles, sampling)
        )

    def table(self, key, make):
        """The `Picture` of what `make` gives, pixels (h, w, 3 or 4) float32, mixed linearly and repeated; made once for
        a key."""
        return self._numbered(("table", working_space(), *key), None, lambda: ([Image(make(), name=key[0])], False))

    def _numbered(self, key, source, make):
        """The `Picture` of the images that `make` gives, together with whether they are tiles; it is made again where
        `source` is another object than before."""

        def made(_):
            images, tiled = make()
            number = self._number(key, images)
            return Picture(Parameter(number, "int"), Parameter(len(images), "int") if tiled else None), source

        picture = self._memory.get(key, made, id(source))[0]
        self.asked += self._places.of(key)
        return picture

    def _number(self, key, images):
        """The number of the first of images; those of the next frame get the place of the one before."""
        before = self._frame_before(key)
        if before is not None and not self._places.of(key):
            self._places.rename(before, key)
        return self._places.put(key, images)

    def _frame_before(self, key):
        """The key of what a sequence showed before, whose place is free now; None where there is none."""
        if key[0] == "table":
            return None
        like = (key[1], *key[3:])
        found = (other for other in self._places.keys() if other[0] == "picture" and (other[1], *other[3:]) == like)
        return next((other for other in found if not self._memory.holds(other)), None)

    def _read(self, node, key, previous):
        """(the `Linear` by number of the tiles of a node's image, of most one; what there is to report). Without tiles
        where it has none. What is as before is the same object."""
        self.keys.add(key)
        self._memory.depend(key[0], *([FRAME] if node.image.source in ("SEQUENCE", "MOVIE") else []))
        image, path, notes = node.image, key[1], []
        tiles = read_tiles(image) if image.source == "TILED" else {0: self._stored(image, path, notes.append)}
        lost = [1001 + number for number, stored in tiles.items() if stored is None]
        if lost:
            self._report_lost(image, path, lost if len(lost) < len(tiles) else (), notes.append)
        tiles = {number: to_linear(stored) for number, stored in tiles.items() if stored is not None}
        self._report_spaces(image, tiles, notes.append)
        if previous is not None and _alike(previous[0], tiles):
            tiles = previous[0]
        return tiles, tuple(notes)

    def _stored(self, image, path, warn):
        if image.source == "MOVIE":
            warn(f"of image {image.name!r}, a movie, only the first frame is rendered")
        return read_file(path, image) if path else read_clean_file(image)

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


def _images(image, tiles, sampling):
    """(the engine's images of tiles by number, pink where one is missing; whether they are tiles)."""
    every = (tiles.get(i, _MISSING_TILE) for i in range(max(tiles) + 1))
    made = [Image(tile.pixels, srgb=tile.srgb, **sampling) for tile in every]
    return made, image.source == "TILED"


def _alike(tiles, others):
    """Whether the `Linear` of tiles are equal."""
    return tiles.keys() == others.keys() and all(
        vars(tile) | {"pixels": 0} == vars(others[number]) | {"pixels": 0}
        and tile.pixels.dtype == others[number].pixels.dtype
        and np.array_equal(tile.pixels, others[number].pixels)
        for number, tile in tiles.items()
    )
