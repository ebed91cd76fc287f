"""What becomes of instances in the engine scene: exact shapes in the world, instances, their attributes and counts."""

import bpy
import numpy as np
import pytest

from addon.engine.expression import attribute_keys, expression
from addon.sync import dupli_iterator
from addon.sync.description import describe
from addon.sync.scene_sync import SyncStatistics, sync_scene
from tests.blender.building import (
    GeometryNodes,
    add_camera,
    link,
    material,
    mesh_of,
    node,
    quad,
    shapes_of,
    sync,
    triangles_of,
    with_nodes,
)

HAS_GEOMETRY_SETS = hasattr(bpy.types.Object, "evaluated_geometry")
needs_geometry_sets = pytest.mark.skipif(not HAS_GEOMETRY_SETS, reason="instance attributes cannot be read")
X = np.arange(5.0)


@pytest.fixture(autouse=True)
def camera():
    add_camera()


def glowing(attribute, kind="INSTANCER", mesh=None):
    """A material that glows in an attribute, in a slot of the mesh."""
    made, tree, output = material(f"by {attribute}")
    emission = node(tree, "Emission", output.inputs["Surface"])
    source = tree.nodes.new("ShaderNodeAttribute")
    source.attribute_name, source.attribute_type = attribute, kind
    tree.links.new(source.outputs["Color"], emission.inputs["Color"])
    if mesh is not None:
        mesh.materials.append(made)
    return made


def row(nodes, instance, scale=None, attribute=None):
    """Instances along X at 0 to 4, with sizes, and an attribute that is ten times their X."""
    line = nodes.add("MeshLine", Count=5, Offset=(1.0, 0.0, 0.0))
    made = nodes.add("InstanceOnPoints", Points=line, Instance=instance, **({"Scale": scale} if scale else {}))
    if attribute:
        times = nodes.tree.nodes.new("ShaderNodeMath")
        times.operation, times.inputs[1].default_value = "MULTIPLY", 10.0
        nodes.tree.links.new(nodes.add("InputIndex"), times.inputs[0])
        made = nodes.stored(made, attribute, times.outputs[0], "FLOAT", "INSTANCE")
    return made


def hidden_ball():
    """A sphere that shows by its instances only."""
    bpy.ops.mesh.primitive_uv_sphere_add()
    ball = bpy.context.object
    bpy.context.collection.objects.unlink(ball)
    return ball


def test_instances_of_a_recognised_mesh_are_primitives_of_the_world():
    nodes = GeometryNodes()
    nodes.output(row(nodes, nodes.object(hidden_ball()), scale=(0.5, 0.5, 0.5)))
    with_nodes(nodes, location=(0.0, 0.0, 3.0))
    scene = sync().scene
    sphere = shapes_of(scene)["sphere"]
    assert not scene.instances
    np.testing.assert_allclose(sphere.center[np.argsort(sphere.center[:, 0])], [(x, 0, 3) for x in X], atol=1e-5)
    np.testing.assert_allclose(sphere.radius, 0.5, rtol=1e-5)


def test_stretched_and_mirrored_instances_share_one_geometry():
    for scale in ((1.0, 2.0, 1.0), (-1.0, 1.0, 1.0)):
        nodes = GeometryNodes()
        nodes.output(row(nodes, nodes.object(bpy.data.objects.get("Sphere") or hidden_ball()), scale=scale))
        with_nodes(nodes)
    (instances,) = sync().scene.instances
    assert len(instances) == 10 and sorted(np.sign(np.linalg.det(instances.matrices[:, :3, :3]))) == [-1] * 5 + [1] * 5


def test_meshes_are_one_block_of_instances():
    nodes = GeometryNodes()
    nodes.output(row(nodes, nodes.add("MeshCube")))
    with_nodes(nodes)
    (instances,) = sync().scene.instances
    assert len(instances) == 5 and len(triangles_of(instances)) == 12
    np.testing.assert_allclose(np.sort(instances.matrices[:, 0, 3]), X, atol=1e-6)


@needs_geometry_sets
@pytest.mark.parametrize("exact", (True, False))
def test_attributes_of_instances(exact):
    """On each primitive where instances are flattened, on each instance otherwise."""
    ball = hidden_ball()
    ball.conic.primitive = "SPHERE" if exact else "MESH"
    glowing("heat", mesh=ball.data)
    nodes = GeometryNodes()
    nodes.output(row(nodes, nodes.object(ball), attribute="heat"))
    with_nodes(nodes)
    scene = sync().scene
    if exact:
        sphere = shapes_of(scene)["sphere"]
        x, values = sphere.center[:, 0], sphere.attributes["instancer:heat"][:, 0]
    else:
        (instances,) = scene.instances
        x, values = instances.matrices[:, 0, 3], instances.attributes["instancer:heat"]
    np.testing.assert_allclose(values, np.stack([10.0 * x] * 3 + [np.ones(5)], axis=1), atol=1e-4)


