"""Curves without bevel, hair and edges as strands, compared with Blender's own evaluation."""

import bpy
import numpy as np
import pytest

from addon.sync.curve_sampling import Sampling
from addon.sync.curves import sampling_of, strands_of_curves, strands_of_edges, strands_of_legacy_curve
from tests.blender.building import link, parts

HAS_GEOMETRY_SETS = hasattr(bpy.types.Object, "evaluated_geometry")
FINE = Sampling(steps=64)
#: How far pieces of 64 steps may be off. Before Blender 5.0 its samples of NURBS pass corners by.
CHORD = 4e-3 if bpy.app.version >= (5, 0, 0) else 3e-2
POINTS = np.array(
    [(0, 0, 0), (1, 0.5, 0.2), (2, -1, 0), (3, 1, 1), (3.5, 0, -1), (2, 2, 0), (1, 3, 0.5), (0, 2, 0), (-1, 1, 1)]
)


def depsgraph():
    return bpy.context.evaluated_depsgraph_get()


def legacy_curve(kind, count=9, **settings):
    """A CURVE object with one spline."""
    data = bpy.data.curves.new("curve", "CURVE")
    data.dimensions = "3D"
    data.resolution_u = 64
    spline = data.splines.new(kind)
    points = spline.bezier_points if kind == "BEZIER" else spline.points
    points.add(count - 1)
    for i, point in enumerate(points):
        point.co = POINTS[i] if kind == "BEZIER" else (*POINTS[i], settings.get("weights", np.ones(9))[i])
        point.radius = 1.0 + i
        if kind == "BEZIER":
            point.handle_left_type = point.handle_right_type = ("AUTO", "VECTOR", "FREE")[i % 3]
            if i % 3 == 2:
                point.handle_left, point.handle_right = POINTS[i] - (0.4, 0.1, 0.0), POINTS[i] + (0.2, 0.5, 0.3)
    for name, value in settings.items():
        if name != "weights":
            setattr(spline, name, value)
    return link(data, "curve")


def read_legacy(obj, radius=0.01, sampling=FINE):
    return strands_of_legacy_curve(obj.evaluated_get(depsgraph()), radius, sampling, depsgraph())


def wire(obj):
    """What Blender makes of the object as a mesh: vertices (n, 3) and edges (m, 2)."""
    evaluated = obj.evaluated_get(depsgraph())
    mesh = evaluated.to_mesh()
    found = arrays_of(mesh)
    evaluated.to_mesh_clear()
    return found


def arrays_of(mesh):
    """Vertices (n, 3) and edges (m, 2)."""
    vertices, ends = np.empty(len(mesh.vertices) * 3, np.float32), np.empty(len(mesh.edges) * 2, np.int32)
    mesh.vertices.foreach_get("co", vertices)
    mesh.edges.foreach_get("vertices", ends)
    return vertices.reshape(-1, 3), ends.reshape(-1, 2)


def distances(points, base, apex):
    """Of points (n, 3) from the nearest of the segments from base to apex (m, 3)."""
    d = apex - base
    squared = np.maximum(np.einsum("mi,mi->m", d, d), 1e-300)
    s = np.clip(np.einsum("nmi,mi->nm", points[:, None] - base, d) / squared, 0.0, 1.0)
    return np.linalg.norm(points[:, None] - base - s[..., None] * d, axis=-1).min(axis=1)


def assert_same_line(read, vertices, ends):
    """Neither line leaves the other by more than their chords do."""
    found = parts(read)
    centers = found["sphere"].center
    sides = [found[kind] for kind in ("cylinder", "cone") if kind in found]
    base, apex = (np.concatenate([getattr(side, end) for side in sides]) for end in ("base", "apex"))
    assert distances(vertices, base, apex).max() < CHORD
    assert distances(centers, vertices[ends[:, 0]], vertices[ends[:, 1]]).max() < CHORD


@pytest.mark.parametrize("cyclic", [False, True])
@pytest.mark.parametrize("kind", ["POLY", "BEZIER"])
def test_legacy_curves_are_where_blender_has_them(kind, cyclic):
    obj = legacy_curve(kind, use_cyclic_u=cyclic)
    assert_same_line(read_legacy(obj), *wire(obj))


@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
@pytest.mark.parametrize("cyclic", [False, True])
@pytest.mark.parametrize("endpoint", [False, True])
@pytest.mark.parametrize("bezier", [False, True])
def test_nurbs_are_where_blender_has_them(order, cyclic, endpoint, bezier):
    weights = np.array([1.0, 2.0, 0.5, 1.0, 1.0, 3.0, 1.0, 0.7, 1.0])
    settings = {"use_cyclic_u": cyclic, "use_endpoint_u": endpoint, "use_bezier_u": bezier, "order_u": order}
    count = 9
    if bezier and cyclic:  # a whole number of Bezier segments
        count = {2: 9, 3: 8, 4: 9, 5: 8, 6: 5}[order]
    obj = legacy_curve("NURBS", count, weights=weights, **settings)
    assert_same_line(read_legacy(obj), *wire(obj))


