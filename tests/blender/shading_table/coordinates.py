"""Texture coordinates, geometry, attributes, light path, normals."""

from functools import partial

import bpy

from tests.blender.building import GeometryNodes, add_camera, link, material, node, quad, with_nodes

from . import objects  # noqa: F401  # more to show on
from .case import PLACE, Node, Scene, Swatch

_ROUND = ("sphere", "cylinder", "cone", "disc")
_FLAT = ("plate", "disc")
_ON = ("plate", *_ROUND, "cube")
_COORDINATES = ("Generated", "Normal", "UV", "Object", "Camera", "Window", "Reflection")
#: A swatch has few pixels.
_OLD_BUMP = "before Blender 4.5 a bump is the difference over a whole pixel, along directions of its own"
_PIECES = "strands are cones cut where they bend: in between values run with the length, in Cycles with the parameter"
_STRETCHED = {"scale": (1.0, 0.6, 0.8)}


def _shown(kind, output, on, name="", **settings):
    of_case = {
        k: settings.pop(k)
        for k in ("constant", "reason", "tolerance", "few", "scale", "told", "of_object", "since")
        if k in settings
    }
    return Swatch(f"{name or output} on a {on}", shown=Node(kind, output, **settings), on=on, **of_case)


def _other_place():
    """The coordinates of another object, which is turned and stretched."""

    def build(tree, socket):
        other = link(None, "other", location=(0.3, -0.2, 0.5), rotation_euler=(0.3, 0.5, 0.7), scale=(0.5, 1.5, 1.0))
        bpy.context.view_layer.update()
        made = tree.nodes.new("ShaderNodeTexCoord")
        made.object = other
        tree.links.new(made.outputs["Object"], socket)

    return build


def _wave(direction, frequency):
    """A height that goes up and down through the object."""
    place = Node("VectorMath", "Value", operation="DOT_PRODUCT", feed=(Node("TexCoord", "Object"), direction))
    return Node("Math", operation="SINE", feed=(Node("Math", operation="MULTIPLY", feed=(place, frequency)),))


def _wave_of_uv(frequency):
    u = Node("SeparateXYZ", "X", Vector=Node("TexCoord", "UV"))
    return Node("Math", operation="SINE", feed=(Node("Math", operation="MULTIPLY", feed=(u, frequency)),))


def _bump(height, **settings):
    return Node("Bump", Height=height, **{"Distance": 0.02, "Strength": 0.8} | settings)


_of_place = Node("SeparateXYZ", "X", Vector=PLACE)


def _bumps():
    old = {"tolerance": 0.06, "reason": _OLD_BUMP} if bpy.app.version < (4, 5, 0) else {}
    along_x, along_y = _wave((1.0, 0.3, 0.2), 12.0), _wave((0.1, 1.0, -0.4), 15.0)
    for on in _ON:
        yield Swatch(f"bump on a {on}", shown=_bump(along_x), on=on, **old)
    for on in ("plate", "sphere", "cylinder", "disc"):
        yield Swatch(f"bump by uv on a {on}", shown=_bump(_wave_of_uv(25.0)), on=on, **old)
    yield Swatch("bump inverted", shown=_bump(along_x, invert=True), on="sphere", **old)
    yield Swatch("bump of a bump", shown=_bump(along_x, Normal=_bump(along_y)), on="sphere", **old)
    yield Swatch("bump by an attribute", shown=_bump(_of_place, Distance=0.1), constant=True)
    yield Swatch("bump on a stretched sphere", shown=_bump(along_x), on="sphere", of_object=_STRETCHED)


def _normal_maps():
    color = (0.6, 0.35, 0.85, 1.0)
    for space in ("TANGENT", "OBJECT", "WORLD", "BLENDER_OBJECT", "BLENDER_WORLD"):
        for on in ("plate", "sphere", "cylinder", "cube"):
            shown = Node("NormalMap", space=space, Color=color, Strength=0.7)
            yield Swatch(f"normal map {space} on a {on}", shown=shown, on=on, constant=on == "plate")
    strong = Node("NormalMap", Color=color, Strength=1.6)
    yield Swatch("normal map of strength 1.6", shown=strong, on="sphere")


