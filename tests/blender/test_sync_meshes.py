"""Meshes: evaluated, triangulated, with normals, uv and slots; instances; what cannot be rendered."""

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from addon.engine.errors import SceneError
from addon.engine.packing import pack
from addon.engine.primitives import invertible
from addon.sync.description import describe
from tests.blender.building import add_camera, image, link, material, mesh_of, node, quad, sync, triangles_of


def test_quad():
    add_camera()
    quad(location=(1.0, 2.0, 3.0), scale=(2.0, 1.0, 1.0))
    (instance,) = sync().scene.instances
    triangles = triangles_of(instance)
    assert len(triangles) == 2
    area = np.linalg.norm(np.cross(triangles.p1 - triangles.p0, triangles.p2 - triangles.p0), axis=1).sum() / 2.0
    assert area == pytest.approx(1.0)
    np.testing.assert_allclose(instance.matrices[0] @ (1, 1, 0, 1), (3.0, 3.0, 3.0, 1.0))
    assert instance.name == "quad"


def test_a_concave_polygon_is_triangulated_within_its_outline():
    add_camera()
    link(mesh_of([(0, 0, 0), (4, 0, 0), (4, 4, 0), (2, 1, 0), (0, 4, 0)], [(0, 1, 2, 3, 4)]))
    triangles = triangles_of(sync().scene.instances[0])
    signed = np.cross(triangles.p1 - triangles.p0, triangles.p2 - triangles.p0)[:, 2] / 2.0
    assert (signed > 0.0).all() and signed.sum() == pytest.approx(10.0)


def test_modifiers_are_applied():
    add_camera()
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.modifiers.new("more", "SUBSURF").render_levels = 2
    bpy.context.object.modifiers["more"].levels = 2
    assert sync().scene.primitive_counts() == {"triangle": 6 * 16 * 2}


@pytest.mark.parametrize("modifier", [None, "SUBSURF", "ARRAY", "DECIMATE"])
@pytest.mark.parametrize("strand_radius", [0.0, 0.1])
def test_in_edit_mode_a_mesh_is_what_it_is_after_it(modifier, strand_radius):
    add_camera()
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    cube.conic.strand_radius = strand_radius
    if modifier:
        cube.modifiers.new("more", modifier)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.transform.translate(value=(1.0, 0.0, 0.0))
    edited = sync()
    said = describe(cube, bpy.context.evaluated_depsgraph_get())
    bpy.ops.object.mode_set(mode="OBJECT")
    left = sync()
    counts = edited.scene.primitive_counts()
    assert counts == left.scene.primitive_counts() and counts["triangle"] >= 48
    assert not edited.messages and said == describe(cube, bpy.context.evaluated_depsgraph_get())
    for name in ("p0", "p1", "p2"):
        corners = [getattr(triangles_of(found.scene.instances[-1]), name) for found in (edited, left)]
        np.testing.assert_allclose(*corners, atol=1e-6)


def test_in_edit_mode_a_sphere_is_exact():
    add_camera()
    bpy.ops.mesh.primitive_uv_sphere_add(location=(3.0, 0.0, 0.0))
    bpy.ops.object.mode_set(mode="EDIT")
    assert sync().scene.primitive_counts() == {"sphere": 1}


def test_normals_of_smooth_and_flat_faces():
    add_camera()
    obj = link(
        mesh_of([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 1), (2, 1, 1)], [(0, 1, 2, 3), (1, 4, 5, 2)])
    )
    obj.data.polygons[0].use_smooth, obj.data.polygons[1].use_smooth = True, False
    triangles = triangles_of(sync().scene.instances[0])
    flat = triangles.p0[:, 2] + triangles.p1[:, 2] + triangles.p2[:, 2] > 0.5
    assert flat.sum() == 2
    for normals in (triangles.n0, triangles.n1, triangles.n2):
        np.testing.assert_allclose(normals[flat], [told(-np.sqrt(0.5), 0.0, np.sqrt(0.5))] * 2, atol=1e-6)
        np.testing.assert_allclose(normals[~flat], [(0.0, 0.0, 1.0)] * 2, atol=1e-6)


def told(*normal):
    """The normal of a flat face beside smooth ones as Cycles has it: that of the whole face, or each triangle's own."""
    return normal if bpy.app.version >= (5, 1, 0) else (0.0, 0.0, 0.0)


