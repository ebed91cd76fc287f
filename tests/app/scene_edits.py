# SPDX-License-Identifier: GPL-3.0-or-later
"""Random edits of what a scene holds: objects, collections, meshes, materials, lights, frames."""

import math

import bmesh
import bpy
import numpy as np

from tests.app.torture_edits import edit, link, operate

# Objects


@edit(8)
def add_shape(edits):
    shape = edits.random.choice(["sphere", "cylinder", "cone", "disc", "plane"])
    size = edits.number(0.3, 1.2)
    operate(getattr(bpy.ops.conic, f"{shape}_add"), location=edits.vector(2.5))
    bpy.context.object.scale *= size
    return shape


@edit(5)
def add_mesh(edits):
    kind = edits.random.choice(["cube", "monkey", "torus", "ico_sphere", "grid"])
    operate(getattr(bpy.ops.mesh, f"primitive_{kind}_add"), location=edits.vector(2.5))
    bpy.context.object.scale *= 0.5
    return kind


@edit(3)
def add_light(edits):
    light = bpy.data.lights.new(edits.name("Light"), edits.random.choice(["POINT", "SUN", "SPOT", "AREA"]))
    light.energy = 2.0 if light.type == "SUN" else 300.0
    lamp = link(bpy.data.objects.new(light.name, light))
    lamp.location, lamp.rotation_euler = edits.vector(5.0), edits.vector(2.0)
    return light.type


@edit(3)
def add_points(edits):
    count = edits.random.choice([1, 50, 3000])
    rng = np.random.default_rng(edits.count)
    cloud = bpy.data.pointclouds.new(edits.name("Points"))
    cloud.resize(count)
    cloud.attributes["position"].data.foreach_set("vector", rng.normal(size=3 * count).astype(np.float32))
    radius = cloud.attributes.get("radius") or cloud.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.full(count, 0.5 * count ** (-1 / 3), np.float32))
    link(bpy.data.objects.new(cloud.name, cloud)).location = edits.vector(2.0)
    return count


@edit(2)
def add_text_or_curve(edits):
    kind = edits.random.choice(["text_add", "curve.primitive_bezier_circle_add", "metaball_add"])
    if kind == "text_add":
        operate(bpy.ops.object.text_add, location=edits.vector(2.0))
    elif kind == "metaball_add":
        operate(bpy.ops.object.metaball_add, type="BALL", location=edits.vector(2.0), radius=0.8)
    else:
        operate(bpy.ops.curve.primitive_bezier_circle_add, location=edits.vector(2.0))
        bpy.context.object.data.bevel_depth = edits.number(0.02, 0.2)
    return kind


@edit(7)
def delete(edits):
    obj = edits.object()
    while obj and obj.type == "CAMERA":
        obj = edits.object("MESH", "LIGHT")
    if obj:
        name = obj.name
        bpy.data.objects.remove(obj)
        return name


@edit(1)
def delete_many(edits):
    names = [obj.name for obj in bpy.context.scene.objects if obj.type != "CAMERA" and edits.random.random() < 0.5]
    bpy.data.batch_remove([bpy.data.objects[name] for name in names])
    operate(bpy.ops.outliner.orphans_purge, do_recursive=True)
    return len(names)


@edit(4)
def duplicate(edits):
    obj, linked = edits.object("MESH", "LIGHT", "POINTCLOUD"), edits.random.random() < 0.5
    if obj:
        copy = link(obj.copy())
        copy.data = obj.data if linked else obj.data.copy()
        copy.location += edits.vector(1.5)
        return f"{obj.name}, {'linked' if linked else 'whole'}"


@edit(12)
def move(edits):
    obj = edits.object()
    if obj:
        obj.location += edits.vector(0.8)
        return obj.name


@edit(5)
def turn_and_scale(edits):
    obj = edits.object("MESH", "POINTCLOUD", "CURVE", "FONT")
    if obj:
        obj.rotation_euler = edits.vector(3.0)
        obj.scale = [edits.number(0.3, 1.2) for _ in range(3)] if edits.random.random() < 0.5 else [0.7] * 3
        return f"{obj.name} {tuple(obj.scale)}"


@edit(5)
def hide(edits):
    obj, way = edits.object(), edits.random.choice(["hide_viewport", "hide_render", "hide_set"])
    if obj and way == "hide_set":
        if obj.name in bpy.context.view_layer.objects:
            obj.hide_set(not obj.hide_get())
    elif obj:
        setattr(obj, way, not getattr(obj, way))
    return f"{way} {obj and obj.name}"


@edit(2)
def ray_visibility(edits):
    obj, way = edits.object("MESH"), edits.random.choice(["visible_camera", "visible_shadow", "is_holdout"])
    if obj:
        setattr(obj, way, not getattr(obj, way))
        return f"{way} {obj.name}"