def _tangents():
    for on in ("plate", "sphere", "cylinder", "disc"):
        flat = on in ("plate", "disc")
        shown = Node("Tangent", direction_type="UV_MAP")
        yield Swatch(f"uv tangent on a {on}", shown=shown, on=on, constant=flat)
        for axis in "Z" if flat else "XYZ":  # what is flat has no direction along it around the others
            shown = Node("Tangent", direction_type="RADIAL", axis=axis)
            yield Swatch(f"tangent around {axis} on a {on}", shown=shown, on=on)


def _transforms():
    for kind in ("POINT", "VECTOR", "NORMAL"):
        for start, end in (("OBJECT", "WORLD"), ("WORLD", "OBJECT"), ("CAMERA", "OBJECT"), ("WORLD", "CAMERA")):
            node = Node(
                "VectorTransform",
                vector_type=kind,
                convert_from=start,
                convert_to=end,
                Vector=Node("TexCoord", "Object"),
            )
            yield Swatch(f"{kind} from {start} to {end}", shown=node, on="cube", of_object=_STRETCHED)


def _infos():
    yield Swatch("Color Attribute", Node("VertexColor", "Color", layer_name="a"))
    yield Swatch("Color Attribute's alpha", Node("VertexColor", "Alpha", layer_name="b"))
    own = {"color": (0.3, 0.6, 0.9, 0.4), "pass_index": 3}
    for output in ("Location", "Color", "Alpha", "Object Index", "Random"):
        for on in ("plate", "sphere"):
            yield _shown("ObjectInfo", output, on, f"Object Info {output}", constant=True, of_object=own)


def _rays():
    for way in _WAYS:
        yield Scene(f"Light Path by way of {way}", build=partial(_seen_by, way), samples=1, few=0.1)
    yield Scene("no shadow by Is Shadow Ray", build=_without_shadow, samples=1, constant=True)


#: Outputs of Light Path, and how much of each is shown.
_PATHS = {
    "Is Camera Ray": 1.0,
    "Is Glossy Ray": 1.0,
    "Is Reflection Ray": 1.0,
    "Is Transmission Ray": 1.0,
    "Is Singular Ray": 1.0,
    "Ray Length": 0.1,
    "Ray Depth": 1.0,
    "Transparent Depth": 1.0,
}
_WAYS = ("a mirror", "glass", "two sheets", "a sheet and a mirror")


def _sheet(kind, location, **settings):
    made, tree, output = material(kind)
    node(tree, kind, output.inputs["Surface"], **settings)
    obj = quad(location=location, scale=(8.0, 8.0, 1.0))
    obj.data.materials.append(made)
    return obj


def _emits(output, scale):
    """A material that shows an output of Light Path."""
    made, tree, out = material("shows")
    emission = node(tree, "Emission", out.inputs["Surface"], Strength=1.0)
    shift = node(tree, "Math", emission.inputs["Color"])
    shift.operation = "MULTIPLY_ADD"
    shift.inputs[1].default_value, shift.inputs[2].default_value = scale, 0.2
    tree.links.new(tree.nodes.new("ShaderNodeLightPath").outputs[output], shift.inputs[0])
    return made


def _seen_by(way):
    """Strips that show the outputs of Light Path, seen from above by way of other things."""
    corner = (-4.0, -4.0)
    if "mirror" in way:
        _sheet("BsdfGlossy", (*corner, 0.0), Roughness=0.0)
    if way == "glass":
        _sheet("BsdfRefraction", (*corner, 3.0), Roughness=0.0, IOR=1.4)
    for height in {"two sheets": (3.0, 5.0), "a sheet and a mirror": (3.0,)}.get(way, ()):
        _sheet("BsdfTransparent", (*corner, height))
    for i, (output, scale) in enumerate(_PATHS.items()):
        place = (-4.0, i - 4.0, 6.0 if "mirror" in way else 0.0)
        strip = quad(location=place, scale=(8.0, 1.0, 1.0), rotation_euler=(0.0, 0.1, 0.0))
        strip.visible_camera = "mirror" not in way  # the camera looks through it at the mirror
        strip.data.materials.append(_emits(output, scale))
    add_camera(lens=80.0 if "mirror" in way else 50.0)


