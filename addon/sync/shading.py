# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's materials as the engine's: node trees of the basic shaders with constants and images."""

from dataclasses import dataclass, replace

import numpy as np

from ..engine.scene import Material
from .attribute_nodes import AttributeNodes
from .attributes import parts_of
from .closures import principled, read_closure
from .compat import has_geometry_sets, node_tree
from .keys import original_key
from .lobes import Lobes
from .made_attributes import attributes_of, make_attributes
from .nodes import output_source
from .textures import NodeReader
from .values import Value

WHITE = Value((1.0, 1.0, 1.0))
DEFAULT = Material()  # Blender's grey, for a slot without material


@dataclass(frozen=True)
class Shading:
    """A material of the scene: its number, the `UvSource` of its images, None where it has none, whether light goes
    through it, and the keys of the attributes of Blender's data that it needs (see `attributes`)."""

    index: int
    uv: object = None
    name: str = ""
    transmits: bool = False
    attributes: tuple = ()


class Shadings:
    """The materials of a scene, each read once, when an object first needs it.

    `layers`: the view layer, scene and world, whose properties attributes of the view layer are.
    """

    def __init__(self, scene, images, reports, layers=()):
        self._scene, self._images, self._reports, self._layers = scene, images, reports, layers
        self._by_key = {}
        self._sheets = {}
        self._made, self._opacities = {}, []

    def of(self, material):
        """The `Shading` of a Blender material, or of None: an empty slot, or one whose material was deleted."""
        key = None if material is None else original_key(material)
        if key not in self._by_key:
            self._by_key[key] = self._read(material)
        return self._by_key[key]

    def of_sheet(self, shading):
        """The `Shading` of the same material on a surface that is not closed: what enters there is in no body."""
        if not shading.transmits:
            return shading
        if shading.index not in self._sheets:
            material = replace(self._scene.materials[shading.index], bounds_body=False)
            self._sheets[shading.index] = replace(shading, index=self._scene.add_material(material))
        return self._sheets[shading.index]

    def finish(self):
        """Once all objects stand in the scene: make the attributes that materials compute from those of the data."""
        sheets = {number: (number, sheet.index) for number, sheet in self._sheets.items()}
        opacities = [(alpha, name, sheets.get(number, (number,))) for alpha, name, number in self._opacities]
        make_attributes(self._scene, self._made, opacities, self._reports)

    def _read(self, material):
        if material is None:
            return Shading(self._scene.add_material(DEFAULT))
        attributes = AttributeNodes(material, self._layers)
        reader = NodeReader(f"material {material.name!r}", self._images, self._reports, attributes=attributes)
        read = read_material(material, reader)
        reader.finish()
        index = self._scene.add_material(read)
        self._made |= reader.made
        self._opacities += [(alpha, material.name, index) for alpha in reader.opacities]
        keys = _needed(attributes_of(read), reader)
        if any(parts_of(key)[0] == "instancer" for key in keys) and not has_geometry_sets():
            reader.warn(
                "attributes of instances are rendered from Blender 4.5 on; properties of objects are used instead"
            )
        return Shading(index, reader.uv, material.name, max(read.transmit) > 0.0, keys)


def _needed(keys, reader):
    """The keys, sorted, of the attributes of the data from which those of a material are made."""
    expressions = [*reader.opacities, *(reader.made[key] for key in keys if key in reader.made)]
    return tuple(sorted({key for key in keys if key not in reader.made}.union(*(e.keys for e in expressions))))


def read_material(material, reader):
    """The engine's Material of a Blender material."""
    return replace(
        _shaded(material, reader),
        cull_back=material.use_backface_culling,
        cull_back_shadow=material.use_backface_culling_shadow,
    )


def _shaded(material, reader):
    tree = node_tree(material)
    if tree is None:
        return _without_nodes(material).material()
    surface = output_source(tree, "Surface")
    if surface is None:
        reader.warn("it has no output node; black is used instead")
        return Lobes().material()
    displacement = output_source(tree, "Displacement")
    if displacement is not None and displacement.node is not None:
        reader.warn(f"displacement by node {displacement.node.name!r} is not rendered")
    volume = output_source(tree, "Volume")
    if surface.node is None and volume is not None and volume.node is not None:
        lobes = Lobes(clear=WHITE)  # a body of volume alone has no surface
    else:
        lobes = read_closure(surface, reader)
    if lobes.blurred:
        reader.warn(
            "its mix of an image or attribute with another or with a color is rendered as the stronger one, brightened"
        )
    if lobes.one_roughness:
        reader.warn("its reflections of different roughness are rendered with the roughness of the strongest")
    return lobes.material(_absorption(volume, reader))


def _without_nodes(material):
    return principled(
        Value(tuple(material.diffuse_color)[:3]),
        metallic=material.metallic,
        roughness=material.roughness,
        specular=material.specular_intensity,
    )


def _absorption(source, reader):
    """Beer-Lambert coefficient (3,) of what is linked to the Volume socket, as Cycles: density * (1 - colour)."""
    if source is None or source.node is None:
        return (0.0, 0.0, 0.0)
    if source.type != "VOLUME_ABSORPTION":
        reader.left_out(source, "its volume")
        return (0.0, 0.0, 0.0)
    color = reader.color(source.input("Color")).average
    return np.maximum(reader.number(source.input("Density")) * (1.0 - color), 0.0)
