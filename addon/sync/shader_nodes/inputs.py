# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that read what objects and their data carry, and what the ray is."""

from ...engine.expression import Parameter, call, calls, component
from ...engine.visibility import Visibility
from ..attributes import key_of, output_of, property_value
from .coordinates import attribute, normal_input, object_space
from .registry import reads

#: Outputs of the Attribute and Color Attribute nodes; Cycles' Vector is its Color.
_OUTPUTS = {"Color": "", "Vector": "", "Fac": "fac", "Alpha": "alpha"}
_SOURCES = {"GEOMETRY": "geometry", "OBJECT": "property", "INSTANCER": "instancer"}
_BLACK = (0.0, 0.0, 0.0)


def _number(key):
    return component(attribute(key), 0)


def _output(n, source, name):
    """An output of an attribute."""
    output = _OUTPUTS[n.output]
    key = key_of(source, name, output)
    return _number(key) if output else attribute(key)


@reads("ATTRIBUTE")
def attribute_node(n):
    node = n.node
    if node.attribute_type == "VIEW_LAYER":
        value = property_value(n.layers, node.attribute_name)
        if value is None:
            return Parameter(_BLACK)
        value = tuple(float(c) for c in output_of(value, _OUTPUTS[n.output])[:3])
        return Parameter(value[0] if _OUTPUTS[n.output] else value)
    if not node.attribute_name or n.in_world:
        return Parameter(_BLACK)
    return _output(n, _SOURCES[node.attribute_type], node.attribute_name)


@reads("VERTEX_COLOR")
def color_attribute(n):
    return Parameter(_BLACK) if n.in_world else _output(n, "geometry", n.node.layer_name)


@reads("OBJECT_INFO")
def object_info(n):
    if n.output == "Material Index":
        return Parameter(float(getattr(n.owner, "pass_index", 0)))
    if n.in_world:
        return Parameter(_BLACK)
    if n.output in ("Location", "Color"):
        return attribute(key_of("object", n.output.lower()))
    return _number(key_of("object", {"Alpha": "alpha", "Object Index": "index", "Random": "random"}[n.output]))


@reads("POINT_INFO")
def point_info(n):
    if n.output == "Random":
        return _number(key_of("random"))
    if n.output == "Position":
        return call("input_point_position", attribute(key_of("point", "position")), *object_space())
    return call("input_point_radius", _number(key_of("point", "radius")), *object_space())


@reads("HAIR_INFO")
def hair_info(n):
    if n.output == "Random":
        return _number(key_of("random"))
    if n.output == "Tangent Normal":
        return call("input_strand_normal")
    return _number(key_of("hair", n.output.lower().replace(" ", "_")))


@reads("PARTICLE_INFO")
def particle_info(n):
    n.instead("0")
    return Parameter(0.0 if n.source.output.type == "VALUE" else _BLACK)


_RAYS = {
    "Is Camera Ray": Visibility.CAMERA,
    "Is Shadow Ray": Visibility.SHADOW,
    "Is Diffuse Ray": Visibility.DIFFUSE,
    "Is Glossy Ray": Visibility.GLOSSY | Visibility.TRANSMISSION,  # as in Cycles, which counts refraction
    "Is Singular Ray": Visibility.GLOSSY | Visibility.TRANSMISSION,
    "Is Reflection Ray": Visibility.DIFFUSE | Visibility.GLOSSY,
    "Is Transmission Ray": Visibility.TRANSMISSION,
}
_DEPTHS = {"Glossy Depth": Visibility.GLOSSY, "Transmission Depth": Visibility.TRANSMISSION}


@reads("LIGHT_PATH")
def light_path(n):
    output = n.output
    if output in _RAYS:
        return call("input_ray_is", int(_RAYS[output]))
    if output == "Ray Length":
        return call("input_ray_length")
    if output == "Ray Depth":
        return call("input_ray_depth") + (1.0 if n.in_world else 0.0)
    if output == "Transparent Depth":
        return call("input_transparent_depth")
    if output in _DEPTHS:
        n.instead(f"the ray depth for {output}")
        return call("input_ray_is", int(_DEPTHS[output])) * call("input_ray_depth")
    return Parameter(0.0)  # the engine has no diffuse bounces, volumes or portals


@reads("LAYER_WEIGHT")
def layer_weight(n):
    fresnel, facing = calls("input_layer_weight", normal_input(n), n.number("Blend"))
    return {"Fresnel": fresnel, "Facing": facing}


@reads("FRESNEL")
def fresnel(n):
    return call("input_fresnel", normal_input(n), n.number("IOR"))


@reads("WIREFRAME")
def wireframe(n):
    n.instead("0")
    return Parameter(0.0)


@reads("AMBIENT_OCCLUSION")
def ambient_occlusion(n):
    n.instead("its color without occlusion")
    return n.color("Color") if n.output == "Color" else Parameter(1.0)


@reads("MATERIAL_RAYCAST")
def raycast(n):
    n.instead("a ray that hits nothing")
    return Parameter(0.0 if n.source.output.type in ("VALUE", "BOOLEAN") else _BLACK)


@reads("VOLUME_INFO", "UVALONGSTROKE")
def without_surface(n):
    n.instead("0")
    return Parameter(0.0 if n.source.output.type == "VALUE" else _BLACK)