def _without_shadow():
    """A roof that lets shadow rays through, over a floor in the sun."""
    _sheet("BsdfDiffuse", (-4.0, -4.0, 0.0))
    roof = quad(location=(-1.0, -1.0, 2.0), scale=(1.0, 2.0, 1.0))
    made, tree, output = material("roof")
    mix = node(tree, "MixShader", output.inputs["Surface"])
    tree.links.new(tree.nodes.new("ShaderNodeLightPath").outputs["Is Shadow Ray"], mix.inputs[0])
    node(tree, "BsdfDiffuse", mix.inputs[1])
    node(tree, "BsdfTransparent", mix.inputs[2])
    roof.data.materials.append(made)
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle = 2.0, 0.0
    link(sun, "sun", rotation_euler=(0.3, 0.4, 0.0))
    add_camera(lens=80.0)


def _angles():
    for on in ("sphere", "cylinder", "cube"):
        for ior in (0.7, 1.45):
            yield Swatch(f"Fresnel {ior} on a {on}", shown=Node("Fresnel", IOR=ior), on=on)
        for blend in (0.2, 0.5, 0.9):
            for output in ("Fresnel", "Facing"):
                yield Swatch(
                    f"Layer Weight {output} {blend} on a {on}", shown=Node("LayerWeight", output, Blend=blend), on=on
                )
    for output in ("Normal", "Dot"):
        given = Node("NewGeometry", "Normal")
        yield Swatch(
            f"Normal node {output}",
            shown=Node("Normal", output, Normal=given, then=_direct),
            on="sphere",
            constant=output == "Normal",
        )


def _of_clouds_and_strands():
    """Point clouds, whose points a mesh has no like of, and strands."""
    clouds = {} if "resize" in bpy.types.PointCloud.bl_rna.functions else {"since": (99,)}  # none can be made
    for output in ("Generated", "Normal", "Object", "Camera"):
        yield _shown("TexCoord", output, "points", f"{output} coordinates", **clouds)
        bent = {"tolerance": 0.05, "reason": _PIECES} if output == "Normal" else {}
        yield _shown("TexCoord", output, "strands", f"{output} coordinates", **bent)
    for output in ("Position", "Radius", "Random"):
        yield _shown("PointInfo", output, "points", f"Point Info {output}", **clouds)
    for output in ("Is Strand", "Intercept", "Length", "Thickness", "Tangent Normal", "Random"):
        bent = {"tolerance": 0.05, "few": 0.35, "reason": _PIECES} if output == "Intercept" else {}
        yield _shown("HairInfo", output, "strands", f"Hair Info {output}", constant=output == "Is Strand", **bent)


def _of_meshes():
    for output in ("Generated", "Object", "UV"):
        yield _shown("TexCoord", output, "bent", f"{output} coordinates")
    for name in ("UVMap", "other"):
        yield _shown("UVMap", "UV", "two maps", f"UV Map {name}", uv_map=name)
    both = Node("VectorMath", operation="ADD", feed=(Node("UVMap", uv_map="other"), Node("UVMap", uv_map="UVMap")))
    yield Swatch("two uv maps at once", shown=both, on="two maps")
    shown = Node("Tangent", direction_type="UV_MAP", uv_map="other")
    yield Swatch("tangent of another uv map", shown=shown, on="two maps")


