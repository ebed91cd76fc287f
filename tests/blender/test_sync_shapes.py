"""Objects as exact shapes: recognised, chosen, transformed, instanced, and described."""

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix, Vector

from addon.sync.description import describe
from tests.blender.building import add_camera, image, link, material, mesh_of, node, quad, shapes_of, sync

ADD = {
    "SPHERE": bpy.ops.mesh.primitive_uv_sphere_add,
    "CYLINDER": bpy.ops.mesh.primitive_cylinder_add,
    "CONE": bpy.ops.mesh.primitive_cone_add,
    "DISC": lambda: bpy.ops.mesh.primitive_circle_add(fill_type="NGON"),
}
TURNED = Matrix.Translation((1.0, -2.0, 3.0)) @ Euler((0.4, 1.1, -2.0)).to_matrix().to_4x4() @ Matrix.Scale(2.5, 4)


def add(kind, matrix=None, shape=None):
    ADD[kind]()
    obj = bpy.context.object
    if matrix is not None:
        obj.matrix_world = matrix
    if shape:
        obj.conic.primitive = shape
    return obj


def described(obj):
    return describe(obj, bpy.context.evaluated_depsgraph_get())


def test_sphere_in_world_space():
    add_camera()
    add("SPHERE", TURNED)
    scene = sync().scene
    assert scene.primitive_counts() == {"sphere": 1} and not scene.instances
    sphere = shapes_of(scene)["sphere"]
    np.testing.assert_allclose(sphere.center, [(1.0, -2.0, 3.0)], atol=1e-5)
    np.testing.assert_allclose(sphere.radius, [2.5], rtol=1e-5)
    np.testing.assert_allclose(sphere.pole[0], TURNED.to_3x3().normalized() @ Vector((0, 0, 1)), atol=1e-5)


def test_cylinder_and_cone_in_world_space():
    add_camera()
    add("CYLINDER", TURNED)
    add("CONE", TURNED)
    shapes = shapes_of(sync().scene)
    assert {kind: len(part) for kind, part in shapes.items()} == {"cylinder": 1, "cone": 1, "disc": 3}
    ends = sorted([tuple(TURNED @ Vector((0, 0, z))) for z in (-1, 1)])
    for kind in ("cylinder", "cone"):
        found = sorted([tuple(shapes[kind].base[0]), tuple(shapes[kind].apex[0])])
        np.testing.assert_allclose(found, ends, atol=1e-5)
    np.testing.assert_allclose(shapes["cylinder"].radius, 2.5, rtol=1e-5)
    np.testing.assert_allclose(shapes["disc"].radius, 2.5, rtol=1e-5)
    outward = np.einsum("ni,ni->n", shapes["disc"].normal, shapes["disc"].center - np.array((1.0, -2.0, 3.0)))
    assert (outward > 0.0).all()


def test_stretched_sphere_is_an_instance_of_a_sphere():
    add_camera()
    add("SPHERE", Matrix.Diagonal((1.0, 2.0, 3.0, 1.0)))
    scene = sync().scene
    (instance,) = scene.instances
    ((_, sphere),) = instance.geometry.kinds()
    assert sphere.kind == "sphere"
    poles = np.linalg.norm(instance.matrices[0, :3, :3] * sphere.radius[0], axis=0)
    np.testing.assert_allclose(sorted(poles), (1.0, 2.0, 3.0), rtol=1e-5)


def test_mirrored_sphere_keeps_its_place():
    add_camera()
    add("SPHERE", Matrix.Translation((1, 2, 3)) @ Matrix.Diagonal((-1.0, 1.0, 1.0, 1.0)))
    (instance,) = sync().scene.instances
    assert np.linalg.det(instance.matrices[0, :3, :3]) < 0.0
    np.testing.assert_allclose(instance.matrices[0, :3, 3], (1.0, 2.0, 3.0))


