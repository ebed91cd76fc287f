"""From a `Scene` to the arrays that go to the GPU: trees, records in data textures, and where each kind of record
begins.

Nothing here draws. Lengths become relative to an origin near the camera, so that float32 keeps its digits where
people look.
"""

from dataclasses import dataclass, field

import numpy as np

from . import bvh, instance_packing, layout
from .errors import SceneError
from .expression import is_zero
from .image_packing import pack_images
from .light_packing import pack_all_lights
from .material_packing import MaterialTable
from .plan import PLANE_ATTRIBUTES, check_texels, make_plan
from .primitives import BY_KIND, Similarity, invertible
from .scene import Visibility
from .settings import SHADOWS
from .timing import timed
from .tree_packing import TreePacker, pieces

_DARK = (
    "the scene has no light: the sky is seen but lights nothing, so that other surfaces are black; add a light or let "
    "the world light the scene"
)


@dataclass
class PackedScene:
    """What a session uploads. `textures`: float32 (height, width, 4) by name. `frame`: values of the `Frame` record
    that depend on the scene alone. `features` and `constants`: of the shader. `origin` (3,): what positions are
    relative to. `bounds` (2, 3): of all but planes. `statistics`: see `Session.statistics`."""

    origin: np.ndarray
    textures: dict
    frame: dict
    features: frozenset
    constants: dict
    programs: str
    world: object
    world_programs: object
    shadows_pass: dict  # whether shadow rays may pass through something, by `Settings.shadows`
    bounds: np.ndarray
    statistics: dict
    warnings: list = field(default_factory=list)
    needs_light: bool = False  # whether without the world's light surfaces are black

    def warnings_with(self, settings):
        """The warnings of a picture with some `Settings`."""
        is_dark = self.needs_light and not (self.world.lights and settings.world_light != "NONE")
        return [*self.warnings, *([_DARK] if is_dark else [])]

    @property
    def lit_by_surfaces_alone(self):
        """Whether surfaces that glow are the only lights."""
        return self.frame["emitter_count"] > 0 and not self.frame["light_count"] and not self.world.lights


def pack(scene, max_texture_size):
    """Pack a scene for a device whose textures are at most `max_texture_size` wide and high.

    Raises SceneError when the scene has no camera, refers to what does not exist, or does not fit; the latter before a
    tree is built.
    """
    if scene.camera is None:
        raise SceneError("the scene has no camera; add one")
    seconds = {}
    with timed(seconds, "build"):
        packed = _Packer(scene, layout.most_texels(max_texture_size)).pack()
    packed.statistics["seconds"] = seconds
    return packed


def _check_matrices(scene):
    """Raise SceneError where the camera or an instance has a matrix that is not finite or cannot be inverted, or the
    camera's window is empty."""
    camera = np.asarray(scene.camera.matrix, np.float64)
    if not invertible(camera[None])[0]:
        raise SceneError("the camera's matrix is not finite or not one of three axes of length 1")
    left, right, bottom, top = scene.camera.window
    if not np.isfinite(scene.camera.window).all() or left == right or bottom == top:
        raise SceneError(f"the camera's window {tuple(scene.camera.window)} has no width or no height")
    for placed in scene.instances:
        if not all(invertible(placed.matrices[rows]).all() for rows in pieces(len(placed))):
            raise SceneError(
                f"instance {placed.name!r} has a scale of 0, axes in one plane or a matrix that is not finite"
            )


def _bounds_of(top, trees):
    """The box (2, 3) of everything that stands in trees, zero without any."""
    if top is not None:
        return top.bounds
    return next((tree.bounds for tree in trees.trees.values()), np.zeros((2, 3)))


def _origin(scene, plan):
    """The point (3,) that positions are taken relative to: the camera's, rounded to a grid much coarser than the
    distances to what is near it. It is exactly 0 for scenes around 0, stays put while the camera moves, and does not
    mind single things that lie far off."""
    eye = np.asarray(scene.camera.matrix, np.float64)[:3, 3]
    places = _sampled_places(plan)
    if not len(places):
        return np.zeros(3)
    distance = float(np.quantile(np.linalg.norm(places - eye, axis=1), 0.25, method="lower"))
    grid = 2.0 ** (np.ceil(np.log2(max(distance, 1e-30))) + 2.0)
    return np.round(eye / grid) * grid


