# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups that make many shapes of the vertices of a mesh and their attributes."""

import bpy

from .proxy_mesh import SEGMENTS


def add_points_modifier(obj, material):
    """Turn the vertices of the mesh object into points with their attribute `radius`: older versions of Blender make no
    point cloud of a given size from Python."""
    _add_modifier(obj, "Conic Points", _points, Material=material)


def add_cones_modifier(obj, apex_radius, material):
    """Put an open cone on each vertex of the mesh object, radius 1 at its lower end and `apex_radius` at its upper one,
    height 1, turned and scaled about its middle by the vertex's attributes `rotation` (quaternion) and `scale`."""
    _add_modifier(obj, "Conic Cones", _cones, Material=material, Apex_Radius=apex_radius)


def _add_modifier(obj, name, make, **inputs):
    """Give `obj` a modifier with a node group of its own, whose inputs are those of `_group` and have the values
    `inputs`: the modifier takes them over, and how a modifier's inputs are set changes with Blender's version."""
    group = _group(name, make)
    for socket, value in inputs.items():
        group.interface.items_tree[socket.replace("_", " ")].default_value = value
    obj.modifiers.new(name, "NODES").node_group = group


def _group(name, make):
    """A new node group: `make(tree, inputs)` gives the socket of the geometry to be shown in the input `Material`."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    tree.is_modifier = True
    interface = tree.interface
    interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    inputs = _node(tree, "NodeGroupInput", -3)
    output = _node(tree, "NodeGroupOutput", 3)
    shown = make(tree, inputs)
    interface.new_socket("Material", in_out="INPUT", socket_type="NodeSocketMaterial")
    colored = _node(tree, "GeometryNodeSetMaterial", 2)
    tree.links.new(shown, colored.inputs["Geometry"])
    tree.links.new(inputs.outputs["Material"], colored.inputs["Material"])
    tree.links.new(colored.outputs[0], output.inputs[0])
    return tree


def _points(tree, inputs):
    points = _node(tree, "GeometryNodeMeshToPoints", 0)
    tree.links.new(inputs.outputs["Geometry"], points.inputs["Mesh"])
    tree.links.new(_attribute(tree, "radius", "FLOAT", 1), points.inputs["Radius"])
    return points.outputs[0]


def _cones(tree, inputs):
    tree.interface.new_socket("Apex Radius", in_out="INPUT", socket_type="NodeSocketFloat")
    cone = _node(tree, "GeometryNodeMeshCone", -1)
    cone.fill_type = "NONE"
    cone.inputs["Vertices"].default_value = SEGMENTS
    cone.inputs["Radius Bottom"].default_value = 1.0
    cone.inputs["Depth"].default_value = 1.0
    tree.links.new(inputs.outputs["Apex Radius"], cone.inputs["Radius Top"])
    centered = _node(tree, "GeometryNodeTransform", 0)
    centered.inputs["Translation"].default_value = (0.0, 0.0, -0.5)  # the node's cone stands on the ground
    tree.links.new(cone.outputs["Mesh"], centered.inputs[0])
    smooth = _node(tree, "GeometryNodeSetShadeSmooth", 0, -1)
    tree.links.new(centered.outputs[0], smooth.inputs[0])
    instances = _node(tree, "GeometryNodeInstanceOnPoints", 1)
    tree.links.new(inputs.outputs["Geometry"], instances.inputs["Points"])
    tree.links.new(smooth.outputs[0], instances.inputs["Instance"])
    tree.links.new(_attribute(tree, "rotation", "QUATERNION", 1), instances.inputs["Rotation"])
    tree.links.new(_attribute(tree, "scale", "FLOAT_VECTOR", 2), instances.inputs["Scale"])
    return instances.outputs[0]


def _attribute(tree, name, data_type, row):
    """The output of a node that gives an attribute."""
    node = _node(tree, "GeometryNodeInputNamedAttribute", -1, row)
    node.data_type = data_type
    node.inputs["Name"].default_value = name
    return node.outputs["Attribute"]


def _node(tree, kind, column, row=0):
    node = tree.nodes.new(kind)
    node.location = 200.0 * column, -200.0 * row
    return node
