# SPDX-License-Identifier: GPL-3.0-or-later
"""Every kind of geometry that Blender has, each built by a function of its own, and a picture of them all.

python examples/every_geometry.py --output build/every_geometry.png     with Blender as a module (bpy)
blender -b -P examples/every_geometry.py -- --output every_geometry.png

`BUILDERS` maps a name to a function `build(material)` that makes objects around the origin, about two metres wide,
and returns them; tests compare each with Cycles.
"""

import sys
from math import pi
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from examples.in_blender import arguments_given, empty_blender, finish, parser_of
from examples.painted_images import linear

SPACING = 2.6
STRAND = 0.05


def link(data, name):
    """A new object with `data` (None: an empty) in the scene."""
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def with_material(obj, material):
    obj.data.materials.append(material)
    return obj


def vertices(points, name="vertices", **attributes):
    """A mesh of vertices (n, 3) alone, each attribute (n,) a float of the points."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(points))
    mesh.attributes["position"].data.foreach_set("vector", np.asarray(points, np.float32).ravel())
    for attribute, values in attributes.items():
        mesh.attributes.new(attribute, "FLOAT", "POINT").data.foreach_set("value", np.asarray(values, np.float32))
    mesh.update()
    return mesh


def rosette(count=40, radius=0.95):
    """Points (n, 3) spread evenly over a ball's surface (a Fibonacci lattice)."""
    k = np.arange(count) + 0.5
    z, angle = 1.0 - 2.0 * k / count, k * pi * (3.0 - np.sqrt(5.0))
    across = np.sqrt(1.0 - z * z)
    return radius * np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=-1)


def prototype(kind, material, size=0.12):
    """A small mesh object that is copied, itself out of the picture."""
    adders = {
        "sphere": lambda: bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=size),
        "cylinder": lambda: bpy.ops.mesh.primitive_cylinder_add(vertices=48, radius=0.4 * size, depth=2.0 * size),
        "cone": lambda: bpy.ops.mesh.primitive_cone_add(vertices=48, radius1=size, depth=2.0 * size),
        "monkey": lambda: bpy.ops.mesh.primitive_monkey_add(size=2.0 * size),
    }
    adders[kind]()
    obj = with_material(bpy.context.object, material)
    obj.data.shade_smooth()
    return obj


def out_of_sight(obj):
    """An object that is not in the scene itself; saved all the same where particles are all that use it."""
    obj.use_fake_user = True
    for collection in obj.users_collection:
        collection.objects.unlink(obj)
    return obj


class NodeTree:
    """A geometry node tree with a geometry in and a geometry out."""

    def __init__(self, name):
        self.tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
        for direction in ("INPUT", "OUTPUT"):
            self.tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
        self.geometry = self.tree.nodes.new("NodeGroupInput").outputs[0]
        self.output = self.tree.nodes.new("NodeGroupOutput")

    def node(self, kind, inputs=None, **settings):
        """A node of type GeometryNode<kind>; `inputs`: sockets by name or number to link, or values to set."""
        node = self.tree.nodes.new(f"GeometryNode{kind}")
        for name, value in settings.items():
            setattr(node, name, value)
        for name, value in (inputs or {}).items():
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, node.inputs[name])
            else:
                node.inputs[name].default_value = value
        return node

    def attribute(self, name, data_type="FLOAT"):
        """The output socket of a named attribute."""
        node = self.node("InputNamedAttribute", {"Name": name}, data_type=data_type)
        return next(socket for socket in node.outputs if socket.enabled)

    def on(self, obj, geometry):
        """End the tree with a geometry socket and give it to an object as a modifier."""
        self.tree.links.new(geometry, self.output.inputs[0])
        obj.modifiers.new(self.tree.name, "NODES").node_group = self.tree
        return obj


def point_cloud(material):
    points = rosette(60)
    tree = NodeTree("points")
    made = tree.node("MeshToPoints", {"Mesh": tree.geometry, "Radius": tree.attribute("size")})
    made = tree.node("SetMaterial", {"Geometry": made.outputs[0], "Material": material})
    obj = link(vertices(points, size=0.05 + 0.1 * np.linspace(0.0, 1.0, len(points))), "point cloud")
    return [tree.on(obj, made.outputs[0])]


def hair_curves(material):
    """Catmull-Rom strands that swirl up from a ring, thin at both ends."""
    strands, keys = 24, 6
    curves = bpy.data.hair_curves.new("hair curves")
    curves.add_curves([keys] * strands)
    t = np.linspace(0.0, 1.0, keys)
    angle = 2.0 * pi * np.arange(strands)[:, None] / strands + 1.2 * t
    reach = 0.35 + 0.55 * np.sin(pi * t)
    points = np.stack(
        [reach * np.cos(angle), reach * np.sin(angle), np.broadcast_to(1.8 * t - 0.9, angle.shape)], axis=-1
    )
    radius = np.broadcast_to(STRAND * (0.2 + 0.8 * np.sin(pi * t)), angle.shape)
    curves.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
    curves.attributes.new("radius", "FLOAT", "POINT").data.foreach_set("value", radius.astype(np.float32).ravel())
    return [with_material(link(curves, "hair curves"), material)]


