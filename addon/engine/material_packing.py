"""Materials as records: the scene's own, then a block for each tuple of materials in the slots of instances, then the
world as one whose glow is seen; and the programs of those that vary."""

from functools import cached_property

import numpy as np

from . import layout
from .errors import SceneError
from .expression import Call, Expression, as_type, attribute_keys, in_order, is_constant, is_zero, vanishes
from .glass_energy import energy_records
from .material import Material
from .node_programs import NodePrograms, constant_texels

_LARGEST = float(np.finfo(np.float32).max)
#: Members of the record that expressions give, with their limits and what stands for them where one number must do.
_MEMBERS = {
    "diffuse": ("vec3", 0.0, _LARGEST, 0.5),
    "reflect": ("vec3", 0.0, 1.0, 0.5),
    "transmit": ("vec3", 0.0, 1.0, 0.5),
    "glow": ("vec3", 0.0, _LARGEST, 0.5),
    "absorption": ("vec3", 0.0, _LARGEST, 0.0),
    "highlight": ("vec3", 0.0, _LARGEST, 0.0),
    "metallic": ("vec3", 0.0, 1.0, 0.5),
    "grazing": ("vec3", 0.0, 1.0, 0.5),
    "edge": ("vec3", 0.0, 1.0, 1.0),
    "translucent": ("vec3", 0.0, 1.0, 0.5),
    "coat": ("vec3", 0.0, 1.0, 0.5),
    "coat_tint": ("vec3", 0.0, 1.0, 1.0),
    "normal": ("vec3", -_LARGEST, _LARGEST, 0.0),
    "straight": ("vec3", 0.0, 1.0, 0.5),
    "roughness": ("float", 0.0, 1.0, 0.5),
    "transmit_roughness": ("float", 0.0, 1.0, 0.5),
    "coat_roughness": ("float", 0.0, 1.0, 0.5),
    "diffuse_roughness": ("float", 0.0, 1.0, 0.5),
    "diffuse_covered": ("float", 0.0, 1.0, 0.5),
    "transmit_covered": ("float", 0.0, 1.0, 0.5),
    "holdout": ("float", 0.0, 1.0, 0.0),
    "body": ("float", 0.0, 1.0, 1.0),
    "ior": ("float", 1e-3, 1e3, 1.5),
    "fresnel_ior": ("float", 0.0, 1e3, 0.0),
    "coat_ior": ("float", 1e-3, 1e3, 1.5),
    "shine": ("float", 0.0, _LARGEST, 1.0),
    "fresnel": ("float", 0.0, 1.0, 1.0),
    "multiscatter": ("float", 0.0, 1.0, 0.0),
}
_FLAGS = ("bounds_body", "cull_back", "cull_back_shadow")
#: Members whose share of the light shadow rays take along, by `Settings.shadows`.
_PASSED = {"TRANSPARENT": "straight", "TINTED": "transmit"}


