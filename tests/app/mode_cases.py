"""What the tests of modes edit: the `Case`s of test_viewport_modes.py by name. Scripts run in Blender's window."""

from dataclasses import dataclass

#: Names that the scripts below use, and what they begin with: an empty place in the middle.
TOOLS = """
import math
import bmesh
import numpy as np

def link(name, data):
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    return obj

def activate(*objects):
    bpy.context.view_layer.objects.active = objects[0]
    for each in bpy.context.view_layer.objects:
        each.select_set(each in objects)
    return objects[0]

def shown(name, color=(0.02, 0.6, 0.02)):
    material = bpy.data.materials.new(name)
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1.0)
    bpy.context.object.data.materials.append(material)
    return bpy.context.object

def call(operator, *arguments, **options):
    with bpy.context.temp_override(**view_parts()):
        return operator(*arguments, **options)

def cube(size=2.0, **options):
    call(bpy.ops.mesh.primitive_cube_add, size=size, **options)
    return shown("Cube")

def grid(**options):
    call(bpy.ops.mesh.primitive_grid_add, x_subdivisions=24, y_subdivisions=24, size=3.0, **options)
    return shown("Grid")

def modifier(kind, **settings):
    made = bpy.context.object.modifiers.new(kind, kind)
    for name, value in settings.items():
        setattr(made, name, value)
    return made

def nodes(*kinds):
    "A tree of geometry nodes, a chain of nodes of these kinds on the object; the nodes."
    tree = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    chain = [tree.nodes.new(kind) for kind in ("NodeGroupInput", *kinds, "NodeGroupOutput")]
    for left, right in zip(chain, chain[1:]):
        tree.links.new(left.outputs[0], right.inputs[0])
    modifier("NODES", node_group=tree)
    return chain[1:-1]

def copied_by_nodes(obj, as_instance):
    "Another object whose geometry nodes show `obj`."
    holder = activate(link("Holder", bpy.data.meshes.new("Holder")))
    info, = nodes("GeometryNodeObjectInfo")
    tree = bpy.context.object.modifiers[0].node_group
    tree.links.new(info.outputs["Geometry"], tree.nodes["Group Output"].inputs[0])
    info.inputs["Object"].default_value, info.inputs["As Instance"].default_value = obj, as_instance
    holder.location.z = 1.5
    return activate(obj)

def hair(count=60):
    call(bpy.ops.object.particle_system_add)
    system = bpy.context.object.particle_systems[0].settings
    system.type, system.count, system.hair_length, system.root_radius = "HAIR", count, 1.0, 4.0
    return bpy.context.object

def hair_curves(count=40, points=6):
    "Strands that stand upright in a square."
    data = bpy.data.hair_curves.new("Strands")
    data.add_curves([points] * count)
    rng = np.random.default_rng(1)
    root = np.repeat(np.insert(rng.uniform(-1.2, 1.2, (count, 2)), 2, 0.0, axis=1), points, axis=0)
    root[:, 2] += np.tile(np.linspace(0.0, 1.5, points), count)
    data.attributes["position"].data.foreach_set("vector", root.astype(np.float32).reshape(-1))
    radius = data.attributes.get("radius") or data.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.full(count * points, 0.03, np.float32))
    activate(link("Strands", data))
    return shown("Strands")

def points(count=60):
    cloud = bpy.data.pointclouds.new("Points")
    cloud.resize(count)
    places = np.random.default_rng(1).uniform(-1.2, 1.2, (count, 3)).astype(np.float32)
    cloud.attributes["position"].data.foreach_set("vector", places.reshape(-1))
    radius = cloud.attributes.get("radius") or cloud.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", np.full(count, 0.12, np.float32))
    activate(link("Points", cloud))
    return shown("Points")

def painted(mesh, domain="CORNER"):
    "A color attribute of the mesh that its material shows."
    colors = mesh.color_attributes.new("Paint", "FLOAT_COLOR", domain)
    colors.data.foreach_set("color", np.tile((0.0, 0.5, 0.0, 1.0), len(colors.data)).astype(np.float32))
    mesh.color_attributes.active_color = colors
    tree = mesh.materials[0].node_tree
    paint = tree.nodes.new("ShaderNodeVertexColor")
    tree.links.new(paint.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])

def strength(settings, size=60):
    unified = getattr(settings, "unified_paint_settings", bpy.context.scene.tool_settings.unified_paint_settings)
    unified.use_unified_size = True
    unified.size = size

bpy.data.objects["green"].hide_viewport = True
before = set(bpy.data.objects)
space, turned = view(), view().region_3d
space.overlay.show_overlays = space.show_gizmo = False
space.show_region_toolbar = space.show_region_header = space.show_region_tool_header = space.show_region_ui = False
"""

