"""Scenes for the tests of the sync, built through bpy, and what the sync makes of them."""

from dataclasses import dataclass, field

import bpy
import numpy as np

from addon.engine.expression import Call, Parameter, as_type, expression, in_order, is_constant
from addon.engine.operators import OPERATORS
from addon.engine.scene import Material
from addon.sync.scene_sync import sync_scene


@dataclass
class Synced:
    """An engine scene and the messages (level, text) of its sync."""

    scene: object
    messages: list = field(default_factory=list)

    def warnings(self, *words):
        """The warnings that contain all of the words."""
        return [text for level, text in self.messages if level == "WARNING" and all(word in text for word in words)]


def sync(width=64, height=48, **settings):
    """The engine scene of Blender's scene; `settings` of `sync_scene`."""
    synced = Synced(None)
    synced.scene = sync_scene(
        bpy.context.evaluated_depsgraph_get(),
        width,
        height,
        report=lambda *message: synced.messages.append(message),
        **settings,
    )
    return synced


@dataclass(frozen=True)
class Constants:
    """The members of an engine Material as numbers and colours, as `material.diffuse`; what varies is an Expression."""

    material: object

    def __getattr__(self, name):
        value = getattr(self.material, name)
        if not is_constant(value):
            return value
        default = getattr(Material(), name)
        numbers = as_type(value, "vec3" if isinstance(default, tuple) else "float").value
        return numbers if len(numbers) == 3 else type(default)(numbers[0])


def value_of(value, **functions):
    """An Expression in float64 (n,). `functions`: what functions of GLSL give, by their names, as numbers."""
    known = {}
    for each in in_order((expression(value),)):
        inputs = [known[id(x)] for x in getattr(each, "inputs", ())]
        if not isinstance(each, Call):
            result = getattr(each, "value", None)
        elif each.name in functions:
            result = as_type(Parameter(functions[each.name]), each.type).value
        elif each.name not in OPERATORS:
            result = None  # what only such functions take
        else:
            twin = OPERATORS[each.name].twin
            result = twin(*map(np.array, inputs)) if twin else inputs[0]  # those without one are conversions
            result = as_type(Parameter(result), each.type).value
        known[id(each)] = result
    return np.array(known[id(each)])


def link(data, name="object", **settings):
    """An object with `data`, in the scene."""
    obj = bpy.data.objects.new(name, data)
    for key, value in settings.items():
        setattr(obj, key, value)
    bpy.context.collection.objects.link(obj)
    return obj


def add_camera(**settings):
    data = bpy.data.cameras.new("camera")
    for key, value in settings.items():
        setattr(data, key, value)
    bpy.context.scene.camera = link(data, "camera", location=(0.0, 0.0, 10.0))
    return bpy.context.scene.camera


def mesh_of(vertices, faces, name="mesh"):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.update()
    return mesh


def quad(name="quad", **settings):
    """A quad from (0, 0) to (1, 1), with the unit square as its uv map."""
    mesh = mesh_of([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)], name)
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", np.array([0, 0, 1, 0, 1, 1, 0, 1], np.float32))
    return link(mesh, name, **settings)


def material(name="material"):
    """A material whose tree holds nothing but its output: (material, tree, output node)."""
    made = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    made.node_tree.nodes.clear()
    return made, made.node_tree, made.node_tree.nodes.new("ShaderNodeOutputMaterial")


def node(tree, kind, to=None, output=0, **inputs):
    """A node of the type ShaderNode<kind>; its inputs by their names, its output linked to the socket `to`."""
    made = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in inputs.items():
        made.inputs[name.replace("_", " ")].default_value = value
    if to is not None:
        tree.links.new(made.outputs[output], to)
    return made


def shaded(build):
    """(`Constants` of the engine material, `Synced`) of a quad whose tree `build(tree, output node)` makes."""
    add_camera()
    made, tree, output = material("stuff")
    build(tree, output)
    quad().data.materials.append(made)
    synced = sync()
    (instance,) = synced.scene.instances
    return Constants(synced.scene.materials[instance.materials[0]]), synced


def of_node(kind, **inputs):
    """`Constants` of the engine material of one shader node alone; it must not be reported."""
    read, synced = shaded(lambda tree, output: node(tree, kind, output.inputs["Surface"], **inputs))
    assert not synced.messages
    return read


def image(pixels, name="image", **settings):
    """A generated image of pixels (h, w, 4) as they stand in its file."""
    pixels = np.asarray(pixels, np.float32)
    made = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], alpha=True, **settings)
    made.pixels.foreach_set(pixels.ravel())
    made.update()
    return made


def triangles_of(instance):
    """The Triangles of an instance that has nothing else."""
    ((_, triangles),) = instance.geometry.kinds()
    return triangles


def shapes_of(scene):
    """The primitives in world space by kind."""
    return {part.kind: part for _, part in scene.shapes.kinds()}


class GeometryNodes:
    """A tree of geometry nodes; what is joined to `output` leaves it."""

    def __init__(self, name="nodes"):
        self.tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
        for direction in ("INPUT", "OUTPUT"):
            self.tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
        self.own = self.tree.nodes.new("NodeGroupInput").outputs[0]
        self._join = self.add("JoinGeometry")
        self.tree.links.new(self._join, self.tree.nodes.new("NodeGroupOutput").inputs[0])

    def add(self, kind, output=0, **inputs):
        """An output of a new node of the type GeometryNode<kind>; its inputs by name get values, or sockets to link."""
        made = self.tree.nodes.new(kind if kind.startswith("FunctionNode") else f"GeometryNode{kind}")
        for name, value in inputs.items():
            socket = made.inputs[name.replace("_", " ")]
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
            else:
                socket.default_value = value
        return made.outputs[output]

    def object(self, obj):
        """An object, as an instance."""
        return self.add("ObjectInfo", "Geometry", Object=obj, As_Instance=True)

    def output(self, *sockets):
        """Let geometry out; the tree."""
        for socket in sockets:
            self.tree.links.new(socket, self._join.node.inputs[0])
        return self.tree

    def named(self, name, data_type="FLOAT"):
        """The values of a named attribute."""
        made = self.tree.nodes.new("GeometryNodeInputNamedAttribute")
        made.data_type = data_type
        made.inputs["Name"].default_value = name
        return next(socket for socket in made.outputs if socket.enabled)

    def stored(self, geometry, name, value, data_type="FLOAT", domain="POINT"):
        """Geometry with a named attribute, `value` a number or a socket."""
        made = self.tree.nodes.new("GeometryNodeStoreNamedAttribute")
        made.data_type, made.domain = data_type, domain
        self.tree.links.new(geometry, made.inputs["Geometry"])
        made.inputs["Name"].default_value = name
        socket = next(s for s in made.inputs if s.name == "Value" and s.enabled)
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value
        return made.outputs[0]


def with_nodes(nodes, name="host", data=None, **settings):
    """An object with the tree of `GeometryNodes` as its modifier."""
    obj = link(data or bpy.data.meshes.new(name), name, **settings)
    obj.modifiers.new("nodes", "NODES").node_group = nodes.tree
    return obj


def parts(read):
    """The primitives of a `Read` by kind."""
    return {part.kind: part for _, part in read.geometry.kinds()}