@pytest.mark.parametrize("kind", ["POLY", "BEZIER", "NURBS"])
def test_radii_of_points_multiply_the_setting(kind):
    obj = legacy_curve(kind, 4, use_endpoint_u=True)
    made = parts(read_legacy(obj, 0.01, Sampling(steps=4)))["sphere"]
    assert made.radius.min() == pytest.approx(0.01) and made.radius.max() == pytest.approx(0.04)
    at_end = np.linalg.norm(made.center - POINTS[3], axis=1) < 1e-5
    assert made.radius[at_end] == pytest.approx([0.04])


def test_shape_keys_and_hooks_reach_legacy_curves():
    obj = legacy_curve("POLY", 3)
    obj.shape_key_add(name="basis")
    key = obj.shape_key_add(name="moved")
    key.data[0].co = (5.0, 5.0, 5.0)
    key.value = 1.0
    assert (parts(read_legacy(obj))["sphere"].center == (5.0, 5.0, 5.0)).all(axis=1).any()


def test_splines_keep_their_material():
    obj = legacy_curve("POLY", 3)
    for _ in range(2):
        obj.data.materials.append(bpy.data.materials.new("m"))
    second = obj.data.splines.new("POLY")
    second.points.add(1)
    second.points[1].co = (0, 0, 5, 1)
    second.material_index = 1
    evaluated = obj.evaluated_get(depsgraph())
    read = strands_of_legacy_curve(evaluated, 0.01, FINE, depsgraph(), slot_count=2)
    assert sorted(np.concatenate([part.material for part in parts(read).values()])) == [0] * 5 + [1] * 3


def test_a_bevel_leaves_no_strands():
    obj = legacy_curve("BEZIER")
    obj.data.bevel_depth = 0.1
    assert read_legacy(obj).geometry is None


def hair(counts, **attributes):
    """A CURVES object; attributes: name=(type, domain, values)."""
    data = bpy.data.hair_curves.new("hair")
    data.add_curves(counts)
    data.attributes["position"].data.foreach_set(
        "vector", np.resize(POINTS, (sum(counts), 3)).ravel().astype(np.float32)
    )
    for name, (kind, domain, values) in attributes.items():
        attribute = data.attributes.get(name) or data.attributes.new(name, kind, domain)
        member = {"FLOAT_VECTOR": "vector", "FLOAT_COLOR": "color"}.get(kind, "value")
        attribute.data.foreach_set(member, np.asarray(values).ravel())
    return link(data, "hair")


def read_hair(obj, sampling=FINE, **settings):
    return strands_of_curves(obj.evaluated_get(depsgraph()).data, sampling, **settings)


