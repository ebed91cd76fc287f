# SPDX-License-Identifier: GPL-3.0-or-later
"""The objects of a depsgraph in two phases: read what its copies are drawn as, then place them."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from ..engine.scene import Geometry, Visibility
from .attributes import parts_of
from .changes import OBJECTS
from .comparing import same_dicts, same_values
from .compat import has_geometry_sets
from .contents import SILENT, Content, Contents
from .keys import original_key
from .light_linking import LightLinks
from .lights import Lights
from .memory import ALWAYS
from .pixel_sizes import STRANDS, PixelSizes
from .placement import MANY, Placed, Stand, World, place, placed_matrices
from .taken import materials_of
from .visibility import Visibilities, layer_flags

#: The sources of attributes that Blender does not report: properties of any name.
_UNREPORTED = {"property", "instancer"}


@dataclass(frozen=True, eq=False, slots=True)
class Part:
    """What one object of the scene has standing there of one content, with one set of materials and one visibility.

    `name`: of the object that is copied, `owner`: the uid of that of the scene. `matrices` (n, 4, 4), object to world.
    `attributes`: (4,), or (n, 4) where copies differ, by key. Nothing of Blender's.
    """

    content: Content
    materials: tuple
    visibility: object
    name: str
    owner: int
    matrices: np.ndarray
    attributes: dict
    are_instances: bool

    def __len__(self):
        return len(self.matrices)

    @property
    def stand(self):
        """What parts have in common that are placed together. Many copies are alone, so that no other touches them."""
        return self.content.drawn, self.materials, self.visibility, self.owner if len(self) >= MANY else 0

    def equals(self, other):
        return (
            (self.stand, self.name, self.are_instances) == (other.stand, other.name, other.are_instances)
            and (self.content.kind, self.content.is_closed) == (other.content.kind, other.content.is_closed)
            and same_values(self.matrices, other.matrices)
            and same_dicts(self.attributes, other.attributes)
        )


@dataclass(frozen=True, eq=False, slots=True)
class _OfObject:
    """What is known of an object: its `parts`, and whether only the iterator tells what else it makes."""

    parts: tuple
    by_iterator: bool = False


class ObjectSync:
    """Reads the objects of a depsgraph, a `SceneCopies`, then places them and the lights in the engine scene. `eyes`:
    as of `PixelSizes`."""

    def __init__(self, scene, copies, shadings, eyes, memory):
        self._scene, self._copies, self._shadings, self._memory = scene, copies, shadings, memory
        self._depsgraph, self._reports, self._lights = copies.depsgraph, memory.reports, Lights(scene, memory)
        self._override = self._depsgraph.view_layer.material_override
        self._seen = self._look()
        self._collect()
        lights = [copies.obj for copies in self._fresh() if copies.kind == "LIGHT"]
        strands = [copies for copies in self._fresh() if copies.kind in STRANDS]
        self._links = LightLinks(lights, self._reports)
        self._visibilities = Visibilities(self._depsgraph.view_layer, self._links)
        self.pixels = PixelSizes(eyes, strands)
        memory.get("pixel sizes", self.pixels.settle, version=object())
        self._contents = Contents(self._depsgraph, self.pixels, memory)
        self._common = memory.get("common", lambda _: object(), (self._common_key(), self._links.groups))
        self._parts = []

    def _look(self):
        """Of each object what Blender does not always report when it changes."""
        found = []
        for obj in self._copies.objects:
            data, settings = obj.data, obj.conic
            uid = 0 if data is None else data.session_uid
            found.append((uid, settings.primitive, settings.strand_radius, self._copies.shown(obj)))
        return found

    def _common_key(self):
        """What all objects depend on, but for the light linking."""
        override, settings = self._override, self._depsgraph.scene_eval.conic
        return (
            None if override is None else original_key(override),
            settings.recognise,
            self._scene.outline_attribute,
            layer_flags(self._depsgraph.view_layer),
        )

    def _collect(self):
        """Ask Blender for the copies of all that is not known, and of lights and strands, which are always read."""
        self._collected, self._others = {}, None
        memory, common = self._memory, self._memory.last("common")
        by_iterator = set()
        for number, uid in enumerate(self._copies.uids):
            key = "object", uid
            if memory.holds(key, (self._seen[number], common)):
                known = memory.last(key)
            else:
                known = self._collected[number] = self._copies.of(number)
            if known.by_iterator:
                by_iterator.add(uid)
        self._iterated = frozenset(by_iterator), self._copies.has_others()
        if any(self._iterated) and not memory.holds("others", (self._iterated, common)):
            self._others = self._copies.others(by_iterator)

    def _fresh(self):
        """The copies that were collected."""
        for found in self._collected.values():
            yield from found.copies
        yield from self._others or ()

    def read(self):
        """Find what everything is drawn as; how many objects were taken as each kind, and the number of `instances`."""
        get, common = self._memory.get, self._common
        for number, uid in enumerate(self._copies.uids):
            found = get(
                ("object", uid), lambda before, n=number: self._read_object(n, before), (self._seen[number], common)
            )
            self._parts += found.parts
        if any(self._iterated):
            self._parts += get("others", self._read_others, (self._iterated, common)).parts
        self._collected, self._others = {}, None  # nothing of Blender's is kept longer than it is needed
        counts = Counter()
        for part in self._parts:
            counts["instances" if part.are_instances else part.content.kind] += len(part)
        return dict(counts)

    def _read_object(self, number, before):
        found = self._collected.pop(number, None) or self._copies.of(number)
        self._memory.depend(self._copies.uids[number], *found.uids)
        return _OfObject(self._read(found.copies, before), found.by_iterator)

    def _read_others(self, before):
        self._memory.depend(OBJECTS)
        others = self._copies.others(self._iterated[0]) if self._others is None else self._others
        return _OfObject(self._read(others, before))

    def _read(self, all_copies, before):
        """The parts of copies; `before`: what the `_OfObject` was. What is as it was is the same object."""
        before = () if before is None else before.parts
        self._contents.before = list({id(part.content.drawn): part.content.drawn for part in before}.values())
        self._contents.before = [drawn for drawn in self._contents.before if isinstance(drawn, Geometry)]
        parts = []
        for copies in all_copies:
            if copies.kind == "LIGHT":
                self._memory.depend(ALWAYS)
                for matrix in copies.matrices.astype(np.float64):
                    self._lights.add(copies.obj, matrix, self._links)
                continue
            self._links.report_others(copies.obj)
            if copies.kind in STRANDS:
                self._memory.depend(ALWAYS)
            if copies.kind not in SILENT:
                parts += self._parts_of(copies)
        if len(parts) == len(before):
            return tuple(old if new.equals(old) else new for new, old in zip(parts, before, strict=True))
        return tuple(parts)

    def _parts_of(self, copies):
        """Yield the parts that copies are; none, reported, where nothing shows."""
        visibility = self._visibilities.of(copies.obj, copies.root)
        if not visibility:
            return
        owner = original_key(copies.root)
        for content, shadings in self._drawn(copies, self._shadings_of(copies)):
            keys = frozenset(key for shading in shadings for key in shading.attributes)
            if any(parts_of(key)[0] in _UNREPORTED for key in keys):
                self._memory.depend(ALWAYS)
            yield Part(
                content,
                tuple(shading.index for shading in shadings),
                visibility,
                copies.obj.name,
                owner,
                copies.matrices,
                self._attributes(copies, keys, content.constants),
                copies.are_instances,
            )

    def _drawn(self, copies, shadings):
        """Yield the contents of copies, each with the shadings of its slots."""
        key = self._contents.key(copies), tuple(shading.needs for shading in shadings)
        pixel = self.pixels.of(copies) if copies.kind in STRANDS else None
        version = self._depsgraph.scene_eval.conic.recognise, pixel
        drawn = self._memory.get(("drawn", *key), lambda _: self._contents.of(copies, shadings), version)
        for note in drawn.notes:
            self._reports.warn(f"object {copies.obj.name!r}{note}", once=(*key, note))
        for content in drawn.contents:
            if content.is_closed:
                yield content, shadings
            else:
                yield content, tuple(self._shadings.of_sheet(shading) for shading in shadings)

    def _attributes(self, copies, keys, constants):
        """The attributes of copies by key: (4,), or (n, 4) where they differ."""
        if not keys:
            return {}
        values = constants | copies.values(keys)
        self._report_unread(copies, keys - values.keys())
        return values

    def _report_unread(self, copies, keys):
        """Name the attributes of instances made by geometry nodes within older instancers, which Blender does not tell.
        Before Blender 4.5 it tells none, which the material says."""
        if copies.random_ids is None or not has_geometry_sets() or not _uses_nodes(copies.instancer):
            return
        for key in sorted(keys):
            source, name, _ = parts_of(key)
            if source == "instancer":
                whose = f"instances within those of {copies.instancer.name!r}"
                self._reports.warn(f"object {copies.obj.name!r}: the attribute {name!r} of {whose} is not rendered")

    def _shadings_of(self, copies):
        """The `Shading` of each slot, at least one."""
        if self._override is not None:
            return (self._shadings.of(self._override),)
        made = materials_of(copies.obj, copies.data, copies.is_own)
        return tuple(self._shadings.of(material) for material in made) or (self._shadings.of(None),)

    def place(self):
        """Put every copy into the scene; those that cannot be, scaled to zero or nowhere, are reported."""
        stands = {}
        for part in self._parts:
            stands.setdefault(part.stand, []).append(part)
        worlds = {Visibility.ALL: []}  # the world's own geometry stays the same, empty too
        for key, parts in stands.items():
            placed = self._memory.get(
                ("placed", *key), lambda before, parts=parts: self._place(parts, before), tuple(parts)
            )
            if placed.in_world:
                worlds.setdefault(placed.visibility, []).append(placed.in_world)
            self._scene.instances += placed.instances
            self._scene.planes += placed.planes
        for visibility, pieces in worlds.items():
            world = self._memory.get(
                ("world", visibility),
                lambda before, pieces=pieces, visibility=visibility: World(pieces, visibility, before),
                tuple(map(id, pieces)),
            )
            if visibility == Visibility.ALL:
                self._scene.shapes = world.geometry
            else:
                self._scene.instances.append(world.instances)

    def _place(self, parts, before):
        """What parts that stand together are in the scene (`Placed`)."""
        content = parts[0].content
        matrices = [part.matrices for part in parts]
        matrices = matrices[0] if len(matrices) == 1 else np.concatenate(matrices)
        world, good = placed_matrices(content.drawn, matrices)
        self._report_lost(parts, matrices, good)
        if not good.any():
            return Placed(parts[0].visibility)
        name = parts[_part_of(parts, int(np.argmax(good)))].name
        stand = Stand(content.drawn, parts[0].materials, parts[0].visibility, name, world, _joined(parts))
        return place(stand.take(good), before)

    def _report_lost(self, parts, matrices, good):
        """Name the objects, each once, of which copies cannot be drawn."""
        bad = np.flatnonzero(~good)
        if not len(bad):
            return
        finite = np.isfinite(matrices[bad]).all(axis=(1, 2))
        for rows, why in ((finite, "scaled to zero"), (~finite, "in a place or of a scale that is not finite")):
            counts = np.bincount(_part_of(parts, bad[rows]), minlength=len(parts))
            for number in np.flatnonzero(counts):
                part, lost = parts[number], counts[number]
                which = "" if not part.are_instances else f": {lost:,} of {len(part):,} instances"
                verb = "are" if which and lost > 1 else "is"
                self._reports.warn(f"object {part.name!r}{which} {verb} {why} and {verb} not rendered")


def _part_of(parts, rows):
    """The parts to which copies, `rows` of all of theirs, belong."""
    ends = np.cumsum([len(part) for part in parts])
    return np.searchsorted(ends, rows, side="right")


def _joined(parts):
    """The attributes of the copies of all parts, (n, 4) float32 by key; 0 where there is none."""
    keys = dict.fromkeys(key for part in parts for key in part.attributes)
    if not keys:
        return {}
    if len(parts) == 1:
        return {key: np.broadcast_to(values, (len(parts[0]), 4)) for key, values in parts[0].attributes.items()}
    ends = np.cumsum([0, *map(len, parts)])
    found = {key: np.zeros((ends[-1], 4), np.float32) for key in keys}
    for part, start, end in zip(parts, ends[:-1], ends[1:], strict=True):
        for key, values in part.attributes.items():
            found[key][start:end] = values
    return found


def _uses_nodes(instancer):
    """Whether geometry nodes have a part in what an object instances."""
    collection = instancer.instance_collection
    objects = (instancer, *(collection.all_objects if collection is not None else ()))
    return any(modifier.type == "NODES" for obj in objects for modifier in obj.modifiers)
