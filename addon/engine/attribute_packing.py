"""The values of attributes on their way to the GPU."""

from . import data_texture
from .residency import Upload
from .threads import pieces


class AttributeWriter:
    """Attributes that are to be uploaded: the values of the `keys` of an `AttributePlan`, in a range of an `Arena`.

    `first`: texel by key. `numbers`: of the geometries.
    """

    def __init__(self, plan, keys, arena):
        self.plan, self.first, self._ranges = plan, {}, {}
        self._start = end = arena.take(sum(plan.texels[key] for key in keys))
        for name, geometry, kind in keys:
            count = plan.texels[name, geometry, kind]
            self.first[name, geometry, kind] = end
            self._ranges.setdefault(geometry, {})[name, kind] = (end, count)
            end += count
        self.numbers = frozenset(self._ranges)
        self._texture = data_texture.zeros(end - self._start)
        self.upload = Upload(self._start, self._texture, end - self._start)

    def texels(self, key):
        """Where the values of a key go, (n, 4)."""
        start = self.first[key] - self._start
        return self._texture.reshape(-1, 4)[start : start + self.plan.texels[key]]

    def write(self, place, part, order):
        """Write the rows `order` of primitives at (geometry number, kind number), where they are asked for."""
        for name in self.plan.names:
            if (name, *place) in self.first:
                values = part.attributes[name]
                target = self.texels((name, *place)).reshape(-1, values.shape[1], 4)
                for rows in pieces(len(order)):
                    target[rows] = values[order[rows]]

    def ranges(self, number):
        """(First texel, texels) of what lies here of a geometry, by name and kind number."""
        return self._ranges.get(number, {})
