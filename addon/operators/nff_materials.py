# SPDX-License-Identifier: GPL-3.0-or-later
"""NFF's materials as node trees whose shares are those of the file, in Conic as in Cycles: what is diffuse, mirrored
and let through is added up."""

from dataclasses import dataclass, replace

import bpy
import numpy as np

from ..sync.compat import node_tree

#: Index of the coats that stand for highlights, the largest there is: Phong's highlight is the same at all angles,
#: and the reflectance of this grows the least towards the edge.
_COAT_IOR = 4.0
_COAT_REFLECTANCE = ((_COAT_IOR - 1.0) / (_COAT_IOR + 1.0)) ** 2
#: Reflectance at normal incidence up to which a coat stands for a highlight: a wide one stays dimmer than Phong's,
#: which takes nothing of what lies below.
_MOST_REFLECTANCE = 0.2
_STEP = 300.0  # between nodes
#: The node of what is diffuse; its first input is the color.
_BODY = "Body"


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
            made.node_tree.nodes[_BODY].inputs[0].default_value = _base_color(material, _Highlight.of(material))
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
    return (*_under(material.diffuse, highlight), 1.0)


def _under(share, highlight):
    """A share (3,) of what lies under the highlight, which takes some of the light, so that it is right from above."""
    return np.divide(share, 1.0 - highlight.reflectance)


def _shaders(tree, material):
    """A node for each share of the material, one at least."""
    highlight = _Highlight.of(material)
    mirror, through = _under(material.reflect, highlight), _under(material.transmit, highlight)
    shaders = []
    if any(material.diffuse) or highlight.reflectance or not any(material.transmit):
        shaders.append(_body(tree, _base_color(material, highlight), highlight))
    if any(mirror):
        shaders.append(new_node(tree, "BsdfAnisotropic", 3, -1, Color=(*mirror, 1.0), Roughness=0.0))
    if any(material.transmit):
        color = (*through, 1.0)
        if material.ior == 1.0:
            shaders.append(new_node(tree, "BsdfTransparent", 3, -2, Color=color))
        else:
            shaders.append(new_node(tree, "BsdfRefraction", 3, -2, Color=color, Roughness=0.0, IOR=material.ior))
    return shaders


def _body(tree, color, highlight):
    """What is diffuse, with the highlight as its coat."""
    if highlight.reflectance:
        node = new_node(tree, "BsdfPrincipled", 3, 0, Base_Color=color, Roughness=0.0, Specular_IOR_Level=0.0)
        node.inputs["Coat Weight"].default_value = highlight.reflectance / _COAT_REFLECTANCE
        node.inputs["Coat IOR"].default_value = _COAT_IOR
        node.inputs["Coat Roughness"].default_value = highlight.roughness
    else:
        node = new_node(tree, "BsdfDiffuse", 3, 0, Color=color)
    node.name = _BODY
    return node


@dataclass(frozen=True)
class _Highlight:
    """The rough mirror whose highlights of the lights are Phong's: its `roughness`, and its reflectance at normal
    incidence, 0 for no highlight."""

    roughness: float = 0.5
    reflectance: float = 0.0

    @classmethod
    def of(cls, material):
        """Of a Material's highlight and shine: as high in the middle, and half as high where that is. Phong's is so
        where the direction is off by arccos h, the half vector by half of that. The peak of GGX is 1 / (4 alpha^2) in
        units of a white diffuse surface."""
        h = 0.5 ** (1.0 / max(material.shine, 1.0))
        alpha_squared = (1.0 - h) / (2.0 * np.sqrt(2.0) - 1.0 - h)
        reflectance = 4.0 * alpha_squared * max(material.highlight)
        return cls(alpha_squared**0.25, min(reflectance, _MOST_REFLECTANCE))
