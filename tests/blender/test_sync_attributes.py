"""Attributes of Blender's data, objects and instances as arrays, and the nodes that read them."""

import bpy
import numpy as np
import pytest

from addon.engine.expression import Expression, attribute_keys, is_constant
from addon.sync import attributes
from addon.sync.images import Images
from addon.sync.reports import Reports
from addon.sync.shading import Shadings, material_places
from examples.every_geometry import NodeTree
from tests.blender.building import add_camera, image, link, material, mesh_of, node, quad, sync

RNG = np.random.default_rng(31)
#: A quad and a triangle: 5 points, 6 edges, 7 corners, 2 faces.
POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0)]
FACES = [(0, 1, 2, 3), (1, 4, 2)]
CORNERS = np.array([(0, 1, 2), (0, 2, 3), (4, 5, 6)])
OF_FACE = np.array([0, 0, 1])
SIZES = {"POINT": 5, "EDGE": 6, "FACE": 2, "CORNER": 7}


def with_attribute(data, name, values, data_type="FLOAT_COLOR", domain="POINT"):
    """Give data an attribute of values (n, width)."""
    member = {"FLOAT_COLOR": "color", "BYTE_COLOR": "color", "FLOAT2": "vector", "FLOAT_VECTOR": "vector"}
    made = data.attributes.new(name, data_type, domain)
    made.data.foreach_set(member.get(data_type, "value"), np.ravel(values))


@pytest.mark.parametrize("domain", SIZES)
def test_triangles_take_each_domain(domain):
    mesh = mesh_of(POINTS, FACES)
    colors = RNG.random((SIZES[domain], 4), np.float32)
    with_attribute(mesh, "paint", colors, domain=domain)
    read = attributes.of_triangles(mesh, ("geometry:paint", "geometry:nothing"), CORNERS, OF_FACE)
    if domain == "EDGE":
        assert not read
        return
    vertices = np.array([vertex for face in FACES for vertex in face])
    expected = {"POINT": colors[vertices[CORNERS] % len(colors)], "FACE": colors[OF_FACE % len(colors)][:, None]}
    expected["CORNER"] = colors[CORNERS % len(colors)]
    assert list(read) == ["geometry:paint"]
    np.testing.assert_array_equal(read["geometry:paint"], expected[domain])


def test_a_million_values_of_every_type_need_no_loop():
    """The values of one row come out whatever the number of rows: read at once, no conversion a row."""
    mesh = bpy.data.meshes.new("many")
    mesh.vertices.add(1000)
    for data_type, width in {"FLOAT": 1, "INT": 1, "BOOLEAN": 1, "FLOAT2": 2, "FLOAT_VECTOR": 3}.items():
        values = RNG.integers(0, 2, (1000, width)).astype({"INT": np.int32, "BOOLEAN": bool}.get(data_type, np.float32))
        with_attribute(mesh, data_type, values, data_type)
        read, domain = attributes.read_attribute(mesh, data_type)
        assert domain == "POINT" and read.dtype == np.float32 and read.shape == (1000, 4)
        shown = np.repeat(values, 3, axis=1) if width == 1 else np.pad(values, ((0, 0), (0, 3 - width)))
        np.testing.assert_array_equal(read[:, :3], shown)
        np.testing.assert_array_equal(read[:, 3], 1.0)


def test_bytes_become_linear():
    mesh = mesh_of(POINTS, FACES)
    with_attribute(mesh, "paint", np.tile((0.5, 0.25, 1.0, 0.5), (7, 1)), "BYTE_COLOR", "CORNER")
    encoded = np.array([d.color_srgb[:] for d in mesh.attributes["paint"].data])
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    read, _ = attributes.read_attribute(mesh, "paint")
    np.testing.assert_allclose(read[:, :3], linear[:, :3], rtol=1e-4)
    np.testing.assert_allclose(read[:, 3], encoded[:, 3])


@pytest.mark.parametrize("data_type", ("STRING", "FLOAT4X4", "INT32_2D"))
def test_types_that_cannot_be_a_color_are_not_there(data_type):
    mesh = mesh_of(POINTS, FACES)
    mesh.attributes.new("odd", data_type, "POINT")
    assert attributes.read_attribute(mesh, "odd") is None