def test_many_copies_of_one_mesh():
    add_camera()
    mesh = add("SPHERE").data
    bpy.data.objects.remove(bpy.context.object)
    materials = [material(name)[0] for name in "ab"]
    mesh.materials.append(None)
    for i in range(60):
        obj = link(mesh, f"ball {i}", location=(i, 2 * i, -i), scale=((1 + i,) * 3))
        obj.material_slots[0].link = "OBJECT"
        obj.material_slots[0].material = materials[i % 2]
    scene = sync().scene
    sphere = shapes_of(scene)["sphere"]
    order = np.argsort(sphere.center[:, 0])
    i = np.arange(60)
    np.testing.assert_allclose(sphere.center[order], np.stack([i, 2 * i, -i], axis=1), atol=1e-4)
    np.testing.assert_allclose(sphere.radius[order], 1 + i, rtol=1e-5)
    assert len(set(sphere.material[order][::2])) == 1 == len(set(sphere.material[order][1::2]))
    assert sphere.material[order][0] != sphere.material[order][1]


def test_materials_of_a_recognised_cylinder_follow_its_slots():
    add_camera()
    obj = add("CYLINDER")
    for name in ("side", "caps"):
        obj.data.materials.append(material(name)[0])
    for face in obj.data.polygons:
        face.material_index = int(abs(face.normal.z) > 0.5)
    shapes = shapes_of(sync().scene)
    assert set(shapes["cylinder"].material) == {0} and set(shapes["disc"].material) == {1}


@pytest.mark.parametrize("kind", ADD)
def test_chosen_mesh_stays_a_mesh(kind):
    add_camera()
    obj = add(kind, shape="MESH")
    assert set(sync().scene.primitive_counts()) == {"triangle"}
    assert described(obj) == ("MESH", "mesh: chosen in the object's settings")


@pytest.mark.parametrize("kind", ADD)
def test_chosen_kind_of_a_recognised_mesh_is_what_is_recognised(kind):
    add_camera()
    obj = add(kind, TURNED, kind)
    counts = sync().scene.primitive_counts()
    obj.conic.primitive = "AUTO"
    assert counts == sync().scene.primitive_counts()


def test_chosen_sphere_fills_the_bounding_box():
    add_camera()
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    obj = bpy.context.object
    for vertex in obj.data.vertices:
        vertex.co = vertex.co * Vector((1, 2, 3)) + Vector((5, 0, 0))
    obj.conic.primitive = "SPHERE"
    (instance,) = sync().scene.instances
    np.testing.assert_allclose(instance.matrices[0, :3], [[1, 0, 0, 5], [0, 2, 0, 0], [0, 0, 3, 0]], atol=1e-6)
    assert described(obj)[0] == "SPHERE" and "bounding box" in described(obj)[1]


@pytest.mark.parametrize("kind", ("CYLINDER", "CONE"))
def test_chosen_cylinder_and_cone_stand_on_z(kind):
    add_camera()
    bpy.ops.mesh.primitive_cube_add(size=2.0, location=(1, 2, 3))
    bpy.context.object.conic.primitive = kind
    shapes = shapes_of(sync().scene)
    side = shapes[kind.lower()]
    np.testing.assert_allclose(side.base, [(1.0, 2.0, 2.0)])
    np.testing.assert_allclose(side.apex, [(1.0, 2.0, 4.0)])
    if kind == "CONE":
        assert (side.base_radius, side.apex_radius) == (1.0, 0.0)
    assert len(shapes["disc"]) == (2 if kind == "CYLINDER" else 1)


def test_chosen_disc_of_a_flat_mesh():
    add_camera()
    quad().conic.primitive = "DISC"
    disc = shapes_of(sync().scene)["disc"]
    np.testing.assert_allclose(disc.center, [(0.5, 0.5, 0.0)])
    np.testing.assert_allclose(disc.radius, [0.5])


def test_chosen_sphere_of_a_flat_mesh_is_named():
    add_camera()
    obj = quad()
    obj.conic.primitive = "SPHERE"
    synced = sync()
    assert synced.scene.primitive_counts() == {"triangle": 2}
    assert synced.warnings("'quad'", "sphere is chosen", "flat") and described(obj)[0] == "MESH"


