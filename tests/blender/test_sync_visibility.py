"""Which rays see what: flags of objects, collections and instancers; what a viewport shows."""

import bpy
import numpy as np
import pytest

from addon.engine.scene import Visibility
from addon.sync.instancing import copies_in
from addon.sync.scene_sync import sync_scene
from addon.sync.visibility import shown_in
from tests.blender.building import GeometryNodes, add_camera, link, quad, shapes_of, sync, with_nodes

FLAGS = {
    "visible_camera": Visibility.ALL & ~Visibility.CAMERA,
    "visible_diffuse": Visibility.ALL & ~Visibility.DIFFUSE,
    "visible_glossy": Visibility.ALL & ~Visibility.GLOSSY,
    "visible_transmission": Visibility.ALL & ~Visibility.TRANSMISSION,
    "visible_shadow": Visibility.ALL & ~Visibility.SHADOW,
    "is_holdout": Visibility.ALL | Visibility.HOLDOUT,
    "is_shadow_catcher": Visibility.ALL | Visibility.SHADOW_CATCHER,
}


@pytest.fixture(autouse=True)
def camera():
    add_camera()


def set_flag(obj, flag):
    setattr(obj, flag, not flag.startswith("visible"))


def ball(**settings):
    bpy.ops.mesh.primitive_uv_sphere_add()
    for name, value in settings.items():
        setattr(bpy.context.object, name, value)
    return bpy.context.object


@pytest.mark.parametrize("flag", FLAGS)
def test_flags_of_a_mesh(flag):
    set_flag(quad("flagged"), flag)
    quad("plain", location=(5, 0, 0))
    synced = sync()
    found = {instances.name: instances.visibility for instances in synced.scene.instances}
    assert found == {"flagged": FLAGS[flag], "plain": Visibility.ALL} and not synced.messages


@pytest.mark.parametrize("flag", FLAGS)
def test_flags_of_exact_shapes(flag):
    """Shapes of one visibility stand together, in a geometry of their own."""
    ball()
    for x in (3.0, 6.0):
        set_flag(ball(location=(x, 0, 0)), flag)
    set_flag(ball(location=(9, 0, 0), scale=(1, 1, 2)), flag)
    scene = sync().scene
    np.testing.assert_allclose(shapes_of(scene)["sphere"].center, [(0, 0, 0)], atol=1e-6)
    world, stretched = sorted(scene.instances, key=lambda i: i.materials is not None)
    assert world.visibility == stretched.visibility == FLAGS[flag]
    ((_, spheres),) = world.geometry.kinds()
    assert world.materials is None and set(spheres.material) <= set(range(len(scene.materials)))
    np.testing.assert_allclose(np.sort(spheres.center[:, 0]), (3.0, 6.0), rtol=1e-6)
    np.testing.assert_array_equal(world.matrices, [np.eye(4)])


def test_flags_of_an_infinite_plane():
    obj = quad("sea", visible_glossy=False)
    obj.conic.primitive = "PLANE"
    (plane,) = sync().scene.planes
    assert plane.visibility.tolist() == [FLAGS["visible_glossy"]]


def test_flags_of_point_clouds():
    nodes = GeometryNodes()
    nodes.output(nodes.add("Points", Count=3))
    with_nodes(nodes, visible_shadow=False)
    (instances,) = sync().scene.instances
    assert instances.visibility == FLAGS["visible_shadow"]


def test_what_no_ray_sees_is_left_out():
    hidden = quad()
    for flag in FLAGS:
        if flag.startswith("visible"):
            setattr(hidden, flag, False)
    set_flag(hidden, "is_holdout")
    assert not sync().scene.instances