def test_values_that_are_not_finite_are_black():
    mesh = mesh_of(POINTS, FACES)
    with_attribute(mesh, "odd", np.array([np.nan, np.inf, -np.inf, 1.0, 2.0], np.float32), "FLOAT")
    np.testing.assert_array_equal(attributes.read_attribute(mesh, "odd")[0][:, 0], (0.0, 0.0, 0.0, 1.0, 2.0))


def test_without_a_name_the_color_attribute_that_is_active_for_rendering():
    mesh = mesh_of(POINTS, FACES)
    assert attributes.read_attribute(mesh, "") is None
    for name, level in (("first", 0.25), ("second", 0.75)):
        mesh.color_attributes.new(name, "FLOAT_COLOR", "POINT").data.foreach_set("color", np.full(20, level))
    mesh.color_attributes.render_color_index = 1
    assert attributes.read_attribute(mesh, "")[0][0, 0] == 0.75


def test_exact_shapes_take_what_does_not_vary():
    mesh = mesh_of(POINTS, FACES)
    with_attribute(mesh, "even", np.tile((0.1, 0.2, 0.3, 1.0), (7, 1)), domain="CORNER")
    with_attribute(mesh, "uneven", RNG.random((5, 4)))
    read = attributes.of_mesh(mesh, ("geometry:even", "geometry:uneven", "geometry:nothing"))
    assert read["geometry:even"] == pytest.approx((0.1, 0.2, 0.3, 1.0)) and read["geometry:uneven"] is None
    assert len(read) == 2


def test_curves_give_points_and_curves():
    curves = bpy.data.hair_curves.new("hair")
    curves.add_curves([2, 3])
    with_attribute(curves, "along", np.arange(5, dtype=np.float32), "FLOAT", "POINT")
    with_attribute(curves, "each", np.array((0.5, 0.25), np.float32), "FLOAT", "CURVE")
    read = attributes.of_curves(curves, ("geometry:along", "geometry:each", "random:"))
    assert [domain for _, domain in read.values()] == ["POINT", "CURVE", "CURVE"]
    assert read["geometry:along"][0][:, 1].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert read["geometry:each"][0][:, 1].tolist() == [0.5, 0.25] and read["random:"][0].shape == (2, 4)


def instances_of(obj, name, inner):
    """Give a mesh object geometry nodes that put the object `inner` on each of its points."""
    tree = NodeTree(name)
    what = tree.node("ObjectInfo", {"Object": inner, "As Instance": True})
    made = tree.node("InstanceOnPoints", {"Points": tree.geometry, "Instance": what.outputs["Geometry"]})
    return tree.on(obj, made.outputs[0])


def test_random_ids_are_blenders():
    """Of objects on the points of one in a collection that stands in the scene: three levels."""
    inner = link(mesh_of(POINTS, FACES), "kernel")
    maker = instances_of(link(mesh_of(POINTS, FACES), "Gerüst"), "on points", inner)
    collection = bpy.data.collections.new("kept aside")
    collection.objects.link(maker)
    bpy.context.scene.collection.objects.unlink(maker)
    link(None, "place", instance_type="COLLECTION", instance_collection=collection)
    checked = []
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        if instance.is_instance:
            levels = [number for number in instance.persistent_id if number != 0x7FFFFFFF]
            made = attributes.instance_random_ids(instance.object.name, instance.parent.name, [levels])
            assert made[0] == instance.random_id & 0xFFFFFFFF, (instance.object.name, levels)
            checked.append(len(levels))
    assert max(checked) == 3 and len(checked) >= 5


def test_what_object_info_gives():
    obj = link(None, "thing", pass_index=7, color=(0.1, 0.2, 0.3, 0.4))
    matrices = np.tile(np.eye(4), (3, 1, 1))
    matrices[:, 0, 3] = (1.0, 2.0, 3.0)
    keys = [f"object:{name}" for name in ("color", "alpha", "index", "location", "random")]
    read = attributes.of_object(obj, keys, matrices, np.array((0, 1 << 31, 0xFFFFFFFF), np.uint32))
    assert read["object:color"] == pytest.approx((0.1, 0.2, 0.3, 0.4))
    assert read["object:alpha"][:3] == pytest.approx((0.4,) * 3) and read["object:index"][:3].tolist() == [7.0] * 3
    np.testing.assert_array_equal(read["object:location"][:, :3], matrices[:, :3, 3])
    np.testing.assert_allclose(read["object:random"][:, 1], (0.0, 0.5, 1.0))


