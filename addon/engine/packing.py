"""From a `Scene` to the arrays that go to the GPU: trees, records in data textures, and where each kind of record
begins.

Nothing here draws. Lengths become relative to an origin near the camera, so that float32 keeps its digits where
people look.
"""

import time
from dataclasses import dataclass, field

import numpy as np

from . import bvh, layout
from .errors import SceneError
from .image_packing import pack_images
from .primitives import BY_KIND, Planes, Similarity, invertible
from .scene import LightKind, Material
from .tree_packing import build_tree, moved_boxes, node_records

_INSTANCE = layout.KINDS.index("instance")


@dataclass
class PackedScene:
    """What a session uploads. `textures`: float32 (height, width, 4) by name. `frame`: values of the `Frame` record
    that depend on the scene alone. `features` and `constants`: of the shader. `origin` (3,): what positions are
    relative to."""

    origin: np.ndarray
    textures: dict
    frame: dict
    features: frozenset
    constants: dict
    statistics: dict
    warnings: list = field(default_factory=list)


def pack(scene, max_texture_size):
    """Pack a scene for a device whose textures are at most `max_texture_size` wide and high.

    Raises SceneError when the scene has no camera, refers to what does not exist, or does not fit.
    """
    if scene.camera is None:
        raise SceneError("the scene has no camera; add one")
    _check_matrices(scene)
    started = time.perf_counter()
    origin = scene_origin(scene)
    geometries = _distinct_geometries(scene)
    trees = [build_tree(geometry, origin if geometry is scene.shapes else None) for geometry in geometries]
    built = time.perf_counter() - started
    packer = _Packer(scene, origin, geometries, trees, max_texture_size)
    packed = packer.pack()
    packed.statistics["seconds"] = {"build": built}
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
    matrices = np.array([instance.matrix for instance in scene.instances], np.float64).reshape(-1, 4, 4)
    bad = ~invertible(matrices)
    if bad.any():
        name = scene.instances[int(np.argmax(bad))].name
        raise SceneError(f"instance {name!r} has a scale of 0, axes in one plane or a matrix that is not finite")


def scene_origin(scene):
    """The point (3,) that positions are taken relative to: the camera's, rounded to a grid much coarser than the
    distances to what is near it. It is exactly 0 for scenes around 0, stays put while the camera moves, and does not
    mind single things that lie far off."""
    eye = np.asarray(scene.camera.matrix, np.float64)[:3, 3]
    places = _sampled_places(scene)
    if not len(places):
        return np.zeros(3)
    distance = float(np.quantile(np.linalg.norm(places - eye, axis=1), 0.25, method="lower"))
    grid = 2.0 ** (np.ceil(np.log2(max(distance, 1e-30))) + 3.0)
    return np.round(eye / grid) * grid


def _sampled_places(scene, most=1000):
    """Where things are, (n, 3): the middle of at most `most` primitives of a kind, the origin of as many instances."""
    places = []
    for _, part in scene.shapes.kinds():
        lower, upper = part.take(_spread(len(part), most)).bounds()
        places.append((lower + upper) / 2.0)
    picked = [scene.instances[i].matrix for i in _spread(len(scene.instances), most)]
    places.append(np.array(picked, np.float64).reshape(-1, 4, 4)[:, :3, 3])
    return np.concatenate(places)


def _spread(count, most):
    """At most `most` indices below `count`, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.int64))


def _distinct_geometries(scene):
    """The world's shapes first (if any), then each instanced geometry once; those without primitives are left out."""
    geometries = [scene.shapes] if len(scene.shapes) else []
    seen = {id(geometry) for geometry in geometries}
    for instance in scene.instances:
        if id(instance.geometry) not in seen and len(instance.geometry):
            seen.add(id(instance.geometry))
            geometries.append(instance.geometry)
    return geometries


