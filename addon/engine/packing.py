"""From a `Scene` to the arrays that go to the GPU: trees, records in data textures, and where each kind of record
begins.

Nothing here draws. Lengths become relative to an origin near the camera, so that float32 keeps its digits where
people look.
"""

from dataclasses import replace

import numpy as np

from . import data_texture, instance_packing, layout, leaves, reference, table_packing
from .attribute_packing import AttributeWriter
from .changes import Change
from .errors import SceneError, StoppedError
from .expression import is_zero
from .image_packing import add_images
from .light_packing import pack_all_lights
from .material_packing import MaterialTable
from .origin import find_origin
from .packed_scene import PackedScene
from .plan import PLANE_ATTRIBUTES, check_matrices, make_plan
from .primitives import BY_KIND, Similarity
from .residency import Residency, ResidentInstances, ResidentPlanes, Upload, is_same, references
from .scene_features import features_of_packed
from .settings import SHADOWS
from .timing import timed
from .tree_packing import QUICK_FROM, TreePacker, rows_by_kind

#: Levels that a good tree may have more than a quick one without another program.
_DEEPER = 6


def pack(scene, max_texture_size, before=None, *, keep=False, quick=False, stopped=None):
    """Pack a scene for a device whose textures are at most `max_texture_size` wide and high.

    `before`: the `Residency` of the scene whose textures are there; what both share is not packed again. `keep`:
    whether to keep what makes later scenes that share much with this one cheap. `quick`: whether to build large trees
    quickly, at the price of slower rays. Packing the scene again, not quickly, with `before` of this one replaces them.
    `stopped()` is asked now and then whether to raise StoppedError.

    Raises SceneError when the scene has no camera, refers to what does not exist, or does not fit; the latter before a
    tree is built.
    """
    if scene.camera is None:
        raise SceneError("the scene has no camera; add one")
    seconds, limit = {}, data_texture.most_texels(max_texture_size)
    with timed(seconds, "build"):
        try:
            packed = _Packer(scene, limit, before, keep, quick, stopped).pack()
        except _NoRoomError:
            packed = _Packer(scene, limit, None, keep, quick, stopped, grids=False).pack()
            packed.change |= Change.ALL_TEXTURES
            for upload in packed.uploads.values():
                upload.anew = True
    packed.statistics["seconds"] = seconds
    return packed


def _bounds_of(top, trees):
    """The box (2, 3) of everything that stands in trees, zero without any."""
    if top is not None:
        return top.bounds
    return next((tree.bounds for tree in trees.trees.values()), np.zeros((2, 3)))


class _NoRoomError(Exception):
    """There is room for a scene, but not beside what lies there already or with grids."""


