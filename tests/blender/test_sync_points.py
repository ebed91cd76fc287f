"""Point clouds as spheres: places, radii, slots, attributes; points that are none."""

import bpy
import numpy as np
import pytest

from addon.sync.description import describe
from tests.blender.building import GeometryNodes, add_camera, link, material, mesh_of, node, sync, with_nodes

POINTS = np.array([(0.0, 0.0, 0.0), (1.0, 2.0, 3.0), (-4.0, 0.5, 2.0), (7.0, 7.0, 7.0)])


def cloud(points=POINTS, radius=None, slots=None, name="cloud", **attributes):
    """An object whose geometry nodes make a point cloud of its vertices; `attributes` (n,) floats by name."""
    mesh = mesh_of(points, [], name)
    nodes = GeometryNodes()
    made = nodes.add("MeshToPoints", Mesh=nodes.own)
    for key, values in {"radius": radius, "material_index": slots}.items():
        if values is not None:  # under another name until then: on meshes these mean something else
            kind = "FLOAT" if key == "radius" else "INT"
            mesh.attributes.new(f"my {key}", kind, "POINT").data.foreach_set("value", values)
            made = nodes.stored(made, key, nodes.named(f"my {key}", kind), kind)
    for key, values in attributes.items():
        mesh.attributes.new(key, "FLOAT", "POINT").data.foreach_set("value", values)
    nodes.output(made)
    return with_nodes(nodes, name, mesh)


def paint(obj, made):
    """Give the object a material of its own: what nodes make has not those of the mesh."""
    obj.data.materials.append(None)
    slot = obj.material_slots[-1]
    slot.link, slot.material = "OBJECT", made


def spheres_of(scene):
    (instances,) = scene.instances
    ((_, spheres),) = instances.geometry.kinds()
    return instances, spheres


def test_places_and_radii():
    add_camera()
    radius = (0.5, 0.25, 2.0, 1.0)
    cloud(radius=radius).location = (1.0, 2.0, 3.0)
    synced = sync()
    instances, spheres = spheres_of(synced.scene)
    np.testing.assert_allclose(spheres.center, POINTS)
    np.testing.assert_allclose(spheres.radius, radius)
    np.testing.assert_allclose(instances.matrices[0, :3, 3], (1.0, 2.0, 3.0))
    assert spheres.kind == "sphere" and not synced.messages


def test_points_that_are_no_spheres_are_counted_and_the_others_keep_their_order():
    add_camera()
    nan, inf = float("nan"), float("inf")
    points = [(i, nan if i == 3 else 0.0, inf if i == 4 else 0.0) for i in range(9)]
    cloud(points, (1.0, 0.0, 2.0, 1.0, 1.0, -1.0, nan, 3.0, inf))
    synced = sync()
    _, spheres = spheres_of(synced.scene)
    np.testing.assert_allclose(spheres.center[:, 0], (0, 2, 7))
    np.testing.assert_allclose(spheres.radius, (1.0, 2.0, 3.0))
    assert synced.warnings("'cloud'", "4 points", "not finite")
    assert synced.warnings("'cloud'", "2 points", "radius above 0")


def test_a_cloud_without_any_sphere_leaves_the_rest_right():
    add_camera()
    cloud(radius=(0.0, -1.0, float("nan"), 0.0), name="nothing")
    cloud(name="something")
    synced = sync()
    _, spheres = spheres_of(synced.scene)
    assert len(spheres) == 4
    assert synced.warnings("'nothing'", "1 point", "not finite") and synced.warnings("'nothing'", "3 points")


def test_each_point_has_its_slot():
    add_camera()
    obj = cloud(slots=(1, 0, 9, -3))
    for name in ("red", "green"):
        made, tree, output = material(name)
        node(tree, "Emission", output.inputs["Surface"], Color=(name == "red", name == "green", 0.0, 1.0))
        paint(obj, made)
    synced = sync()
    instances, spheres = spheres_of(synced.scene)
    glow = [synced.scene.materials[instances.materials[slot]].glow.value[:2] for slot in spheres.material]
    assert glow == [(0.0, 1.0), (1.0, 0.0), (0.0, 1.0), (1.0, 0.0)]


def test_attributes_of_points():
    add_camera()
    values = np.array([0.1, 0.5, 0.0, 2.0], np.float32)
    obj = cloud(radius=(1.0, 0.0, 1.0, 1.0), heat=values, cold=values)
    made, tree, output = material("hot")
    emission = node(tree, "Emission", output.inputs["Surface"])
    attribute = node(tree, "Attribute")
    attribute.attribute_name = "heat"
    tree.links.new(attribute.outputs["Color"], emission.inputs["Color"])
    paint(obj, made)
    _, spheres = spheres_of(sync().scene)
    assert list(spheres.attributes) == ["geometry:heat"], "only what the material wants"
    expected = np.stack([values[[0, 2, 3]]] * 3 + [np.ones(3)], axis=1)
    np.testing.assert_allclose(spheres.attributes["geometry:heat"][:, 0], expected, rtol=1e-6)


@pytest.mark.skipif("resize" not in bpy.types.PointCloud.bl_rna.functions, reason="nodes alone make them")
def test_point_cloud_objects_and_their_radius_by_default():
    add_camera()
    data = bpy.data.pointclouds.new("points")
    data.resize(len(POINTS))
    data.attributes["position"].data.foreach_set("vector", POINTS.astype(np.float32).ravel())
    obj = link(data, "points", scale=(1.0, 1.0, 3.0))
    instances, spheres = spheres_of(sync().scene)
    np.testing.assert_allclose(spheres.center, POINTS)
    np.testing.assert_allclose(spheres.radius, 0.01)
    np.testing.assert_allclose(instances.matrices[0], np.diag((1.0, 1.0, 3.0, 1.0)))
    assert describe(obj, bpy.context.evaluated_depsgraph_get()) == ("POINT_CLOUD", "point cloud: 4 spheres")


def test_a_cloud_is_read_once_for_all_its_copies():
    add_camera()
    inner = cloud()
    nodes = GeometryNodes()
    grid = nodes.add("MeshGrid", Vertices_X=5, Vertices_Y=2)
    nodes.output(nodes.add("InstanceOnPoints", Points=grid, Instance=nodes.object(inner)))
    with_nodes(nodes)
    scene = sync().scene
    assert len({id(instances.geometry) for instances in scene.instances}) == 1
    assert scene.primitive_counts() == {"sphere": 11 * len(POINTS)}
