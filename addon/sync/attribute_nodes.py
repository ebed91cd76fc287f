# SPDX-License-Identifier: GPL-3.0-or-later
"""The nodes that read attributes, each as an expression: of the key by which the engine knows the attribute."""

from dataclasses import dataclass

from .attributes import key_of, output_of, property_value
from .expressions import Attribute, Constant

#: Outputs of the Attribute and Color Attribute nodes; Cycles' Vector is its Color.
_OUTPUTS = {"Color": "", "Vector": "", "Fac": "fac", "Alpha": "alpha"}
_BLACK = Constant((0.0, 0.0, 0.0))
_SOURCES = {"GEOMETRY": "geometry", "OBJECT": "property", "INSTANCER": "instancer"}
_OF_OBJECT_INFO = {
    "Location": "location",
    "Color": "color",
    "Alpha": "alpha",
    "Object Index": "index",
    "Random": "random",
}


@dataclass(frozen=True)
class AttributeNodes:
    """Reads the attribute nodes of one material; `layers`: the view layer, scene and world, whose properties an
    Attribute node of type View Layer gives, the first first."""

    material: object
    layers: tuple = ()

    def read(self, source):
        """The expression of a `Source`, None where its node or output is no attribute that can be had."""
        read = _NODES.get(source.type)
        return read(self, source) if read else None

    def _attribute(self, source):
        node, output = source.node, _OUTPUTS[source.output.identifier]
        if node.attribute_type == "VIEW_LAYER":
            value = property_value(self.layers, node.attribute_name)
            return _BLACK if value is None else Constant(tuple(float(c) for c in output_of(value, output)[:3]))
        if not node.attribute_name:
            return _BLACK
        return _attribute(source, key_of(_SOURCES[node.attribute_type], node.attribute_name, output))

    def _color_attribute(self, source):
        key = key_of("geometry", source.node.layer_name, _OUTPUTS[source.output.identifier])
        return _attribute(source, key)

    def _object_info(self, source):
        output = source.output.identifier
        if output == "Material Index":
            return Constant((float(self.material.pass_index),))
        return _attribute(source, key_of("object", _OF_OBJECT_INFO[output])) if output in _OF_OBJECT_INFO else None

    def _random(self, source):
        return _attribute(source, key_of("random")) if source.output.identifier == "Random" else None


def _attribute(source, key):
    return Attribute(key, is_number=source.output.type == "VALUE")


_NODES = {
    "ATTRIBUTE": AttributeNodes._attribute,
    "VERTEX_COLOR": AttributeNodes._color_attribute,
    "OBJECT_INFO": AttributeNodes._object_info,
    "POINT_INFO": AttributeNodes._random,
    "HAIR_INFO": AttributeNodes._random,
}
