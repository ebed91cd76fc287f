"""Materials as records: the scene's own, then a block for each tuple of materials in the slots of instances."""

import numpy as np

from . import layout
from .errors import SceneError
from .scene import Material

_ROLES = ("diffuse", "reflect", "transmit", "glow")


class MaterialTable:
    """The materials of a scene in the order of their records. Raises SceneError where one is used that is not there."""

    def __init__(self, scene, plan):
        self._count = max(len(scene.materials), 1)  # a scene without materials has the default one
        self.materials = list(scene.materials) or [Material()]
        self._slots = [_slots(geometry) for geometry in plan.geometries]
        self._blocks = {}
        for _, part in scene.shapes.kinds():
            self._check(part.material, f"a {part.kind}")
        for planes in scene.planes:
            self._check(planes.material, "a plane")
        for placed in plan.placed:
            self.first(placed, plan)
        self._check_images(scene)

    def first(self, placed, plan):
        """Index of the record of slot 0 of `Instances`; those with the same materials share a block."""
        slots = self._slots[plan.number(placed.geometry)]
        if placed.materials is None:
            self._check(np.arange(slots), f"instance {placed.name!r}")
            return 0
        block = tuple(placed.materials)
        if slots > len(block):
            raise SceneError(f"instance {placed.name!r} has {len(block)} materials, its geometry uses slot {slots - 1}")
        if block not in self._blocks:
            self._check(np.array(block, np.int64), f"instance {placed.name!r}")
            self._blocks[block] = block[0] if len(block) == 1 else len(self.materials)
            if len(block) > 1:
                self.materials += [self.materials[slot] for slot in block]
        return self._blocks[block]

    def records(self, attributes):
        """Records of `layout.MATERIAL`; `attributes` is the plan's `AttributePlan`."""
        records = layout.MATERIAL.zeros(len(self.materials))
        for name in (name for name in records.dtype.names if name != "unused"):
            values = [getattr(material, name) for material in self.materials]
            records[name] = list(map(attributes.number, values)) if name.endswith("_attribute") else values
        return records

    def features(self):
        """Features of the shader that the materials make use of."""
        used = {
            "HAS_IMAGES": lambda m: any(getattr(m, f"{role}_image") >= 0 for role in _ROLES),
            "HAS_ATTRIBUTES": lambda m: any(getattr(m, f"{role}_attribute") for role in _ROLES),
            "HAS_ABSORPTION": lambda m: max(m.absorption) > 0.0,
            "HAS_ROUGHNESS": lambda m: max(m.roughness, m.transmit_roughness) > 0.0,
            "HAS_METALS": lambda m: max(m.grazing) > 0.0 or min(m.edge) < 1.0,
            "HAS_CULLING": lambda m: m.cull_back,
            "CULLED_SHADOWS": lambda m: m.cull_back_shadow,
        }
        return {feature for feature, uses in used.items() if any(map(uses, self.materials))}

    def _check(self, material, what):
        bad = (material < 0) | (material >= self._count)
        if bad.any():
            raise SceneError(f"{what} uses material {int(material[np.argmax(bad)])}, the scene has {self._count}")

    def _check_images(self, scene):
        for number, material in enumerate(self.materials[: self._count]):
            for role in _ROLES:
                check_image(scene, getattr(material, f"{role}_image"), f"material {number}")


def check_image(scene, image, user):
    """Raise SceneError where a scene lacks the image of a number that `user` names."""
    if image >= len(scene.images):
        raise SceneError(f"{user} uses image {image}, the scene has {len(scene.images)}")


def _slots(geometry):
    """One more than the largest material slot that a geometry uses. Raises SceneError for negative ones."""
    slots = 0
    for _, part in geometry.kinds():
        if part.material.min() < 0:
            raise SceneError(f"geometry {geometry.name!r}: a {part.kind} uses material slot {int(part.material.min())}")
        slots = max(slots, 1 + int(part.material.max()))
    return slots