@needs_geometry_sets
def test_the_innermost_instances_give_the_value():
    ball = hidden_ball()
    glowing("heat", mesh=ball.data)
    nodes = GeometryNodes()
    inner = row(nodes, nodes.object(ball), attribute="heat")
    outer = nodes.stored(
        nodes.add("InstanceOnPoints", Points=nodes.add("MeshLine", Count=2, Offset=(0, 9, 0)), Instance=inner),
        *("heat", 7.0, "FLOAT", "INSTANCE"),
    )
    nodes.output(outer)
    with_nodes(nodes)
    sphere = shapes_of(sync().scene)["sphere"]
    assert len(sphere) == 10
    np.testing.assert_allclose(sphere.attributes["instancer:heat"][:, 0, 0], 10.0 * sphere.center[:, 0], atol=1e-4)


@needs_geometry_sets
def test_attributes_within_older_instancers_are_named():
    ball = hidden_ball()
    glowing("heat", mesh=ball.data)
    nodes = GeometryNodes()
    nodes.output(row(nodes, nodes.object(ball), attribute="heat"))
    host = with_nodes(nodes)
    collection = bpy.data.collections.new("group")
    collection.objects.link(host)
    bpy.context.collection.objects.unlink(host)
    link(None, "place", instance_type="COLLECTION", instance_collection=collection)
    synced = sync()
    assert synced.scene.primitive_counts() == {"sphere": 5}
    assert len(synced.warnings("'Sphere'", "'heat'", "'place'")) == 1 == len(synced.messages)


def test_an_instancer_without_the_attribute_gives_its_property():
    ball = hidden_ball()
    glowing("heat", mesh=ball.data)
    for name, value in (("hot", 3.0), ("cold", None)):
        nodes = GeometryNodes()
        nodes.output(row(nodes, nodes.object(ball)))
        host = with_nodes(nodes, name, location=(0.0, 0.0, 5.0 if value else 0.0))
        if value:
            host["heat"] = value
    sphere = shapes_of(sync().scene)["sphere"]
    values = sphere.attributes["instancer:heat"][:, 0, 0]
    assert set(values[sphere.center[:, 2] > 1.0]) == {3.0} and set(values[sphere.center[:, 2] < 1.0]) == {0.0}


def test_every_copy_has_its_own_random_number():
    ball = hidden_ball()
    ball.data.materials.append(by_random())
    nodes = GeometryNodes()
    nodes.output(row(nodes, nodes.object(ball)))
    with_nodes(nodes)
    expected = {
        round(float(i.matrix_world.translation.x)): (i.random_id & 0xFFFFFFFF) / 0xFFFFFFFF
        for i in bpy.context.evaluated_depsgraph_get().object_instances
        if i.is_instance
    }
    sphere = shapes_of(sync().scene)["sphere"]
    ((_, values),) = sphere.attributes.items()
    found = {round(float(x)): float(value) for x, value in zip(sphere.center[:, 0], values[:, 0, 0], strict=True)}
    assert len(expected) == 5 and found == pytest.approx(expected, abs=1e-6)


def by_random():
    made, tree, output = material("by random")
    emission = node(tree, "Emission", output.inputs["Surface"])
    tree.links.new(tree.nodes.new("ShaderNodeObjectInfo").outputs["Random"], emission.inputs["Color"])
    return made


def test_nested_geometry_has_the_materials_of_its_data():
    """Empty slots count; what is linked to the object goes before."""
    glow, paint = glowing("x", "GEOMETRY"), material("paint")[0]
    nodes = GeometryNodes()
    cube = nodes.add("MeshCube")
    painted = nodes.add("SetMaterial", Geometry=cube, Material=glow)
    nodes.output(row(nodes, painted))
    host = with_nodes(nodes)
    scene = sync().scene
    (instances,) = scene.instances
    ((_, triangles),) = instances.geometry.kinds()
    shown = {instances.materials[slot] for slot in triangles.material}
    assert len(instances.materials) == 2, "Blender's cube brings an empty slot along"
    assert [attribute_keys([scene.materials[number].glow]) for number in shown] == [{"geometry:x"}]
    for _ in range(2):
        host.data.materials.append(None)
    host.material_slots[1].link, host.material_slots[1].material = "OBJECT", paint
    scene = sync().scene
    assert not attribute_keys([expression(scene.materials[scene.instances[0].materials[1]].glow)])