def _worlds():
    for output in _COORDINATES:
        for orthographic in (False, True) if output in ("Generated", "Window", "Camera") else (False,):
            name = f"{output} coordinates of the world, {'orthographic' if orthographic else 'perspective'}"
            build = partial(_world_showing, "TexCoord", output, orthographic)
            yield Scene(name, build=build, samples=1, constant=(orthographic and output != "Window") or output == "UV")
    for output in ("Position", "Normal", "Incoming"):
        yield Scene(f"{output} of the world", build=partial(_world_showing, "NewGeometry", output, False), samples=1)
    for output in ("View Vector", "View Z Depth", "View Distance"):
        yield Scene(f"{output} of the world", build=partial(_world_showing, "CameraData", output, False), samples=1)
    for output in ("Ray Depth", "Is Camera Ray"):
        build = partial(_world_showing, "LightPath", output, False)
        yield Scene(f"{output} of the world", build=build, samples=1, constant=True)


def _world_showing(kind, output, orthographic):
    """A world that shows an output of a node."""
    world = bpy.context.scene.world = bpy.data.worlds.new("world")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    background = node(tree, "Background", node(tree, "OutputWorld").inputs["Surface"], Strength=1.0)
    shift = node(tree, "VectorMath", background.inputs["Color"])
    shift.operation = "MULTIPLY_ADD"
    shift.inputs[1].default_value, shift.inputs[2].default_value = (0.25,) * 3, (1.0,) * 3
    tree.links.new(tree.nodes.new(f"ShaderNode{kind}").outputs[output], shift.inputs[0])
    bpy.context.scene.render.film_transparent = False
    camera = add_camera(type="ORTHO" if orthographic else "PERSP", ortho_scale=3.0, lens=20.0)
    camera.location, camera.rotation_euler = (2.0, -1.0, 0.5), (1.2, 0.2, 0.6)


def _instances():
    for output in ("Generated", "Normal", "UV", "Object"):
        build = partial(_of_instances, "TexCoord", output)
        yield Scene(
            f"{output} coordinates of instances",
            build=build,
            samples=16,
            few=0.2,
            since=(5, 2) if output == "UV" else (4, 5),
        )
    for kind, output in (("TexCoord", "Window"), ("TexCoord", "Camera"), ("CameraData", "View Distance")):
        build = partial(_in_perspective, kind, output)
        yield Scene(f"{output} in perspective", build=build, samples=1, few=0.1)


def _shows(kind, output):
    """A material that shows an output of a node."""
    made, tree, out = material("shows")
    emission = node(tree, "Emission", out.inputs["Surface"], Strength=1.0)
    shift = node(tree, "VectorMath", emission.inputs["Color"])
    shift.operation = "MULTIPLY_ADD"
    shift.inputs[1].default_value, shift.inputs[2].default_value = (0.25,) * 3, (1.0,) * 3
    tree.links.new(tree.nodes.new(f"ShaderNode{kind}").outputs[output], shift.inputs[0])
    return made


def _of_instances(kind, output):
    """Balls, turned and stretched in different ways, that geometry nodes put on points."""
    nodes = GeometryNodes()
    ball = nodes.add("MeshUVSphere", Segments=64, Rings=32, Radius=0.4)
    uv = ball.node.outputs["UV Map"]
    ball = nodes.stored(ball, "UVMap", uv, "FLOAT2", "CORNER")
    ball = nodes.add("SetShadeSmooth", Geometry=ball)
    ball = nodes.add("SetMaterial", Geometry=ball, Material=_shows(kind, output))
    points = nodes.add("MeshGrid", Size_X=3.0, Size_Y=2.0, Vertices_X=4, Vertices_Y=3)
    place = nodes.tree.nodes.new("GeometryNodeInputPosition").outputs[0]
    made = nodes.add("InstanceOnPoints", Points=points, Instance=ball, Scale=(0.9, 0.7, 1.1))
    nodes.tree.links.new(place, made.node.inputs["Rotation"])
    nodes.output(made)
    with_nodes(nodes)
    add_camera(lens=150.0)


