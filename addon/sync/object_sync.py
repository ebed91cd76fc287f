# SPDX-License-Identifier: GPL-3.0-or-later
"""The objects of a depsgraph in two phases: read what its copies are drawn as, then place them."""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from .attributes import parts_of
from .compat import has_geometry_sets
from .contents import SILENT, Contents
from .instancing import copies_in
from .light_linking import LightLinks
from .pixel_sizes import PixelSizes
from .placement import Placement, Stand, placed_matrices
from .taken import materials_of
from .visibility import Visibilities, shown_in


@dataclass
class _Asset:
    """What stands in the scene once or many times, with one set of materials and one visibility.

    `entries`: (`Copies`, the constant attributes of what they are drawn as, (4,) by key).
    """

    content: object
    materials: tuple
    visibility: object
    keys: frozenset = frozenset()
    entries: list = field(default_factory=list)


class ObjectSync:
    """Reads the objects of a depsgraph, then places them in the engine scene."""

    def __init__(self, scene, shadings, lights, reports, depsgraph, height, space=None):
        self._scene, self._shadings, self._lights, self._reports = scene, shadings, lights, reports
        self._override = depsgraph.view_layer.material_override
        self._copies = copies_in(depsgraph, shown_in(space))
        self._links = LightLinks(self._copies, reports)
        self._visibilities = Visibilities(depsgraph.view_layer, self._links)
        self._contents = Contents(depsgraph, PixelSizes(scene.camera, height, self._copies), reports)
        self._assets = {}
        self._found = {}

    def read(self):
        """Find what everything is drawn as; how many objects were taken as each kind, and the number of `instances`."""
        counts = Counter()
        for copies in self._copies:
            if copies.kind == "LIGHT":
                for matrix in copies.matrices.astype(np.float64):
                    self._lights.add(copies.obj, matrix, self._links)
            elif copies.kind not in SILENT:
                for asset, constants in self._assets_of(copies):
                    asset.entries.append((copies, constants))
                    counts["instances" if copies.are_instances else asset.content.kind] += len(copies)
        return dict(counts)

    def place(self):
        """Put every copy into the scene; those that cannot be, scaled to zero or nowhere, are reported."""
        placement = Placement(self._scene)
        for asset in self._assets.values():
            matrices = [copies.matrices for copies, _ in asset.entries]
            matrices = matrices[0] if len(matrices) == 1 else np.concatenate(matrices)
            world, good = placed_matrices(asset.content.drawn, matrices)
            self._report_lost(asset, matrices, good)
            if good.any():
                drawn = asset.content.drawn
                name = asset.entries[_entry_of(asset, int(np.argmax(good)))][0].obj.name
                stand = Stand(drawn, asset.materials, asset.visibility, name, world, self._attributes(asset))
                placement.place(stand.take(good))
        placement.finish()

    def _attributes(self, asset):
        """The attributes of an asset's copies, (n, 4) float32 by key; 0 where there is none."""
        if not asset.keys:
            return {}
        ends = np.cumsum([0, *(len(copies) for copies, _ in asset.entries)])
        found = {}
        for (copies, constants), start, end in zip(asset.entries, ends[:-1], ends[1:], strict=True):
            values = constants | copies.values(asset.keys)
            self._report_unread(copies, asset.keys - values.keys())
            for key, of_copies in values.items():
                if key not in found:
                    found[key] = np.zeros((ends[-1], 4), np.float32)
                found[key][start:end] = of_copies
        return found

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

    def _report_lost(self, asset, matrices, good):
        """Name the objects, each once, of which copies cannot be drawn."""
        bad = np.flatnonzero(~good)
        if not len(bad):
            return
        finite = np.isfinite(matrices[bad]).all(axis=(1, 2))
        for rows, why in ((finite, "scaled to zero"), (~finite, "in a place or of a scale that is not finite")):
            counts = np.bincount(_entry_of(asset, bad[rows]), minlength=len(asset.entries))
            for entry in np.flatnonzero(counts):
                copies, lost = asset.entries[entry][0], counts[entry]
                which = "" if not copies.are_instances else f": {lost:,} of {len(copies):,} instances"
                verb = "are" if which and lost > 1 else "is"
                self._reports.warn(f"object {copies.obj.name!r}{which} {verb} {why} and {verb} not rendered")

    def _assets_of(self, copies):
        """The assets, with constant attributes, of which these are copies; none, reported, where nothing shows."""
        visibility = self._visibilities.of(copies.obj, copies.root)
        if not visibility:
            return ()
        shadings = self._shadings_of(copies)
        key = self._contents.key(copies), tuple(shading.index for shading in shadings), visibility
        if key not in self._found:
            self._found[key] = tuple(self._read(copies, shadings, visibility))
        return self._found[key]

    def _read(self, copies, shadings, visibility):
        for content in self._contents.of(copies, shadings):
            of_content = shadings
            if not content.is_closed:
                of_content = tuple(self._shadings.of_sheet(shading) for shading in shadings)
            materials = tuple(shading.index for shading in of_content)
            key = id(content.drawn), materials, visibility
            if key not in self._assets:
                keys = frozenset(name for shading in of_content for name in shading.attributes)
                self._assets[key] = _Asset(content, materials, visibility, keys)
            yield self._assets[key], content.constants

    def _shadings_of(self, copies):
        """The `Shading` of each slot, at least one."""
        if self._override is not None:
            return (self._shadings.of(self._override),)
        made = materials_of(copies.obj, copies.data, copies.is_own)
        return tuple(self._shadings.of(material) for material in made) or (self._shadings.of(None),)


def _entry_of(asset, rows):
    """The entries of an asset to which its copies `rows` belong."""
    ends = np.cumsum([len(copies) for copies, _ in asset.entries])
    return np.searchsorted(ends, rows, side="right")


def _uses_nodes(instancer):
    """Whether geometry nodes have a part in what an object instances."""
    collection = instancer.instance_collection
    objects = (instancer, *(collection.all_objects if collection is not None else ()))
    return any(modifier.type == "NODES" for obj in objects for modifier in obj.modifiers)