@pytest.mark.parametrize(
    ("flag", "visibility"),
    [("holdout", FLAGS["is_holdout"]), ("indirect_only", FLAGS["visible_camera"])],
)
def test_flags_of_collections(flag, visibility):
    collection = bpy.data.collections.new("kept apart")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(quad("in it"))
    bpy.context.scene.collection.objects.unlink(bpy.data.objects["in it"])
    quad("outside")
    layer = bpy.context.view_layer.layer_collection.children["kept apart"]
    setattr(layer, flag, True)
    found = {instances.name: instances.visibility for instances in sync().scene.instances}
    assert found == {"in it": visibility, "outside": Visibility.ALL}
    layer.holdout = True
    found = {instances.name: instances.visibility for instances in sync().scene.instances}
    assert found["in it"] == FLAGS["is_holdout"], "a holdout is seen by the camera"


def test_rays_see_instances_that_the_instanced_and_the_instancer_let_them_see():
    original = quad(visible_glossy=False, is_shadow_catcher=True)
    nodes = GeometryNodes()
    grid = nodes.add("MeshGrid", Vertices_X=2, Vertices_Y=2)
    nodes.output(nodes.add("InstanceOnPoints", Points=grid, Instance=nodes.object(original)))
    with_nodes(nodes, visible_shadow=False, is_holdout=True)
    found = {len(instances): instances.visibility for instances in sync().scene.instances}
    seen_itself = FLAGS["visible_glossy"] | Visibility.SHADOW_CATCHER
    assert found == {1: seen_itself, 4: seen_itself & ~Visibility.SHADOW | Visibility.HOLDOUT}


def viewport():
    """A SpaceView3D: the screens of Blender's factory state are there in the background too."""
    spaces = (space for screen in bpy.data.screens for area in screen.areas for space in area.spaces)
    return next(space for space in spaces if space.type == "VIEW_3D")


@pytest.mark.parametrize("iterate_all", (False, True))
def test_a_viewport_decides_which_objects_and_what_they_make_are_shown(iterate_all):
    bpy.ops.object.text_add()
    nodes = GeometryNodes()
    grid = nodes.add("MeshGrid", Vertices_X=3, Vertices_Y=3)
    nodes.output(nodes.add("InstanceOnPoints", Points=grid, Instance=nodes.object(bpy.context.object)), nodes.own)
    with_nodes(nodes, "host")
    link(None, "empty", instance_type="COLLECTION", instance_collection=bpy.data.collections.new("group"))
    depsgraph, space = bpy.context.evaluated_depsgraph_get(), viewport()
    numbers = []
    for space.show_object_viewport_mesh in (True, False):
        found = copies_in(depsgraph, shown_in(space), iterate_all)
        numbers.append(sum(len(copies) for copies in found if copies.kind == "MESH"))
    assert numbers == [1 + 1 + 9, 1], "the host, the text, the instances; the text alone"


def test_sync_takes_a_viewport():
    quad()
    depsgraph, space = bpy.context.evaluated_depsgraph_get(), viewport()
    space.show_object_viewport_mesh = False
    numbers = [len(sync_scene(depsgraph, 8, 8, report=print, space=of).instances) for of in (None, space)]
    assert numbers == [1, 0]


def shown(view_layer, space):
    """The names of the meshes that a viewport shows of a view layer."""
    return {obj.name for obj in view_layer.depsgraph.objects if obj.type == "MESH" and shown_in(space)(obj)}


def test_a_viewport_shows_its_local_collections():
    quad("outside")
    collection = bpy.data.collections.new("collection")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(bpy.data.objects.new("inside", bpy.data.objects["outside"].data))
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    space = area.spaces.active
    with bpy.context.temp_override(window=window, area=area):
        space.use_local_collections = True
        bpy.context.view_layer.update()
        assert shown(bpy.context.view_layer, space) == {"outside", "inside"}
        bpy.ops.object.hide_collection(collection_index=1, extend=True)
        bpy.context.view_layer.update()
        assert shown(bpy.context.view_layer, space) == {"outside"}


def test_what_another_view_layer_hides_is_shown():
    obj, layers, space = quad("quad"), bpy.context.scene.view_layers, viewport()
    other = layers.new("other")
    obj.hide_set(True, view_layer=other)
    for layer in (layers[0], other):
        layer.update()
    assert [shown(layer, space) for layer in (layers[0], other)] == [{"quad"}, set()]