@edit(4)
def select(edits):
    obj = edits.object()
    if obj and obj.name in bpy.context.view_layer.objects:
        obj.select_set(not obj.select_get())
        bpy.context.view_layer.objects.active = obj
        return obj.name


@edit(2)
def parent(edits):
    child, owner = edits.object("MESH"), edits.object("MESH", "EMPTY")
    if child and owner and child != owner and owner not in child.children_recursive:
        child.parent = owner if child.parent is None else None
        return f"{child.name} to {owner.name}"


# Collections


@edit(3)
def collection(edits):
    known = edits.one(bpy.data.collections)
    if known is None or edits.random.random() < 0.3:
        known = bpy.data.collections.new(edits.name("Collection"))
        bpy.context.scene.collection.children.link(known)
    # Blender refuses an instance of a collection in that collection.
    obj = edits.one(obj for obj in bpy.context.scene.objects if not obj.instance_collection)
    if obj:
        (known.objects.unlink if obj.name in known.objects else known.objects.link)(obj)
        if not obj.users_collection:
            link(obj)
    return f"{known.name}: {obj and obj.name}"


@edit(3)
def collection_shown(edits):
    layer = edits.one(bpy.context.view_layer.layer_collection.children)
    if layer:
        way = edits.random.choice(["exclude", "hide_viewport", "holdout"])
        setattr(layer, way, not getattr(layer, way))
        return f"{layer.name}.{way}"


@edit(2)
def collection_instance(edits):
    known = edits.one(bpy.data.collections)
    if known and not any(obj.instance_collection for obj in known.all_objects):
        empty = link(bpy.data.objects.new(edits.name("Instance"), None))
        empty.instance_type, empty.instance_collection = "COLLECTION", known
        empty.location = edits.vector(2.0)
        return known.name


# Meshes and modifiers


@edit(6)
def mesh_moved(edits):
    obj = edits.object("MESH")
    if obj and len(obj.data.vertices):
        shift = np.random.default_rng(edits.count).normal(scale=0.05, size=3 * len(obj.data.vertices))
        places = np.empty(len(shift), np.float32)
        obj.data.vertices.foreach_get("co", places)
        obj.data.vertices.foreach_set("co", (places + shift).astype(np.float32))
        obj.data.update()
        return obj.name