def bare_curve(material):
    """A Bezier curve without bevel: a knot whose points have radii of their own."""
    curve = bpy.data.curves.new("bare curve", "CURVE")
    curve.dimensions, curve.resolution_u = "3D", 16
    spline = curve.splines.new("BEZIER")
    spline.bezier_points.add(7)
    spline.use_cyclic_u = True
    for k, point in enumerate(spline.bezier_points):
        angle = 2.0 * pi * k / 8.0
        reach = 0.7 + 0.2 * (-1) ** k
        point.co = (reach * np.cos(angle), 0.5 * (-1) ** (k // 2), reach * np.sin(angle))
        point.radius = 1.0 + 0.5 * (-1) ** k
        point.handle_left_type = point.handle_right_type = "AUTO"
    obj = with_material(link(curve, "bare curve"), material)
    obj.conic.strand_radius = STRAND
    return [obj]


def edges_alone(material):
    """A wire cube with its diagonals: a mesh without faces."""
    corners = 0.7 * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    pairs = [(i, j) for i in range(8) for j in range(i) if np.count_nonzero(corners[i] != corners[j]) in (1, 3)]
    mesh = bpy.data.meshes.new("edges alone")
    mesh.from_pydata(corners, pairs, [])
    obj = with_material(link(mesh, "edges alone"), material)
    obj.conic.strand_radius = STRAND
    obj.rotation_euler = (0.3, 0.2, 0.5)
    return [obj]


def node_instances(material):
    """Spheres, stretched by a field, instanced by geometry nodes on the points of a mesh."""
    tree = NodeTree("node instances")
    source = tree.node("ObjectInfo", {"Object": out_of_sight(prototype("sphere", material)), "As Instance": True})
    points = tree.node("MeshToPoints", {"Mesh": tree.geometry})
    scale = tree.attribute("stretch", "FLOAT_VECTOR")
    made = tree.node(
        "InstanceOnPoints",
        {"Points": points.outputs[0], "Instance": source.outputs["Geometry"], "Scale": scale},
    )
    mesh = vertices(rosette())
    stretch = np.tile((1.0, 1.0, 1.8), (len(mesh.vertices), 1)).astype(np.float32)
    mesh.attributes.new("stretch", "FLOAT_VECTOR", "POINT").data.foreach_set("vector", stretch.ravel())
    return [tree.on(link(mesh, "node instances"), made.outputs[0])]


def collection_instances(material):
    """Two empties that show one collection of a cylinder, a cone and a sphere."""
    collection = bpy.data.collections.new("set of three")
    for kind, x in (("cylinder", -0.5), ("cone", 0.0), ("sphere", 0.5)):
        obj = out_of_sight(prototype(kind, material, 0.22))
        obj.location.x = x
        collection.objects.link(obj)
    empties = []
    for z, scale in ((0.5, (1.0, 1.0, 1.0)), (-0.5, (1.0, 1.0, -1.4))):
        empty = link(None, "collection instance")
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        empty.location.z, empty.scale = z, scale
        empties.append(empty)
    return empties


def vertex_instances(material):
    child = prototype("cylinder", material)
    parent = link(vertices(rosette(24)), "vertex instances")
    child.parent, parent.instance_type = parent, "VERTS"
    return [parent, child]


def face_instances(material):
    child = prototype("cone", material, 0.2)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.8)
    parent = with_material(bpy.context.object, material)
    child.parent, parent.instance_type = parent, "FACES"
    parent.show_instancer_for_render = parent.show_instancer_for_viewport = False
    return [parent, child]


def emitted_objects(material):
    """A particle system that shows an object."""
    emitter, system = _particles(material, "emitted objects", count=60)
    system.frame_start, system.frame_end, system.lifetime = 1, 1, 100
    system.physics_type = "NO"
    system.render_type, system.instance_object = "OBJECT", out_of_sight(prototype("sphere", material))
    system.particle_size = 1.0
    return [emitter]


def particle_hair(material):
    emitter, system = _particles(material, "particle hair", count=120, hair=True)
    system.emit_from = "VERT"
    system.hair_length, system.hair_step, system.render_step = 0.5, 4, 3
    system.root_radius, system.tip_radius, system.radius_scale = 1.0, 0.5, 0.06
    system.material = 1
    return [emitter]


def _particles(material, name, count, hair=False):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.5)
    emitter = with_material(bpy.context.object, material)
    emitter.name = name
    emitter.data.shade_smooth()
    emitter.modifiers.new(name, "PARTICLE_SYSTEM")
    settings = emitter.particle_systems[0].settings
    if hair:
        settings.type = "HAIR"
    settings.count, settings.use_emit_random = count, False
    return emitter, settings


