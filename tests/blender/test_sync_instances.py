"""Instances of every origin, read whole and one by one, against what Blender's iterator gives."""

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from addon.sync.instancing import copies_in
from addon.sync.taken import materials_of
from tests.blender.building import GeometryNodes, add_camera, link, mesh_of, with_nodes

HAS_GEOMETRY_SETS = hasattr(bpy.types.Object, "evaluated_geometry")
TRIANGLE = ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
MOVED = Matrix.Translation((0.5, -2.0, 1.0)) @ Euler((0.3, 1.0, -0.7)).to_matrix().to_4x4()


def child(name="child", matrix=None, collection=None):
    """An object of one triangle, in a collection or in the scene."""
    obj = bpy.data.objects.new(name, mesh_of(*TRIANGLE, name))
    (collection or bpy.context.scene.collection).objects.link(obj)
    if matrix is not None:
        obj.matrix_world = matrix
    return obj


def collection_of(*names, offset=(1.0, 2.0, 3.0)):
    """A collection, not in the scene, of triangles that stand differently, with a child collection of one more."""
    made = bpy.data.collections.new("collection")
    made.instance_offset = offset
    for i, name in enumerate(names):
        child(name, Matrix.Translation((i, 0, 0)) @ MOVED, made)
    inner = bpy.data.collections.new("inner")
    made.children.link(inner)
    child("in inner", MOVED, inner)
    return made


def scattered(nodes, instance, count=3):
    """`instance` on the points of a grid, turned, stretched and partly mirrored."""
    grid = nodes.add("MeshGrid", Vertices_X=count, Vertices_Y=count, Size_X=7.0)
    where = nodes.add("InputPosition")
    return nodes.add("InstanceOnPoints", Points=grid, Instance=instance, Rotation=where, Scale=where)


def objects():
    nodes = GeometryNodes()
    nodes.output(scattered(nodes, nodes.object(child(matrix=MOVED))))
    with_nodes(nodes).matrix_world = MOVED


def objects_under_other_names():
    for name in ("Größe", "日本", "x" * 60):
        nodes = GeometryNodes()
        nodes.output(scattered(nodes, nodes.object(child(name))))
        with_nodes(nodes, f"host of {name}"[:60])


def sheared_objects():
    nodes = GeometryNodes()
    nodes.output(scattered(nodes, nodes.object(child())))
    sheared = Matrix.Identity(4)
    sheared[0][1] = 0.8
    with_nodes(nodes).matrix_world = sheared @ Matrix.Diagonal((1.0, -2.0, 1.0, 1.0))


def flattened_objects():
    nodes = GeometryNodes()
    nodes.output(scattered(nodes, nodes.object(child(matrix=Matrix.Diagonal((1.0, 0.0, 1.0, 1.0))))))
    with_nodes(nodes, scale=(1.0, 1.0, 0.0))


def collections():
    nodes = GeometryNodes()
    nodes.output(scattered(nodes, nodes.add("CollectionInfo", Collection=collection_of("a", "b"))))
    with_nodes(nodes).matrix_world = MOVED


def collections_apart():
    nodes = GeometryNodes()
    parts = nodes.add("CollectionInfo", Collection=collection_of("a", "b"), Separate_Children=True)
    grid = nodes.add("MeshGrid", Vertices_X=2, Vertices_Y=3)
    nodes.output(nodes.add("InstanceOnPoints", Points=grid, Instance=parts, Pick_Instance=True))
    with_nodes(nodes)


def collections_with_hidden_objects():
    collection = collection_of("seen", "hidden", "not seen")
    hidden = collection.objects["hidden"]
    hidden.hide_viewport = hidden.hide_render = True
    collection.objects["not seen"].hide_render = True
    nodes = GeometryNodes()
    nodes.output(scattered(nodes, nodes.add("CollectionInfo", Collection=collection)))
    with_nodes(nodes)


def nested():
    nodes = GeometryNodes()
    inner = scattered(nodes, nodes.object(child()), 2)
    nodes.output(scattered(nodes, inner))
    with_nodes(nodes).matrix_world = MOVED


