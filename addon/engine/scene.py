"""The plain data that is the renderer's only input: no bpy, no GPU, only dataclasses and numpy arrays.

Right-handed, Z up, metres, scene-linear colour, images bottom row first. World coordinates may be large: they are
kept in float64 and taken relative to an origin near the camera when they are packed.
"""

from dataclasses import dataclass, field

import numpy as np

from .errors import SceneError
from .image import Image as Image
from .light import Light as Light
from .light import LightKind as LightKind
from .material import Material as Material
from .material import World as World
from .primitives import BY_KIND, Cones, Cylinders, Discs, Planes, Spheres, Triangles
from .visibility import Visibility


@dataclass(frozen=True)
class Camera:
    """A camera that looks along its -Z with Y up, as Blender's.

    `matrix` (4, 4): camera to world, without scale. `window` (left, right, bottom, top): the picture's edges at
    distance 1 in front of the eye, or in world units when `orthographic`. `clip` (start, end): distances along the
    view.
    """

    matrix: np.ndarray
    window: tuple
    orthographic: bool = False
    clip: tuple = (0.0, 1e30)

    @classmethod
    def look_at(cls, eye, target, up=(0.0, 0.0, 1.0), angle=45.0, aspect=1.0, clip=(0.0, 1e30)):
        """A perspective camera at `eye` towards `target`; `angle` in degrees from the bottom to the top row, `aspect`
        the picture's width over height. Raises SceneError when `up` is along the view."""
        matrix = _look_at_matrix(eye, target, up)
        half = float(np.tan(np.radians(angle) / 2.0))
        return cls(matrix, (-half * aspect, half * aspect, -half, half), False, clip)

    @classmethod
    def orthographic_at(cls, eye, target, height, up=(0.0, 0.0, 1.0), aspect=1.0, clip=(0.0, 1e30)):
        """Parallel rays from a window of `height` world units centred at `eye`, towards `target`."""
        half = height / 2.0
        return cls(_look_at_matrix(eye, target, up), (-half * aspect, half * aspect, -half, half), True, clip)


def _look_at_matrix(eye, target, up):
    eye, target, up = (np.asarray(v, np.float64) for v in (eye, target, up))
    back = eye - target
    right = np.cross(up, back)
    if not np.isfinite(right).all() or not np.linalg.norm(right) > 1e-12 * np.linalg.norm(up) * np.linalg.norm(back):
        eye, target, up = (tuple(float(x) for x in v) for v in (eye, target, up))
        raise SceneError(
            f"camera: from {eye} to {target} with up {up} gives no view; the two points must "
            "differ and up must not lie along the view"
        )
    back, right = back / np.linalg.norm(back), right / np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3] = np.stack([right, np.cross(back, right), back, eye], axis=-1)
    return matrix


class _Token:
    """Equal to itself alone; without content, where contents are compared."""


class Geometry:
    """Primitives of any kinds in a space of their own; it gets one tree, and can stand in the scene many times.

    Its primitives' `material` is a slot: an index into the `materials` of the instance. `replaces`: None, or a weak
    reference to the Geometry of an earlier scene that has as many primitives of each kind, in the same order. `token`:
    another object whenever something is added. `tree`: None, or (token, what it was moved by, a good tree) where one is
    on its way to take the place of one that was built quickly: seconds of work for what may be overtaken by an edit.
    """

    def __init__(self, *primitives, name=""):
        self.name = name
        self.replaces = self.tree = self._joined = self._slots = None
        self.token = _Token()
        self._parts = {cls: [] for cls in BY_KIND}
        for part in primitives:
            self.add(part)

    def add(self, primitives):
        """Add primitives of one kind (Spheres, Cylinders, Cones, Discs or Triangles)."""
        if type(primitives) not in self._parts:
            raise SceneError(f"{type(primitives).__name__} cannot stand in a geometry")
        if len(primitives):
            self._parts[type(primitives)].append(primitives)
            self._joined = self._slots = None
            self.token = _Token()

    @property
    def parts(self):
        """((leaf label, primitives), ...) of each kind that is there; the same tuple until something is added."""
        if self._joined is None:
            for cls, parts in self._parts.items():
                parts[:] = [cls.concatenate(parts)] if parts else []
            self._joined = tuple((label, self._parts[cls][0]) for label, cls in enumerate(BY_KIND) if self._parts[cls])
        return self._joined

    def kinds(self):
        """Iterate over `parts`."""
        return iter(self.parts)

    def counts(self):
        """Number of primitives by kind; an absent kind is left out."""
        return {cls.kind: sum(map(len, parts)) for cls, parts in self._parts.items() if parts}

    @property
    def slots(self):
        """One more than the largest material slot that is used. Raises SceneError for negative ones."""
        if self._slots is None:
            for _, part in self.parts:
                if part.material.min() < 0:
                    slot = int(part.material.min())
                    raise SceneError(f"geometry {self.name!r}: a {part.kind} uses material slot {slot}")
            self._slots = 1 + max((int(part.material.max()) for _, part in self.parts), default=-1)
        return self._slots

    def __len__(self):
        return sum(len(part) for parts in self._parts.values() for part in parts)