class _Packer:
    """State while a scene is packed. The constructor refuses what cannot be rendered, before anything large is made.

    `before`: the `Residency` that the scene before left behind, None where there is nothing.
    """

    def __init__(self, scene, limit, before, keep, quick, stopped, grids=True):
        self._stopped = stopped or (lambda: False)
        self.scene, self.limit, self.before = scene, limit, before or Residency()
        self.keep, self.quick, self.grids = keep, quick, grids
        self.numbers, self.there_is_more = self.before.numbers, before is not None
        self.plan = make_plan(scene, self.numbers)
        self.plan.check(limit)
        check_matrices(scene, self.before)
        self.materials = MaterialTable(scene, self.plan)
        self.origin = find_origin(scene, self.plan, self.before.origin)
        self.residency = self.before.copy()
        self.residency.origin = self.origin
        self.uploads, self.frame, self.warnings, self.change = {}, {}, [], Change.NONE

    def pack(self):
        plan, residency = self.plan, self.residency
        written = self._geometries_to_write()
        stand = not written.size and self._instances_stand()
        top_nodes = 0 if stand else plan.top_nodes
        options = {"keep": self.keep, "quick": self.quick, "grids": self.grids}
        trees = TreePacker(plan, written, residency, self.origin, top_nodes=top_nodes, **options)
        keys = self._attributes_to_write(written, stand)
        attributes = AttributeWriter(plan.attributes, keys, residency.arenas["attribute"])
        if plan.placed and not stand:
            self._instance_rows = self._take_rows()
        self._check_room()
        trees.add(attributes, self._replaced_by, self._check_wanted)
        residency.geometries |= trees.settle()
        self._check_room()
        self._check_wanted()
        self._add_attributes(written, attributes)
        with timed(trees.seconds, "instances"):
            self._instances(trees, attributes, stand)
        trees.finish()
        self.uploads |= trees.uploads
        self.refitted = trees.refitted
        if attributes.upload.count:
            self.uploads["attributes"] = attributes.upload
            self.change |= Change.ATTRIBUTES
        planes = self._tables(trees, attributes)
        self._drop_what_went(written, stand)
        root = self._root(trees)
        low, high = reference.split_index(root)
        self.frame |= {
            **self.lights.frame,
            **leaves.places_outside(self.plan, trees.bases[0]),
            "plane_count": len(planes),
            "root": low,
            "root_high": high,
            "root_count": len(trees.trees),
            "geometry_count": len(plan.geometries),
            "world_material": self.materials.world,
            "outline_attribute": self._outline_attribute(),
            "world_visibility": int(self.scene.world.visibility),
        }
        top = residency.instances.tree if residency.instances else None
        depth = max((tree.depth for tree in trees.trees.values()), default=0) + (top.depth if top is not None else 0)
        return PackedScene(
            origin=self.origin,
            uploads=self.uploads,
            frame=self.frame,
            features=self._features(planes),
            constants={"BVH_STACK_SIZE": self._stack_size(depth + 1)},
            programs=self.materials.programs.text(),
            world=self.scene.world,
            world_programs=self.materials.world_programs,
            shadows_pass={way: self.lights.varies or self.materials.lets_shadows_pass(way) for way in SHADOWS},
            bounds=_bounds_of(top, trees),
            statistics=self._statistics(trees, top, depth),
            warnings=self.warnings,
            needs_light=self._needs_light(),
            residency=residency,
            change=self.change,
            tables=self.tables,
            table_texels=self.uploads["tables"].texels.reshape(-1, 4) if self.keep else None,
        )

    def _check_wanted(self):
        if self._stopped():
            raise StoppedError("packing was stopped")

    def _check_room(self):
        has_grids = any(resident.tree.is_grid for resident in self.residency.geometries.values())
        if (self.there_is_more or has_grids) and not self.residency.fits(self.limit):
            raise _NoRoomError

    # What is there already

    def _geometries_to_write(self):
        """Numbers (n,) of the geometries whose records are not there."""
        moved = self.origin.tobytes() if self.origin.any() else b""
        needed = {}
        for name, number, kind in self.plan.attributes.texels:
            needed.setdefault(number, set()).add((name, kind))

        def is_there(number):
            resident = self.before.geometries.get(number)
            if resident is None or not resident.is_of(
                self.plan.geometries[number], moved if self.plan.in_world[number] else b""
            ):
                return False
            if not self._is_good_enough(resident):
                return False
            # Attributes lie in the order of the tree, which must be known for those that are new.
            return resident.kept or needed.get(number, set()) <= set(resident.attributes)

        return np.array([number for number in self.plan.built.tolist() if not is_there(number)], np.int64)

    def _replaced_by(self, number):
        """The `Resident` whose tree a geometry may have again."""
        replaced = self.plan.geometries[number].replaces
        resident = self.before.geometries.get(self.numbers.get(id(replaced)))
        serves = resident and resident.kept and self._is_good_enough(resident)
        return resident if serves and np.array_equal(resident.counts, self.plan.counts[number]) else None

    def _is_good_enough(self, resident):
        """Whether the tree of a `Resident` or of `ResidentInstances` need not give way to a better one."""
        return self.quick or not resident.quick

    def _attributes_to_write(self, written, instances_stand):
        """Keys of the `AttributePlan` whose values are not there."""
        known, written = set(), set(written.tolist())
        for number, resident in self.before.geometries.items():
            if number not in written:
                known |= {(name, number, kind) for name, kind in resident.attributes}
        if instances_stand and self.before.instances:
            place = len(self.plan.geometries), layout.KINDS.index("instance")
            known |= {(name, *place) for name in self.before.instances.attributes}
        if is_same(self.before.planes.planes, self.scene.planes):
            known |= {(name, *PLANE_ATTRIBUTES) for name in self.before.planes.attributes}
        return [key for key in self.plan.attributes.texels if key not in known]

    def _add_attributes(self, written, attributes):
        """Write the attributes that are new on geometries that are not, and those of planes."""
        kinds, written = len(BY_KIND), set(written.tolist())
        for number in {number for _, number, kind in attributes.first if kind < kinds} - written:
            resident = self.residency.geometries[number]
            parts, outside = self.plan.parts(number)
            for label, part, order in rows_by_kind(resident.kept.form.bvh, parts):
                attributes.write((number, label), part, order)
            for label, part in outside.items():
                attributes.write((number, label), part, np.arange(len(part)))
            ranges = resident.attributes | attributes.ranges(number)
            self.residency.geometries[number] = replace(resident, attributes=ranges)
        if not is_same(self.before.planes.planes, self.scene.planes):
            self.residency.planes = ResidentPlanes(references(self.scene.planes), {})
        planes = [key for key in attributes.first if key[1:] == PLANE_ATTRIBUTES]
        if planes:
            joined = self.scene.joined_planes()
            ranges = dict(self.residency.planes.attributes)
            for key in planes:
                attributes.texels(key)[:] = joined.attributes[key[0]][:, 0]
                ranges[key[0]] = attributes.first[key], len(joined)
            self.residency.planes = ResidentPlanes(references(self.scene.planes), ranges)

    def _drop_what_went(self, written, instances_stand):
        """Give back where things lay that the scene has no more: the next scene may lie there."""
        before, now, plan = self.before, self.residency, self.plan
        gone = {n for n in before.geometries if n >= len(plan.geometries) or not plan.counts[n].any()}
        for number in gone:
            del now.geometries[number]
        for number in gone | (set(written.tolist()) & set(before.geometries)):
            now.drop_geometry(before.geometries[number])
        if before.instances and not instances_stand:
            now.drop_instances(before.instances)
        if now.planes.planes != before.planes.planes:
            now.drop_attributes(before.planes)
        if gone or len(written) > self.refitted:
            self.change |= Change.GEOMETRY
        if self.refitted:
            self.change |= Change.REFIT

    def _outline_attribute(self):
        name = self.scene.outline_attribute
        return self.plan.attributes.number(name) if name else -1

    # Instances

    def _instance_key(self):
        """What the records of the instances are made from, but for the `Instances` themselves."""
        plan, numbers, trees = self.plan, self.plan.placed_numbers, self.residency.geometries
        return (
            tuple(trees[number].tree.root for number in (*numbers, *([0] if plan.shapes else []))),
            tuple(numbers),
            plan.in_world[numbers].tobytes(),
            tuple(self.materials.firsts),
            self.origin.tobytes(),
            plan.attributes.instances,
        )

    def _instances_stand(self):
        """Whether the records of all instances are there; asked where no geometry is new."""
        there, placed = self.before.instances, self.plan.placed
        if there is None:
            return not placed
        return self._is_good_enough(there) and there.is_of(placed, self._instance_key())

    def _instances(self, trees, attributes, stand):
        """Write the records of the instances and the upper tree."""
        plan, residency = self.plan, self.residency
        if not stand:
            if plan.placed or residency.instances:
                self.change |= Change.INSTANCES
            residency.instances = self._new_instances(trees, attributes) if plan.placed else None
        there = residency.instances
        if there:
            first = there.first * data_texture.WIDTH
            self.frame |= {"instance_first": first, "instance_surface_first": plan.instance_surface_first(first)}

    def _take_rows(self):
        """(First, number) of rows of the texture of instances."""
        arena, texels = self.residency.arenas["row"], self.plan.instance_texels(0)
        near = arena.end * data_texture.WIDTH + texels < data_texture.EXACT
        rows = -(-self.plan.instance_texels(0 if near else data_texture.EXACT) // data_texture.WIDTH)
        return arena.take(rows), rows

    def _new_instances(self, trees, attributes):
        plan = self.plan
        placed = instance_packing.blocks(self.scene, plan)
        instances = instance_packing.place(placed, plan, self.materials, self.origin)
        bounds, roots = np.zeros((len(plan.geometries), 2, 3)), np.zeros(len(plan.geometries), np.int64)
        for number, tree in trees.trees.items():
            bounds[number], roots[number] = tree.bounds, tree.reference
        there = self.before.instances
        before = there.kept if there and self._is_good_enough(there) else None
        like_before = before is not None and len(before.form.bvh.order) == plan.leaves
        top, kept = instance_packing.upper_tree(instances, bounds, before if like_before else None, quick=self.quick)
        quick = (there.quick if kept is before else self.quick) and plan.leaves >= QUICK_FROM
        first, rows = self._instance_rows
        start = first * data_texture.WIDTH
        count = plan.instance_texels(start)
        texture = data_texture.zeros(count)
        hits = data_texture.records_of(texture, layout.INSTANCE)[: plan.leaves]
        surfaces = data_texture.records_of(texture, layout.INSTANCE_SURFACE, plan.instance_surface_first(start) - start)
        instance_packing.write_records(hits, surfaces, instances, top.order, roots)
        instance_packing.write_attributes(attributes, placed, top.order)
        self.uploads["instances"] = Upload(start, texture, count)
        ranges = {name: value for (name, _), value in attributes.ranges(len(plan.geometries)).items()}
        built = trees.add_top(top)
        kept = kept if self.keep else None
        return ResidentInstances(self._instance_key(), references(plan.placed), first, rows, built, ranges, kept, quick)

    def _stack_size(self, needed):
        """References that can wait in a traversal, rounded up so that few programs are made; as before, if that is not
        much too large. Good trees are often a little deeper than quick ones, and those much deeper where shapes crowd.
        """
        size = -(-(needed + _DEEPER * bool(self.residency.quick)) // 8) * 8
        if not needed <= self.before.stack_size <= size + 32:
            self.residency.stack_size = size
        return self.residency.stack_size

    def _root(self, trees):
        """The reference to the node or the grid where a traversal begins."""
        if self.residency.instances:
            return self.residency.instances.tree.reference
        return next((tree.reference for tree in trees.trees.values()), 0)

    # What is few

    def _tables(self, trees, attributes):
        """Write the records that share the texture `tables`; those of the planes."""
        planes, plane_surfaces = self._planes()
        self.lights = pack_all_lights(self.scene, self.plan, self.materials, self.origin)
        self.warnings += self.lights.warnings
        materials, constants = self.materials.records(self.plan.attributes)
        materials["glow_area"][: len(self.lights.glow_area)] = self.lights.glow_area
        records = {
            "material": materials,
            "constant": constants,
            "glass_energy": self.materials.glass_energy(),
            **self.lights.records,
            "plane": planes,
            "plane_surface": plane_surfaces,
            "image": self._images(),
            "attribute": self._directory(trees, attributes),
        }
        self.tables, upload = table_packing.lay_out(records, self.limit)
        self.uploads["tables"] = upload
        self.frame |= {f"{name}_first": texels.start for name, texels in self.tables.items()}
        return planes

    def _planes(self):
        planes = self.scene.joined_planes()
        if planes is None:
            return layout.PLANE.zeros(0), layout.PLANE_SURFACE.zeros(0)
        return planes.transformed(Similarity(np.eye(3), 1.0, -self.origin)).records()

    def _directory(self, trees, attributes):
        """Records that say where the values of attributes lie."""
        first, now, count = dict(attributes.first), self.residency, len(self.plan.geometries)
        for number, resident in now.geometries.items():
            first |= {(name, number, kind): texel for (name, kind), (texel, _) in resident.attributes.items()}
        for name, (texel, _) in now.instances.attributes.items() if now.instances else ():
            first[name, count, layout.KINDS.index("instance")] = texel
        first |= {(name, *PLANE_ATTRIBUTES): texel for name, (texel, _) in now.planes.attributes.items()}
        return self.plan.attributes.directory(first, trees.bases)

    def _images(self):
        """Image records; their texels go in the texture `images`, reduced where they would not fit."""
        upload = add_images(self.scene.images, self.limit, self.residency)
        if upload:
            self.uploads["images"] = upload
            self.change |= Change.IMAGES
        self.warnings += self.residency.reduced
        return np.array([image.record for image in self.residency.images], layout.IMAGE.dtype)

    def _needs_light(self):
        """Whether there are surfaces that only light makes visible, and neither lamps nor what glows."""
        diffuse = any(not is_zero(material.diffuse) for material in self.materials.materials)
        shown = len(self.plan.built) or self.scene.planes
        return bool(diffuse and shown and not len(self.lights.records["light"]))

    # The whole

    def _features(self, planes):
        in_grids = np.zeros(len(self.plan.geometries), bool)
        in_grids[[number for number, resident in self.residency.geometries.items() if resident.tree.is_grid]] = True
        return features_of_packed(self.plan, in_grids, planes, self.materials, self.lights)

    def _statistics(self, trees, top, depth):
        plan = self.plan
        built = [*trees.trees.values(), *([top] if top is not None else [])]
        nodes = sum(tree.nodes for tree in built if not tree.is_grid)
        if plan.largest in trees.trees:
            cost = trees.trees[plan.largest].sah_cost
        else:
            cost = top.sah_cost if top is not None else 0.0
        return {
            "primitives": self.scene.primitive_counts(),
            "instances": sum(map(len, plan.placed)),
            "geometries": len({id(p.geometry) for p in plan.placed}),
            "bvh": {"nodes": nodes, "depth": depth, "sah_cost": cost, "grids": sum(tree.is_grid for tree in built)},
            "build": trees.seconds,
        }
