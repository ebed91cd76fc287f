# SPDX-License-Identifier: GPL-3.0-or-later
"""NFF's materials as node trees whose shares are those of the file, in Conic as in Cycles: what is diffuse, mirrored
and let through is added up."""

from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..sync.compat import node_tree
from ..sync.lobes import ior_of_reflectance, normal_reflectance, phong_of, sharpness

#: A highlight whose lobe would mirror more than this part of Ks by itself is smaller than a pixel: it is left out.
_MOST_MIRRORED = 0.5
#: Reflectance at normal incidence up to which a dielectric stands for a highlight.
_MOST_REFLECTANCE = 0.9
_STEP = 300.0  # between nodes


class Materials:
    """The Blender materials of a file, each made when something first needs it."""

    def __init__(self, materials, stem):
        self._materials, self._stem = materials, stem
        self._made = {}
        self._alike = {}

    def of(self, index, one_sided=False):
        """The material number `index`; `one_sided`: seen from its front only."""
        key = int(index), one_sided
        if key not in self._made:
            name = f"{self._stem} {key[0] + 1}{' one-sided' if one_sided else ''}"
            self._made[key] = self._make(name, self._materials[key[0]], one_sided)
        return self._made[key]

    def _make(self, name, material, one_sided):
        """A new material. One that differs from an earlier one in its colour alone is a copy of that: each change of a
        node tree takes the longer the more trees there are, and some files have a colour for each shape."""
        black = not any(material.diffuse)
        key = replace(material, diffuse=(0.0, 0.0, 0.0)), black, one_sided
        if key not in self._alike:
            self._alike[key] = new_material(name, material, one_sided)
            return self._alike[key]
        made = self._alike[key].copy()
        made.name = name
        _set_viewport_color(made, material)
        if not black:
            body = next(node for node in made.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
            body.inputs["Base Color"].default_value = _base_color(material, _Highlight.of(material))
        return made


def new_tree(owner):
    """The emptied node tree of a new material, world or light, and its output node."""
    if node_tree(owner) is None:
        owner.use_nodes = True
    tree = node_tree(owner)
    tree.nodes.clear()
    kind = {bpy.types.Material: "Material", bpy.types.World: "World"}.get(type(owner), "Light")
    output = tree.nodes.new(f"ShaderNodeOutput{kind}")
    return tree, output


def new_node(tree, kind, column, row=0, **inputs):
    """A node of the type ShaderNode<kind>, `column` places left of the output and `row` below it; its inputs by their
    names."""
    node = tree.nodes.new(f"ShaderNode{kind}")
    node.location = -_STEP * column, -_STEP * row
    for name, value in inputs.items():
        node.inputs[name.replace("_", " ")].default_value = value
    return node


def new_material(name, material, one_sided=False):
    """A Blender material of the engine Material of an `f` record."""
    made = bpy.data.materials.new(name)
    tree, output = new_tree(made)
    shaders = _shaders(tree, material)
    last = shaders[0]
    for place, shader in enumerate(shaders[1:], 1):
        both = new_node(tree, "AddShader", len(shaders) - place)
        tree.links.new(last.outputs[0], both.inputs[0])
        tree.links.new(shader.outputs[0], both.inputs[1])
        last = both
    tree.links.new(last.outputs[0], output.inputs["Surface"])
    _set_viewport_color(made, material)
    made.use_backface_culling = one_sided  # what cannot be seen casts shadows nevertheless
    return made


def _set_viewport_color(made, material):
    """The colour in solid view."""
    seen = np.add(np.add(material.diffuse, material.reflect), material.transmit)
    made.diffuse_color = (*np.clip(seen, 0.0, 1.0), 1.0)


def _base_color(material, highlight):
    """The colour of the body under its highlight, which takes some of the light."""
    return (*np.divide(material.diffuse, 1.0 - highlight.taken), 1.0)


def _shaders(tree, material):
    """A node for each share of the material, one at least."""
    highlight = _Highlight.of(material)
    mirror = np.maximum(np.subtract(material.reflect, highlight.mirror), 0.0)
    shaders = []
    if any(material.diffuse) or highlight.reflectance or not (any(mirror) or any(material.transmit)):
        shaders.append(_principled(tree, _base_color(material, highlight), highlight))
    if any(mirror):
        shaders.append(new_node(tree, "BsdfAnisotropic", 3, -1, Color=(*mirror, 1.0), Roughness=0.0))
    if any(material.transmit):
        color = (*material.transmit, 1.0)
        if material.ior == 1.0:
            shaders.append(new_node(tree, "BsdfTransparent", 3, -2, Color=color))
        else:
            shaders.append(new_node(tree, "BsdfRefraction", 3, -2, Color=color, Roughness=0.0, IOR=material.ior))
    return shaders


def _principled(tree, base, highlight):
    node = new_node(tree, "BsdfPrincipled", 3, 0, Base_Color=base, Roughness=highlight.roughness)
    if highlight.reflectance:
        node.inputs["IOR"].default_value = ior_of_reflectance(highlight.reflectance)
    else:
        node.inputs["Specular IOR Level"].default_value = 0.0
    return node


@dataclass(frozen=True)
class _Highlight:
    """The rough dielectric surface whose highlight of the lights is Phong's: its `roughness` and its reflectance at
    normal incidence, 0 for no highlight."""

    roughness: float = 0.5
    reflectance: float = 0.0

    @classmethod
    def of(cls, material):
        """Of a Material's highlight and shine: the inverse of what the sync makes of a Principled BSDF."""
        weight = max(material.highlight)
        # Exponent n / 4 of a microfacet lobe of width alpha with n = 2 / alpha^2 - 2: see `phong_of`.
        roughness = (1.0 / (2.0 * max(material.shine, 1.0) + 1.0)) ** 0.25
        peak = (1.0 - sharpness(roughness)) * phong_of(roughness)[0]
        if not weight > 0.0 or not peak > 0.0:
            return cls()
        made = cls(roughness, min(weight / peak, _MOST_REFLECTANCE))
        return made if made.mirror <= _MOST_MIRRORED * max(material.reflect) else cls()

    @property
    def mirror(self):
        """What the surface reflects as a mirror."""
        return self.reflectance * sharpness(self.roughness)

    @property
    def taken(self):
        """What it takes of the light of the body under it, once for its blurred and once for its sharp part."""
        reflectance = normal_reflectance(ior_of_reflectance(self.reflectance))
        blurred = (1.0 - sharpness(self.roughness)) * reflectance
        return 1.0 - (1.0 - blurred) * (1.0 - self.mirror)
