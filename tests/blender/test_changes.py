"""Each edit in Blender changes on the GPU what it must and nothing else: the exact `Change`, and what was uploaded."""

import bpy
import gpu
import numpy as np
import pytest

from addon.engine.changes import Change
from addon.viewport import history
from tests.blender.viewport.stand_in import StandIn, draws, mark, records

pytestmark = pytest.mark.skipif(not hasattr(gpu, "init"), reason="no GPU context in the background before Blender 5.2")

FILM = Change.FILM
#: The largest part of what is uploaded, in bytes, where neither geometry nor images change: some records.
SMALL = 16384


@pytest.fixture(scope="module")
def view(registered):
    """A viewport that shows a scene with something of everything."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    build_scene()
    bpy.app.handlers.depsgraph_update_post.append(mark)
    view = StandIn()
    view.settle()
    yield view
    view.close()
    bpy.app.handlers.depsgraph_update_post.remove(mark)


@pytest.fixture(autouse=True)
def _empty_blender():
    """In place of the one of all other tests: the scene lasts."""


def build_scene():
    scene = bpy.context.scene
    scene.conic.preview_samples, scene.conic.preview_frame_seconds = 2, 0.2
    scene.world = bpy.data.worlds.new("World")
    for name, location, add in (
        ("Ball", (0.0, 0.0, 0.0), bpy.ops.conic.sphere_add),
        ("Floor", (0.0, 0.0, -2.0), bpy.ops.conic.plane_add),
        ("Monkey", (0.0, 1.5, 0.0), bpy.ops.mesh.primitive_monkey_add),
        ("Other", (2.0, 0.0, 0.0), bpy.ops.conic.sphere_add),
    ):
        add(location=location)
        bpy.context.object.name = name
        material = bpy.data.materials.new(name)
        if not material.node_tree:
            material.use_nodes = True
        bpy.context.object.data.materials.append(material)
    for name, data in (("Twin", of("Monkey").data), ("Sister", of("Monkey").data.copy())):
        scene.collection.objects.link(bpy.data.objects.new(name, data))
        of(name).location = -2.0, 1.5, 0.0
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    lamp.location.z = 5.0
    scene.collection.objects.link(lamp)


def principled(name="Monkey"):
    return bpy.data.materials[name].node_tree.nodes["Principled BSDF"].inputs


def of(name):
    return bpy.data.objects[name]


def change_of(view, edit):
    """The change that an edit makes, and how many bytes were uploaded for it."""
    history.records.clear()
    edit()
    view.settle()
    loads = records(history.Load)
    assert not any(load.error for load in loads), loads
    change = Change.NONE
    for load in loads:
        change |= load.change
    assert any(draw.began for draw in draws()) == bool(change)
    return change, sum(sum(load.bytes.values()) for load in loads)


def in_scene(path, value):
    """Set an attribute of the scene by its path."""
    owner, _, name = path.rpartition(".")
    setattr(bpy.context.scene.path_resolve(owner), name, value)


EDITS_OF_NOTHING = {
    "select": lambda: of("Ball").select_set(not of("Ball").select_get()),
    "make active": lambda: setattr(bpy.context.view_layer.objects, "active", of("Lamp")),
    "go to a frame": lambda: bpy.context.scene.frame_set(bpy.context.scene.frame_current + 1),
    "frame rate": lambda: in_scene("render.fps", 25),
    "samples": lambda: in_scene("conic.preview_samples", 3),
    "samples of renders": lambda: in_scene("conic.samples", 33),
    "frame of the viewport": lambda: in_scene("conic.preview_frame_seconds", 0.3),
    "unused material": lambda: bpy.data.materials.new("Unused"),
    "unused mesh": lambda: bpy.data.meshes.new("Unused"),
    "camera": lambda: bpy.ops.object.camera_add(),
    "empty": lambda: bpy.ops.object.empty_add(),
    "color of the viewport": lambda: setattr(of("Monkey"), "color", (1.0, 0.0, 0.0, 1.0)),
    "place of a node": lambda: setattr(principled()["Base Color"].node, "location", (300.0, 0.0)),
    "the same value": lambda: setattr(of("Ball").location, "x", of("Ball").location.x),
}


@pytest.mark.parametrize("name", EDITS_OF_NOTHING)
def test_what_is_not_seen_changes_nothing(view, name):
    assert change_of(view, EDITS_OF_NOTHING[name]) == (Change.NONE, 0)


def set_world_color(color):
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = color


def test_one_sample_alone_is_drawn_otherwise(view):
    assert change_of(view, lambda: in_scene("conic.preview_samples", 1))[0] & Change.FILM


#: Name: (the change besides FILM, the edit). Nothing is uploaded that grows with the scene.
SMALL_EDITS = {
    "color": (Change.MATERIALS, lambda: setattr(principled()["Base Color"], "default_value", (1.0, 0.0, 0.0, 1.0))),
    "roughness": (Change.MATERIALS, lambda: setattr(principled()["Roughness"], "default_value", 0.3)),
    "move a lamp": (Change.LIGHTS, lambda: setattr(of("Lamp").location, "x", 1.0)),
    "energy of a lamp": (Change.LIGHTS, lambda: setattr(of("Lamp").data, "energy", 200.0)),
    "move a plane": (Change.PLANES, lambda: setattr(of("Floor").location, "z", -3.0)),
    "turn a plane": (Change.PLANES, lambda: setattr(of("Floor").rotation_euler, "x", 0.1)),
    "move a mesh": (Change.INSTANCES, lambda: setattr(of("Monkey").location, "x", 0.5)),
    "turn a mesh": (Change.INSTANCES, lambda: setattr(of("Monkey").rotation_euler, "x", 0.5)),
    "hide a copy": (Change.INSTANCES, lambda: of("Twin").hide_set(True)),
    "show a copy": (Change.INSTANCES, lambda: of("Twin").hide_set(False)),
    "hide a mesh": (Change.INSTANCES | Change.GEOMETRY, lambda: of("Sister").hide_set(True)),
    "show a mesh": (Change.INSTANCES | Change.GEOMETRY, lambda: of("Sister").hide_set(False)),
    "film without a sky": (Change.NONE, lambda: in_scene("render.film_transparent", True)),
    "cut-off": (Change.NONE, lambda: in_scene("conic.weight_cutoff", 0.01)),
    "depth": (Change.PROGRAM, lambda: in_scene("conic.max_depth", 3)),
    "flat colors": (Change.PROGRAM, lambda: in_scene("conic.use_flat_colors", True)),
    "color of the world": (Change.WORLD, lambda: set_world_color((0.2, 0.3, 0.4, 1.0))),
}


@pytest.mark.parametrize("name", SMALL_EDITS)
def test_a_small_edit_changes_its_records(view, name):
    expected, edit = SMALL_EDITS[name]
    change, uploaded = change_of(view, edit)
    assert change == expected | FILM
    if not change & (Change.WORLD | Change.GEOMETRY):
        assert uploaded <= SMALL


def move_vertex():
    mesh = of("Monkey").data
    mesh.vertices[0].co.x += 0.1
    mesh.update()


def add_noise():
    tree = bpy.data.materials["Monkey"].node_tree
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])


def test_an_edited_mesh_is_the_only_geometry_that_is_uploaded(view):
    change, uploaded = change_of(view, move_vertex)
    assert change & (Change.GEOMETRY | Change.REFIT) and not change & (Change.ALL_TEXTURES | Change.PROGRAM)
    assert "spheres" not in records(history.Load)[-1].bytes
    assert 0 < uploaded < 1 << 20


def test_an_added_shape_leaves_the_meshes_alone(view):
    change, _ = change_of(view, lambda: bpy.ops.conic.sphere_add(location=(-2.0, 0.0, 0.0)))
    assert change & Change.GEOMETRY and not change & Change.ALL_TEXTURES
    assert "triangles" not in records(history.Load)[-1].bytes


def test_a_new_node_is_another_program(view):
    change, _ = change_of(view, add_noise)
    assert change & Change.PROGRAM and not change & (Change.GEOMETRY | Change.ALL_TEXTURES)


def test_a_removed_mesh_uploads_no_geometry(view):
    change_of(view, lambda: bpy.data.objects.remove(of("Monkey")))
    assert not {"triangles", "spheres"} & set(records(history.Load)[-1].bytes)


def test_pixels_of_an_image(view):
    image = bpy.data.images.new("Image", 8, 8)
    tree = bpy.data.materials["Other"].node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    view.settle()

    def paint():
        image.pixels.foreach_set(np.full(8 * 8 * 4, 0.5, np.float32))
        image.update()
        image.update_tag()

    change, uploaded = change_of(view, paint)
    assert change == FILM | Change.IMAGES and 0 < uploaded <= SMALL