def add_nodes(obj, build):
    """A geometry nodes modifier; `build` gets the tree and the input geometry, and gives the output socket."""
    tree = bpy.data.node_groups.new("nodes", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    tree.links.new(build(tree, start.outputs[0]), end.inputs[0])
    obj.modifiers.new("nodes", "NODES").node_group = tree


def as_wire(tree, geometry):
    made = tree.nodes.new("GeometryNodeCurveToMesh")
    tree.links.new(geometry, made.inputs[0])
    return made.outputs[0]


def typed(kind, cyclic):
    """Nodes that make curves of a type, with the resolution of `FINE`."""

    def build(tree, geometry):
        for name, settings in (
            ("CurveSplineType", {"spline_type": kind}),
            ("SetSplineResolution", {"Resolution": 64}),
            ("SetSplineCyclic", {"Cyclic": cyclic}),
        ):
            node = tree.nodes.new(f"GeometryNode{name}")
            for setting, value in settings.items():
                if hasattr(node, setting):
                    setattr(node, setting, value)
                else:
                    node.inputs[setting].default_value = value
            tree.links.new(geometry, node.inputs[0])
            geometry = node.outputs[0]
        return geometry

    return build


@pytest.mark.parametrize("cyclic", [False, True])
@pytest.mark.parametrize("kind", ["CATMULL_ROM", "POLY", "BEZIER", "NURBS"])
def test_curves_of_nodes_are_where_blender_has_them(kind, cyclic):
    obj, converted = hair([9]), hair([9])
    add_nodes(obj, typed(kind, cyclic))
    read = read_hair(obj)
    add_nodes(converted, lambda tree, geometry: as_wire(tree, typed(kind, cyclic)(tree, geometry)))
    mesh = next(i.object.data for i in depsgraph().object_instances if i.object.type == "MESH")
    assert_same_line(read, *arrays_of(mesh))


def test_hair_without_a_radius_has_that_of_cycles():
    made = parts(read_hair(hair([3, 2]), Sampling(steps=1)))
    assert len(made["sphere"]) == 5 and np.allclose(made["sphere"].radius, 0.005)
    assert len(made["cylinder"]) == 3


def test_hair_has_its_radii_slots_and_attributes():
    rows = np.linspace(0.0, 1.0, 20, dtype=np.float32).reshape(5, 4)
    obj = hair(
        [3, 2],
        radius=("FLOAT", "POINT", np.float32([0.1, 0.05, 0.0, 0.2, 0.2])),
        material_index=("INT", "CURVE", np.int32([7, 1])),
        color=("FLOAT_COLOR", "POINT", rows),
        shade=("FLOAT", "CURVE", np.float32([0.25, 0.75])),
    )
    read = read_hair(obj, Sampling(steps=1), slot_count=3, keys=("geometry:color", "geometry:shade", "geometry:none"))
    found = parts(read)
    assert found["cone"].material.tolist() == [2, 2] and found["cylinder"].material.tolist() == [1]
    assert len(found["sphere"]) == 4, "none at the pointed tip"
    np.testing.assert_allclose(found["sphere"].attributes["geometry:color"][:, 0], rows[[0, 1, 3, 4]])
    np.testing.assert_allclose(found["cylinder"].attributes["geometry:shade"][0, :, 0], 0.75)
    assert "geometry:none" not in found["sphere"].attributes


def test_hair_that_is_not_finite_is_counted():
    obj = hair([3, 2], radius=("FLOAT", "POINT", np.float32([0.1, np.nan, 0.0, 0.2, 0.2])))
    assert read_hair(obj).dropped == 1


def test_no_hair():
    assert read_hair(link(bpy.data.hair_curves.new("hair"))).geometry is None


@pytest.mark.skipif(not HAS_GEOMETRY_SETS, reason="no geometry sets in this Blender")
def test_curves_that_nodes_make_on_a_mesh():
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0)], [], [(0, 1, 2)])
    obj = link(mesh)

    def line(tree, _geometry):
        made, radius = tree.nodes.new("GeometryNodeCurvePrimitiveLine"), tree.nodes.new("GeometryNodeSetCurveRadius")
        radius.inputs["Radius"].default_value = 0.3
        tree.links.new(made.outputs[0], radius.inputs[0])
        return radius.outputs[0]

    add_nodes(obj, line)
    evaluated = obj.evaluated_get(depsgraph())
    geometry = evaluated.evaluated_geometry()
    cylinder = parts(strands_of_curves(geometry.curves, FINE, radius=2.0))["cylinder"]
    assert cylinder.radius == pytest.approx([0.6]) and cylinder.apex.tolist() == [[0, 0, 1]]


def mesh_of_edges(faces=()):
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 3)], [(0, 4), (4, 1)], faces)
    mesh.update()
    color = mesh.attributes.new("color", "FLOAT_COLOR", "POINT")
    color.data.foreach_set("color", np.arange(20, dtype=np.float32))
    return mesh


def test_edges_of_a_mesh_without_faces():
    found = parts(strands_of_edges(mesh_of_edges(), 0.1, keys=("geometry:color",)))
    assert len(found["cylinder"]) == 2 and len(found["sphere"]) == 3
    assert found["cylinder"].attributes["geometry:color"][:, :, 0].tolist() == [[0, 16], [16, 4]]


def test_edges_beside_faces():
    found = parts(strands_of_edges(mesh_of_edges([(0, 1, 2, 3)]), 0.1))
    assert len(found["cylinder"]) == 2 and len(found["sphere"]) == 3


def test_no_edges():
    assert strands_of_edges(bpy.data.meshes.new("mesh"), 0.1).geometry is None
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0)], [], [(0, 1, 2)])
    assert strands_of_edges(mesh, 0.1).geometry is None


def test_the_settings_of_the_sampling():
    settings = bpy.context.scene.conic
    assert sampling_of(settings, 0.1) == Sampling(tolerance=pytest.approx(0.025))
    settings.curve_sampling, settings.curve_steps = "FIXED", 5
    assert sampling_of(settings, 0.1) == Sampling(steps=5)
    assert link(None).conic.strand_radius == 0.0


def test_nodes_on_a_legacy_curve():
    obj = legacy_curve("POLY", 3)

    def thin(tree, geometry):
        radius = tree.nodes.new("GeometryNodeSetCurveRadius")
        radius.inputs["Radius"].default_value = 0.3
        tree.links.new(geometry, radius.inputs[0])
        return radius.outputs[0]

    add_nodes(obj, thin)
    read = read_legacy(obj, 0.5)
    if HAS_GEOMETRY_SETS:
        assert parts(read)["sphere"].radius == pytest.approx([0.15] * 3) and not read.warnings
    else:
        assert parts(read)["sphere"].radius == pytest.approx([0.5, 1.0, 1.5])
        assert "Blender 4.5" in read.warnings[0]