def test_properties():
    data = bpy.data.meshes.new("data")
    obj = link(data, "thing", location=(1.0, 2.0, 3.0))
    instancer = link(None, "maker")
    obj["number"], obj["vector"], obj["text"], obj["flag"] = 3, (0.1, 0.2, 0.3), "seven", True
    data["of_data"], instancer["number"] = 0.5, 8.0
    names = ("number", "vector", "text", "flag", "of_data", "location", "nothing", "data.name")
    keys = [f"property:{name}" for name in names]
    read = attributes.of_object(obj, [*keys, "property.fac:vector"], np.eye(4), None, instancer)
    assert {key.partition(":")[2] for key in read} == {"number", "vector", "flag", "of_data", "location"}
    assert read["property:number"].tolist() == [3.0, 3.0, 3.0, 1.0]
    assert read["property:vector"] == pytest.approx((0.1, 0.2, 0.3, 1.0))
    assert read["property.fac:vector"] == pytest.approx((0.2, 0.2, 0.2, 1.0))
    assert read["property:location"].tolist() == [1.0, 2.0, 3.0, 1.0]
    assert attributes.of_object(obj, ["instancer:number"], np.eye(4), None, instancer)["instancer:number"][0] == 8.0
    assert attributes.of_object(obj, ["instancer:number"], np.eye(4))["instancer:number"][0] == 3.0


@pytest.mark.skipif(bpy.app.version < (4, 5, 0), reason="instances can be read as a point cloud since Blender 4.5")
def test_instances_of_geometry_nodes():
    obj = link(mesh_of(POINTS, FACES), "maker")
    with_attribute(obj.data, "paint", np.arange(10, dtype=np.float32), "FLOAT2")
    tree = NodeTree("instances")
    ball = tree.node("MeshUVSphere")
    made = tree.node("InstanceOnPoints", {"Points": tree.geometry, "Instance": ball.outputs[0]})
    tree.on(obj, made.outputs[0])
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    geometry = evaluated.evaluated_geometry()
    cloud = geometry.instances_pointcloud()
    read = attributes.of_instances(cloud, ("instancer:paint", "instancer.fac:paint", "geometry:paint"))
    np.testing.assert_array_equal(read["instancer:paint"][:, :3], [(2 * i, 2 * i + 1, 0) for i in range(5)])
    # As Blender, which reads colors there, not as of a geometry, whose fac would be the first of the pair.
    np.testing.assert_allclose(read["instancer.fac:paint"][:, 1], [(4 * i + 1) / 3 for i in range(5)], rtol=1e-6)
    assert len(read) == 2


def shading(build, layers=()):
    """(engine Material, Shading, messages) of a material whose tree `build(tree, output)` makes."""
    made, tree, output = material("stuff")
    build(tree, output)
    places, messages = material_places(), []
    reports = Reports(lambda level, text: messages.append(text))
    read = Shadings(Images(), reports, layers, places=places).of(made)
    return places.things[read.index], read, messages


def constant(value):
    """A colour of a material that is the same everywhere."""
    assert is_constant(value)
    return tuple(np.broadcast_to(value.value, 3).tolist())


def of_output(tree, output, kind, name="Color", **settings):
    """An Emission of an output of a node."""
    emission = node(tree, "Emission", output.inputs["Surface"])
    made = node(tree, kind, emission.inputs["Color"], output=name)
    for key, value in settings.items():
        setattr(made, key, value)
    return made