def test_plane_without_end():
    add_camera()
    obj = quad()
    obj.matrix_world = TURNED
    obj.conic.primitive = "PLANE"
    scene = sync().scene
    (plane,) = scene.planes
    np.testing.assert_allclose(plane.point, [(1.0, -2.0, 3.0)])
    np.testing.assert_allclose(plane.normal[0], TURNED.to_3x3().normalized() @ Vector((0, 0, 1)), atol=1e-6)
    np.testing.assert_allclose(plane.meridian[0], TURNED.to_3x3().normalized() @ Vector((1, 0, 0)), atol=1e-6)
    np.testing.assert_allclose(plane.tile, 2.5, rtol=1e-6)
    assert described(obj)[0] == "PLANE"


def test_stretched_and_mirrored_plane_faces_along_its_z():
    add_camera()
    obj = quad()
    obj.matrix_world = Matrix.Diagonal((-2.0, 3.0, 1.0, 1.0))
    obj.conic.primitive = "PLANE"
    (plane,) = sync().scene.planes
    np.testing.assert_allclose(plane.normal, [(0.0, 0.0, 1.0)], atol=1e-6)


def test_scene_setting():
    add_camera()
    flat, smooth = add("SPHERE"), add("SPHERE")
    for obj, value in ((flat, False), (smooth, True)):
        obj.data.polygons.foreach_set("use_smooth", [value] * len(obj.data.polygons))
        obj.data.update()
    conic = bpy.context.scene.conic
    counts = {}
    for setting in ("ALWAYS", "SMOOTH", "NEVER"):
        conic.recognise = setting
        counts[setting] = sync().scene.primitive_counts().get("sphere", 0)
    assert counts == {"ALWAYS": 2, "SMOOTH": 1, "NEVER": 0}
    assert "switched off" in described(smooth)[1]
    smooth.conic.primitive = "SPHERE"
    assert sync().scene.primitive_counts()["sphere"] == 1


def textured_material():
    made, tree, output = material("checked")
    node(tree, "BsdfDiffuse", output.inputs["Surface"])
    picture = node(tree, "TexImage", tree.nodes["Diffuse BSDF"].inputs["Color"])
    picture.image = image(np.ones((2, 2, 4)))
    return made, tree, picture


def test_texture_by_blenders_own_uv_map_keeps_the_sphere_exact():
    add_camera()
    obj = add("SPHERE")
    obj.data.materials.append(textured_material()[0])
    assert sync().scene.primitive_counts() == {"sphere": 1} and described(obj)[0] == "SPHERE"


def test_texture_by_another_uv_map_keeps_the_mesh():
    add_camera()
    obj = add("SPHERE")
    made, tree, picture = textured_material()
    obj.data.materials.append(made)
    layer = obj.data.uv_layers[0]
    uv = np.empty(len(layer.uv) * 2, np.float32)
    layer.uv.foreach_get("vector", uv)
    layer.uv.foreach_set("vector", uv[::-1].copy() ** 2)
    assert set(sync().scene.primitive_counts()) == {"triangle"}
    assert described(obj)[0] == "MESH" and "'checked' uses the uv map" in described(obj)[1]
    tree.links.remove(picture.outputs["Color"].links[0])
    assert sync().scene.primitive_counts() == {"sphere": 1}


def test_texture_through_a_mapping_node_keeps_the_sphere_exact():
    """It is computed where a ray hits."""
    add_camera()
    obj = add("SPHERE")
    made, tree, picture = textured_material()
    obj.data.materials.append(made)
    mapping = node(tree, "Mapping", picture.inputs["Vector"], Scale=(2.0, 2.0, 1.0))
    node(tree, "TexCoord", mapping.inputs["Vector"], output="UV")
    assert described(obj)[0] == "SPHERE"
    assert sync().scene.primitive_counts() == {"sphere": 1}


def test_description_follows_an_edit():
    obj = add("SPHERE")
    assert described(obj)[0] == "SPHERE"
    obj.data.vertices[40].co *= 1.5
    obj.data.update()
    assert described(obj)[0] == "MESH"
    obj.data.vertices[40].co /= 1.5
    obj.data.update()
    assert described(obj)[0] == "SPHERE"


def test_description_of_what_is_no_mesh():
    assert described(add_camera())[0] == "NONE"
    bpy.ops.object.text_add()
    assert described(bpy.context.object) == ("MESH", "mesh: made from a text")
    bpy.context.object.conic.primitive = "PLANE"
    assert described(bpy.context.object)[0] == "PLANE"
    assert described(link(mesh_of([(0, 0, 0)], [])))[1] == "mesh: it has no faces"