def test_a_bent_flat_face_beside_smooth_ones_has_one_normal():
    add_camera()
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 1), (2, 0, 0), (2, 1, 0)]
    obj = link(mesh_of(corners, [(0, 1, 2, 3), (1, 4, 5, 2)]))
    obj.data.polygons.foreach_set("use_smooth", [False, True])
    triangles = triangles_of(sync().scene.instances[0])
    bent = np.minimum(np.minimum(triangles.p0[:, 0], triangles.p1[:, 0]), triangles.p2[:, 0]) == 0.0
    assert bent.sum() == 2
    for normals in (triangles.n0, triangles.n1, triangles.n2):
        np.testing.assert_allclose(normals[bent], [told(*obj.data.polygons[0].normal)] * 2, atol=1e-6)


def test_smooth_normals_are_interpolated_over_an_edge():
    add_camera()
    obj = link(
        mesh_of([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (1, 0, 1), (1, 1, 1)], [(0, 1, 2, 3), (1, 4, 5, 2)])
    )
    obj.data.polygons.foreach_set("use_smooth", [True, True])
    triangles = triangles_of(sync().scene.instances[0])
    corners = np.concatenate([triangles.p0, triangles.p1, triangles.p2])
    normals = np.concatenate([triangles.n0, triangles.n1, triangles.n2])
    edge = (corners[:, 0] == 1.0) & (corners[:, 2] == 0.0)
    np.testing.assert_allclose(normals[edge], [(-np.sqrt(0.5), 0.0, np.sqrt(0.5))] * edge.sum(), atol=1e-5)


def test_all_flat_mesh_has_no_normals():
    add_camera()
    quad()
    assert not triangles_of(sync().scene.instances[0]).n0.any()


def textured(name, uv_map=None):
    """A material with an image by the active uv map, or one by name."""
    made, tree, output = material(name)
    picture = node(tree, "TexImage")
    picture.image = image(np.ones((2, 2, 4)))
    node(tree, "BsdfDiffuse", output.inputs["Surface"])
    tree.links.new(picture.outputs["Color"], tree.nodes["Diffuse BSDF"].inputs["Color"])
    if uv_map:
        node(tree, "UVMap", picture.inputs["Vector"]).uv_map = uv_map
    return made


def uv_by_position(triangles):
    """uv of each corner, for comparing with its position."""
    points = np.concatenate([triangles.p0, triangles.p1, triangles.p2])[:, :2]
    return points, np.concatenate([triangles.uv0, triangles.uv1, triangles.uv2])


def test_uv_of_the_active_render_map():
    add_camera()
    obj = quad()
    obj.data.uv_layers.new(name="other")
    obj.data.materials.append(textured("a"))
    points, uv = uv_by_position(triangles_of(sync().scene.instances[0]))
    np.testing.assert_allclose(uv, points)


def test_uv_of_a_named_map():
    add_camera()
    obj = quad()
    other = obj.data.uv_layers.new(name="other")
    other.uv.foreach_set("vector", np.full(8, 0.25, np.float32))
    obj.data.materials.append(textured("a", "other"))
    _, uv = uv_by_position(triangles_of(sync().scene.instances[0]))
    np.testing.assert_allclose(uv, 0.25)


def test_each_slot_takes_its_own_uv():
    add_camera()
    vertices = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0)]
    obj = link(mesh_of(vertices, [(0, 1, 2, 3), (1, 4, 5, 2)]))
    for name, value in (("first", 0.25), ("second", 0.75)):
        obj.data.uv_layers.new(name=name).uv.foreach_set("vector", np.full(16, value, np.float32))
        obj.data.materials.append(textured(name, name))
    obj.data.polygons[1].material_index = 1
    triangles = triangles_of(sync().scene.instances[0])
    np.testing.assert_allclose(triangles.uv0[triangles.material == 0], 0.25)
    np.testing.assert_allclose(triangles.uv2[triangles.material == 1], 0.75)


def test_slots_and_object_linked_materials():
    add_camera()
    obj = quad()
    red, green = (material(name)[0] for name in ("red", "green"))
    obj.data.materials.append(red)
    obj.data.materials.append(None)
    obj.data.polygons[0].material_index = 7
    twin = link(obj.data, "twin")
    twin.material_slots[0].link = "OBJECT"
    twin.material_slots[0].material = green
    first, second = sync().scene.instances
    assert first.geometry is second.geometry
    assert (triangles_of(first).material == 1).all(), "a slot past the end is the last one"
    assert len(first.materials) == 2 and first.materials[1] == second.materials[1]
    assert first.materials[0] != second.materials[0]


