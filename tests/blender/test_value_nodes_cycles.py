"""Value nodes on attributes of geometry, objects and instances against Cycles; the shading table has each by itself."""

import bpy
import numpy as np
import pytest

from tests.blender.building import add_camera, link, material, node, sync
from tests.blender.test_attributes_cycles import (
    assert_constants,
    assert_same,
    of_points,
    pictures,
    set_attribute,
    swatch,
)

SINCE_4_5 = pytest.mark.skipif(bpy.app.version < (4, 5, 0), reason="instances can be read since Blender 4.5")


@pytest.fixture
def rng():
    return np.random.default_rng(41)


def attribute(tree, to, name, output="Color", kind="GEOMETRY"):
    made = tree.nodes.new("ShaderNodeAttribute")
    made.attribute_name, made.attribute_type = name, kind
    tree.links.new(next(s for s in made.outputs if s.identifier == output), to)


def emission():
    """A new material that shows a color: (material, tree, the socket of the color)."""
    made, tree, output = material("computed")
    return made, tree, node(tree, "Emission", output.inputs["Surface"], Strength=1.0).inputs["Color"]


def sync_messages():
    add_camera()
    return sync().messages


def ramp(tree, to, output=0):
    """A Color Ramp of three colors that feeds a socket; its factor."""
    made = node(tree, "ValToRGB", to, output)
    elements = made.color_ramp.elements
    elements.new(0.4)
    for element, color in zip(
        elements, ((1.0, 0.1, 0.0, 0.2), (0.0, 0.8, 0.3, 1.0), (0.1, 0.2, 1.0, 0.6)), strict=True
    ):
        element.color = color
    return made.inputs["Fac"]


@pytest.mark.parametrize("output", (0, 1))
def test_random_of_objects_through_a_ramp(output, tmp_path):
    for i in range(8):
        made, tree, socket = emission()
        node(tree, "ObjectInfo", ramp(tree, socket, output), output="Random")
        swatch(i, made, name=f"swatch {i}")
    conic, cycles = pictures(8, tmp_path)
    # Cycles has a table of 256.
    np.testing.assert_allclose(conic, cycles, atol=4e-3)
    assert np.ptp(cycles[..., 0], axis=0).max() > 0.1, "they differ"


def instance_tree(obj, tree, geometry, made):
    """Give a mesh object's points instances of a square of 0.8 with a material."""
    square = tree.node("MeshGrid", {"Size X": 0.8, "Size Y": 0.8, "Vertices X": 2, "Vertices Y": 2}).outputs[0]
    square = tree.node("SetMaterial", {"Geometry": square, "Material": made}).outputs[0]
    return tree.node("InstanceOnPoints", {"Points": geometry, "Instance": square}).outputs[0]


def test_random_of_instances_through_a_ramp(tmp_path, rng):
    made, tree, socket = emission()
    node(tree, "ObjectInfo", ramp(tree, socket), output="Random")
    obj, nodes = of_points(6, rng)
    nodes.on(obj, instance_tree(obj, nodes, nodes.geometry, made))
    conic, cycles = pictures(6, tmp_path, margin=2)
    np.testing.assert_allclose(conic, cycles, atol=4e-3)
    assert np.ptp(cycles[..., 0], axis=0).max() > 0.1, "they differ"


def paint_of_either(tree, socket):
    """The color as Molecular Nodes 4.5 takes it: of the geometry plus that of the instance where its alpha is not 0."""
    mix = tree.nodes.new("ShaderNodeMix")
    mix.data_type, mix.blend_type = "RGBA", "ADD"
    factor, a, b = (s for s in mix.inputs if s.enabled)
    greater = node(tree, "Math", factor)
    greater.operation = "GREATER_THAN"
    greater.inputs[1].default_value = 0.0
    attribute(tree, greater.inputs[0], "paint", "Alpha", "INSTANCER")
    attribute(tree, a, "paint")
    attribute(tree, b, "paint", "Color", "INSTANCER")
    tree.links.new(next(s for s in mix.outputs if s.enabled), socket)