def text(material):
    curve = bpy.data.curves.new("text", "FONT")
    curve.body, curve.extrude, curve.bevel_depth = "Conic", 0.08, 0.02
    curve.align_x, curve.align_y, curve.size = "CENTER", "CENTER", 0.9
    obj = with_material(link(curve, "text"), material)
    obj.rotation_euler.x = pi / 2.0
    return [obj]


def surface(material):
    bpy.ops.surface.primitive_nurbs_surface_torus_add(radius=1.0)
    obj = with_material(bpy.context.object, material)
    obj.scale, obj.rotation_euler = (0.5, 0.5, 0.5), (0.9, 0.0, 0.0)
    return [obj]


def metaballs(material):
    data = bpy.data.metaballs.new("metaballs")
    data.resolution = data.render_resolution = 0.06
    for x, radius in ((-0.45, 0.75), (0.35, 0.9)):
        ball = data.elements.new()
        ball.co, ball.radius = (x, 0.0, 0.3 * x), radius
    return [with_material(link(data, "metaballs"), material)]


def displaced(material):
    """A subdivided and displaced monkey."""
    obj = prototype("monkey", material, 0.8)
    obj.modifiers.new("finer", "SUBSURF").levels = 2
    obj.modifiers["finer"].render_levels = 2
    noise = bpy.data.textures.new("noise", "CLOUDS")
    noise.noise_scale = 0.3
    displace = obj.modifiers.new("rough", "DISPLACE")
    displace.texture, displace.strength, displace.mid_level = noise, 0.1, 0.5
    return [obj]


def exact_shapes(material):
    """A sheared sphere and a mirrored cone, through parents that are stretched and turned."""
    objects = []
    for kind, x in (("sphere", -0.5), ("cone", 0.5)):
        parent = link(None, "stretched parent")
        parent.scale, parent.location.x = (0.7, 1.0, 1.6), x
        child = prototype(kind, material, 0.45)
        child.parent, child.rotation_euler = parent, (0.5, 0.6, 0.0)
        child.scale.x = -1.0
        objects += [parent, child]
    return objects


BUILDERS = {
    builder.__name__: builder
    for builder in (
        point_cloud,
        hair_curves,
        bare_curve,
        edges_alone,
        node_instances,
        collection_instances,
        vertex_instances,
        face_instances,
        emitted_objects,
        particle_hair,
        text,
        surface,
        metaballs,
        displaced,
        exact_shapes,
    )
}

#: Base colors, sRGB, one for each of BUILDERS.
COLORS = (
    "d9534f",
    "f0ad4e",
    "5cb85c",
    "5bc0de",
    "428bca",
    "9b59b6",
    "e67e22",
    "1abc9c",
    "f1c40f",
    "8d6e63",
    "ec7fa9",
    "7fb3d5",
    "a3c940",
    "b0bec5",
    "ff7043",
)


def matte(name, color):
    """A Principled material of a base color (r, g, b)."""
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = 0.25
    return material


def build_scene(columns=5):
    """All geometries in rows on a floor without end, with lights and a camera."""
    scene = bpy.context.scene
    scene.render.engine = "CONIC"
    for k, ((name, build), code) in enumerate(zip(BUILDERS.items(), COLORS, strict=True)):
        row, column = divmod(k, columns)
        place = Vector(((column - (columns - 1) / 2.0) * SPACING, -row * 3.7, 1.1))
        for obj in build(matte(name, linear(code))):
            if obj.parent is None:
                obj.location += place
    _add_floor()
    _add_lights()
    scene.world = bpy.data.worlds.new("sky")
    scene.world.color = linear("aebdca")
    camera = bpy.data.cameras.new("camera")
    camera.lens = 68.0
    scene.camera = link(camera, "camera")
    scene.camera.location = (-4.0, -26.0, 17.0)
    scene.camera.rotation_euler = (Vector((0.0, -3.6, 0.7)) - scene.camera.location).to_track_quat("-Z", "Y").to_euler()
    scene.frame_set(5)  # particles are born by then
    return scene


def _add_floor():
    bpy.ops.mesh.primitive_plane_add(size=20.0)
    floor = with_material(bpy.context.object, matte("floor", linear("e8e5df")))
    floor.name, floor.conic.primitive = "floor", "PLANE"
    shader = floor.data.materials[0].node_tree.nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value = 0.5


def _add_lights():
    """A sun from the upper left and two lamps that lighten its shadows."""
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle = 3.0, 0.0
    link(sun, "sun").rotation_euler = (0.65, -0.45, 0.0)
    for location, watts in (((9.0, -18.0, 9.0), 2200.0), ((-10.0, -16.0, 5.0), 900.0)):
        lamp = bpy.data.lights.new("lamp", "POINT")
        lamp.energy, lamp.shadow_soft_size = watts, 0.0
        link(lamp, "lamp").location = location


def main():
    options = parser_of(__file__, __doc__.splitlines()[0], size=(1280, 800)).parse_args(arguments_given())
    empty_blender()
    finish(build_scene(), options)


if __name__ == "__main__":
    main()