def deeply_nested():
    nodes = GeometryNodes()
    made = nodes.object(child())
    for _ in range(8):
        made = nodes.add("GeometryToInstance", Geometry=made)
    nodes.output(made)
    with_nodes(nodes)


def made_meshes():
    nodes = GeometryNodes()
    nodes.output(scattered(nodes, nodes.add("MeshCone", Vertices=5)), nodes.own)
    with_nodes(nodes, data=mesh_of(*TRIANGLE))


def objects_that_instance():
    inner = GeometryNodes("inner")
    inner.output(scattered(inner, inner.object(child()), 2), inner.own, inner.add("Points", Count=3))
    middle = with_nodes(inner, "middle", mesh_of(*TRIANGLE))
    middle.matrix_world = MOVED
    nodes = GeometryNodes()
    nodes.output(scattered(nodes, nodes.object(middle)))
    with_nodes(nodes)


def realized():
    nodes = GeometryNodes()
    nodes.output(nodes.add("RealizeInstances", Geometry=scattered(nodes, nodes.object(child()))))
    with_nodes(nodes)


def everything_at_once():
    nodes = GeometryNodes()
    points, curve = nodes.add("Points", Count=4), nodes.add("CurvePrimitiveCircle")
    mixed = nodes.add("JoinGeometry")
    for socket in (points, curve, nodes.add("MeshCone"), scattered(nodes, nodes.object(child()), 2)):
        nodes.tree.links.new(socket, mixed.node.inputs[0])
    nodes.output(points, curve, nodes.own, scattered(nodes, nodes.object(child("other"))), scattered(nodes, mixed))
    with_nodes(nodes, data=mesh_of(*TRIANGLE))


def on_other_types_of_object():
    for data in (bpy.data.curves.new("text", "FONT"), bpy.data.curves.new("curve", "CURVE")):
        if hasattr(data, "body"):
            data.body = "ab"
        nodes = GeometryNodes()
        nodes.output(scattered(nodes, nodes.object(child(f"on {data.name}"))), nodes.own)
        with_nodes(nodes, f"host {data.name}", data)
    bpy.ops.object.metaball_add(type="BALL")
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()
    bpy.ops.object.text_add()


def texts_and_metaballs_as_instances():
    for add in (
        bpy.ops.object.metaball_add,
        bpy.ops.object.text_add,
        bpy.ops.surface.primitive_nurbs_surface_torus_add,
    ):
        add()
        nodes = GeometryNodes()
        nodes.output(scattered(nodes, nodes.object(bpy.context.object), 2))
        with_nodes(nodes, f"host of {bpy.context.object.name}")


def letters():
    nodes = GeometryNodes()
    letters = nodes.add("StringToCurves", String="abcab")
    nodes.output(letters, nodes.add("FillCurve", Curve=letters))
    with_nodes(nodes)


def numbered():
    nodes = GeometryNodes()
    index = nodes.add("InputIndex")
    negative = nodes.tree.nodes.new("ShaderNodeMath")
    negative.operation = "MULTIPLY_ADD"
    negative.inputs[1].default_value, negative.inputs[2].default_value = -3.0, 5.0
    nodes.tree.links.new(index, negative.inputs[0])
    made = scattered(nodes, nodes.object(child()))
    nodes.output(nodes.stored(made, "id", negative.outputs[0], "INT", "INSTANCE"))
    with_nodes(nodes)


def numbered_alike():
    nodes = GeometryNodes()
    nodes.output(nodes.stored(scattered(nodes, nodes.object(child())), "id", 7, "INT", "INSTANCE"))
    with_nodes(nodes)


def hosts_that_do_not_show():
    nodes = GeometryNodes()
    nodes.output(scattered(nodes, nodes.object(child())), nodes.own, nodes.add("Points", Count=2))
    hidden = with_nodes(nodes, "hidden host", mesh_of(*TRIANGLE))
    hidden.show_instancer_for_render = hidden.show_instancer_for_viewport = False
    outer = GeometryNodes("outer")
    outer.output(scattered(outer, outer.object(hidden), 2))
    with_nodes(outer, "outer host")