@pytest.mark.parametrize(
    ("kind", "name", "settings", "key"),
    [
        ("Attribute", "Color", {"attribute_name": "paint"}, "geometry:paint"),
        ("Attribute", "Vector", {"attribute_name": "paint"}, "geometry:paint"),
        ("Attribute", 2, {"attribute_name": "paint"}, "geometry.fac:paint"),
        ("Attribute", "Alpha", {"attribute_name": "paint"}, "geometry.alpha:paint"),
        ("Attribute", "Color", {"attribute_name": "a:b.c", "attribute_type": "OBJECT"}, "property:a:b.c"),
        ("Attribute", "Color", {"attribute_name": "paint", "attribute_type": "INSTANCER"}, "instancer:paint"),
        ("VertexColor", "Color", {"layer_name": "paint"}, "geometry:paint"),
        ("VertexColor", "Alpha", {}, "geometry.alpha:"),
        ("ObjectInfo", "Color", {}, "object:color"),
        ("ObjectInfo", "Alpha", {}, "object:alpha"),
        ("ObjectInfo", "Object Index", {}, "object:index"),
        ("ObjectInfo", "Random", {}, "object:random"),
        ("ObjectInfo", "Location", {}, "object:location"),
        ("PointInfo", "Random", {}, "random:"),
        ("HairInfo", "Random", {}, "random:"),
    ],
)
def test_nodes_that_read_attributes(kind, name, settings, key):
    read, made, messages = shading(lambda tree, output: of_output(tree, output, kind, name, **settings))
    assert attribute_keys((read.glow,)) == {key} and made.attributes == (key,)
    unknown = key.startswith("instancer") and bpy.app.version < (4, 5, 0)
    assert len(messages) == unknown and all("from Blender 4.5 on" in message for message in messages)
    assert not isinstance(read.diffuse, Expression) or is_constant(read.diffuse)
    assert attributes.key_of(*attributes.parts_of(key)) == key


def test_material_index_and_properties_of_the_view_layer_are_constants():
    def index(tree, output):
        bpy.data.materials["stuff"].pass_index = 5
        of_output(tree, output, "ObjectInfo", "Material Index")

    def of_layer(tree, output):
        of_output(tree, output, "Attribute", attribute_type="VIEW_LAYER", attribute_name="tint")

    bpy.context.scene["tint"] = (0.1, 0.2, 0.3)
    layers = bpy.context.view_layer, bpy.context.scene
    assert constant(shading(index)[0].glow) == (5.0, 5.0, 5.0)
    read, made, messages = shading(of_layer, layers)
    assert constant(read.glow) == pytest.approx((0.1, 0.2, 0.3)) and made.attributes == () and not messages
    assert constant(shading(of_layer)[0].glow) == (0.0, 0.0, 0.0), "a property that is not there is 0"


def test_a_property_of_the_view_layer_that_is_not_there_in_a_scene_without_a_world():
    made, tree, output = material("stuff")
    of_output(tree, output, "Attribute", attribute_type="VIEW_LAYER", attribute_name="tint")
    mesh = mesh_of(POINTS, FACES)
    mesh.materials.append(made)
    link(mesh)
    add_camera()
    bpy.context.scene.world = None
    (read,) = sync().scene.materials
    assert constant(read.glow) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("exponent", [100.0, 1000.0])
def test_a_constant_beyond_float32_is_0(exponent):
    def huge(tree, output):
        power = node(tree, "Math", node(tree, "Emission", output.inputs["Surface"]).inputs["Color"])
        power.operation = "EXPONENT"
        power.inputs[0].default_value = exponent

    assert constant(shading(huge)[0].glow) == (0.0, 0.0, 0.0)


def mixed(tree, output, blend, factor=1.0):
    """A diffuse surface of a Mix of colors: its two color inputs."""
    made = node(tree, "Mix", node(tree, "BsdfDiffuse", output.inputs["Surface"]).inputs["Color"])
    made.data_type, made.blend_type = "RGBA", blend
    tree.links.new(next(s for s in made.outputs if s.enabled), tree.nodes["Diffuse BSDF"].inputs["Color"])
    amount, first, second = (socket for socket in made.inputs if socket.enabled)
    amount.default_value = factor
    return first, second


def paint(tree, to, name="paint"):
    node(tree, "Attribute", to, output="Color").attribute_name = name


@pytest.mark.parametrize("blend", ("MULTIPLY", "ADD", "MIX"))
def test_an_attribute_an_image_and_another_attribute_are_mixed(blend):
    def build(tree, output):
        first, second = mixed(tree, output, blend, 0.5)
        paint(tree, first)
        inner = node(tree, "MixRGB", second)
        paint(tree, inner.inputs[1], "other")
        node(tree, "TexImage", inner.inputs[2]).image = image(np.full((2, 2, 4), 0.5), float_buffer=True)

    read, made, messages = shading(build)
    assert attribute_keys((read.diffuse,)) == {"geometry:paint", "geometry:other"} == set(made.attributes)
    assert made.uv_map == "" and not messages