class _Packer:
    """State while a scene is packed: what each geometry's nodes and records begin at."""

    def __init__(self, scene, origin, geometries, trees, max_texture_size):
        self.scene, self.origin, self.trees = scene, origin, trees
        self.index = {id(geometry): i for i, geometry in enumerate(geometries)}
        self.limit = layout.DATA_WIDTH * max_texture_size
        self.texels, self.frame, self.warnings = {}, {}, []
        self.world_only = not scene.instances
        self.materials = list(scene.materials) or [Material()]
        self._blocks = {}

    def pack(self):
        instances, top = self._instances()
        self._nodes(top)
        self._primitives()
        if not self.world_only:
            self._records("instances", instance=instances[0], instance_surface=instances[1])
        planes = self._planes()
        images = self._images()
        self._records(
            "tables",
            material=self._materials(),
            light=self._lights(),
            plane=planes[0],
            plane_surface=planes[1],
            image=images,
        )
        self._warn_of_darkness()
        self.frame |= {
            "light_count": len(self.scene.lights),
            "plane_count": len(planes[0]),
            "root_count": len(self.trees),
            "world_color": self.scene.world.color,
            "world_image": self._checked_image(self.scene.world.image, "the world"),
        }
        return PackedScene(
            origin=self.origin,
            textures={name: self._texture(name, texels) for name, texels in self.texels.items()},
            frame=self.frame,
            features=self._features(planes[0]),
            constants={"BVH_STACK_SIZE": self._stack_size(top)},
            statistics=self._statistics(top),
            warnings=self.warnings,
        )

    # Trees

    def _instances(self):
        """The upper tree and the two instance records in the order of its leaves; (None, None) and None without
        instances."""
        if self.world_only:
            return None, None
        placed = [i for i in self.scene.instances if id(i.geometry) in self.index]
        matrices = np.array([i.matrix for i in placed], np.float64).reshape(-1, 4, 4)
        which = [self.index[id(i.geometry)] for i in placed]
        first = [self._material_block(i) for i in placed]
        if len(self.scene.shapes):
            matrices = np.concatenate([np.eye(4)[None], matrices])
            which, first = [0, *which], [0, *first]
            matrices[1:, :3, 3] -= self.origin
        else:
            matrices[:, :3, 3] -= self.origin
        which = np.array(which, np.int64)
        bounds = np.array([t.tree.bounds for t in self.trees], np.float64).reshape(-1, 2, 3)
        lower, upper = moved_boxes(bounds[which], matrices)
        top = bvh.build(lower, upper, leaf_size=1)
        return self._instance_records(matrices[top.order], which[top.order], np.array(first)[top.order], top), top

    def _material_block(self, instance):
        """Index of the material record of the instance's slot 0; instances with the same materials share a block."""
        slots = self.trees[self.index[id(instance.geometry)]].slots
        if slots > len(instance.materials):
            raise SceneError(
                f"instance {instance.name!r} has {len(instance.materials)} materials, its geometry uses slot "
                f"{slots - 1}"
            )
        block = tuple(instance.materials)
        if block not in self._blocks:
            self._check_slots(np.array(block), f"instance {instance.name!r}")
            if len(block) == 1:
                self._blocks[block] = block[0]
            else:
                self._blocks[block] = len(self.materials)
                self.materials += [self.materials[slot] for slot in block]
        return self._blocks[block]

    def _instance_records(self, matrices, which, first_material, top):
        starts = self._node_starts(top)
        to_object = np.linalg.inv(matrices)
        hit, surface = layout.INSTANCE.zeros(len(matrices)), layout.INSTANCE_SURFACE.zeros(len(matrices))
        for row, axis in enumerate("xyz"):
            hit[f"to_object_{axis}"] = to_object[:, row]
            surface[f"to_world_{axis}"] = matrices[:, row]
        hit["root"], hit["root_high"] = layout.split_index(starts[which])
        hit["first_material"] = first_material
        return hit, surface

    def _node_starts(self, top):
        """Index of the root node of each geometry's tree: the upper tree, if any, comes first."""
        sizes = [len(top) if top is not None else 0, *(len(t.tree) for t in self.trees)]
        return np.cumsum(sizes)[:-1]

    def _nodes(self, top):
        bases, kinds = np.zeros(len(BY_KIND), np.int64), np.arange(len(BY_KIND))
        nodes = []
        if top is not None:
            nodes.append(node_records(top, 0, np.zeros(1, np.int64), np.array([_INSTANCE])))
        for start, geometry in zip(self._node_starts(top), self.trees, strict=True):
            nodes.append(node_records(geometry.tree, start, bases, kinds))
            for label, (hit, _) in geometry.records.items():
                bases[label] += len(hit)
        self.texels["nodes"] = _texels(np.concatenate(nodes) if nodes else layout.NODE.zeros(1))

    def _primitives(self):
        for label, cls in enumerate(BY_KIND):
            parts = [t.records[label] for t in self.trees if label in t.records]
            if parts:
                for record, arrays in zip((cls.record, cls.surface_record), zip(*parts, strict=True), strict=True):
                    self.texels[record.texture] = _texels(np.concatenate(arrays))

    # What is few

    def _records(self, texture, **records):
        """Several kinds of records in one texture, each from a first texel of its own."""
        texels = []
        for name, array in records.items():
            self.frame[f"{name}_first"] = sum(len(t) for t in texels)
            texels.append(_texels(array))
        self.texels[texture] = np.concatenate(texels)

    def _planes(self):
        if not self.scene.planes:
            return layout.PLANE.zeros(0), layout.PLANE_SURFACE.zeros(0)
        planes = Planes.concatenate(self.scene.planes).transformed(Similarity(np.eye(3), 1.0, -self.origin))
        self._check_slots(planes.material, "a plane")
        return planes.records()

    def _check_slots(self, material, what):
        count = max(len(self.scene.materials), 1)  # a scene without materials has the default one
        bad = (material < 0) | (material >= count)
        if bad.any():
            raise SceneError(f"{what} uses material {int(material[np.argmax(bad)])}, the scene has {count}")

    def _materials(self):
        if len(self.scene.shapes):
            for _, part in self.scene.shapes.kinds():
                self._check_slots(part.material, f"a {part.kind}")
        records = layout.MATERIAL.zeros(len(self.materials))
        for name in records.dtype.names:
            if name != "unused":
                records[name] = [getattr(material, name) for material in self.materials]
        for number, material in enumerate(self.materials):
            for name in ("diffuse_image", "reflect_image", "transmit_image", "glow_image"):
                self._checked_image(getattr(material, name), f"material {number}")
        return records

    def _checked_image(self, image, user):
        if image >= len(self.scene.images):
            raise SceneError(f"{user} uses image {image}, the scene has {len(self.scene.images)}")
        return image

    def _lights(self):
        records = layout.LIGHT.zeros(len(self.scene.lights))
        for record, light in zip(records, self.scene.lights, strict=True):
            offset = 0.0 if light.kind == LightKind.SUN else self.origin
            record["position"] = np.subtract(light.position, offset)
            record["kind"], record["color"], record["shadow"] = light.kind, light.color, light.shadow
        if not all(np.isfinite(records[name]).all() for name in ("position", "color")):
            raise SceneError("a light has a position or colour that is not finite")
        return records

    def _images(self):
        """Image records; their texels go in the texture `images`, reduced where they would not fit."""
        records, texels, warnings = pack_images(self.scene.images, self.limit)
        if len(texels):
            self.texels["images"] = texels
        self.warnings += warnings
        return records

    def _warn_of_darkness(self):
        diffuse = any(max(material.diffuse) > 0.0 for material in self.materials)
        if diffuse and not self.scene.lights and (self.trees or self.scene.planes):
            self.warnings.append(
                "the scene has no light: the sky and what glows are seen but light nothing, so that other surfaces are "
                "black; add a light"
            )

    # The whole

    def _texture(self, name, texels):
        """Texels (n, 4) as rows of the fixed width. Raises SceneError when they do not fit a texture."""
        count = max(len(texels), 1)
        if count > self.limit:
            raise SceneError(
                f"the scene needs {count} texels of {name}, a texture of this device holds {self.limit}; "
                "render it in parts or with fewer primitives"
            )
        width = min(count, layout.DATA_WIDTH)
        height = -(-count // width)
        padded = np.zeros((height * width, 4), np.float32)
        padded[: len(texels)] = texels
        return padded.reshape(height, width, 4)

    def _features(self, planes):
        features = {
            f"HAS_{cls.kind.upper()}"
            for label, cls in enumerate(BY_KIND)
            if any(label in t.records for t in self.trees)
        }
        if len(planes):
            features.add("HAS_PLANE")
        if not self.world_only:
            features.add("HAS_INSTANCES")
        if any(max(m.diffuse_image, m.reflect_image, m.transmit_image, m.glow_image) >= 0 for m in self.materials):
            features.add("HAS_IMAGES")
        if self.scene.world.image >= 0:
            features.add("HAS_WORLD_IMAGE")
        if any(max(m.absorption) > 0.0 for m in self.materials):
            features.add("HAS_ABSORPTION")
        return frozenset(features)

    def _stack_size(self, top):
        """References that can wait in a traversal, rounded up so that few programs are made."""
        depth = max((t.tree.depth for t in self.trees), default=0) + (top.depth if top is not None else 0)
        return -(-(depth + 1) // 8) * 8

    def _statistics(self, top):
        trees = [t.tree for t in self.trees] + ([top] if top is not None else [])
        deepest = max((t.tree.depth for t in self.trees), default=0)
        main = max(trees, key=lambda tree: len(tree.order), default=None)
        return {
            "primitives": self.scene.primitive_counts(),
            "bvh": {
                "nodes": sum(len(tree) for tree in trees),
                "depth": deepest + (top.depth if top is not None else 0),
                "sah_cost": float(bvh.sah_cost(main)) if main is not None and len(main) else 0.0,
            },
        }


def _texels(records):
    """Structured records (n,) as texels (n * texels of the record, 4) float32."""
    return np.ascontiguousarray(records).view(np.float32).reshape(-1, 4)