def hidden_objects():
    for name in ("hide_viewport", "hide_render"):
        nodes = GeometryNodes()
        nodes.output(scattered(nodes, nodes.object(child(f"child {name}"))))
        setattr(with_nodes(nodes, name), name, True)
        setattr(nodes.tree.nodes["Object Info"].inputs["Object"].default_value, name, True)


def collection_empties():
    collection = collection_of("a", "b")
    nodes = GeometryNodes()
    nodes.output(scattered(nodes, nodes.object(child())), nodes.own)
    host = with_nodes(nodes, "inner host", mesh_of(*TRIANGLE))
    bpy.context.collection.objects.unlink(host)
    collection.objects.link(host)
    outer = bpy.data.collections.new("outer")
    for x in range(2):
        empty = bpy.data.objects.new(f"inner empty {x}", None)
        empty.location.x, empty.instance_type, empty.instance_collection = x, "COLLECTION", collection
        outer.objects.link(empty)
    for x in range(3):
        link(None, f"empty {x}", location=(x, 0, 5), instance_type="COLLECTION", instance_collection=outer)
    objects()


def nodes_that_instance_empties():
    link(None, "empty", instance_type="COLLECTION", instance_collection=collection_of("a", "b"))
    nodes = GeometryNodes()
    nodes.output(scattered(nodes, nodes.object(bpy.data.objects["empty"])))
    with_nodes(nodes)
    objects()


def on_vertices_and_faces():
    for kind in ("VERTS", "FACES"):
        host = link(mesh_of([(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 1)], [(0, 1, 2), (0, 2, 3)]), kind)
        host.instance_type, host.use_instance_vertices_rotation, host.use_instance_faces_scale = kind, True, True
        on_it = child(f"on {kind}")
        on_it.parent = host
        nodes = GeometryNodes()
        nodes.output(scattered(nodes, nodes.object(child(f"nodes on {kind}")), 2), nodes.own)
        with_nodes(nodes, f"nodes {kind}", mesh_of(*TRIANGLE)).parent = host
    nodes = GeometryNodes()
    nodes.output(scattered(nodes, nodes.object(on_it)))
    with_nodes(nodes, "of originals")


def particles():
    for kind in ("OBJECT", "COLLECTION"):
        bpy.ops.mesh.primitive_plane_add(size=4.0)
        host = bpy.context.object
        host.name = f"emitter of {kind}"
        host.show_instancer_for_render = host.show_instancer_for_viewport = kind == "OBJECT"
        settings = host.modifiers.new("particles", "PARTICLE_SYSTEM").particle_system.settings
        settings.count, settings.type, settings.render_type = 9, "HAIR", kind
        settings.particle_size, settings.size_random = 0.5, 0.5
        settings.instance_object, settings.instance_collection = child(f"for {kind}"), collection_of(f"in {kind}")


def painted():
    """Slots of the object, of its data, of what nodes make; instances of it."""
    made = [bpy.data.materials.new(name) for name in ("of data", "of object", "by nodes")]
    obj = child()
    obj.data.materials.append(made[0])
    obj.data.materials.append(None)
    obj.material_slots[1].link, obj.material_slots[1].material = "OBJECT", made[1]
    nodes = GeometryNodes()
    cone = nodes.add("SetMaterial", Geometry=nodes.add("MeshCone"), Material=made[2])
    nodes.output(scattered(nodes, nodes.object(obj)), scattered(nodes, cone), nodes.add("MeshCube"), nodes.own)
    with_nodes(nodes, "plain host", mesh_of(*TRIANGLE))
    host = with_nodes(nodes, "painted host", mesh_of(*TRIANGLE))
    for kind, own in (("DATA", made[0]), ("OBJECT", made[1]), ("OBJECT", None)):
        host.data.materials.append(made[0])
        slot = host.material_slots[len(host.material_slots) - 1]
        slot.link, slot.material = kind, own


