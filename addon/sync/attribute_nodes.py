# SPDX-License-Identifier: GPL-3.0-or-later
"""The nodes that read attributes, each as a `Value`: of the key by which the engine knows the attribute."""

from dataclasses import dataclass

from .attributes import key_of, output_of, property_value
from .values import Value

#: Outputs of the Attribute and Color Attribute nodes; Cycles' Vector is its Color.
_OUTPUTS = {"Color": "", "Vector": "", "Fac": "fac", "Alpha": "alpha"}
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

    def value(self, source):
        """The `Value` of a `Source`, None where its node or output is no attribute that can be had."""
        read = _NODES.get(source.type)
        return read(self, source) if read else None

    def _attribute(self, source):
        node, output = source.node, _OUTPUTS[source.output.identifier]
        if node.attribute_type == "VIEW_LAYER":
            value = property_value(self.layers, node.attribute_name)
            return Value() if value is None else Value(tuple(float(c) for c in output_of(value, output)[:3]))
        if not node.attribute_name:
            return Value()
        return Value.of_attribute(key_of(_SOURCES[node.attribute_type], node.attribute_name, output))

    def _color_attribute(self, source):
        return Value.of_attribute(key_of("geometry", source.node.layer_name, _OUTPUTS[source.output.identifier]))

    def _object_info(self, source):
        output = source.output.identifier
        if output == "Material Index":
            return Value((float(self.material.pass_index),) * 3)
        return Value.of_attribute(key_of("object", _OF_OBJECT_INFO[output])) if output in _OF_OBJECT_INFO else None

    def _random(self, source):
        return Value.of_attribute(key_of("random")) if source.output.identifier == "Random" else None


_NODES = {
    "ATTRIBUTE": AttributeNodes._attribute,
    "VERTEX_COLOR": AttributeNodes._color_attribute,
    "OBJECT_INFO": AttributeNodes._object_info,
    "POINT_INFO": AttributeNodes._random,
    "HAIR_INFO": AttributeNodes._random,
}
