"""Value nodes between attributes and colors against Cycles in the same Blender."""

import bpy
import numpy as np
import pytest

from addon.sync.value_functions import BLENDS, MATH, VECTOR_MATH
from tests.blender.building import add_camera, link, material, mesh_of, node, sync
from tests.blender.test_attributes_cycles import assert_constants, of_points, pictures, set_attribute, swatch

#: The attributes of four faces: something of every sign, small, whole and zero.
NAMES = "abcd"
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


def of_values(column, made, rng):
    """A square of four faces with a value each in four attributes."""
    places = [(column + x / 2.0, y / 2.0, 0.0) for y in range(3) for x in range(3)]
    mesh = mesh_of(places, [(i, i + 1, i + 4, i + 3) for i in (0, 1, 3, 4)], "square")
    mesh.materials.append(made)
    for name in NAMES:
        values = rng.uniform(-1.2, 2.2, (4, 4)).astype(np.float32)
        values[0] = rng.uniform(0.05, 0.95, 4)
        values[3] = {"a": 0.7, "b": 0.0, "c": 0.3, "d": 1.0}[name]
        set_attribute(mesh, name, "FLOAT_COLOR", "FACE", values)
    link(mesh, "square")


def assert_node(cases, folder, rng):
    """Each case, (kind, settings) or with the number of the output, gives what it does in Cycles, shown as
    1 + a quarter of it: what is negative can be seen too."""
    for column, (kind, settings, *output) in enumerate(cases):
        made, tree, socket = emission()
        shown = node(tree, "VectorMath", socket)
        shown.operation = "MULTIPLY_ADD"
        shown.inputs[1].default_value, shown.inputs[2].default_value = (0.25,) * 3, (1.0,) * 3
        tested = tree.nodes.new(f"ShaderNode{kind}")
        for name, value in settings.items():
            setattr(tested, name, value)
        inputs = [s for s in tested.inputs if s.enabled]
        for i, to in enumerate(inputs):
            attribute(tree, to, NAMES[(i + 3 * (len(inputs) > 4)) % 4], "Color" if i % 2 else "Vector")
        outputs = [s for s in tested.outputs if s.enabled]
        tree.links.new(outputs[output[0] if output else 0], shown.inputs[0])
        of_values(column, made, rng)
    assert not sync_messages()
    for column, (conic, cycles) in enumerate(zip(*pictures(len(cases), folder), strict=True)):
        # Whole faces, away from the lines between them.
        ours, theirs = (p[::2, ::2].reshape(-1, 4)[[0, 2, 6, 8]] for p in (conic, cycles))
        np.testing.assert_allclose(ours, theirs, rtol=2e-3, atol=2e-3, err_msg=str(cases[column]))


def sync_messages():
    add_camera()
    return sync().messages


def known(kind, name, values):
    """Those of the values that this Blender's node has."""
    items = getattr(bpy.types, f"ShaderNode{kind}").bl_rna.properties[name].enum_items.keys()
    return [value for value in values if value in items]


def test_math(tmp_path, rng):
    cases = [("Math", {"operation": operation}) for operation in known("Math", "operation", MATH)]
    assert len(cases) == len(bpy.types.ShaderNodeMath.bl_rna.properties["operation"].enum_items)
    assert_node([*cases, ("Math", {"operation": "ADD", "use_clamp": True})], tmp_path, rng)


def test_vector_math(tmp_path, rng):
    operations = known("VectorMath", "operation", VECTOR_MATH)
    assert len(operations) >= 25
    if bpy.app.version < (4, 5, 0):
        for operation in ("REFLECT", "REFRACT"):  # NaN in Cycles where the normal is 0
            operations.remove(operation)
    assert_node([("VectorMath", {"operation": operation}) for operation in operations], tmp_path, rng)


def test_mix(tmp_path, rng):
    blends = known("Mix", "blend_type", BLENDS)
    cases = [("Mix", {"data_type": "RGBA", "blend_type": blend}) for blend in blends]
    cases += [("MixRGB", {"blend_type": blend, "use_clamp": blend == "ADD"}) for blend in ("ADD", "DIVIDE", "OVERLAY")]
    cases.append(("Mix", {"data_type": "RGBA", "blend_type": "ADD", "clamp_factor": False}))
    cases.append(("Mix", {"data_type": "RGBA", "blend_type": "SUBTRACT", "clamp_result": True}))
    cases += [("Mix", {"data_type": kind, "clamp_factor": clamp}) for kind in ("FLOAT", "VECTOR") for clamp in (0, 1)]
    cases.append(("Mix", {"data_type": "VECTOR", "factor_mode": "NON_UNIFORM"}))
    assert_node(cases, tmp_path, rng)