@pytest.mark.parametrize("primitive", ("AUTO", "SPHERE", "PLANE"))
def test_a_curve_is_described_as_what_is_drawn_of_it(primitive):
    add_camera()
    bpy.ops.curve.primitive_bezier_curve_add()
    obj = bpy.context.object
    obj.conic.primitive = primitive
    assert described(obj)[0] == "NONE" and "has no surface" in described(obj)[1]
    assert sync().scene.primitive_counts() == {}
    obj.data.bevel_depth = 0.1
    assert described(obj)[0] == {"AUTO": "MESH"}.get(primitive, primitive)
    assert sync().scene.primitive_counts() or sync().scene.planes


def test_a_metaball_is_a_mesh():
    bpy.ops.object.metaball_add(type="BALL")
    assert described(bpy.context.object) == ("MESH", "mesh: made from a metaball")


@pytest.mark.parametrize("kind", ("SPHERE", "CYLINDER", "CONE", "DISC"))
def test_a_chosen_shape_without_faces_is_named(kind):
    add_camera()
    obj = link(mesh_of([(0, 0, 0), (1, 1, 1)], []), "points")
    obj.conic.primitive = kind
    synced = sync()
    assert synced.scene.primitive_counts() == {}
    assert len(synced.warnings("'points'", kind.lower(), "no faces to take its size from")) == 1
    assert described(obj)[0] == "NONE" and "no faces to take its size from" in described(obj)[1]


def test_a_plane_without_end_needs_no_faces():
    add_camera()
    obj = link(bpy.data.meshes.new("nothing"), "sea", location=(0.0, 0.0, -1.0))
    obj.conic.primitive = "PLANE"
    synced = sync()
    (plane,) = synced.scene.planes
    assert plane.point[0, 2] == -1.0 and not synced.messages and described(obj)[0] == "PLANE"


@pytest.mark.parametrize("size", (1e-4, 1.0, 1e4))
def test_a_plane_without_end_needs_no_height(size):
    add_camera()
    obj = quad("floor", scale=(size, 3.0 * size, 0.0), rotation_euler=(0.0, 0.5, 0.0))
    obj.conic.primitive = "PLANE"
    synced = sync()
    (plane,) = synced.scene.planes
    np.testing.assert_allclose(plane.normal, [(np.sin(0.5), 0.0, np.cos(0.5))], atol=1e-5)
    np.testing.assert_allclose(plane.tile, size, rtol=1e-5)
    assert not synced.messages
    obj.scale = (1.0, 0.0, 1.0)
    synced = sync()
    assert not synced.scene.planes and synced.warnings("'floor'", "scaled to zero")


def test_instances_by_geometry_nodes():
    add_camera()
    tree = bpy.data.node_groups.new("balls", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    points, place, output = (
        tree.nodes.new(name) for name in ("GeometryNodeMeshLine", "GeometryNodeInstanceOnPoints", "NodeGroupOutput")
    )
    points.inputs["Count"].default_value = 7
    points.inputs["Offset"].default_value = (0.0, 0.0, 3.0)
    ball = tree.nodes.new("GeometryNodeObjectInfo")
    ball.inputs["Object"].default_value = add("SPHERE")
    ball.inputs["As Instance"].default_value = True
    tree.links.new(points.outputs[0], place.inputs["Points"])
    tree.links.new(ball.outputs["Geometry"], place.inputs["Instance"])
    tree.links.new(place.outputs[0], output.inputs[0])
    link(bpy.data.meshes.new("carrier")).modifiers.new("nodes", "NODES").node_group = tree
    sphere = shapes_of(sync().scene)["sphere"]
    np.testing.assert_allclose(sorted(sphere.center[:, 2]), [0, 0, 3, 6, 9, 12, 15, 18], atol=1e-5)


def test_a_thousand_spheres_share_a_mesh():
    add_camera()
    mesh = add("SPHERE").data
    for i in range(1000):
        link(mesh, "ball", location=(i, 0, 0))
    assert sync().scene.primitive_counts() == {"sphere": 1001}
