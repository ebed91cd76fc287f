"""A scene with an object of each kind."""

import bpy
import numpy as np

from tests.blender.building import GeometryNodes, add_camera, image, link, material, node, quad, with_nodes

MANY = 300  # instances: enough to be a geometry of their own


def sphere_mesh(name):
    bpy.ops.conic.sphere_add()
    made = bpy.context.object.data
    bpy.data.objects.remove(bpy.context.object)
    made.name = name
    return made


def painted(name, pixels):
    """A material whose color is that of an image."""
    made, tree, output = material(name)
    diffuse = node(tree, "BsdfDiffuse", output.inputs["Surface"])
    node(tree, "TexImage", diffuse.inputs["Color"]).image = image(pixels, name)
    return made


def plainly(name, kind="BsdfDiffuse", **inputs):
    made, tree, output = material(name)
    node(tree, kind, output.inputs["Surface"], **inputs)
    return made


def of_group(name):
    """A material whose color comes out of a node group."""
    made, tree, output = material(name)
    diffuse = node(tree, "BsdfDiffuse", output.inputs["Surface"])
    group = bpy.data.node_groups.new("group", "ShaderNodeTree")
    group.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
    group.links.new(group.nodes.new("ShaderNodeRGB").outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
    node(tree, "Group").node_tree = group
    tree.links.new(tree.nodes["Group"].outputs[0], diffuse.inputs["Color"])
    return made


def with_coordinates(name, obj):
    """A material whose color is the place in the space of another object."""
    made, tree, output = material(name)
    diffuse = node(tree, "BsdfDiffuse", output.inputs["Surface"])
    node(tree, "TexCoord", diffuse.inputs["Color"], output="Object").object = obj
    return made


def of_attribute(name, attribute, kind="GEOMETRY"):
    made, tree, output = material(name)
    diffuse = node(tree, "BsdfDiffuse", output.inputs["Surface"])
    found = node(tree, "Attribute", diffuse.inputs["Color"])
    found.attribute_type, found.attribute_name = kind, attribute
    return made


def given(obj, made):
    obj.data.materials.append(made)
    return obj


def build_everything():
    """Fill the scene."""
    scene = bpy.context.scene
    scene.conic.curve_sampling = "FIXED"
    add_camera()
    ball = sphere_mesh("ball")
    ball.materials.append(plainly("red"))
    link(ball, "ball")
    link(ball, "ball 2", location=(2.0, 0.0, 0.0))
    link(ball, "squashed", scale=(1.0, 1.0, 0.5))
    given(link(ball.copy(), "glass"), plainly("glass", "BsdfGlass"))
    link(None, "parent")
    given(quad("painted"), painted("painted", np.full((4, 4, 4), 0.5))).parent = bpy.data.objects["parent"]
    given(quad("grouped"), of_group("grouped"))
    given(quad("elsewhere"), with_coordinates("elsewhere", bpy.data.objects["ball 2"]))
    given(quad("indexed"), of_attribute("indexed", "pass_index", "OBJECT"))
    given(quad("vertex colors"), of_attribute("vertex colors", "paint")).data.color_attributes.new(
        "paint", "FLOAT_COLOR", "POINT"
    )
    bent = quad("bent")
    bent.modifiers.new("subdivided", "SUBSURF").levels = 1
    given(quad("open glass"), bpy.data.materials["glass"])
    nodes = GeometryNodes("cloud")
    points = nodes.add("MeshLine", Count=MANY)
    nodes.output(nodes.add("InstanceOnPoints", Points=points, Instance=nodes.object(bpy.data.objects["ball"])))
    with_nodes(nodes, "cloud", location=(0.0, 5.0, 0.0))
    nodes = GeometryNodes("dots")
    nodes.output(nodes.add("MeshToPoints", Mesh=nodes.add("MeshGrid", Vertices_X=3), Radius=0.1))
    with_nodes(nodes, "dots")
    inner = bpy.data.collections.new("inner")
    inner.objects.link(link(bpy.data.objects["grouped"].data, "in collection"))
    outer = bpy.data.collections.new("outer")
    scene.collection.children.link(outer)
    outer.objects.link(link(quad("in outer").data.copy(), "in outer 2"))
    link(None, "instancer", instance_type="COLLECTION", instance_collection=inner, location=(0.0, 0.0, 3.0))
    curve = bpy.data.curves.new("strand", "CURVE")
    curve.dimensions = "3D"
    curve.splines.new("POLY").points.add(2)
    curve.splines[0].points.foreach_set("co", np.arange(12, dtype=np.float32))
    link(curve, "strand").conic.strand_radius = 0.1
    link(bpy.data.lights.new("lamp", "POINT"), "lamp", location=(0.0, 0.0, 4.0))
    scene.world = bpy.data.worlds.new("world")
    if bpy.app.version < (5, 0, 0):
        scene.world.use_nodes = True
    given(quad("nan"), bpy.data.materials["red"]).data.vertices[0].co = (np.nan, 0.0, 0.0)
