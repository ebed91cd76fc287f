"""Add > Conic: the objects, and that their meshes stand for the exact shapes."""

import bpy
import numpy as np
import pytest
from mathutils import Euler, Vector

from addon.engine.primitives import Cones, Cylinders, Discs, Planes, Spheres

KINDS = ("sphere", "cylinder", "cone", "disc", "plane")
Z = (0.0, 0.0, 1.0)


def add(kind, **settings):
    """Add one, and give it back."""
    assert getattr(bpy.ops.conic, f"{kind}_add")(**settings) == {"FINISHED"}
    return bpy.context.object


def corners(mesh):
    """Position (c, 3), uv (c, 2), face (c,) and whether the face is smooth (c,) of each corner."""
    vertex = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", vertex)
    positions = np.array([v.co for v in mesh.vertices], np.float64)
    uv = np.empty(len(mesh.loops) * 2, np.float32)
    mesh.uv_layers.active.uv.foreach_get("vector", uv)
    face = np.repeat(np.arange(len(mesh.polygons)), [p.loop_total for p in mesh.polygons])
    smooth = np.array([p.use_smooth for p in mesh.polygons])
    return positions[vertex], uv.reshape(-1, 2).astype(np.float64), face, smooth[face]


def assert_side_uv(point, uv, face, expected):
    """u is an angle in turns that may pass 1 at the seam, and has no value of its own at a pole or tip."""
    np.testing.assert_allclose(uv[:, 1], expected[:, 1], atol=1e-6)
    around = np.hypot(point[:, 0], point[:, 1]) > 1e-6
    turns = uv[around, 0] - expected[around, 0]
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-6)
    for number in np.unique(face):
        u = uv[face == number, 0]
        assert np.ptp(u) == pytest.approx(1 / 32, abs=1e-6), "a face goes the long way round"


@pytest.mark.parametrize("kind", KINDS)
def test_added_object_is_the_shape_at_the_cursor(kind):
    bpy.context.scene.cursor.location = (1.0, 2.0, 3.0)
    added = add(kind)
    assert added.conic.primitive == kind.upper()
    assert added.name == added.data.name == kind.capitalize()
    assert tuple(added.location) == (1.0, 2.0, 3.0)
    assert added.select_get() and bpy.context.selected_objects == [added]
    assert not added.data.validate(verbose=True), "the mesh had to be repaired"


def test_place_and_rotation_can_be_given():
    added = add("cylinder", location=(4.0, 5.0, 6.0), rotation=(0.1, 0.2, 0.3))
    assert added.location == Vector((4.0, 5.0, 6.0))
    np.testing.assert_allclose(added.rotation_euler, Euler((0.1, 0.2, 0.3)), atol=1e-6)


def test_second_one_gets_a_name_of_its_own():
    assert [add("sphere").name, add("sphere").name] == ["Sphere", "Sphere.001"]


@pytest.mark.parametrize("kind", KINDS)
def test_adding_can_be_undone(kind):
    rna = getattr(bpy.ops.conic, f"{kind}_add").get_rna_type()
    registered = getattr(bpy.types, f"CONIC_OT_{kind}_add")
    assert registered.bl_options == {"REGISTER", "UNDO"}
    assert rna.description and all(p.description for p in rna.properties if p.identifier.startswith("radius"))


def test_sphere_mesh_lies_on_the_sphere_with_its_uv():
    point, uv, face, smooth = corners(add("sphere", radius=2.5).data)
    np.testing.assert_allclose(np.linalg.norm(point, axis=1), 2.5, rtol=1e-6)
    exact = Spheres(center=np.zeros((len(point), 3)), radius=2.5)
    assert_side_uv(point, uv, face, exact.reference_surface(point)[1])
    assert smooth.all()


@pytest.mark.parametrize("radii", [(1.0, 1.0), (1.0, 0.0), (0.0, 1.5), (2.0, 0.5)])
def test_cone_and_cylinder_meshes_lie_on_the_shape_with_its_uv(radii):
    same = radii[0] == radii[1]
    size = {"radius": radii[0]} if same else {"radius1": radii[0], "radius2": radii[1]}
    point, uv, face, smooth = corners(add("cylinder" if same else "cone", depth=3.0, **size).data)
    height = point[:, 2] / 3.0 + 0.5
    np.testing.assert_allclose(np.hypot(*point.T[:2]), radii[0] + (radii[1] - radii[0]) * height, atol=1e-6)
    ends = {"base": [(0.0, 0.0, -1.5)] * smooth.sum(), "apex": (0.0, 0.0, 1.5)}
    if same:
        exact = Cylinders(radius=radii[0], **ends)
    else:
        exact = Cones(base_radius=radii[0], apex_radius=radii[1], **ends)
    assert_side_uv(point[smooth], uv[smooth], face[smooth], exact.reference_surface(point[smooth])[1])
    for end, radius in ((-1.0, radii[0]), (1.0, radii[1])):
        on_cap = ~smooth & (point[:, 2] * end > 0.0)
        assert on_cap.sum() == (32 if radius else 0)
        if radius:
            cap = Discs(center=[(0.0, 0.0, 1.5 * end)] * 32, normal=(0.0, 0.0, end), radius=radius)
            np.testing.assert_allclose(uv[on_cap], cap.reference_surface(point[on_cap])[1], atol=1e-6)


def test_cone_without_a_radius_is_refused():
    with pytest.raises(RuntimeError, match="radius above 0"):
        bpy.ops.conic.cone_add(radius1=0.0, radius2=0.0)
    assert not bpy.data.objects


def test_disc_mesh_lies_on_the_disc_with_its_uv():
    point, uv, _, smooth = corners(add("disc", radius=0.5).data)
    np.testing.assert_allclose(np.linalg.norm(point, axis=1), 0.5, rtol=1e-6)
    exact = Discs(center=np.zeros((32, 3)), normal=Z, radius=0.5)
    np.testing.assert_allclose(uv, exact.reference_surface(point)[1], atol=1e-6)
    assert not smooth.any()


def test_plane_mesh_lies_in_the_plane_and_its_uv_goes_on_beyond_it():
    point, uv, _, _ = corners(add("plane", size=5.0).data)
    exact = Planes(point=np.zeros((4, 3)), normal=Z)
    np.testing.assert_allclose(uv, exact.reference_surface(point)[1], atol=1e-6)
    assert np.ptp(point, axis=0).tolist() == [5.0, 5.0, 0.0]


@pytest.mark.parametrize("kind, exact", [("sphere", 4 / 3 * np.pi), ("cylinder", 2 * np.pi), ("cone", 2 / 3 * np.pi)])
def test_bodies_are_closed_and_face_outwards(kind, exact):
    mesh = add(kind).data
    used = np.zeros(len(mesh.edges), int)
    for face in mesh.polygons:
        for key in face.edge_keys:
            used[mesh.edge_keys.index(key)] += 1
    assert (used == 2).all()
    mesh.calc_loop_triangles()
    volume = sum(
        mesh.vertices[a].co.dot(mesh.vertices[b].co.cross(mesh.vertices[c].co)) / 6.0
        for a, b, c in (triangle.vertices for triangle in mesh.loop_triangles)
    )
    assert 0.96 * exact < volume < exact  # inscribed


def test_menu_has_all_of_them():
    from addon.operators import add_shape

    assert add_shape.draw_submenu in bpy.types.VIEW3D_MT_add._dyn_ui_initialize()
    assert {operator.primitive for operator, _ in add_shape.OPERATORS} == {kind.upper() for kind in KINDS}