@dataclass(frozen=True)
class Instances:
    """A geometry that stands in the world many times.

    `matrices` (n, 4, 4) float, or one (4, 4): object to world, any invertible affine. `materials`: the index into
    `Scene.materials` for each material slot; None where the slots are the scene's materials themselves. `visibility`:
    of all. `attributes`: arrays (n, 4) float32 by name, a value per instance, or (4,) for all. Raises SceneError for
    arrays of other shapes.
    """

    geometry: Geometry
    matrices: np.ndarray
    materials: tuple | None = (0,)
    name: str = ""
    visibility: Visibility = Visibility.ALL
    attributes: dict = field(default_factory=dict)

    def __post_init__(self):
        matrices = np.asarray(self.matrices)
        matrices = matrices if matrices.dtype in (np.float32, np.float64) else matrices.astype(np.float64)
        if matrices.ndim not in (2, 3) or matrices.shape[-2:] != (4, 4):
            raise SceneError(f"instances {self.name!r}: matrices have shape {matrices.shape}, expected (n, 4, 4)")
        object.__setattr__(self, "matrices", matrices.reshape(-1, 4, 4))
        object.__setattr__(self, "attributes", {n: self._per_instance(n, v) for n, v in self.attributes.items()})

    def _per_instance(self, name, values):
        values = np.asarray(values, np.float32)
        if values.shape not in ((4,), (1, 4), (len(self), 4)):
            expected = f"({len(self)}, 4) or (4,)"
            raise SceneError(
                f"instances {self.name!r}: attribute {name!r} has shape {values.shape}, expected {expected}"
            )
        return np.broadcast_to(values, (len(self), 4))

    def __len__(self):
        return len(self.matrices)


@dataclass
class Scene:
    """Everything a picture is made from.

    Shapes that keep their form (see `keeps_shapes`) go straight into `shapes`, one geometry in world space whose
    material slots are the scene's materials. Meshes and stretched shapes are geometries of `instances`, a list of
    `Instances`. `planes` is a list of infinite planes. `outline_attribute`: the attribute whose values have an outline
    each, where outlines go around one.
    """

    camera: Camera | None = None
    world: World = field(default_factory=World)
    lights: list = field(default_factory=list)
    materials: list = field(default_factory=list)
    images: list = field(default_factory=list)
    shapes: Geometry = field(default_factory=lambda: Geometry(name="world"))
    instances: list = field(default_factory=list)
    planes: list = field(default_factory=list)
    outline_attribute: str = ""

    def forget_trees(self):
        """Good trees have taken the place of those that were built quickly."""
        for geometry in (self.shapes, *(placed.geometry for placed in self.instances)):
            geometry.tree = None

    def add_material(self, material):
        """Append a material; its index."""
        self.materials.append(material)
        return len(self.materials) - 1

    def add_image(self, image):
        """Append an image; its index."""
        self.images.append(image)
        return len(self.images) - 1

    def add(self, primitives):
        """Add primitives in world space: planes to the list of planes, all else to `shapes`."""
        if isinstance(primitives, Planes):
            self.planes.append(primitives)
        else:
            self.shapes.add(primitives)

    def add_spheres(self, center, radius, material=0, **columns):
        self.add(Spheres(center=center, radius=radius, material=material, **columns))

    def add_cylinders(self, base, apex, radius, material=0, *, caps=True, **columns):
        """Cylinders from base to apex; with `caps` they are solid."""
        sides = Cylinders(base=base, apex=apex, radius=radius, material=material, **columns)
        self.add(sides)
        if caps:
            self._add_caps(sides, np.abs(sides.radius), np.abs(sides.radius))

    def add_cones(self, base, apex, base_radius, apex_radius=0.0, material=0, *, caps=True, **columns):
        """Cones from base to apex, truncated where `apex_radius` is not 0; with `caps` they are solid."""
        sides = Cones(
            base=base,
            apex=apex,
            base_radius=base_radius,
            apex_radius=apex_radius,
            material=material,
            **columns,
        )
        self.add(sides)
        if caps:
            self._add_caps(sides, np.abs(sides.base_radius), np.abs(sides.apex_radius))

    def _add_caps(self, sides, base_radius, apex_radius):
        """Discs with outward normals at both ends, except where the radius is 0."""
        axis = sides.apex - sides.base
        for center, normal, radius in ((sides.base, -axis, base_radius), (sides.apex, axis, apex_radius)):
            rows = radius > 0.0
            if rows.any():
                self.add(
                    Discs(
                        center=center[rows],
                        normal=normal[rows],
                        radius=radius[rows],
                        material=sides.material[rows],
                        meridian=sides.meridian[rows],
                    )
                )

    def add_discs(self, center, normal, radius, material=0, **columns):
        self.add(Discs(center=center, normal=normal, radius=radius, material=material, **columns))

    def add_triangles(self, p0, p1, p2, material=0, **columns):
        self.add(Triangles(p0=p0, p1=p1, p2=p2, material=material, **columns))

    def add_plane(self, point, normal, material=0, **columns):
        self.add(Planes(point=point, normal=normal, material=material, **columns))

    def add_light(self, light):
        self.lights.append(light)

    def joined_planes(self):
        """All planes as one `Planes`, None without any."""
        return Planes.concatenate(self.planes) if self.planes else None

    def primitive_counts(self):
        """Number of primitives in the picture by kind; an instanced one counts each time, an absent kind not at all."""
        counts = {}
        for geometry, times in [(self.shapes, 1), *((placed.geometry, len(placed)) for placed in self.instances)]:
            for kind, count in geometry.counts().items():
                counts[kind] = counts.get(kind, 0) + count * times
        counts = {kind: count for kind, count in counts.items() if count}
        if self.planes:
            counts["plane"] = sum(len(planes) for planes in self.planes)
        return counts