def test_ranges(tmp_path, rng):
    cases = [("Clamp", {"clamp_type": kind}) for kind in ("MINMAX", "RANGE")]
    for data_type in ("FLOAT", "FLOAT_VECTOR"):
        for kind in ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP"):
            for clamp in (False, True):
                cases.append(("MapRange", {"data_type": data_type, "interpolation_type": kind, "clamp": clamp}))
    assert_node(cases, tmp_path, rng)


def test_colors(tmp_path, rng):
    cases = [("SeparateColor", {"mode": mode}, i) for mode in ("RGB", "HSV", "HSL") for i in range(3)]
    cases += [("CombineColor", {"mode": mode}) for mode in ("RGB", "HSV", "HSL")]
    cases += [("SeparateXYZ", {}, i) for i in range(3)] + [("CombineXYZ", {})]
    cases += [(kind, {}) for kind in ("Invert", "Gamma", "BrightContrast", "HueSaturation", "RGBToBW")]
    assert_node(cases, tmp_path, rng)


def ramp(tree, to, interpolation="LINEAR", output=0):
    """A Color Ramp of three colors that feeds a socket; its factor."""
    made = node(tree, "ValToRGB", to, output)
    elements = made.color_ramp.elements
    made.color_ramp.interpolation = interpolation
    elements.new(0.4)
    for element, color in zip(
        elements, ((1.0, 0.1, 0.0, 0.2), (0.0, 0.8, 0.3, 1.0), (0.1, 0.2, 1.0, 0.6)), strict=True
    ):
        element.color = color
    return made.inputs["Fac"]


@pytest.mark.parametrize("interpolation", ("LINEAR", "CONSTANT", "EASE", "CARDINAL"))
@pytest.mark.parametrize("output", (0, 1))
def test_random_of_objects_through_a_ramp(interpolation, output, tmp_path):
    for i in range(8):
        made, tree, socket = emission()
        node(tree, "ObjectInfo", ramp(tree, socket, interpolation, output), output="Random")
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


def shared_mesh(made, colors):
    """Objects of these colors that share a mesh of one face, painted."""
    objects = [swatch(0, made)]
    objects += [link(objects[0].data, "other") for _ in colors[1:]]
    set_attribute(objects[0].data, "paint", "FLOAT_COLOR", "FACE", (0.5, 0.25, 1.0, 1.0))
    for obj, color in zip(objects, colors, strict=True):
        obj.color = color
    return objects


@pytest.mark.parametrize("differ", (False, True))
def test_geometry_and_instances_that_both_vary_are_reported_once(differ):
    made, tree, socket = emission()
    total = node(tree, "VectorMath", socket)
    attribute(tree, total.inputs[0], "paint")
    node(tree, "ObjectInfo", total.inputs[1], output="Color")
    shared_mesh(made, [(0.1, 0.2, 0.3, 1.0), (0.4 if differ else 0.1, 0.2, 0.3, 1.0)])
    messages = sync_messages()
    scene = sync().scene
    (instances,) = scene.instances
    ((_, part),) = instances.geometry.kinds()
    (values,) = part.attributes.values()
    expected = (0.5, 0.25, 1.0) if differ else (0.6, 0.45, 1.3)
    np.testing.assert_allclose(values[..., :3], np.broadcast_to(expected, (*values.shape[:2], 3)), rtol=1e-6)
    assert len(messages) == differ and all("of its geometry and of its instances" in text for _, text in messages)


@pytest.mark.parametrize("alpha", (1.0, 0.5))
@pytest.mark.parametrize("what", ("sphere", "mesh", "instances"))
def test_alpha_by_an_attribute_is_opaque_without_a_word_where_it_is_1(alpha, what, rng):
    """Also where a sphere beside it, of another material, lacks the attribute."""
    made, tree, output = material("clear")
    principled = node(tree, "BsdfPrincipled", output.inputs["Surface"])
    kind = "INSTANCER" if what == "instances" else "GEOMETRY"
    attribute(tree, principled.inputs["Alpha"], "opacity", "Fac", kind)
    plain, tree, output = material("plain")
    node(tree, "BsdfDiffuse", output.inputs["Surface"])
    for used in (made, plain):
        bpy.ops.mesh.primitive_uv_sphere_add()
        mesh = bpy.context.object.data
        mesh.shade_smooth()
        mesh.materials.append(used if what == "sphere" else plain)
        if used == made:
            painted = mesh
    if what == "mesh":
        painted = swatch(3, made).data
    if what == "instances":
        if bpy.app.version < (4, 5, 0):
            pytest.skip("instances can be read since Blender 4.5")
        obj, nodes = of_points(2, rng)
        painted = obj.data
        nodes.on(obj, instance_tree(obj, nodes, nodes.geometry, made))
    set_attribute(painted, "opacity", "FLOAT", "POINT", np.full(len(painted.vertices), alpha, np.float32))
    messages = [text for _, text in sync_messages()]
    assert not any(max(read.transmit) for read in sync().scene.materials)
    assert len(messages) == (alpha < 1.0) and all("'clear': its alpha varies" in text for text in messages)