@edit(4)
def mesh_changed(edits):
    obj, way = edits.object("MESH"), edits.random.choice(["subdivide", "delete", "wire"])
    if obj and 0 < len(obj.data.polygons) < 3000:
        mesh = bmesh.new()
        mesh.from_mesh(obj.data)
        if way == "subdivide":
            bmesh.ops.subdivide_edges(mesh, edges=mesh.edges[:20], cuts=1, use_grid_fill=True)
        elif way == "delete":
            bmesh.ops.delete(mesh, geom=mesh.faces[: len(mesh.faces) // 3], context="FACES")
        else:
            bmesh.ops.wireframe(mesh, faces=mesh.faces, thickness=0.05)
        mesh.to_mesh(obj.data)
        mesh.free()
        obj.data.update()
        return f"{way} {obj.name}"


@edit(3)
def edit_mode(edits):
    """Into a mode, something done there, out again, or not at once."""
    obj, mode = edits.object("MESH"), edits.random.choice(["EDIT", "EDIT", "SCULPT", "WEIGHT_PAINT"])
    if not obj or obj.name not in bpy.context.view_layer.objects or not obj.visible_get():
        return
    name = obj.name
    bpy.context.view_layer.objects.active = obj
    if not operate(bpy.ops.object.mode_set, mode=mode):
        return
    yield
    if mode == "EDIT":
        operate(bpy.ops.mesh.select_all, action="SELECT")
        operate(bpy.ops.transform.translate, value=edits.vector(0.3))
        yield
        operate(bpy.ops.mesh.subdivide)
        yield
    operate(bpy.ops.object.mode_set, mode="OBJECT")
    return f"{mode} {name}"


@edit(5)
def modifier(edits):
    obj = edits.object("MESH")
    if not obj:
        return
    known = edits.one(obj.modifiers)
    if known and edits.random.random() < 0.6:
        known.show_viewport = not known.show_viewport
        if edits.random.random() < 0.5:
            obj.modifiers.remove(known)
        return f"{obj.name} less"
    if len(obj.modifiers) < 2 and len(obj.data.polygons) < 3000:
        kind = edits.random.choice(["ARRAY", "SUBSURF", "MIRROR", "DECIMATE", "SOLIDIFY", "WIREFRAME"])
        obj.modifiers.new(kind, kind)
        return f"{obj.name} {kind}"


# Materials


@edit(5)
def new_material(edits):
    obj = edits.object("MESH", "POINTCLOUD", "CURVE", "FONT", "META")
    if not obj:
        return
    material = bpy.data.materials.new(edits.name("Material"))
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = edits.color()
    if len(obj.data.materials):
        obj.data.materials[0] = material
    else:
        obj.data.materials.append(material)
    return f"{material.name} on {obj.name}"


@edit(8)
def material_constant(edits):
    material = edits.one(bpy.data.materials)
    bsdf = material and material.node_tree and material.node_tree.nodes.get("Principled BSDF")
    if bsdf:
        name = edits.random.choice(["Base Color", "Roughness", "Metallic", "Transmission Weight", "Emission Strength"])
        bsdf.inputs[name].default_value = (
            edits.color() if name == "Base Color" else edits.random.choice([0.0, 0.4, 1.0])
        )
        return f"{material.name}: {name}"


@edit(4)
def material_nodes(edits):
    """A texture on a socket, or its removal."""
    material = edits.one(bpy.data.materials)
    nodes = material and material.node_tree and material.node_tree.nodes
    bsdf = nodes and nodes.get("Principled BSDF")
    if not bsdf:
        return
    texture = edits.one(node for node in nodes if node.type.startswith("TEX_"))
    if texture and edits.random.random() < 0.5:
        nodes.remove(texture)
        return f"{material.name} without a texture"
    kind = edits.random.choice(["TexNoise", "TexChecker", "TexWave", "TexImage", "TexGradient"])
    texture = nodes.new(f"ShaderNode{kind}")
    if kind == "TexImage":
        texture.image = edits.one(bpy.data.images) or bpy.data.images.new("Painted", 16, 16)
    name = edits.random.choice(["Base Color", "Roughness"])
    material.node_tree.links.new(texture.outputs[0], bsdf.inputs[name])
    return f"{material.name}: {kind} to {name}"


@edit(2)
def material_removed(edits):
    material = edits.one(bpy.data.materials)
    if material:
        name = material.name
        bpy.data.materials.remove(material)
        return name


@edit(2)
def image_painted(edits):
    image = edits.one(image for image in bpy.data.images if image.type == "IMAGE" and image.size[0])
    if image:
        pixels = np.random.default_rng(edits.count).random(len(image.pixels)).astype(np.float32)
        image.pixels.foreach_set(pixels)
        image.update()
        image.update_tag()
        return image.name


# Lights, world, camera, frame


@edit(4)
def light(edits):
    lamp = edits.object("LIGHT")
    if lamp:
        lamp.data.energy *= edits.number(0.5, 1.8)
        lamp.data.color = edits.color()[:3]
        if edits.random.random() < 0.2:
            lamp.data.type = edits.random.choice(["POINT", "SUN", "SPOT", "AREA"])
        return lamp.name


@edit(3)
def world(edits):
    scene = bpy.context.scene
    if scene.world is None or edits.random.random() < 0.2:
        scene.world = None if scene.world else edits.one(bpy.data.worlds) or bpy.data.worlds.new("World")
        return f"world {scene.world and scene.world.name}"
    background = scene.world.node_tree and scene.world.node_tree.nodes.get("Background")
    if background:
        background.inputs["Color"].default_value = edits.color()
        background.inputs["Strength"].default_value = edits.number(0.0, 1.5)
    return "background"


@edit(2)
def camera(edits):
    camera = bpy.context.scene.camera
    if camera:
        camera.location += edits.vector(0.5)
        camera.data.lens = edits.number(20.0, 80.0)
        camera.data.type = edits.random.choice(["PERSP", "PERSP", "ORTHO"])
        return camera.data.type


@edit(3)
def animate(edits):
    obj = edits.object("MESH", "LIGHT")
    if obj:
        for frame in (1, 20):
            obj.location += edits.vector(0.5)
            obj.keyframe_insert("location", frame=frame)
        return obj.name


@edit(5)
def frame(edits):
    bpy.context.scene.frame_set(edits.random.randint(1, 30))
    return bpy.context.scene.frame_current


def start_scene():
    """Some of everything, lit."""
    scene = bpy.context.scene
    scene.render.engine = "CONIC"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 160, 90, 100
    scene.conic.preview_samples = scene.conic.samples = 2
    scene.view_settings.view_transform = "Standard"
    for index, shape in enumerate(("plane", "sphere", "cylinder", "cone")):
        angle = 2.0 * math.pi * index / 3.0
        place = (0.0, 0.0, -1.0) if shape == "plane" else (2.0 * math.cos(angle), 2.0 * math.sin(angle), 0.0)
        operate(getattr(bpy.ops.conic, f"{shape}_add"), location=place)
