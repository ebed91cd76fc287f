"""Every kind of geometry against Cycles in the same Blender: the same silhouette, the same object under each pixel."""

import bpy
import numpy as np
import pytest

from examples import every_geometry
from examples.every_geometry import BUILDERS, COLORS, STRAND
from examples.painted_images import linear
from tests.blender.building import add_camera, link, material, mesh_of, node
from tests.blender.pictures import picture

SIZE = 160


def glowing(name, color):
    """A material that shows a color (r, g, b) as it is."""
    made, tree, output = material(name)
    node(tree, "Emission", output.inputs["Surface"], Color=(*color, 1.0), Strength=1.0)
    return made


def rendered(engine, folder, width=SIZE, height=SIZE):
    """The picture (height, width, 4) by an engine, one ray through the middle of each pixel, no background."""
    scene = bpy.context.scene
    scene.world = None
    render = scene.render
    render.engine, render.film_transparent = engine, True
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.image_settings.color_mode = "RGBA"
    render.filepath = str(folder / f"{engine}.exr")
    scene.conic.samples = 1
    scene.cycles.device, scene.cycles.samples = "CPU", 4
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "GAUSSIAN", 0.01
    scene.cycles_curves.shape = "THICK"
    bpy.ops.render.render(write_still=True)
    return picture(render.filepath)


def grown(mask):
    """A mask and the eight neighbours of each of its pixels, which lie within 1.5 pixels of it."""
    padded = np.pad(mask, 1)
    height, width = mask.shape
    return np.any([padded[y : y + height, x : x + width] for y in range(3) for x in range(3)], axis=0)


def strays(a, b):
    """How many pixels of mask `a` lie farther than 1.5 pixels from all of `b`, and of the ground likewise."""
    return int((a & ~grown(b)).sum() + (~a & ~grown(~b)).sum())


def assert_same_silhouette(conic, cycles):
    a, b = conic[..., 3] > 0.5, cycles[..., 3] > 0.5
    assert b.mean() > 0.02, "Cycles draws next to nothing"
    assert strays(a, b) + strays(b, a) == 0, f"{a.sum()} pixels by Conic, {b.sum()} by Cycles"


def look_from_the_front(distance=6.0, lens=80.0):
    camera = add_camera(lens=lens)
    camera.location, camera.rotation_euler = (0.0, -distance, 0.0), (np.pi / 2.0, 0.0, 0.0)


def beveled(objects):
    """What Cycles draws in place of a curve without bevel."""
    for obj in objects:
        obj.data.bevel_depth, obj.data.bevel_resolution = STRAND, 8


def as_hair(objects):
    """What Cycles draws in place of a mesh of edges alone: a straight strand each, and balls at their ends."""
    for obj in objects:
        mesh = obj.data
        ends = np.array([[mesh.vertices[i].co for i in edge.vertices] for edge in mesh.edges], np.float32)
        curves = bpy.data.hair_curves.new("edges as hair")
        curves.add_curves([2] * len(ends))
        curves.attributes["position"].data.foreach_set("vector", ends.ravel())
        curves.attributes.new("radius", "FLOAT", "POINT").data.foreach_set("value", np.full(2 * len(ends), STRAND))
        balls = every_geometry.vertices(ends.reshape(-1, 3), size=np.full(2 * len(ends), STRAND))
        tree = every_geometry.NodeTree("balls")
        points = tree.node("MeshToPoints", {"Mesh": tree.geometry, "Radius": tree.attribute("size")})
        made = tree.node("SetMaterial", {"Geometry": points.outputs[0], "Material": mesh.materials[0]})
        curves.materials.append(mesh.materials[0])
        for twin in (link(curves, "edges as hair"), tree.on(link(balls, "balls"), made.outputs[0])):
            twin.rotation_euler = obj.rotation_euler
        obj.hide_render = True


#: What Cycles needs to draw the same.
TWINS = {"bare_curve": beveled, "edges_alone": as_hair}


@pytest.mark.parametrize("kind", BUILDERS)
def test_silhouette_and_color(kind, tmp_path):
    color = linear(COLORS[list(BUILDERS).index(kind)])
    objects = BUILDERS[kind](glowing(kind, color))
    look_from_the_front()
    bpy.context.scene.frame_set(5)
    conic = rendered("CONIC", tmp_path)
    TWINS.get(kind, lambda objects: None)(objects)
    cycles = rendered("CYCLES", tmp_path)
    assert_same_silhouette(conic, cycles)
    seen = conic[..., 3] > 0.5
    np.testing.assert_allclose(conic[seen][:, :3], np.broadcast_to(color, (seen.sum(), 3)), rtol=1e-4)


def test_all_in_one_picture(tmp_path):
    """The object under each pixel is the same, and no outline of what is seen of one is off by more than 1.5 pixels."""
    columns = 5
    rows = -(-len(BUILDERS) // columns)
    built = {}
    for k, (kind, build) in enumerate(BUILDERS.items()):
        built[kind] = build(glowing(kind, linear(COLORS[k])))
        for obj in built[kind]:
            if obj.parent is None:
                obj.location.x += (k % columns - (columns - 1) / 2.0) * 1.1  # so that they hide one another
                obj.location.y += 0.5 * (k % 2)
                obj.location.z += (k // columns - (rows - 1) / 2.0) * 1.2
    look_from_the_front(distance=14.0, lens=80.0)
    bpy.context.scene.frame_set(5)
    conic = rendered("CONIC", tmp_path, 240, 160)
    for kind, twin in TWINS.items():
        places = [obj.location.copy() for obj in built[kind]]
        before = set(bpy.data.objects)
        twin(built[kind])
        for obj in set(bpy.data.objects) - before:
            obj.location = places[0]
    cycles = rendered("CYCLES", tmp_path, 240, 160)
    assert_same_silhouette(conic, cycles)
    stray = 0
    for color in map(linear, COLORS):
        a, b = (np.abs(p[..., :3] - color).max(axis=-1) < 0.01 for p in (conic, cycles))
        stray += strays(a, b) + strays(b, a)
    assert stray <= 2  # slivers between two outlines, which add up
    assert (np.abs(conic - cycles) > 0.01).any(axis=-1).mean() < 0.05


def test_far_from_the_origin(tmp_path):
    """A million metres away, where Blender's own coordinates are 6 cm apart: what is placed on them looks the same."""
    obj = link(mesh_of([(-1, 0, -1), (1, 0, -1), (0, 0, 1)], [(0, 1, 2)]), "triangle")
    obj.data.materials.append(glowing("triangle", (0.5, 0.6, 0.7)))
    for build in (every_geometry.point_cloud, every_geometry.exact_shapes, every_geometry.hair_curves):
        build(glowing(build.__name__, (0.3, 0.6, 0.9)))
    look_from_the_front()
    near = rendered("CONIC", tmp_path)
    for obj in bpy.context.scene.objects:
        if obj.parent is None:
            obj.location += type(obj.location)((2.0**20, -(2.0**20), 2.0**19))
    far = rendered("CONIC", tmp_path)
    assert (near[..., 3] > 0.5).mean() > 0.1
    np.testing.assert_allclose(far, near, atol=1e-5)