def test_deleted_material_is_grey():
    add_camera()
    obj = quad()
    made, _, _ = material()
    obj.data.materials.append(made)
    bpy.data.materials.remove(made)
    synced = sync()
    (instance,) = synced.scene.instances
    assert synced.scene.materials[instance.materials[0]].diffuse == (0.8, 0.8, 0.8)


def test_objects_that_share_a_mesh_share_its_geometry_unless_modified():
    add_camera()
    first = quad()
    for i in range(3):
        link(first.data, f"copy {i}", location=(i, 0, 0))
    link(first.data, "thick").modifiers.new("solid", "SOLIDIFY")
    scene = sync().scene
    assert sorted(len(instances) for instances in scene.instances) == [1, 4]
    assert len({id(instances.geometry) for instances in scene.instances}) == 2


def test_collection_instances_share_geometry_and_stand_where_they_are_put():
    add_camera()
    collection = bpy.data.collections.new("kept aside")
    collection.objects.link(bpy.data.objects.new("inner", quad().data))
    bpy.data.objects.remove(bpy.data.objects["quad"])
    for x in (1.0, 2.0):
        link(None, f"place {x}", location=(x, 0, 0), instance_type="COLLECTION", instance_collection=collection)
    (instances,) = sync().scene.instances
    assert sorted(instances.matrices[:, 0, 3]) == [1.0, 2.0]


@pytest.mark.parametrize("add", ("text", "metaball", "curve", "surface"))
def test_other_geometry_comes_as_triangles(add):
    add_camera()
    operators = {
        "text": bpy.ops.object.text_add,
        "metaball": bpy.ops.object.metaball_add,
        "curve": bpy.ops.curve.primitive_bezier_circle_add,
        "surface": bpy.ops.surface.primitive_nurbs_surface_sphere_add,
    }
    operators[add]()
    if add == "curve":
        bpy.context.object.data.bevel_depth = 0.1
    made, _, _ = material()
    bpy.context.object.data.materials.append(made)
    synced = sync()
    (instance,) = synced.scene.instances
    assert len(triangles_of(instance)) > 10
    assert instance.materials == (0,) and not synced.messages


@pytest.mark.parametrize("nan", [float("nan"), 1e30, -1e19])
def test_triangles_with_vertices_that_are_nowhere_are_dropped_and_named(nan):
    add_camera()
    vertices = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, nan, 0), (2, 1, 0)]
    link(mesh_of(vertices, [(0, 1, 2, 3), (1, 4, 5), (1, 5, 2)]), "broken")
    synced = sync()
    assert len(triangles_of(synced.scene.instances[0])) == 3
    assert len(synced.warnings("broken", "1 triangle", "is not rendered")) == 1 == len(synced.messages)


def test_a_mesh_of_nan_alone_leaves_the_rest_right():
    add_camera()
    link(mesh_of([(float("nan"),) * 3] * 3, [(0, 1, 2)]), "broken")
    quad()
    synced = sync()
    assert [instance.name for instance in synced.scene.instances] == ["quad"]
    assert synced.warnings("broken", "not finite")


@pytest.mark.parametrize("scale", ((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)))
def test_zero_scale_is_named_and_leaves_the_rest_right(scale):
    add_camera()
    quad("flat", scale=scale)
    bpy.ops.mesh.primitive_uv_sphere_add()
    bpy.context.object.scale = scale
    quad()
    synced = sync()
    assert [instance.name for instance in synced.scene.instances] == ["quad"]
    assert not len(synced.scene.shapes)
    assert synced.warnings("'flat'", "scaled to zero") and synced.warnings("'Sphere'", "scaled to zero")


def test_what_is_flattened_along_one_axis_is_drawn_flat():
    add_camera()
    bpy.ops.mesh.primitive_cube_add(rotation=(0.3, 0.4, 0.5))
    bpy.context.object.scale = (1.0, 0.0, 2.0)
    bpy.ops.mesh.primitive_uv_sphere_add()
    bpy.context.object.scale = (1.0, 1.0, 0.0)
    bpy.context.object.rotation_euler = (0.3, 0.4, 0.5)
    synced = sync()
    assert not synced.messages
    by_kind = {part.kind: i for i in synced.scene.instances for _, part in i.geometry.kinds()}
    assert set(by_kind) == {"triangle", "sphere"}
    for instances, sizes in ((by_kind["triangle"], (2.0, 1.0)), (by_kind["sphere"], (1.0, 1.0))):
        assert invertible(instances.matrices).all()
        scales = np.linalg.svd(instances.matrices[0, :3, :3])[1]
        np.testing.assert_allclose(scales[:2], sizes, rtol=1e-4)
        assert scales[2] < 1e-3
    pack(synced.scene, 1 << 12)


