# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects a light lights and which cast its shadows: Blender's light linking as groups of objects."""

from dataclasses import dataclass

from ..engine.visibility import GROUPS, Visibility
from .keys import original_key


@dataclass(frozen=True)
class _Group:
    """The objects, by key, that a collection includes, all if none, but for those that it excludes."""

    bit: Visibility
    included: frozenset
    excluded: frozenset

    def holds(self, keys):
        return not keys & self.excluded and (not self.included or bool(keys & self.included))


class LightLinks:
    """The groups of objects that `lights`, evaluated objects, are linked to."""

    def __init__(self, lights, reports):
        self._reports, self._groups = reports, {}
        for light in lights:
            for collection in _collections(light):
                self._add(collection, light)

    @property
    def groups(self):
        """All that decides which groups an object belongs to."""
        return frozenset(self._groups.values())

    def report_others(self, obj):
        """Report an evaluated object, no light, that has light linking of its own."""
        if any(_collections(obj)):
            self._reports.warn(f"object {obj.name!r}: its light linking is not rendered, only that of lights is")

    def receivers(self, light):
        """The group of what the light of a Blender object lights alone; 0: it lights everything."""
        return self._bit(light.original.light_linking.receiver_collection)

    def blockers(self, light):
        """The group of what casts its shadows alone; 0: everything does."""
        return self._bit(light.original.light_linking.blocker_collection)

    def groups_of(self, obj, root):
        """The groups that the copies of an object belong to which `root`, itself or its instancer, puts somewhere."""
        if not self._groups:
            return 0
        keys = {original_key(obj), original_key(root)}
        return sum(int(group.bit) for group in self._groups.values() if group.holds(keys))

    def _bit(self, collection):
        group = None if collection is None else self._groups.get(original_key(collection))
        return Visibility(0) if group is None else group.bit

    def _add(self, collection, light):
        if collection is None or original_key(collection) in self._groups:
            return
        if len(self._groups) == GROUPS:
            self._reports.warn(
                f"light {light.name!r} is not linked to {collection.name!r}: lights are linked to {GROUPS} other "
                "collections already, which is the most"
            )
            return
        included, excluded = set(), set()
        for entry, obj in zip(collection.collection_objects, collection.objects, strict=True):
            (included if entry.light_linking.link_state == "INCLUDE" else excluded).add(original_key(obj))
        for entry, child in zip(collection.collection_children, collection.children, strict=True):
            keys = map(original_key, child.all_objects)
            (included if entry.light_linking.link_state == "INCLUDE" else excluded).update(keys)
        bit = Visibility.group(len(self._groups))
        self._groups[original_key(collection)] = _Group(bit, frozenset(included), frozenset(excluded))


def _collections(obj):
    linking = obj.original.light_linking
    return linking.receiver_collection, linking.blocker_collection
