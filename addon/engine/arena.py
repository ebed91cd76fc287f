"""Where things lie in a texture that grows: ranges that are taken and given back. It sees numbers only."""

from bisect import bisect


class Arena:
    """Takes ranges of units, whatever these are. What was taken never moves. `end`: units up to the last one taken."""

    def __init__(self):
        self.end = 0
        self._holes = []  # (first, count) of what is free below the end, in order, none beside another

    def copy(self):
        """One that is taken from independently."""
        new = Arena()
        new.end, new._holes = self.end, list(self._holes)
        return new

    def take(self, count):
        """First of `count` units that were free: the smallest hole that has room, else at the end."""
        fitting = [hole for hole in self._holes if hole[1] >= count]
        if not count or not fitting:
            first = self.end
            self.end += count
            return first
        first, room = hole = min(fitting, key=lambda hole: hole[1])
        place = self._holes.index(hole)
        self._holes[place : place + 1] = [(first + count, room - count)] if room > count else []
        return first

    def give_back(self, first, count):
        """Free units that were taken."""
        if not count:
            return
        holes, place = self._holes, bisect(self._holes, (first, count))
        start, stop = place, place
        if place < len(holes) and holes[place][0] == first + count:
            count, stop = count + holes[place][1], place + 1
        if place and sum(holes[place - 1]) == first:
            first, count, start = holes[place - 1][0], count + holes[place - 1][1], place - 1
        holes[start:stop] = [(first, count)]
        if sum(holes[-1]) == self.end:
            self.end = holes.pop()[0]
