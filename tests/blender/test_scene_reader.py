"""A reader that reads again: what did not change is the same object, and nothing of it is ever stale."""

import random
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from addon.engine.expression import Call, Expression, Parameter
from addon.fingerprint import fingerprint
from addon.sync.scene_reader import SceneReader

from .building import GeometryNodes, add_camera, image, link, material, node, quad, with_nodes

MANY = 300  # instances: enough to be a geometry of their own


class Reading:
    """A SceneReader that hears of Blender's changes, as a viewport does."""

    def __init__(self, space=None):
        self.messages, self.space = [], space
        self.reader = SceneReader(lambda *message: self.messages.append(message))
        self.handler = lambda _scene, depsgraph: self.reader.mark(depsgraph)
        bpy.app.handlers.depsgraph_update_post.append(self.handler)
        bpy.app.handlers.frame_change_post.append(self.handler)
        self.scene = None

    def read(self):
        """The Scene; it must be what a reader sees that reads for the first time."""
        depsgraph = bpy.context.evaluated_depsgraph_get()
        self.messages.clear()
        self.scene = self.reader.read(depsgraph, 64, 48, space=self.space)
        messages = []
        fresh = SceneReader(lambda *message: messages.append(message)).read(depsgraph, 64, 48, space=self.space)
        assert sorted(self.messages) == sorted(messages)
        assert list(differences(plain(self.scene), plain(fresh))) == []
        return self.scene

    def renewed(self, edit):
        """What an edit renews of the Scene, as `things` names it."""
        before = things(self.scene or self.read())
        edit()
        after = things(self.read())
        return {name for name, thing in after.items() if before.get(name) is not thing} | {
            f"-{name}" for name in before.keys() - after.keys()
        }


@pytest.fixture
def reading():
    made = Reading()
    yield made
    bpy.app.handlers.depsgraph_update_post.remove(made.handler)
    bpy.app.handlers.frame_change_post.remove(made.handler)


def things(scene):
    """What keeps its identity, by name."""
    found = {"shapes": scene.shapes}
    for placed in scene.instances:
        found[f"placed {placed.name}"] = placed
        found[f"geometry {placed.name}"] = placed.geometry
    found |= {f"material {number}": made for number, made in enumerate(scene.materials)}
    return found | {f"image {number}": made for number, made in enumerate(scene.images)}


def plain(scene):
    """The content of a Scene, whatever the numbers of its materials and images, by part."""
    digests = [_digest(made, scene) for made in scene.materials]
    return {
        "camera": scene.camera,
        "lights": scene.lights,
        "world": _resolved(scene.world, scene),
        "shapes": _rows(scene.shapes, digests),
        "planes": [_columns(planes, digests) for planes in scene.planes],
        "instances": [
            (
                placed.name,
                np.array(placed.matrices),
                None if placed.materials is None else [digests[number] for number in placed.materials],
                int(placed.visibility),
                {key: np.array(values) for key, values in sorted(placed.attributes.items())},
                _rows(placed.geometry, digests if placed.materials is None else None),
            )
            for placed in scene.instances
        ],
    }


def differences(found, expected, path=""):
    """Yield the paths to where plain contents differ."""
    if type(found) is not type(expected):
        yield f"{path}: {type(found).__name__} {type(expected).__name__}"
    elif isinstance(expected, dict) and found.keys() == expected.keys():
        for key in expected:
            yield from differences(found[key], expected[key], f"{path}.{key}")
    elif isinstance(expected, list | tuple) and len(found) == len(expected):
        for i, (a, b) in enumerate(zip(found, expected, strict=True)):
            yield from differences(a, b, f"{path}[{i}]")
    elif fingerprint(found) != fingerprint(expected):
        yield f"{path}: {found} {expected}"


def _rows(geometry, digests):
    return [geometry.name, *((label, _columns(part, digests)) for label, part in geometry.kinds())]


def _columns(part, digests):
    """All arrays of primitives in full; their materials are those `digests`, or slots."""
    columns = {column.name: np.array(getattr(part, column.name)) for column in part.columns}
    if digests is not None:
        columns["material"] = np.array([digests[number] for number in part.material])
    return columns | {f"attribute {key}": np.array(values) for key, values in sorted(part.attributes.items())}