def test_a_matrix_that_is_not_finite_is_named_as_such():
    add_camera()
    value = np.nan  # of infinity Blender makes its largest number
    quad("lost", location=(value, 0.0, 0.0))
    bpy.ops.mesh.primitive_uv_sphere_add()
    bpy.context.object.location.z = value
    quad("endless", location=(0.0, value, 0.0)).conic.primitive = "PLANE"
    quad()
    synced = sync()
    assert [instance.name for instance in synced.scene.instances] == ["quad"] and not synced.scene.planes
    assert not len(synced.scene.shapes)
    for name in ("lost", "Sphere", "endless"):
        assert synced.warnings(f"{name!r}", "not finite") and not synced.warnings(f"{name!r}", "zero")


@pytest.mark.parametrize("flattened", (1e-3, 1e-5, 1e-6, 3e-7, 1e-8))
def test_what_passes_sync_the_engine_takes(flattened):
    """A nearly flat object is drawn, or left out and named; the rest of the picture is never lost with it."""
    add_camera()
    quad("thin", scale=(1.0, 1.0, flattened), rotation_euler=(0.3, 0.4, 0.5))
    sheared = quad("sheared")
    sheared.matrix_world = Matrix(((1, 1, 0, 0), (1, 1 + flattened, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)))
    bpy.ops.mesh.primitive_uv_sphere_add()
    egg = bpy.context.object  # an exact shape with a stretched space of its own
    egg.name = "egg"
    egg.data.transform(Euler((0.4, 0.6, 0.2)).to_matrix().to_4x4() @ Matrix.Diagonal((1.0, 1.0, 2.0, 1.0)))
    egg.scale.z = flattened
    quad()
    synced = sync()
    assert "egg" in {i.name for i in synced.scene.instances if "sphere" in {p.kind for _, p in i.geometry.kinds()}} or (
        synced.warnings("'egg'")
    )
    pack(synced.scene, 1 << 12)
    drawn = {instance.name for instance in synced.scene.instances}
    for name in ("thin", "sheared", "egg"):
        assert (name in drawn) != bool(synced.warnings(f"{name!r}", "scaled to zero"))
    assert "quad" in drawn


def test_empty_scene_and_empty_meshes():
    add_camera()
    link(bpy.data.meshes.new("nothing"))
    link(mesh_of([(0, 0, 0), (1, 0, 0)], []), "points")
    synced = sync()
    assert synced.scene.primitive_counts() == {} and not synced.messages


def test_no_camera():
    quad()
    with pytest.raises(SceneError, match="has no camera; add one"):
        sync()


@pytest.mark.parametrize("data", (None, "light"))
def test_a_camera_that_is_none_is_named(data):
    obj = link(data and bpy.data.lights.new("lamp", "SUN"), "lookout")
    bpy.context.scene.camera = obj
    with pytest.raises(SceneError, match=rf"'lookout' \({data or 'empty'}\) is set as its camera, but is not a camera"):
        sync()


def test_hidden_objects_are_left_out():
    add_camera()
    quad(hide_viewport=True)
    assert not sync().scene.instances


def test_point_cloud_is_spheres():
    add_camera()
    tree = bpy.data.node_groups.new("points", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    points, output = tree.nodes.new("GeometryNodePoints"), tree.nodes.new("NodeGroupOutput")
    points.inputs["Count"].default_value = 5
    points.inputs["Radius"].default_value = 0.25
    points.inputs["Position"].default_value = (1.0, 2.0, 3.0)
    tree.links.new(points.outputs[0], output.inputs[0])
    obj = link(bpy.data.meshes.new("carrier"))
    obj.modifiers.new("nodes", "NODES").node_group = tree
    scene = sync().scene
    assert scene.primitive_counts() == {"sphere": 5}
    ((_, spheres),) = scene.instances[0].geometry.kinds()
    np.testing.assert_allclose(spheres.center, [(1.0, 2.0, 3.0)] * 5)
    np.testing.assert_allclose(spheres.radius, 0.25)


def test_unknown_geometry_is_named():
    add_camera()
    link(bpy.data.volumes.new("smoke"), "cloud")
    assert len(sync().warnings("'cloud'", "volume")) == 1
