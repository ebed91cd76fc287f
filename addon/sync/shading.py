# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's materials as the engine's."""

from dataclasses import dataclass, replace

from ..engine.expression import Parameter, attribute_keys, is_zero
from ..engine.material_packing import expressions_of
from ..engine.scene import Material
from ..fingerprint import fingerprint
from .attributes import parts_of
from .changes import ids_in
from .closures import principled, read_absorption, read_closure
from .compat import flattened, has_geometry_sets
from .keys import original_key
from .lobes import Lobes
from .memory import ALWAYS, Memory
from .nodes import output_source
from .places import Places
from .tree_reader import TreeReader, deep_recursion

DEFAULT = Material()  # Blender's grey, for a slot without material

#: So many materials more than are in use are kept: where one of them comes back, the program still serves.
_SPARE = 64


def material_places():
    """The `Places` of engine Materials."""
    return Places(Material(), _SPARE)


@dataclass(frozen=True)
class Shading:
    """A material of the scene: its number, the uv map that it takes, None where it takes none, whether light may go
    through it, and the keys of the attributes of Blender's data that it needs (see `attributes`)."""

    index: int
    uv_map: str | None = None
    name: str = ""
    transmits: bool = False
    attributes: tuple = ()

    @property
    def needs(self):
        """What geometries and attributes depend on."""
        return self.index, self.uv_map, self.transmits, self.attributes


class Shadings:
    """The materials of a scene, each read once, when an object first needs it; it keeps its number from read to read.

    `places`: the `Places` of engine Materials, those of earlier reads too. `layers`: the view layer, scene and world,
    whose properties attributes of the view layer are. `outline_attribute`: see `engine.scene.Scene`.
    """

    def __init__(self, images, reports, layers=(), memory=None, places=None, outline_attribute=""):
        self._images, self._reports, self._layers = images, reports, layers
        self._memory = memory or Memory(reports)
        self._places = material_places() if places is None else places
        self._outline_attribute = outline_attribute

    def of(self, material):
        """The `Shading` of a Blender material, or of None: an empty slot, or one whose material was deleted."""
        key = "material", None if material is None else original_key(material)
        return self._memory.get(key, lambda _: self._read(key, material), self._outline_attribute)

    def of_sheet(self, shading):
        """The `Shading` of the same material on a surface that is not closed: what enters there is in no body."""
        if not shading.transmits:
            return shading
        key, source = ("sheet", shading.index), self._places.things[shading.index]

        def made(previous):
            if previous is not None and previous[1:] == (shading, source):
                return previous
            index = self._number(key, replace(source, bounds_body=False))
            return replace(shading, index=index), shading, source

        return self._memory.get(key, made, (shading, id(source)))[0]

    def _number(self, key, material):
        """The number of a material, the one that it has had; where it looks as before it stays the same object."""
        known = self._places.of(key)
        if known and fingerprint(material) == fingerprint(self._places.things[known[0]]):
            return known[0]
        return self._places.put(key, [material])

    def _read(self, key, material):
        if material is None:
            return Shading(self._number(key, DEFAULT), attributes=self._keys(set()))
        self._memory.depend(original_key(material), *ids_in(material.node_tree))
        user = f"material {material.name!r}"
        reader = TreeReader(user, material, "MATERIAL", self._images, self._reports, self._layers)
        with deep_recursion():
            read = read_material(material, reader)
            reader.finish()
        if reader.asked_layers:
            self._memory.depend(ALWAYS)
        keys = self._keys(attribute_keys(expressions_of(read)))
        if any(parts_of(key)[0] == "instancer" for key in keys) and not has_geometry_sets():
            reader.warn(
                "attributes of instances are rendered from Blender 4.5 on; properties of objects are used instead"
            )
        transmits = not is_zero(read.transmit)
        return Shading(self._number(key, read), reader.uv_map, material.name, transmits, keys)

    def _keys(self, needed):
        """The attributes to read, sorted: those that a material needs and that of the scene's outlines."""
        return tuple(sorted({*needed, self._outline_attribute} - {""}))


def read_material(material, reader):
    """The engine's Material of a Blender material."""
    return replace(
        _shaded(material, reader),
        cull_back=material.use_backface_culling,
        cull_back_shadow=material.use_backface_culling_shadow,
        emission=_emission_sampling(material),
    )


def _emission_sampling(material):
    """Which sides of what glows light other things: a setting of Cycles, which may be switched off."""
    cycles = getattr(material, "cycles", None)
    sampling = cycles.emission_sampling if cycles is not None else "AUTO"
    return {"AUTO": "BOTH", "FRONT_BACK": "BOTH"}.get(sampling, sampling)


def _shaded(material, reader):
    tree, _kept = flattened(material)
    if tree is None:
        return _without_nodes(material)
    surface = output_source(tree, "Surface")
    if surface is None:
        reader.warn("it has no output node; black is used instead")
        return Lobes().material()
    displacement = output_source(tree, "Displacement")
    if displacement is not None and displacement.node is not None:
        reader.warn(f"displacement by node {displacement.name!r} is not rendered")
    volume = output_source(tree, "Volume")
    if surface.node is None and volume is not None and volume.node is not None:
        lobes = Lobes(clear=1.0)  # a body of volume alone has no surface
    else:
        lobes = read_closure(surface, reader)
    return lobes.material(read_absorption(volume, reader))


def _without_nodes(material):
    return principled(
        Parameter(tuple(material.diffuse_color)[:3]),
        metallic=Parameter(material.metallic),
        roughness=Parameter(material.roughness),
        specular=Parameter(material.specular_intensity),
    ).material()