@SINCE_4_5
def test_one_material_on_a_point_cloud_and_on_instances(tmp_path, rng):
    made, tree, socket = emission()
    paint_of_either(tree, socket)
    obj, nodes = of_points(6, rng)
    cloud = nodes.node("MeshToPoints", {"Mesh": nodes.geometry, "Radius": 0.45}).outputs[0]
    cloud = nodes.node("SetMaterial", {"Geometry": cloud, "Material": made}).outputs[0]
    moved = nodes.node("SetPosition", {"Geometry": nodes.geometry, "Offset": (6.0, 0.0, 0.0)}).outputs[0]
    both = nodes.tree.nodes.new("GeometryNodeJoinGeometry")
    for part in (instance_tree(obj, nodes, moved, made), cloud):
        nodes.tree.links.new(part, both.inputs[0])
    nodes.on(obj, both.outputs[0])
    conic, cycles = pictures(12, tmp_path, margin=3)
    assert_constants(conic, cycles)
    np.testing.assert_allclose(cycles[:6, 0, 0], cycles[6:, 0, 0], atol=1e-5)
    assert np.ptp(cycles[:6, 0, 0, 0]) > 0.1, "they differ"


def test_object_color_times_paint_of_faces(tmp_path, rng):
    """Attributes of the geometry and of its object in one expression: exact where they do not vary at once."""
    for i in range(4):
        made, tree, socket = emission()
        product = node(tree, "VectorMath", socket)
        product.operation = "MULTIPLY"
        attribute(tree, product.inputs[0], "paint")
        node(tree, "ObjectInfo", product.inputs[1], output="Color")
        obj = swatch(i, made, color=(*rng.random(3), 1.0))
        set_attribute(obj.data, "paint", "FLOAT_COLOR", "FACE", rng.random((1, 4), np.float32))
    assert not sync_messages()
    assert_constants(*pictures(4, tmp_path))


def test_strength_of_an_emission_by_an_attribute(tmp_path, rng):
    for i in range(3):
        made, tree, socket = emission()
        socket.default_value = (0.2, 0.5, 0.9, 1.0)
        attribute(tree, socket.node.inputs["Strength"], "paint", "Fac")
        obj = swatch(i, made)
        set_attribute(obj.data, "paint", "FLOAT", "FACE", rng.random(1, np.float32))
    assert_constants(*pictures(3, tmp_path))


def test_attributes_of_the_geometry_and_of_objects_that_share_it_are_added(tmp_path):
    """Both vary at once: a mesh of two faces, and two objects of it."""
    made, tree, socket = emission()
    total = node(tree, "VectorMath", socket)
    attribute(tree, total.inputs[0], "paint")
    node(tree, "ObjectInfo", total.inputs[1], output="Color")
    first = swatch(0, made, color=(0.1, 0.2, 0.3, 1.0))
    set_attribute(
        first.data, "paint", "FLOAT_COLOR", "POINT", np.repeat([(0.5, 0.25, 0.1, 1.0), (0.1, 0.2, 0.6, 1)], 2, 0)
    )
    link(first.data, "other", location=(1.0, 0.0, 0.0), color=(0.4, 0.1, 0.0, 1.0))
    assert not sync_messages()
    conic, cycles = pictures(2, tmp_path)
    assert_same(conic, cycles)
    assert np.ptp(cycles[0, ..., 0]) > 0.2 and np.ptp(cycles[:, 0, 0, 0]) > 0.2


def test_what_is_clear_by_an_attribute_shows_what_lies_behind(tmp_path):
    """Also where what it lies on, of another material, lacks the attribute."""
    made, tree, output = material("clear")
    mix = node(tree, "MixShader", output.inputs["Surface"])
    node(tree, "BsdfTransparent", mix.inputs[1])
    node(tree, "Emission", mix.inputs[2], Color=(0.2, 0.5, 0.9, 1.0))
    attribute(tree, mix.inputs[0], "opacity", "Fac")
    behind, _, socket = emission()
    socket.default_value = (0.8, 0.1, 0.0, 1.0)
    for i, opacity in enumerate((0.0, 0.3, 1.0)):
        set_attribute(swatch(i, made, location=(0, 0, 1)).data, "opacity", "FLOAT", "FACE", np.float32([opacity]))
        swatch(i, behind)
    assert not sync_messages()
    conic, cycles = pictures(3, tmp_path)
    np.testing.assert_allclose(conic[[0, 2]], cycles[[0, 2]], atol=1e-3)
    np.testing.assert_allclose(
        conic[1, ..., :3], np.broadcast_to((0.62, 0.22, 0.27), conic[1, ..., :3].shape), atol=1e-3
    )