def _digest(made, scene):
    return int.from_bytes(fingerprint(_resolved(made, scene))[:7], "little")


def _resolved(owner, scene):
    """A Material or World, its expressions with images in place of their numbers."""
    seen = {}
    return {name: _resolve(value, scene, seen) for name, value in vars(owner).items()}


def _resolve(value, scene, seen):
    if not isinstance(value, Expression):
        return value
    if id(value) not in seen:
        inputs = list(getattr(value, "inputs", ()))
        made = SimpleNamespace(kind=type(value).__name__, **{**vars(value), "inputs": ()})
        seen[id(value)] = made
        if isinstance(value, Call) and value.name.startswith("image_sample"):
            count = int(inputs[1].value[0]) if value.name.endswith("tiled") else 1
            first = int(inputs.pop(0).value[0])
            assert isinstance(value.inputs[0], Parameter)
            made.images = [vars(scene.images[first + i]) for i in range(count)]
        made.inputs = [_resolve(other, scene, seen) for other in inputs]
    return seen[id(value)]


# A scene of everything, and edits of it


def sphere_mesh(name):
    bpy.ops.conic.sphere_add()
    made = bpy.context.object.data
    bpy.data.objects.remove(bpy.context.object)
    made.name = name
    return made


def painted(name, pixels):
    """A material whose color is that of an image."""
    made, tree, output = material(name)
    diffuse = node(tree, "BsdfDiffuse", output.inputs["Surface"])
    node(tree, "TexImage", diffuse.inputs["Color"]).image = image(pixels, name)
    return made


def plainly(name, kind="BsdfDiffuse", **inputs):
    made, tree, output = material(name)
    node(tree, kind, output.inputs["Surface"], **inputs)
    return made