def _sampled_places(plan, most=1000):
    """Where things are, (n, 3): the middle of about `most` primitives of a kind in world space, the origin of as many
    instances of other geometries."""
    places = [np.zeros((0, 3))]
    in_world = np.flatnonzero(plan.in_world)
    for number in in_world:
        for _, part in plan.geometries[number].kinds():
            lower, upper = part.take(_spread(len(part), -(-most // len(in_world)))).bounds()
            places.append((lower + upper) / 2.0)
    stands = [p.matrices[:, :3, 3] for p in plan.placed if not plan.in_world[plan.number(p.geometry)]]
    if stands:
        stands = np.concatenate(stands)
        places.append(stands[_spread(len(stands), most)])
    return np.concatenate(places)


def _spread(count, most):
    """At most `most` indices below `count`, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.int64))


class _Packer:
    """State while a scene is packed. The constructor refuses what cannot be rendered, before anything large is made."""

    def __init__(self, scene, limit):
        self.scene, self.limit = scene, limit
        self.plan = make_plan(scene)
        self.plan.check(limit)
        _check_matrices(scene)
        self.materials = MaterialTable(scene, self.plan)
        self.origin = _origin(scene, self.plan)
        self.textures, self.frame, self.warnings = {}, {}, []

    def pack(self):
        plan = self.plan
        attributes = self._attribute_texels()
        trees = TreePacker(plan, self.origin)
        for number in plan.built:
            trees.add(number, attributes)
        with timed(trees.seconds, "instances"):
            top = self._instances(trees.trees, attributes)
        trees.finish(top)
        self.textures |= trees.textures
        planes = self._tables()
        self.frame |= {
            **self.lights.frame,
            "plane_count": len(planes),
            "root_count": len(trees.trees),
            "geometry_count": len(plan.geometries),
            "world_material": self.materials.world,
            "outline_attribute": self._outline_attribute(),
            "world_visibility": int(self.scene.world.visibility),
        }
        depth = max((tree.depth for tree in trees.trees.values()), default=0) + (top.depth if top is not None else 0)
        return PackedScene(
            origin=self.origin,
            textures=self.textures,
            frame=self.frame,
            features=self._features(planes),
            # References that can wait in a traversal, rounded up so that few programs are made.
            constants={"BVH_STACK_SIZE": -(-(depth + 1) // 8) * 8},
            programs=self.materials.programs.text(),
            world=self.scene.world,
            world_programs=self.materials.world_programs,
            shadows_pass={way: self.lights.varies or self.materials.lets_shadows_pass(way) for way in SHADOWS},
            bounds=_bounds_of(top, trees),
            statistics=self._statistics(trees, top, depth),
            warnings=self.warnings,
            needs_light=self._needs_light(),
        )

    def _outline_attribute(self):
        name = self.scene.outline_attribute
        return self.plan.attributes.number(name) if name else -1

    def _attribute_texels(self):
        """Where the values of attributes go, (n, 4): the texels of their texture. Planes' are written already."""
        attributes = self.plan.attributes
        if not attributes.names:
            return np.zeros((0, 4), np.float32)
        self.textures["attributes"] = layout.data_texture(attributes.texels)
        texels = self.textures["attributes"].reshape(-1, 4)
        planes = self.scene.joined_planes()
        for (name, *place), first in attributes.first.items():
            if tuple(place) == PLANE_ATTRIBUTES:
                texels[first : first + len(planes)] = planes.attributes[name][:, 0]
        return texels

    def _instances(self, trees, attributes):
        """Write the records of the instances; the upper tree, None without instances."""
        plan = self.plan
        if not plan.placed:
            return None
        placed = instance_packing.blocks(self.scene, plan)
        instances = instance_packing.place(placed, plan, self.materials, self.origin)
        bounds, roots = np.zeros((len(plan.geometries), 2, 3)), np.zeros(len(plan.geometries), np.int64)
        for number, tree in trees.items():
            bounds[number], roots[number] = tree.bounds, tree.root
        top = instance_packing.upper_tree(instances, bounds)
        self.frame |= {"instance_first": 0, "instance_surface_first": plan.instance_surface_first}
        texture = layout.data_texture(plan.instance_texels)
        hits = layout.records_of(texture, layout.INSTANCE)[: plan.leaves]
        surfaces = layout.records_of(texture, layout.INSTANCE_SURFACE, plan.instance_surface_first)
        instance_packing.write_records(hits, surfaces, instances, top.order, roots)
        instance_packing.write_attributes(attributes, placed, plan.attributes, top.order)
        self.textures["instances"] = texture
        return top

    # What is few

    def _tables(self):
        """Write the records that share the texture `tables`; those of the planes."""
        planes, plane_surfaces = self._planes()
        self.lights = pack_all_lights(self.scene, self.plan, self.materials, self.origin)
        self.warnings += self.lights.warnings
        materials, constants = self.materials.records(self.plan.attributes)
        materials["glow_area"][: len(self.lights.glow_area)] = self.lights.glow_area
        records = {
            "material": materials,
            "constant": constants,
            **self.lights.records,
            "plane": planes,
            "plane_surface": plane_surfaces,
            "image": self._images(),
            "attribute": self.plan.attributes.directory,
        }
        end = 0
        for name, array in records.items():
            self.frame[f"{name}_first"] = layout.next_start(end)
            end = self.frame[f"{name}_first"] + array.nbytes // 16
        check_texels(end, self.limit, "materials, lights, planes and images")
        texture = self.textures["tables"] = layout.data_texture(end)
        for name, array in records.items():
            texels = array.view(np.float32).reshape(-1, 4)
            first = self.frame[f"{name}_first"]
            texture.reshape(-1, 4)[first : first + len(texels)] = texels
        return planes

    def _planes(self):
        planes = self.scene.joined_planes()
        if planes is None:
            return layout.PLANE.zeros(0), layout.PLANE_SURFACE.zeros(0)
        return planes.transformed(Similarity(np.eye(3), 1.0, -self.origin)).records()

    def _images(self):
        """Image records; their texels go in the texture `images`, reduced where they would not fit."""
        records, texture, warnings = pack_images(self.scene.images, self.limit)
        if texture is not None:
            self.textures["images"] = texture
        self.warnings += warnings
        return records

    def _needs_light(self):
        """Whether there are surfaces that only light makes visible, and neither lamps nor what glows."""
        diffuse = any(not is_zero(material.diffuse) for material in self.materials.materials)
        shown = len(self.plan.built) or self.scene.planes
        return bool(diffuse and shown and not len(self.lights.records["light"]))

    # The whole

    def _features(self, planes):
        totals = self.plan.counts.sum(axis=0)
        features = {f"HAS_{cls.kind.upper()}" for cls, count in zip(BY_KIND, totals, strict=True) if count}
        features |= self.materials.features()
        if len(planes):
            features.add("HAS_PLANE")
        if self.plan.placed:
            features.add("HAS_INSTANCES")
        if self.plan.attributes.names:
            features.add("HAS_ATTRIBUTES")
        seen = {int(p.visibility) for p in self.plan.placed} | set(np.unique(planes["visibility"]).astype(int).tolist())
        features |= self.lights.features
        if any(~bits & Visibility.ALL for bits in seen):
            features.add("HAS_VISIBILITY")
        if any(bits & Visibility.HOLDOUT for bits in seen):
            features.add("HAS_HOLDOUT")
        if any(bits & Visibility.SHADOW_CATCHER for bits in seen):
            features.add("HAS_SHADOW_CATCHER")
        return frozenset(features)

    def _statistics(self, trees, top, depth):
        plan = self.plan
        nodes = sum(tree.nodes for tree in trees.trees.values()) + (len(top) if top is not None else 0)
        if plan.largest in trees.trees:
            cost = trees.trees[plan.largest].sah_cost
        else:
            cost = float(bvh.sah_cost(top)) if top is not None else 0.0
        return {
            "primitives": self.scene.primitive_counts(),
            "instances": sum(map(len, plan.placed)),
            "geometries": len({id(p.geometry) for p in plan.placed}),
            "bvh": {"nodes": nodes, "depth": depth, "sah_cost": cost},
            "build": trees.seconds,
        }