#: Back to where TOOLS began.
LEAVE = """
if bpy.context.object and bpy.context.object.mode != "OBJECT":
    call(bpy.ops.object.mode_set, mode="OBJECT")
for each in set(bpy.data.objects) - before:
    bpy.data.objects.remove(each)
bpy.data.objects["green"].hide_viewport = False
space.overlay.show_overlays = space.show_region_toolbar = space.show_region_header = True
bpy.context.scene.tool_settings.use_proportional_edit = False
"""

MOVE = "call(bpy.ops.transform.translate, value=(0.7, 0.0, 0.3))"
MOVE_ALL = f"call(bpy.ops.mesh.select_all, action='SELECT'); {MOVE}"
ALL_OF_CURVE = f"call(bpy.ops.curve.select_all, action='SELECT'); {MOVE}"
ALL_OF_STRANDS = f"call(bpy.ops.curves.select_all, action='SELECT'); {MOVE}"
SOME = """
mesh = bmesh.from_edit_mesh(bpy.context.object.data)
for vertex in mesh.verts:
    vertex.select = vertex.co.x > 0.2
mesh.select_flush(True)
bmesh.update_edit_mesh(bpy.context.object.data)
call(bpy.ops.transform.translate, value=(0.6, 0.0, 0.4))
"""
STROKE = "STROKE"  # with the mouse, over the middle


@dataclass(frozen=True)
class Case:
    """A script that builds what is edited and makes it active, the mode, and what is done there: a script, or STROKE.

    `hides`: whether Blender itself, with any engine, hides in the mode what is edited: it is seen afterwards.
    """

    build: str
    mode: str = "EDIT"
    edit: str = MOVE_ALL
    hides: bool = False


