"""From the textures of one scene to those of the next, without touching what the first one draws."""

import numpy as np

from . import data_texture
from .timing import timed

#: Texels that are uploaded at once where time is short: 4 MiB.
_PIECE = 1 << 18
#: How much more room a texture gets that must grow.
_SPARE = 1.25


class NewTextures:
    """The textures of an update while they come to be: those of the scene before, until they are put anew or grow.

    What the scene before draws is not touched: to a texture that both share only what lies where that has nothing is
    written. `rooms`: texels that there is room for, by name.
    """

    def __init__(self, device, update, before, in_pieces):
        self.device, self.update = device, update
        # Pieces are copied twice more: not where there is nothing to draw meanwhile.
        self.in_pieces = in_pieces and before is not None
        self.textures, self.rooms = (dict(before.textures), dict(before.rooms)) if before else ({}, {})
        self._tables = before.packed.table_texels if before else None
        for name in update.packed.residency.unused_textures():
            self.leave_out(name)

    def add(self, name, upload):
        """Bring an `Upload` to the texture of a name; yields between pieces."""
        texels, here = upload.texels, name in self.textures and not upload.anew
        if name == "tables" and self._tables is not None:
            self._add_tables(upload)
        elif not here and not self.in_pieces:
            self.put(name, texels)
            yield
        elif upload.count:
            room = upload.first + upload.count
            if not here:
                self._place(name, self.device.grown(None, room), room)
            elif room > self.rooms[name]:
                self._grow(name, room)
            yield
            flat = texels.reshape(-1, 4)[: upload.count]
            for start in range(0, len(flat), _PIECE):
                self._update(name, upload.first + start, flat[start : start + _PIECE])
                yield

    def put(self, name, texels):
        """Make the texture of a name anew of texels (height, width, 4)."""
        with timed(self.update.seconds, "upload"):
            self._place(name, self.device.texture(texels), texels.size // 4)
        self._count(name, texels.size // 4)

    def complete(self, names):
        """Put something where a program asks for what the scene has nothing of."""
        for name in names:
            if name not in self.textures:
                self._place(name, self.device.texture(data_texture.zeros(1)), 1)

    def leave_out(self, name):
        self.textures.pop(name, None)
        self.rooms.pop(name, None)

    def _add_tables(self, upload):
        """The tables are made anew each time: what differs goes to a copy of those that are there."""
        texels, there = upload.texels.reshape(-1, 4)[: upload.count], self._tables
        spans = _spans_that_differ(there, texels)
        if spans:
            self._grow("tables", max(len(texels), self.rooms["tables"]))
        for start, stop in spans:
            self._update("tables", start, texels[start:stop])

    def _grow(self, name, room):
        """A copy with room for so many texels and, where more than before is needed, some to spare."""
        if room > self.rooms[name]:
            most = data_texture.most_texels(self.device.max_texture_size)
            room = max(room, min(-(-int(room * _SPARE) // data_texture.WIDTH) * data_texture.WIDTH, most))
        with timed(self.update.seconds, "upload"):
            self._place(name, self.device.grown(self.textures[name], room), room)

    def _place(self, name, texture, room):
        self.update.made.append(texture)
        self.textures[name], self.rooms[name] = texture, room

    def _update(self, name, first, texels):
        with timed(self.update.seconds, "upload"):
            self.device.update(self.textures[name], first, texels)
        self._count(name, len(texels))

    def _count(self, name, texels):
        self.update.bytes[name] = self.update.bytes.get(name, 0) + 16 * texels


def _spans_that_differ(before, now, gap=64):
    """[start, stop) of the rows of `now` (n, 4) that `before` has otherwise; those less than a `gap` apart are one."""
    common = min(len(before), len(now))
    differ = np.ones(len(now), bool)
    differ[:common] = (before[:common] != now[:common]).any(axis=1)
    rows = np.flatnonzero(differ)
    if not len(rows):
        return []
    cuts = np.flatnonzero(np.diff(rows) > gap)
    starts, stops = rows[np.append(0, cuts + 1)], rows[np.append(cuts, len(rows) - 1)] + 1
    return list(zip(starts.tolist(), stops.tolist(), strict=True))