class MaterialTable:
    """The materials of a scene in the order of their records, `materials`, and their `programs`. `firsts`: index of the
    record of slot 0 of each of the plan's `placed`. Raises SceneError where one is used that is not there."""

    def __init__(self, scene, plan):
        self._count = max(len(scene.materials), 1)  # a scene without materials has the default one
        self.materials = list(scene.materials) or [Material()]
        self._slots = [geometry.slots for geometry in plan.geometries]
        self._blocks = {}
        for _, part in scene.shapes.parts if scene.shapes.slots > self._count else ():
            self._check(part.material, f"a {part.kind}")
        for planes in scene.planes:
            self._check(planes.material, "a plane")
        self.firsts = [self._first(p, number) for p, number in zip(plan.placed, plan.placed_numbers, strict=True)]
        self._world = Material(diffuse=0.0, glow=scene.world.radiance)
        self.programs = NodePrograms()
        self._distinct = list({id(m): m for m in self.materials}.values())
        self._program_of = {id(m): self._program(m, self.programs) for m in (*self._distinct, self._world)}
        self._check_images(scene)

    def _first(self, placed, number):
        """Index of the record of slot 0 of `Instances` of a geometry; those with the same materials share a block."""
        slots = self._slots[number]
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

    @cached_property
    def world_programs(self):
        """The `NodePrograms` of the world alone, and its `Program` there, None where it is the same everywhere."""
        programs = NodePrograms()
        return programs, self._program(self._world, programs)

    @property
    def world(self):
        """Number of the record of the world."""
        return len(self.materials)

    def records(self, attributes):
        """(Records of `layout.MATERIAL`, of `layout.CONSTANT`); `attributes` is the plan's `AttributePlan`."""
        materials = [*self._distinct, self._world]
        records = layout.MATERIAL.zeros(len(materials))
        for name, (kind, low, high, stand_in) in _MEMBERS.items():
            values = [_constant(getattr(material, name), kind, stand_in) for material in materials]
            records[name] = np.clip(np.reshape(values, records[name].shape), low, high)
        for name in _FLAGS:
            records[name] = [getattr(material, name) for material in materials]
        texels, first = [np.zeros((0, 4), np.float32)], {}
        end = 0
        for material, record in zip(materials, records, strict=True):
            program = self._program_of[id(material)]
            if program is None:
                continue
            if id(program) not in first:
                first[id(program)] = end
                texels.append(constant_texels(program, end, attributes.number))
                end += len(texels[-1])
            record["program"], record["constants"] = program.number, first[id(program)]
        row = {id(material): number for number, material in enumerate(materials)}
        records = records[[row[id(material)] for material in (*self.materials, self._world)]]
        return records, np.concatenate(texels).view(layout.CONSTANT.dtype)[:, 0]

    def features(self):
        """Features of the shader that the materials make use of, by their structure: a parameter that is zero now may
        not be so the next time."""
        used = {
            "HAS_ABSORPTION": lambda m: not is_zero(m.absorption),
            "HAS_TRANSMISSION": lambda m: not is_zero(m.transmit),
            "HAS_ROUGHNESS": lambda m: not (is_zero(m.roughness) and is_zero(m.transmit_roughness)) or _has_coat(m),
            "HAS_GLASS_ENERGY": _gives_back_in_glass,
            "HAS_METALS": lambda m: not (is_zero(m.metallic) and is_zero(m.grazing)),
            "HAS_COAT": _has_coat,
            "HAS_TRANSLUCENT": lambda m: not is_zero(m.translucent),
            "HAS_DIFFUSE_ROUGHNESS": lambda m: not is_zero(m.diffuse_roughness),
            "HAS_NORMALS": lambda m: not is_zero(m.normal),
            "HAS_HOLDOUT_SHARE": lambda m: not is_zero(m.holdout),
            "HAS_CULLING": lambda m: m.cull_back,
            "CULLED_SHADOWS": lambda m: m.cull_back_shadow,
            "TINTED_SHADOWS": lambda m: not is_zero(m.transmit),
            "TRANSPARENT_SHADOWS": lambda m: not is_zero(m.straight),
        }
        found = {feature for feature, uses in used.items() if any(map(uses, self._distinct))}
        if len(self.programs):
            found |= {"HAS_PROGRAMS", *self.programs.features()}
        return found

    def glass_energy(self):
        """Records of `layout.GLASS_ENERGY`, none where no material needs them."""
        needed = any(map(_gives_back_in_glass, self._distinct))
        return energy_records() if needed else layout.GLASS_ENERGY.zeros(0)

    def lets_shadows_pass(self, way):
        """Whether shadow rays may pass through a surface; `way` as `Settings.shadows`."""
        passed = _PASSED.get(way)
        return any(m.cull_back_shadow or (passed and _may_be(getattr(m, passed))) for m in self._distinct)

    def _program(self, material, programs):
        """The `Program` of a material among `programs`; None for one that is the same everywhere."""
        members = {}
        for name, (kind, low, high, _) in _MEMBERS.items():
            value = getattr(material, name)
            if isinstance(value, Call):
                text = f"operator_within({{0}}, {_text(low)}, {_text(high)})"
                members[name] = as_type(value, kind), text
        return programs.add(members) if members else None

    def _check(self, material, what):
        bad = (material < 0) | (material >= self._count)
        if bad.any():
            raise SceneError(f"{what} uses material {int(material[np.argmax(bad)])}, the scene has {self._count}")

    def _check_images(self, scene):
        users = [(material, f"material {number}") for number, material in enumerate(self.materials[: self._count])]
        for material, user in (*users, (self._world, "the world")):
            for number in image_numbers(expressions_of(material)):
                if number >= len(scene.images):
                    raise SceneError(f"{user} uses image {number}, the scene has {len(scene.images)}")


def expressions_of(material):
    """The members of a material that vary."""
    return tuple(v for name in _MEMBERS if isinstance(v := getattr(material, name), Call))


def image_numbers(values):
    """Numbers of the images that expressions look up, each once, in order."""
    looked_up = (n for n in in_order(values) if isinstance(n, Call) and n.name.startswith("image_sample"))
    return sorted({int(node.inputs[0].value[0]) for node in looked_up})


def attribute_names(scene):
    """Names of the attributes that the materials and the outlines of a scene need, sorted."""
    names = attribute_keys([e for material in scene.materials for e in expressions_of(material)])
    return tuple(sorted({*names, scene.outline_attribute} - {""}))


def _gives_back_in_glass(material):
    """Whether facets that bend light give back what they lose."""
    needed = (material.transmit, material.transmit_roughness, material.multiscatter, material.body)
    return not any(map(is_zero, needed))


def _has_coat(material):
    return not is_zero(material.coat)


def _may_be(value):
    """Whether a colour may be anything but black, as far as its constants tell."""
    return not vanishes(value) if isinstance(value, Expression) else max(value) > 0.0


def _constant(value, kind, stand_in):
    """The numbers of a member, of one that varies those that stand for it."""
    if is_constant(value):
        return as_type(value, kind).value
    value = stand_in if isinstance(value, Expression) else value
    return value if hasattr(value, "__len__") else (value,) * (1 if kind == "float" else 3)


def _text(number):
    return repr(float(np.float32(number)))