CASES = {
    # Meshes
    "mesh": Case("cube()", edit=SOME),
    "mesh with a material of each face": Case(
        """
        cube()
        shown("Another", (0.02, 0.5, 0.6))
        for polygon in bpy.context.object.data.polygons:
            polygon.material_index = polygon.index % 2
    """,
        edit=SOME,
    ),
    "exact sphere": Case("call(bpy.ops.conic.sphere_add); shown('Sphere')"),
    "exact sphere, deformed": Case("call(bpy.ops.conic.sphere_add); shown('Sphere')", edit=SOME),
    "subdivision surface": Case("cube(); modifier('SUBSURF', levels=3)", edit=SOME),
    "subdivision surface by simplify": Case(
        """
        cube(); modifier("SUBSURF", levels=3)
        bpy.context.scene.render.use_simplify, bpy.context.scene.render.simplify_subdivision = True, 1
    """,
        edit=SOME + "\nbpy.context.scene.render.use_simplify = False",
    ),
    "array": Case("cube(0.8); modifier('ARRAY', count=3)", edit=SOME),
    "mirror": Case("cube(1.0, location=(0.8, 0.0, 0.0)); modifier('MIRROR')"),
    "shape key": Case(
        """
        obj = cube()
        obj.shape_key_add(); key = obj.shape_key_add()
        key.value, obj.active_shape_key_index, obj.use_shape_key_edit_mode = 1.0, 1, True
    """,
        edit=SOME,
    ),
    "edges as strands": Case("""
        activate(link("Wire", bpy.data.meshes.new("Wire")))
        bpy.context.object.data.from_pydata([(-1, 0, 0), (0, 0, 1), (1, 0, 0)], [(0, 1), (1, 2)], [])
        bpy.context.object.conic.strand_radius = 0.1; shown("Wire")
    """),
    "uv and image": Case(
        """
        image = bpy.data.images.new("Spots", 8, 8)
        image.pixels.foreach_set(np.random.default_rng(2).random(256).astype(np.float32))
        obj = cube(); tree = obj.data.materials[0].node_tree; node = tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        tree.links.new(node.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
    """,
        edit="call(bpy.ops.mesh.select_all, action='SELECT'); call(bpy.ops.uv.cube_project, cube_size=0.4)",
    ),
    "generated coordinates": Case(
        """
        obj = cube(); tree = obj.data.materials[0].node_tree; node = tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(node.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
    """,
        edit=SOME,
    ),
    "several objects at once": Case("""
        left = cube(0.8, location=(-0.8, 0.0, 0.0)); right = cube(0.8, location=(0.8, 0.0, 0.0))
        activate(left, right)
    """),
    "objects that share a mesh": Case(
        """
        obj = cube(0.8); link("Copy", obj.data).location = (0.0, 1.0, 1.2)
        activate(obj)
    """,
        edit=SOME,
    ),
    # Instances of what is edited
    "in an instanced collection": Case(
        """
        obj = cube(0.8); made = bpy.data.collections.new("Made"); made.objects.link(obj)
        empty = link("Instance", None); empty.instance_type, empty.instance_collection = "COLLECTION", made
        empty.location = (0.0, 1.0, 1.2)
        activate(obj)
    """,
        edit=SOME,
    ),
    "on vertices of its parent": Case("""
        parent = cube(1.6); child = cube(0.3); child.parent = parent; parent.instance_type = "VERTS"
        activate(child)
    """),
    "parent with children on its vertices": Case(
        """
        parent = cube(1.6); child = cube(0.3); child.parent = parent; parent.instance_type = "VERTS"
        activate(parent)
    """,
        edit=SOME,
    ),
    "instanced by geometry nodes": Case("copied_by_nodes(cube(0.8), True)", edit=SOME),
    "joined by geometry nodes": Case("copied_by_nodes(cube(0.8), False)", edit=SOME),
    "points by geometry nodes": Case("""
        cube(); made, = nodes("GeometryNodeMeshToPoints")
        made.inputs["Radius"].default_value = 0.3
    """),
    "instances on its own points": Case(
        """
        cube(); made, = nodes("GeometryNodeInstanceOnPoints")
        tree = bpy.context.object.modifiers[0].node_group; ball = tree.nodes.new("GeometryNodeMeshUVSphere")
        ball.inputs["Radius"].default_value = 0.4; tree.links.new(ball.outputs[0], made.inputs["Instance"])
    """,
        edit=SOME,
    ),
    "particles that show an object": Case("""
        ball = cube(0.3); grid(); hair(30)
        system = bpy.context.object.particle_systems[0].settings
        system.render_type, system.instance_object, system.particle_size = "OBJECT", ball, 1.0
        activate(ball)
    """),
    # Hair
    "what hair grows on": Case("grid(); hair()", hides=True),
    "what hair grows on, its roots' coordinates seen": Case(
        """
        grid(); hair(); tree = bpy.context.object.data.materials[0].node_tree
        node = tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(node.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
    """,
        hides=True,
    ),
    "particle edit": Case("grid(); hair()", "PARTICLE_EDIT", STROKE, hides=True),
    "hair curves in Edit Mode": Case("hair_curves()", edit=ALL_OF_STRANDS),
    "hair curves, sculpted": Case("hair_curves()", "SCULPT_CURVES", STROKE),
    # What is no mesh
    "curve with a bevel": Case(
        """
        call(bpy.ops.curve.primitive_bezier_circle_add); bpy.context.object.data.bevel_depth = 0.2; shown("Curve")
    """,
        edit=ALL_OF_CURVE,
    ),
    "curve as a strand": Case(
        """
        call(bpy.ops.curve.primitive_bezier_curve_add); bpy.context.object.conic.strand_radius = 0.1; shown("Curve")
    """,
        edit=ALL_OF_CURVE,
    ),
    "NURBS surface": Case(
        """
        call(bpy.ops.surface.primitive_nurbs_surface_torus_add); shown("Surface")
    """,
        edit=ALL_OF_CURVE,
    ),
    "metaballs": Case(
        "call(bpy.ops.object.metaball_add, type='BALL'); shown('Meta')",
        edit=f"call(bpy.ops.mball.select_all, action='SELECT'); {MOVE}",
    ),
    "text": Case(
        "call(bpy.ops.object.text_add); bpy.context.object.data.extrude = 0.1; shown('Text')",
        edit="call(bpy.ops.font.text_insert, text=' and more')",
    ),
    "lattice": Case(
        """
        obj = grid(); call(bpy.ops.object.add, type="LATTICE"); lattice = bpy.context.object
        lattice.scale = (4, 4, 4); activate(obj); modifier("LATTICE", object=lattice); activate(lattice)
    """,
        edit=f"call(bpy.ops.lattice.select_all, action='SELECT'); {MOVE}",
    ),
    "armature": Case(
        """
        obj = cube(0.8); call(bpy.ops.object.armature_add); bones = bpy.context.object
        obj.parent, obj.parent_type, obj.parent_bone = bones, "BONE", "Bone"; activate(bones)
    """,
        "POSE",
        f"call(bpy.ops.pose.select_all, action='SELECT'); {MOVE}",
    ),
    "point cloud": Case("points()", edit=f"call(bpy.ops.pointcloud.select_all, action='SELECT'); {MOVE}"),
    # Brushes
    "sculpted": Case("grid()", "SCULPT", STROKE),
    "sculpted exact sphere": Case("call(bpy.ops.conic.sphere_add); shown('Sphere')", "SCULPT", STROKE),
    "sculpted with modifiers": Case("grid(); modifier('SUBSURF', levels=1)", "SCULPT", STROKE),
    "sculpted multiresolution": Case(
        """
        grid(); modifier("MULTIRES"); call(bpy.ops.object.multires_subdivide, modifier="MULTIRES")
    """,
        "SCULPT",
        STROKE,
        hides=True,
    ),
    "sculpted, dynamic topology": Case(
        "grid()", "SCULPT", "call(bpy.ops.sculpt.dynamic_topology_toggle)\nSTROKE", hides=True
    ),
    "weights painted that shape it": Case(
        """
        obj = grid(); group = obj.vertex_groups.new(name="Group"); group.add([0], 1.0, "ADD")
        modifier("DISPLACE", strength=0.8, mid_level=0.0, vertex_group="Group")
    """,
        "WEIGHT_PAINT",
        STROKE,
    ),
    "vertices painted": Case("painted(grid().data)", "VERTEX_PAINT", STROKE),
    "vertices painted, modifiers after": Case(
        """
        painted(grid().data); modifier("SUBSURF", levels=1)
    """,
        "VERTEX_PAINT",
        STROKE,
    ),
    "texture painted": Case(
        """
        obj = grid(); image = bpy.data.images.new("Canvas", 64, 64)
        image.generated_color = (0.8, 0.8, 0.1, 1.0); tree = obj.data.materials[0].node_tree
        node = tree.nodes.new("ShaderNodeTexImage"); node.image = image; tree.nodes.active = node
        settings = bpy.context.scene.tool_settings.image_paint; settings.mode, settings.canvas = "IMAGE", image
        tree.links.new(node.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
    """,
        "TEXTURE_PAINT",
        STROKE,
    ),
}
