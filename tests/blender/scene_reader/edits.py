"""Edits of the scene of `everything`: each a function of a `random.Random`, to be done any number of times."""

import bpy
import numpy as np

from tests.blender.building import link
from tests.blender.scene_reader.everything import MANY


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