def of_group(name):
    """A material whose color comes out of a node group."""
    made, tree, output = material(name)
    diffuse = node(tree, "BsdfDiffuse", output.inputs["Surface"])
    group = bpy.data.node_groups.new("group", "ShaderNodeTree")
    group.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
    group.links.new(group.nodes.new("ShaderNodeRGB").outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
    node(tree, "Group").node_tree = group
    tree.links.new(tree.nodes["Group"].outputs[0], diffuse.inputs["Color"])
    return made


def with_coordinates(name, obj):
    """A material whose color is the place in the space of another object."""
    made, tree, output = material(name)
    diffuse = node(tree, "BsdfDiffuse", output.inputs["Surface"])
    node(tree, "TexCoord", diffuse.inputs["Color"], output="Object").object = obj
    return made


def of_attribute(name, attribute, kind="GEOMETRY"):
    made, tree, output = material(name)
    diffuse = node(tree, "BsdfDiffuse", output.inputs["Surface"])
    found = node(tree, "Attribute", diffuse.inputs["Color"])
    found.attribute_type, found.attribute_name = kind, attribute
    return made


def given(obj, made):
    obj.data.materials.append(made)
    return obj


@pytest.fixture
def everything():
    """A scene with an object of each kind."""
    scene = bpy.context.scene
    scene.conic.curve_sampling = "FIXED"
    add_camera()
    ball = sphere_mesh("ball")
    ball.materials.append(plainly("red"))
    link(ball, "ball")
    link(ball, "ball 2", location=(2.0, 0.0, 0.0))
    link(ball, "squashed", scale=(1.0, 1.0, 0.5))
    given(link(ball.copy(), "glass"), plainly("glass", "BsdfGlass"))
    link(None, "parent")
    given(quad("painted"), painted("painted", np.full((4, 4, 4), 0.5))).parent = bpy.data.objects["parent"]
    given(quad("grouped"), of_group("grouped"))
    given(quad("elsewhere"), with_coordinates("elsewhere", bpy.data.objects["ball 2"]))
    given(quad("indexed"), of_attribute("indexed", "pass_index", "OBJECT"))
    given(quad("vertex colors"), of_attribute("vertex colors", "paint")).data.color_attributes.new(
        "paint", "FLOAT_COLOR", "POINT"
    )
    bent = quad("bent")
    bent.modifiers.new("subdivided", "SUBSURF").levels = 1
    given(quad("open glass"), bpy.data.materials["glass"])
    nodes = GeometryNodes("cloud")
    points = nodes.add("MeshLine", Count=MANY)
    nodes.output(nodes.add("InstanceOnPoints", Points=points, Instance=nodes.object(bpy.data.objects["ball"])))
    with_nodes(nodes, "cloud", location=(0.0, 5.0, 0.0))
    nodes = GeometryNodes("dots")
    nodes.output(nodes.add("MeshToPoints", Mesh=nodes.add("MeshGrid", Vertices_X=3), Radius=0.1))
    with_nodes(nodes, "dots")
    inner = bpy.data.collections.new("inner")
    inner.objects.link(link(bpy.data.objects["grouped"].data, "in collection"))
    outer = bpy.data.collections.new("outer")
    scene.collection.children.link(outer)
    outer.objects.link(link(quad("in outer").data.copy(), "in outer 2"))
    link(None, "instancer", instance_type="COLLECTION", instance_collection=inner, location=(0.0, 0.0, 3.0))
    curve = bpy.data.curves.new("strand", "CURVE")
    curve.dimensions = "3D"
    curve.splines.new("POLY").points.add(2)
    curve.splines[0].points.foreach_set("co", np.arange(12, dtype=np.float32))
    link(curve, "strand").conic.strand_radius = 0.1
    link(bpy.data.lights.new("lamp", "POINT"), "lamp", location=(0.0, 0.0, 4.0))
    scene.world = bpy.data.worlds.new("world")
    if bpy.app.version < (5, 0, 0):
        scene.world.use_nodes = True
    given(quad("nan"), bpy.data.materials["red"]).data.vertices[0].co = (np.nan, 0.0, 0.0)


def tree_of(name):
    return bpy.data.materials[name].node_tree


def set_input(name, kind, socket, value):
    tree_of(name).nodes[kind].inputs[socket].default_value = value


def move(name, random):
    bpy.data.objects[name].location.z += 0.25 + random.random()


def edit_mesh(name, random):
    mesh = bpy.data.objects[name].data
    mesh.vertices[0].co.z += 0.5 + random.random()
    mesh.update()


def rename(name, random, data=""):
    """Rename an object that has something to report, or its data."""
    obj = next(obj for obj in objects() if obj.name.startswith(name))
    (obj.data if data else obj).name = f"{name} {random.randrange(100)}"


def paint(random):
    pixels = np.full(64, random.random(), np.float32)
    bpy.data.images["painted"].pixels.foreach_set(pixels)
    bpy.data.images["painted"].update_tag()


def relink(random):
    tree = tree_of("painted")
    socket = tree.nodes["Diffuse BSDF"].inputs["Color"]
    if socket.is_linked:
        tree.links.remove(socket.links[0])
    else:
        tree.links.new(tree.nodes["Image Texture"].outputs[0], socket)


def toggle(owner, name):
    setattr(owner, name, not getattr(owner, name))


def add_or_delete(random):
    if "added" in bpy.data.objects:
        bpy.data.objects.remove(bpy.data.objects["added"])
    else:
        link(random.choice([bpy.data.meshes["ball"], bpy.data.objects["grouped"].data]), "added")


def replace_by_namesake(random):
    old = bpy.data.objects["in outer"]
    mesh = old.data
    bpy.data.objects.remove(old)
    link(mesh, "in outer", location=(random.random(), 0.0, 0.0))


def paint_vertices(random):
    mesh = bpy.data.objects["vertex colors"].data
    mesh.color_attributes["paint"].data.foreach_set("color", np.full(16, random.random(), np.float32))
    mesh.update()


def color_group(random):
    rgb = next(node for node in bpy.data.node_groups["group"].nodes if node.type == "RGB")
    rgb.outputs[0].default_value[0] = random.random()


def radius_of_dots(random):
    tree = bpy.data.node_groups["dots"]
    tree.nodes["Mesh to Points"].inputs["Radius"].default_value = 0.1 + random.random()


def count_of_cloud(random):
    tree = bpy.data.node_groups["cloud"]
    tree.nodes["Mesh Line"].inputs["Count"].default_value = random.choice((10, MANY, MANY + 7))


def link_light(random):
    lamp = bpy.data.objects["lamp"]
    linking = lamp.light_linking
    if linking.receiver_collection is None:
        linking.receiver_collection = bpy.data.collections.new("receivers")
    members = linking.receiver_collection.objects
    name = random.choice(["ball", "painted", "cloud"])
    (members.unlink if name in members else members.link)(bpy.data.objects[name])


def objects():
    return bpy.data.objects


def layer():
    return bpy.context.view_layer.layer_collection.children["outer"]


def nothing_but_a_panel(random):
    bpy.context.scene.conic.preview_samples += 1


EDITS = {
    "nothing": lambda random: None,
    "select": lambda random: objects()["ball"].select_set(not objects()["ball"].select_get()),
    "panel": nothing_but_a_panel,
    "move": lambda random: move(random.choice(["ball", "ball 2", "painted", "indexed", "lamp", "cloud"]), random),
    "move parent": lambda random: move("parent", random),
    "move instanced": lambda random: move(random.choice(["in collection", "ball"]), random),
    "move instancer": lambda random: move("instancer", random),
    "move camera": lambda random: move("camera", random),
    "scale": lambda random: setattr(objects()["ball 2"], "scale", random.choice([(1, 1, 1), (2, 1, 1), (0, 1, 1)])),
    "edit mesh": lambda random: edit_mesh(random.choice(["painted", "grouped", "bent", "open glass"]), random),
    "edit sphere": lambda random: edit_mesh("glass", random),
    "modifier": lambda random: setattr(objects()["bent"].modifiers[0], "levels", random.choice((1, 2))),
    "modifier off": lambda random: toggle(objects()["bent"].modifiers[0], "show_viewport"),
    "points": radius_of_dots,
    "count": count_of_cloud,
    "add or delete": add_or_delete,
    "namesake": replace_by_namesake,
    "hide": lambda random: objects()["painted"].hide_set(not objects()["painted"].hide_get()),
    "hide in viewports": lambda random: toggle(objects()[random.choice(["ball", "grouped"])], "hide_viewport"),
    "exclude": lambda random: toggle(layer(), "exclude"),
    "hide collection": lambda random: toggle(bpy.data.collections["outer"], "hide_viewport"),
    "holdout collection": lambda random: toggle(layer(), "holdout"),
    "indirect": lambda random: toggle(layer(), "indirect_only"),
    "holdout": lambda random: toggle(objects()["indexed"], "is_holdout"),
    "rays": lambda random: toggle(random.choice([objects()["ball"], objects()["painted"]]), "visible_camera"),
    "constant": lambda random: set_input("red", "Diffuse BSDF", "Roughness", random.random()),
    "glass": lambda random: set_input("glass", "Glass BSDF", "IOR", 1.0 + random.random()),
    "link": relink,
    "group": color_group,
    "backface": lambda random: toggle(bpy.data.materials["painted"], "use_backface_culling"),
    "paint": paint,
    "reload": lambda random: bpy.data.images["painted"].reload(),
    "colorspace": lambda random: setattr(
        bpy.data.images["painted"].colorspace_settings, "name", random.choice(["sRGB", "Non-Color"])
    ),
    "alpha": lambda random: setattr(bpy.data.images["painted"], "alpha_mode", random.choice(["STRAIGHT", "NONE"])),
    "energy": lambda random: setattr(bpy.data.lights["lamp"], "energy", random.random()),
    "light linking": link_light,
    "world color": lambda random: setattr(bpy.data.worlds["world"], "color", (random.random(), 0, 0)),
    "world node": lambda random: setattr(
        bpy.data.worlds["world"].node_tree.nodes["Background"].inputs["Strength"], "default_value", random.random()
    ),
    "no world": lambda random: setattr(
        bpy.context.scene, "world", None if bpy.context.scene.world else bpy.data.worlds["world"]
    ),
    "primitive": lambda random: setattr(objects()["ball"].conic, "primitive", random.choice(["AUTO", "MESH", "DISC"])),
    "strand radius": lambda random: setattr(objects()["strand"].conic, "strand_radius", random.choice((0.0, 0.1, 0.2))),
    "recognise": lambda random: setattr(bpy.context.scene.conic, "recognise", random.choice(["ALWAYS", "NEVER"])),
    "steps": lambda random: setattr(bpy.context.scene.conic, "curve_steps", random.choice((2, 3))),
    "outlines": lambda random: toggle(bpy.context.scene.conic, "use_outlines"),
    "outlines around": lambda random: setattr(
        bpy.context.scene.conic, "outline_around", random.choice(["SHAPES", "OBJECTS"])
    ),
    "pass index": lambda random: setattr(objects()["indexed"], "pass_index", random.randrange(9)),
    "color": lambda random: setattr(objects()["indexed"], "color", (random.random(), 0, 0, 1)),
    "custom property": lambda random: objects()["indexed"].__setitem__("pass_index", random.random()),
    "vertex colors": paint_vertices,
    "rename": lambda random: rename("nan", random),
    "rename mesh": lambda random: rename("nan", random, "data"),
    "slot": lambda random: objects()["bent"].data.materials.append(bpy.data.materials["red"]),
    "slot's material": lambda random: setattr(
        objects()["ball"].material_slots[0], "material", bpy.data.materials[random.choice(["red", "glass", "painted"])]
    ),
    "override": lambda random: setattr(
        bpy.context.view_layer,
        "material_override",
        None if bpy.context.view_layer.material_override else bpy.data.materials["glass"],
    ),
    "instanced collection": lambda random: setattr(
        objects()["instancer"], "instance_collection", bpy.data.collections[random.choice(["inner", "outer"])]
    ),
    "offset": lambda random: setattr(bpy.data.collections["inner"], "instance_offset", (random.random(), 0, 0)),
    "frame": lambda random: bpy.context.scene.frame_set(random.randrange(1, 20)),
    "data": lambda random: setattr(
        objects()["bent"], "data", random.choice([objects()["grouped"].data, objects()["painted"].data])
    ),
}


@pytest.mark.parametrize("name", EDITS)
def test_after_an_edit_and_a_second_one_all_is_as_read_anew(everything, reading, name):
    chance = random.Random(name)
    reading.read()
    for _ in range(3):
        EDITS[name](chance)
        reading.read()


@pytest.mark.parametrize("seed", range(6))
def test_after_any_edits_all_is_as_read_anew(everything, reading, seed):
    chance = random.Random(seed)
    reading.read()
    for _ in range(40):
        name = chance.choice(list(EDITS))
        EDITS[name](chance)
        if chance.random() < 0.7:
            reading.read()
    reading.read()


def number_of(reading, name):
    """The number of a material."""
    key = "material", bpy.data.materials[name].session_uid
    return reading.reader._materials.of(key)[0]


def recolor(_random):
    objects()["ball"].color = (0.5, 0.5, 0.5, 1.0)  # which no material asks for


def tag_all(_random):
    for data in (*bpy.data.objects, *bpy.data.meshes, *bpy.data.materials, *bpy.data.images, *bpy.data.worlds):
        data.update_tag()


@pytest.mark.parametrize("edit", [*(EDITS[name] for name in ("nothing", "select", "panel", "frame")), recolor, tag_all])
def test_what_changes_nothing_renews_nothing(everything, reading, edit):
    assert reading.renewed(lambda: edit(random.Random(1))) == set()


def test_a_reader_that_forgets_finds_the_same_objects_again(everything, reading):
    assert reading.renewed(reading.reader.forget) == set()


#: What an edit renews, by its name; `material NAME` stands for its number.
RENEWED = {
    "move ball 2": {"shapes", "material elsewhere"},  # which has the coordinates of ball 2
    "move painted": {"placed painted"},
    "move parent": {"placed painted"},
    "move cloud": {"placed ball", "geometry ball"},
    "move instancer": {"placed grouped"},  # whose mesh it has
    "move camera": set(),
    "rename glass": set(),
    "edit painted": {"placed painted", "geometry painted"},
    "points": {"placed dots", "geometry dots"},
    "constant": {"material red"},
    "group": {"material grouped"},
    "paint": {"image 0"},
    "energy": set(),
    "world node": set(),
    "pass index": {"placed indexed"},
    "vertex colors": {"placed vertex colors", "geometry vertex colors"},
    "modifier off": {"placed bent", "geometry bent"},
    "hide": {"-placed painted", "-geometry painted", "image 0"},
    "rays": {"placed painted"},
    "link": {"material painted", "image 0", "placed painted", "geometry painted"},  # which needs no uv any more
}


@pytest.mark.parametrize("name", RENEWED)
def test_an_edit_renews_what_it_changes_and_nothing_else(everything, reading, name):
    verb, _, what = name.partition(" ")
    reading.read()
    expected = {
        f"material {number_of(reading, thing[9:])}" if thing.startswith("material") else thing
        for thing in RENEWED[name]
    }

    def edit():
        if name in EDITS and name not in ("rays",):
            EDITS[name](random.Random(3))
        elif verb == "move":
            move(what, random.Random(1))
        elif verb == "rename":
            objects()[what].name = "renamed"
        elif verb == "edit":
            edit_mesh(what, random.Random(1))
        else:
            objects()["painted"].visible_camera = False

    assert reading.renewed(edit) == expected


def test_what_has_as_many_primitives_replaces_what_was_there(everything, reading):
    before = reading.read()
    of = {placed.name: placed.geometry for placed in before.instances}
    shapes = before.shapes
    for name in ("painted", "ball 2"):
        move(name, random.Random(1))
    edit_mesh("painted", random.Random(1))
    radius_of_dots(random.Random(1))
    after = reading.read()
    found = {placed.name: placed.geometry for placed in after.instances}
    assert after.shapes is not shapes and after.shapes.replaces() is shapes
    for name in ("painted", "dots"):
        assert found[name] is not of[name] and found[name].replaces() is of[name]
    assert found["bent"] is of["bent"]
    link(bpy.data.meshes["ball"], "one more")
    assert reading.read().shapes.replaces is None


def test_what_is_still_there_is_not_replaced(everything, reading):
    twin = link(objects()["painted"].data, "twin")
    before = things(reading.read())
    twin.data = twin.data.copy()
    edit_mesh("twin", random.Random(1))
    after = things(reading.read())
    assert after["geometry painted"] is before["geometry painted"]
    assert after["geometry twin"].replaces is None


def test_materials_and_images_keep_their_numbers(everything, reading):
    before = reading.read()
    objects()["ball"].hide_viewport = objects()["painted"].hide_viewport = True
    reading.read()
    objects()["ball"].hide_viewport = objects()["painted"].hide_viewport = False
    given(quad("late"), plainly("late"))
    after = reading.read()
    assert len(after.materials) == len(before.materials) + 1
    assert all(a is b for a, b in zip(before.materials, after.materials, strict=False))
    assert len(after.images) == len(before.images)


def test_many_copies_stand_in_a_geometry_of_their_own(everything, reading):
    scene = reading.read()
    (cloud,) = (placed for placed in scene.instances if placed.materials is None)
    assert cloud.name == "ball" and np.array_equal(cloud.matrices, np.eye(4)[None])
    assert sum(cloud.geometry.counts().values()) == MANY


def test_warnings_are_said_again(everything, reading):
    reading.read()
    messages = list(reading.messages)
    reading.read()
    assert messages and reading.messages == messages


def test_nothing_of_a_failed_read_is_lost(everything, reading):
    reading.read()
    camera = bpy.context.scene.camera
    bpy.context.scene.camera = None
    move("painted", random.Random(1))
    with pytest.raises(Exception, match="camera"):
        reading.read()
    bpy.context.scene.camera = camera
    reading.read()


def test_after_undo_only_what_was_undone_is_renewed(everything, reading):
    reading.read()
    bpy.ops.ed.undo_push(message="before")
    move("painted", random.Random(1))
    bpy.ops.ed.undo_push(message="moved")
    reading.read()

    def undo():
        bpy.ops.ed.undo()
        reading.reader.forget()

    assert reading.renewed(undo) == {"placed painted"}


def animate(owner, path, values):
    """Let a property go through values at frames 1, 2, ..."""
    for frame, value in enumerate(values, 1):
        target, _, name = path.rpartition(".")
        target = owner.path_resolve(target) if target else owner
        setattr(target, name, value)
        owner.keyframe_insert(path, frame=frame)


def animated_transform():
    animate(objects()["painted"], "location", [(0, 0, 0), (1, 0, 0), (2, 0, 0)])
    return {"placed painted"}


def animated_material():
    animate(tree_of("red"), 'nodes["Diffuse BSDF"].inputs["Roughness"].default_value', [0.0, 0.5, 0.1])
    return {"material red"}


def animated_shape_keys():
    bent = objects()["bent"]
    bent.shape_key_add(name="basis")
    key = bent.shape_key_add(name="up")
    key.data[0].co.z = 3.0
    animate(bent.data.shape_keys, 'key_blocks["up"].value', [0.0, 0.5, 1.0])
    return {"placed bent", "geometry bent"}


def animated_armature():
    armature = link(bpy.data.armatures.new("armature"), "armature")
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    armature.data.edit_bones.new("bone").tail = (0.0, 0.0, 1.0)
    bpy.ops.object.mode_set(mode="OBJECT")
    skinned = objects()["painted"]
    skinned.vertex_groups.new(name="bone").add([0, 1], 1.0, "REPLACE")
    skinned.modifiers.new("armature", "ARMATURE").object = armature
    animate(armature.pose.bones["bone"].id_data, 'pose.bones["bone"].location', [(0, 0, 0), (1, 0, 0), (2, 0, 0)])
    return {"placed painted", "geometry painted"}


def animated_points():
    tree = bpy.data.node_groups["dots"]
    animate(tree, 'nodes["Mesh to Points"].inputs["Radius"].default_value', [0.1, 0.2, 0.3])
    return {"placed dots", "geometry dots"}


@pytest.mark.parametrize(
    "build", [animated_transform, animated_material, animated_shape_keys, animated_armature, animated_points]
)
def test_frames_renew_what_is_animated(everything, reading, build):
    expected = build()
    bpy.context.scene.frame_set(1)
    reading.read()
    expected = {f"material {number_of(reading, n[9:])}" if n.startswith("material") else n for n in expected}
    for frame in (2, 3, 1):
        assert reading.renewed(lambda frame=frame: bpy.context.scene.frame_set(frame)) == expected


def test_frames_of_a_sequence_take_one_place(everything, reading, tmp_path):
    for frame in (1, 2, 3):
        still = image(np.full((4, 4, 4), frame / 4.0), f"still {frame}")
        still.filepath_raw, still.file_format = str(tmp_path / f"frame_{frame}.png"), "PNG"
        still.save()
    texture = tree_of("painted").nodes["Image Texture"]
    texture.image = bpy.data.images.load(str(tmp_path / "frame_1.png"))
    texture.image.source = "SEQUENCE"
    texture.image_user.frame_duration, texture.image_user.use_auto_refresh = 3, True
    bpy.context.scene.frame_set(1)
    number = len(reading.read().images) - 1
    for frame in (2, 3):
        renewed = reading.renewed(lambda frame=frame: bpy.context.scene.frame_set(frame))
        assert renewed == {f"image {number}"}


def test_hair_that_changes_is_read_anew(everything, reading):
    hairy = quad("hairy")
    settings = hairy.modifiers.new("hair", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.count, settings.render_type = "HAIR", 5, "PATH"
    reading.read()
    for name, value in (("root_radius", 0.5), ("count", 7), ("hair_length", 2.0)):
        setattr(settings, name, value)
        reading.read()
    assert "geometry hairy" in things(reading.scene)