def test_what_cannot_be_placed_is_reported_once_with_its_number():
    nodes = GeometryNodes()
    index = nodes.add("InputIndex")
    thin = nodes.tree.nodes.new("ShaderNodeCombineXYZ")
    nodes.tree.links.new(index, thin.inputs[0])  # the first is scaled to nothing
    thin.inputs[1].default_value, thin.inputs[2].default_value = 0.0, 1.0
    nodes.output(row(nodes, nodes.add("MeshCube"), scale=thin.outputs[0]))
    with_nodes(nodes, "host")
    synced = sync()
    (instances,) = synced.scene.instances
    assert len(instances) == 4, "what is flattened along one axis is drawn"
    assert synced.warnings("'host'", "1 of 5 instances", "scaled to zero") == [text for _, text in synced.messages]


def test_a_shape_with_an_attribute_that_varies_stays_a_mesh():
    bpy.ops.mesh.primitive_uv_sphere_add()
    obj = bpy.context.object
    glowing("heat", "GEOMETRY", obj.data)
    values = np.full(len(obj.data.vertices), 0.25, np.float32)
    obj.data.attributes.new("heat", "FLOAT", "POINT").data.foreach_set("value", values)
    sphere = shapes_of(sync().scene)["sphere"]
    np.testing.assert_allclose(sphere.attributes["geometry:heat"], [[(0.25, 0.25, 0.25, 1.0)]])
    values[7] = 1.0
    obj.data.attributes["heat"].data.foreach_set("value", values)
    obj.data.update()
    triangles = triangles_of(sync().scene.instances[0])
    assert triangles.attributes["geometry:heat"].shape == (len(triangles), 3, 4)
    assert describe(obj, bpy.context.evaluated_depsgraph_get()) == (
        "MESH",
        "mesh: a material uses the attribute 'heat', which is not the same all over it",
    )
    obj.conic.primitive = "SPHERE"
    assert sync().warnings("'Sphere'", "'heat'", "exact shape")


@needs_geometry_sets
def test_instances_of_geometry_nodes_need_no_iterator(monkeypatch):
    """Nor do hosts of them that hold a mesh, text, curves, collections or instances themselves."""
    monkeypatch.setattr(dupli_iterator, "copies_by_iterator", None)
    collection = bpy.data.collections.new("collection")
    collection.objects.link(bpy.data.objects.new("in it", mesh_of([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])))
    inner = GeometryNodes("inner")
    inner.output(row(inner, inner.add("MeshCube")), inner.own)
    middle = with_nodes(inner, "middle")
    bpy.ops.object.text_add()
    nodes = GeometryNodes()
    nodes.output(
        row(nodes, nodes.object(middle)),
        row(nodes, nodes.object(bpy.context.object)),
        row(nodes, nodes.add("CollectionInfo", Collection=collection)),
        nodes.own,
    )
    with_nodes(nodes)
    assert sum(len(instances) for instances in sync().scene.instances) == 5 + 25 + 1 + 5 + 5


def realized_balls(shade_smooth=True):
    """Six balls and a cube in one mesh."""
    nodes = GeometryNodes()
    ball = nodes.add("SetShadeSmooth", Geometry=nodes.add("MeshIcoSphere", Subdivisions=3), Shade_Smooth=shade_smooth)
    nodes.output(nodes.add("RealizeInstances", Geometry=row(nodes, ball)), nodes.add("MeshCube"))
    return with_nodes(nodes)


@pytest.mark.parametrize("smooth", (True, False))
@pytest.mark.parametrize("setting", ("ALWAYS", "SMOOTH", "NEVER"))
def test_exact_shapes_within_a_mesh(setting, smooth):
    bpy.context.scene.conic.recognise = setting
    realized_balls(smooth)
    counts = sync().scene.primitive_counts()
    if setting == "ALWAYS" or (setting == "SMOOTH" and smooth):
        assert counts == {"sphere": 5, "triangle": 12}
    else:
        assert set(counts) == {"triangle"} and counts["triangle"] > 400


def test_a_mesh_that_is_chosen_has_no_shapes_within():
    realized_balls().conic.primitive = "MESH"
    assert set(sync().scene.primitive_counts()) == {"triangle"}


