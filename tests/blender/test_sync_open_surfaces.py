"""Transmitting surfaces that close around nothing: sheets, which bend light but are no border of a body."""

import bpy
import numpy as np
import pytest

from tests.blender.building import add_camera, link, material, mesh_of, node, quad, shapes_of, sync

CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
CUBE_FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]


def glass(name="glass", shader="BsdfGlass"):
    made, tree, output = material(name)
    node(tree, shader, output.inputs["Surface"])
    return made


def with_glass(obj):
    obj.data.materials.append(glass())
    return obj


def bounds_body(materials, numbers):
    """Whether the materials of the numbers are borders of a body; all of them are, or none."""
    (answer,) = {materials[number].bounds_body for number in np.ravel(numbers)}
    return answer


def mesh_bounds_body(vertices, faces):
    add_camera()
    obj = with_glass(link(mesh_of(vertices, faces)))
    obj.conic.primitive = "MESH"
    scene = sync().scene
    return bounds_body(scene.materials, scene.instances[0].materials)


def test_a_cube_is_a_body():
    assert mesh_bounds_body(CUBE, CUBE_FACES)


def test_a_loose_edge_opens_nothing():
    add_camera()
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata([*CUBE, (5, 5, 5), (6, 6, 6)], [(8, 9)], CUBE_FACES)
    with_glass(link(mesh))
    scene = sync().scene
    assert bounds_body(scene.materials, scene.instances[0].materials)


@pytest.mark.parametrize("faces", (CUBE_FACES[1:], CUBE_FACES[:1], [*CUBE_FACES, (0, 1, 6, 7)]))
def test_what_has_a_rim_or_a_wall_within_is_none(faces):
    assert not mesh_bounds_body(CUBE, faces)


def test_a_cube_and_a_sheet_in_one_mesh_are_none():
    sheet = [(3, 0, 0), (4, 0, 0), (4, 1, 0)]
    assert not mesh_bounds_body(CUBE + sheet, [*CUBE_FACES, (8, 9, 10)])


@pytest.mark.parametrize(
    "add, kind, closed",
    [
        (lambda: bpy.ops.mesh.primitive_uv_sphere_add(), "sphere", True),
        (lambda: bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3), "sphere", True),
        (lambda: bpy.ops.mesh.primitive_cylinder_add(), "cylinder", True),
        (lambda: bpy.ops.mesh.primitive_cylinder_add(end_fill_type="NOTHING"), "cylinder", False),
        (lambda: bpy.ops.mesh.primitive_cone_add(), "cone", True),
        (lambda: bpy.ops.mesh.primitive_cone_add(radius2=0.5), "cone", True),
        (lambda: bpy.ops.mesh.primitive_cone_add(end_fill_type="NOTHING"), "cone", False),
        (lambda: bpy.ops.mesh.primitive_cone_add(radius2=0.5, end_fill_type="NOTHING"), "cone", False),
        (lambda: bpy.ops.mesh.primitive_circle_add(fill_type="NGON"), "disc", False),
    ],
)
def test_exact_shapes(add, kind, closed):
    add_camera()
    add()
    with_glass(bpy.context.object)
    scene = sync().scene
    shapes = shapes_of(scene)
    assert kind in shapes
    for part in shapes.values():
        assert bounds_body(scene.materials, part.material) == closed


def test_water_below_a_plane_without_end_is_a_body():
    add_camera()
    with_glass(quad()).conic.primitive = "PLANE"
    scene = sync().scene
    assert bounds_body(scene.materials, scene.planes[0].material)


def test_a_material_of_bodies_and_sheets_is_there_twice_and_other_ones_once():
    add_camera()
    clear, dull = glass(), glass("dull", "BsdfDiffuse")
    bpy.ops.mesh.primitive_uv_sphere_add()
    bpy.context.object.data.materials.append(clear)
    for name in ("pane", "window"):
        quad(name).data.materials.append(clear)
    quad("wall").data.materials.append(dull)
    scene = sync().scene
    assert len(scene.materials) == 3
    of = {instance.name: instance.materials[0] for instance in scene.instances}
    sphere = shapes_of(scene)["sphere"].material[0]
    assert of["pane"] == of["window"] != sphere
    assert scene.materials[sphere].bounds_body and scene.materials[of["wall"]].bounds_body
    assert not scene.materials[of["pane"]].bounds_body
    assert scene.materials[of["pane"]].transmit == scene.materials[sphere].transmit


def test_points_of_glass_are_bodies():
    add_camera()
    tree = bpy.data.node_groups.new("drops", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    points, paint, output = (
        tree.nodes.new(name) for name in ("GeometryNodePoints", "GeometryNodeSetMaterial", "NodeGroupOutput")
    )
    paint.inputs["Material"].default_value = glass()
    tree.links.new(points.outputs[0], paint.inputs["Geometry"])
    tree.links.new(paint.outputs[0], output.inputs[0])
    link(bpy.data.meshes.new("carrier")).modifiers.new("nodes", "NODES").node_group = tree
    scene = sync().scene
    ((_, spheres),) = scene.instances[0].geometry.kinds()
    made = scene.materials[scene.instances[0].materials[0]]
    assert spheres.kind == "sphere" and max(made.transmit.value) > 0.0 and made.bounds_body