def test_attribute_through_groups_and_reroutes():
    def build(tree, output):
        group = bpy.data.node_groups.new("group", "ShaderNodeTree")
        group.interface.new_socket("Tint", in_out="OUTPUT", socket_type="NodeSocketColor")
        paint(group, group.nodes.new("NodeGroupOutput").inputs[0])
        used = node(tree, "Group")
        used.node_tree = group
        reroute = tree.nodes.new("NodeReroute")
        tree.links.new(used.outputs[0], reroute.inputs[0])
        principled = node(tree, "BsdfPrincipled", output.inputs["Surface"], Metallic=1.0, Roughness=0.0)
        tree.links.new(reroute.outputs[0], principled.inputs["Base Color"])

    _, made, messages = shading(build)
    assert made.attributes == ("geometry:paint",) and not messages


def test_attributes_as_numbers():
    def build(tree, output):
        principled = node(tree, "BsdfPrincipled", output.inputs["Surface"], Roughness=0.3)
        made = node(tree, "Attribute", principled.inputs["Roughness"], output=2)
        made.attribute_name = "paint"

    read, made, messages = shading(build)
    assert attribute_keys((read.roughness,)) == {"geometry.fac:paint"} == set(made.attributes) and not messages


def test_ambient_occlusion_leaves_the_color():
    """As materials of molecules have it: the color of the atoms, darker where they are crowded."""

    def build(tree, output):
        paint(tree, of_output(tree, output, "AmbientOcclusion").inputs["Color"])

    read, _, messages = shading(build)
    assert attribute_keys((read.glow,)) == {"geometry:paint"}
    assert len(messages) == 1 and "'Ambient Occlusion' is not rendered; its color without occlusion" in messages[0]


@pytest.mark.parametrize("shadow", (False, True))
@pytest.mark.parametrize("back", (False, True))
def test_backface_culling(back, shadow):
    def build(tree, output):
        node(tree, "BsdfDiffuse", output.inputs["Surface"])
        made = bpy.data.materials["stuff"]
        made.use_backface_culling, made.use_backface_culling_shadow = back, shadow

    read, _, _ = shading(build)
    assert (read.cull_back, read.cull_back_shadow) == (back, shadow)


def test_a_world_has_no_attributes():
    add_camera()
    quad()
    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    background = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
    node(world.node_tree, "ObjectInfo", background.inputs["Color"], output="Color")
    synced = sync()
    assert not attribute_keys((synced.scene.world.color,)) and not synced.messages


@pytest.mark.parametrize(
    ("kind", "output", "instead"),
    [
        ("Wireframe", "Fac", "0"),
        ("Bevel", "Normal", "its normal without bevel"),
        ("NewGeometry", "Pointiness", "the pointiness 0.5"),
        ("ParticleInfo", "Age", "0"),
        ("LightPath", "Glossy Depth", "the ray depth for Glossy Depth"),
    ],
)
def test_what_is_used_instead_is_named_once(kind, output, instead):
    def build(tree, out):
        made = of_output(tree, out, kind, output)
        tree.links.new(made.outputs[output], tree.nodes["Emission"].inputs["Strength"])

    _, _, messages = shading(build)
    assert len(messages) == 1 and "'stuff'" in messages[0] and messages[0].endswith(f"{instead} is used instead")


def test_parts_of_a_mesh_have_a_random_number_each():
    mesh = mesh_of([*POINTS, (9, 0, 0), (9, 1, 0), (8, 0, 0)], [*FACES, (5, 6, 7)])
    ((key, values, domain),) = attributes.of_elements(mesh, ("island:",))
    assert key == "island:" and domain == "POINT" and ((values >= 0.0) & (values <= 1.0)).all()
    assert len(np.unique(values[:5, 0])) == len(np.unique(values[5:, 0])) == 1 and values[0, 0] != values[5, 0]


def test_generated_coordinates_of_a_deformed_mesh_are_those_before():
    mesh = mesh_of(POINTS, FACES)
    obj = link(mesh, "bent")
    keys = ("generated:scale", "generated:offset")
    depsgraph = bpy.context.evaluated_depsgraph_get
    read = attributes.of_texture_space(obj.evaluated_get(depsgraph()).data, keys)
    low, high = (np.array(corner) * read[keys[0]][:3] + read[keys[1]][:3] for corner in ((0, 0, 0), (2, 1, 0)))
    np.testing.assert_allclose((low[:2], high[:2]), ((0, 0), (1, 1)), atol=1e-6)
    assert not list(attributes.of_elements(obj.evaluated_get(depsgraph()).data, keys))