def test_statistics():
    bpy.ops.mesh.primitive_uv_sphere_add()
    quad()
    quad("another", location=(3, 0, 0))
    nodes = GeometryNodes()
    nodes.output(nodes.add("Points", Count=4), row(nodes, nodes.object(hidden_ball())))
    with_nodes(nodes)
    statistics = SyncStatistics()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    sync_scene(depsgraph, 64, 48, report=lambda *message: None, statistics=statistics)
    assert statistics.objects == {"sphere": 1, "mesh": 2, "point cloud": 1, "instances": 5}
    assert set(statistics.seconds) == {"collect", "read", "place"} and min(statistics.seconds.values()) >= 0.0


def described(obj):
    return describe(obj, bpy.context.evaluated_depsgraph_get())


@needs_geometry_sets
def test_descriptions_of_what_geometry_nodes_make():
    collection = bpy.data.collections.new("twigs")
    nodes = GeometryNodes()
    nodes.output(row(nodes, nodes.object(quad("leaf"))))
    host = with_nodes(nodes)
    assert described(host) == ("INSTANCES", "instances 5 copies of 'leaf'")
    nodes.output(row(nodes, nodes.add("CollectionInfo", Collection=collection)), nodes.add("Points", Count=1234))
    kind, reason = described(host)
    assert kind == "POINT_CLOUD" and reason.startswith("point cloud: 1,234 spheres; instances 5 copies of ")
    assert "5 of " in reason and "'leaf'" in reason and "'twigs'" in reason
    nodes.output(nodes.own)
    host.data.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    host.data.update()
    kind, reason = described(host)
    assert kind == "MESH" and "; point cloud: 1,234 spheres; instances " in reason


def test_descriptions_of_older_instancers():
    collection = bpy.data.collections.new("flock")
    empty = link(None, "place", instance_type="COLLECTION", instance_collection=collection)
    assert described(empty) == ("INSTANCES", "instances the collection 'flock'")
    host = quad("host", instance_type="VERTS")
    assert described(host)[1].endswith("; instances its children on 4 vertices")
    host.instance_type = "NONE"
    settings = host.modifiers.new("seeds", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.count, settings.render_type = "HAIR", 6, "OBJECT"
    settings.instance_object = quad("seed")
    assert described(host)[1].endswith("; instances 'seed' on 6 particles")


def test_strands_are_drawn_and_described():
    obj = link(bpy.data.meshes.new("wire"))
    obj.data.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 1), (1, 2)], [])
    assert described(obj) == ("MESH", "mesh: it has no faces") and not sync().scene.instances
    obj.conic.strand_radius = 0.1
    assert sync().scene.primitive_counts() == {"cylinder": 2, "sphere": 3}
    assert described(obj) == ("CURVES", "2 edges: 2 cylinders, 3 spheres")
    bpy.data.objects.remove(obj)
    bpy.ops.curve.primitive_bezier_circle_add()
    obj = bpy.context.object
    assert described(obj)[0] == "NONE" and "no surface" in described(obj)[1] and not sync().scene.instances
    obj.conic.strand_radius = 0.1
    counts = sync().scene.primitive_counts()
    assert counts["cylinder"] == counts["sphere"] > 8
    assert described(obj)[0] == "CURVES" and described(obj)[1].startswith("1 strand: ")
    obj.data.bevel_depth = 0.1
    assert set(sync().scene.primitive_counts()) == {"triangle"} and described(obj)[0] == "MESH"


def test_particle_hair_is_drawn_though_its_emitter_is_not():
    bpy.ops.mesh.primitive_uv_sphere_add()
    obj = bpy.context.object
    settings = obj.modifiers.new("hair", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.count = "HAIR", 20
    scene = sync().scene
    assert len(shapes_of(scene)["sphere"]) == 1 and scene.primitive_counts()["cone"] >= 20
    assert described(obj)[1].endswith("; hair of 'hair'")
    obj.show_instancer_for_viewport = False
    scene = sync().scene
    assert not len(scene.shapes) and scene.primitive_counts()["cone"] >= 20


def test_nearer_curves_are_finer():
    bpy.ops.curve.primitive_bezier_circle_add()
    bpy.context.object.conic.strand_radius = 0.01
    counts = []
    for distance in (3.0, 300.0):
        bpy.context.scene.camera.location.z = distance
        counts.append(sync().scene.primitive_counts()["cylinder"])
    assert counts[0] > 4 * counts[1]
    link(bpy.context.object.data, "near", location=(0.0, 0.0, 297.0)).conic.strand_radius = 0.01
    assert sync().scene.primitive_counts()["cylinder"] == sum(counts)