def _in_perspective(kind, output):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.5, segments=128, ring_count=64)
    bpy.context.object.data.shade_smooth()
    bpy.context.object.data.materials.append(_shows(kind, output))
    camera = add_camera(lens=50.0, shift_x=0.1)
    camera.location, camera.rotation_euler = (2.0, -5.0, 1.0), (1.4, 0.2, 0.35)


def _lit_normals():
    bump = _bump(_wave((1.0, 0.3, 0.2), 12.0), Distance=0.05)
    told = Node("NormalMap", Color=(0.65, 0.4, 0.85, 1.0))
    for name, shown, few in (("bump", bump, 0.15), ("normal map", told, 0.1)):
        build = partial(_lit, "BsdfDiffuse", shown)
        yield Scene(f"diffuse with a {name} under the sun", build=build, few=few)
        glossy = partial(_lit, "BsdfGlossy", shown)
        yield Scene(f"glossy with a {name} under the sun", build=glossy, samples=64, few=few)


def _lit(kind, shown):
    """A ball whose normals a node tells."""
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1.5, segments=128, ring_count=64)
    bpy.context.object.data.shade_smooth()
    made, tree, output = material("lit")
    shader = node(tree, kind, output.inputs["Surface"])
    shader.inputs["Roughness"].default_value = 0.0 if kind == "BsdfDiffuse" else 0.4
    tree.links.new(shown.build(tree), shader.inputs["Normal"])
    bpy.context.object.data.materials.append(made)
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle = 2.0, 0.0
    link(sun, "sun", rotation_euler=(0.3, 0.4, 0.0))
    add_camera(lens=80.0)


def _direct(node):
    node.outputs["Normal"].default_value = (0.3, -0.5, 0.9)


def _coordinates():
    for output in _COORDINATES:
        for on in _ON:
            constant = on in _FLAT and output in ("Normal", "Reflection")
            yield _shown("TexCoord", output, on, f"{output} coordinates", constant=constant)
            if output in ("Generated", "Normal", "Object"):
                name = f"{output} coordinates of a stretched one"
                yield _shown("TexCoord", output, on, name, constant=constant, of_object=_STRETCHED)
    for on in ("plate", "sphere"):
        yield Swatch(f"coordinates of another object on a {on}", shown=_other_place(), on=on)


def _geometries():
    for output in ("Position", "Normal", "Tangent", "Incoming", "True Normal"):
        for on in _ON:
            if output != "True Normal" or on not in _ROUND:
                constant = output == "Incoming" or (on in _FLAT and "Normal" in output)
                yield _shown("NewGeometry", output, on, constant=constant)
    yield _shown("NewGeometry", "Parametric", "plate", few=0.35, reason="pixels lie on the diagonals of quads")
    for name, angle in (("front", 0.0), ("back", 3.0)):
        shown = Node("Math", operation="ADD", feed=(Node("NewGeometry", "Backfacing"), 0.5))
        of_object = {"rotation_euler": (angle, 0.0, 0.0)}
        yield Swatch(f"Backfacing of a {name}", shown=shown, of_object=of_object, constant=True)
    for output in ("View Vector", "View Z Depth", "View Distance"):
        for on in ("plate", "sphere"):
            constant = on == "plate" and output == "View Z Depth"
            yield _shown("CameraData", output, on, constant=constant)
    for output in ("Normal", "Reflection"):
        of_object = {"rotation_euler": (3.0, 0.2, 0.0)}
        yield _shown("TexCoord", output, "plate", f"{output} coordinates of a back", of_object=of_object, constant=True)


CASES = [
    *_coordinates(),
    *_geometries(),
    *_infos(),
    *_rays(),
    *_angles(),
    *_tangents(),
    *_normal_maps(),
    *_bumps(),
    *_transforms(),
    *_of_clouds_and_strands(),
    *_of_meshes(),
    *_worlds(),
    *_instances(),
    *_lit_normals(),
]
