# SPDX-License-Identifier: GPL-3.0-or-later
"""Things that are known by their number in a list, and keep it from read to read."""


class Places:
    """Things by place, a list in `things`. Those of a key stand one after the other, where they stood before if they
    are as many. `vacant` stands where nothing else does.

    `spare`: so many keys that nobody uses are kept, for the case that they come back; more make room, all of them.
    """

    def __init__(self, vacant, spare=0):
        self.things = []
        self._vacant, self._spare = vacant, spare
        self._slices, self._free = {}, set()

    def of(self, key):
        """The numbers of the things of a key, a range."""
        place = self._slices.get(key, slice(0, 0))
        return range(place.start, place.stop)

    def keys(self):
        """All that have a place."""
        return self._slices.keys()

    def put(self, key, things):
        """Let `things` be those of a key; the number of the first."""
        place = self._slices.get(key)
        if place is None or place.stop - place.start != len(things):
            self.drop(key)
            place = self._slices[key] = self._room(len(things))
        self.things[place] = things
        return place.start

    def rename(self, key, new):
        """Let the things of a key be those of another one, which had none."""
        self._slices[new] = self._slices.pop(key)

    def drop(self, key):
        """Make room where the things of a key stand, if it has any."""
        place = self._slices.pop(key, None)
        if place is not None:
            self.things[place] = [self._vacant] * (place.stop - place.start)
            self._free.update(range(place.start, place.stop))

    def drop_unused(self, is_used):
        """Make room where too many stand that nobody uses: those of keys for which `is_used(key)` is false."""
        unused = [key for key in self._slices if not is_used(key)]
        for key in unused if len(unused) > self._spare else ():
            self.drop(key)

    def _room(self, count):
        """Where `count` further things may stand: a vacant place for a single one, else the end."""
        if count == 1 and self._free:
            number = min(self._free)
            self._free.remove(number)
            return slice(number, number + 1)
        return slice(len(self.things), len(self.things) + count)