SCENES = (
    *(objects, objects_under_other_names, sheared_objects, flattened_objects, collections, collections_apart),
    *(collections_with_hidden_objects, nested, deeply_nested, made_meshes),
    *(objects_that_instance, realized, everything_at_once, on_other_types_of_object, texts_and_metaballs_as_instances),
    *(letters, numbered, numbered_alike, hosts_that_do_not_show, hidden_objects, collection_empties),
    *(nodes_that_instance_empties, on_vertices_and_faces, particles, painted),
)


def line(obj, kind, data, instancer, materials, random, matrix):
    """Of one copy: what it is of, who makes it, its slots, its random number and place."""
    size = len(data.vertices) if kind == "MESH" else 0
    slots = " ".join(made.name if made else "-" for made in materials).rstrip(" -")  # 4.2 leaves empty ones out
    numbers = (round(float(x), 4) + 0.0 for x in (random, *np.ravel(matrix)))
    return (obj.name, kind.replace("CURVES", "CURVE"), size, instancer.name if instancer else "", slots, *numbers)


def table(copies):
    """The lines of all copies."""
    lines = []
    for block in copies:
        materials = materials_of(block.obj, block.data, block.is_own)
        numbers = block.values(("object:random",))["object:random"][:, 0]
        if block.instancer is None:
            numbers = np.zeros(len(block))  # Blender tells none
        what = block.obj, block.kind, block.data, block.instancer, materials
        lines += [line(*what, number, matrix[:3]) for number, matrix in zip(numbers, block.matrices, strict=True)]
    return sorted(lines)


def blenders_own(depsgraph):
    """The lines of all that Blender's iterator gives."""
    lines = []
    for instance in depsgraph.object_instances:
        obj = instance.object
        if instance.show_self and obj.data is not None:
            materials = [slot.material for slot in obj.material_slots]
            random = (instance.random_id & 0xFFFFFFFF) / 0xFFFFFFFF if instance.is_instance else 0.0
            what = obj, obj.type, obj.data, instance.parent, materials
            lines.append(line(*what, random, [row[:] for row in instance.matrix_world][:3]))
    return sorted(lines)


def compare(depsgraph):
    """Both ways against Blender; the number of copies."""
    expected = blenders_own(depsgraph)
    for slowly in (True, False) if HAS_GEOMETRY_SETS else (True,):
        found = table(copies_in(depsgraph, iterate_all=slowly))
        assert [line[:5] for line in found] == [line[:5] for line in expected]
        np.testing.assert_allclose([line[5:] for line in found], [line[5:] for line in expected], atol=2e-4)
    return len(expected)


class Comparing(bpy.types.RenderEngine):
    """Compares in a final render, where other flags count than in a viewport."""

    bl_idname, bl_label = "COMPARING", "Comparing"
    found = None

    def render(self, depsgraph):
        try:
            Comparing.found = depsgraph.mode, compare(depsgraph)
        except Exception as error:
            Comparing.found = error


@pytest.fixture(scope="module")
def comparing_engine():
    bpy.utils.register_class(Comparing)
    yield
    bpy.utils.unregister_class(Comparing)


@pytest.mark.parametrize("build", SCENES, ids=lambda build: build.__name__)
def test_both_ways_find_what_blender_finds(build):
    build()
    assert compare(bpy.context.evaluated_depsgraph_get()) > 1


@pytest.mark.parametrize("build", SCENES, ids=lambda build: build.__name__)
def test_so_it_does_in_a_final_render(comparing_engine, build):
    build()
    add_camera()
    Comparing.found = None
    scene = bpy.context.scene
    scene.render.engine, scene.render.resolution_x, scene.render.resolution_y = "COMPARING", 8, 8
    bpy.ops.render.render()
    if isinstance(Comparing.found, BaseException):
        raise Comparing.found
    assert Comparing.found[0] == "RENDER" and Comparing.found[1] > 1
