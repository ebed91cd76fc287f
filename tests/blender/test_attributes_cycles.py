"""Attributes against Cycles in the same Blender: what reaches a surface, and what is read of each type of data."""

import bpy
import numpy as np
import pytest

from addon.sync.attributes import read_attribute
from examples.every_geometry import NodeTree
from tests.blender.building import add_camera, link, material, mesh_of, node
from tests.blender.test_geometry_cycles import rendered

#: Pixels of a swatch, the unit square that shows one value.
PIXELS = 8
VALUES = {
    "FLOAT": 0.3,
    "INT": 3,
    "INT8": 5,
    "BOOLEAN": True,
    "FLOAT2": (0.2, 0.6),
    "FLOAT_VECTOR": (0.2, 0.6, 0.7),
    "FLOAT_COLOR": (0.2, 0.6, 0.7, 0.4),
    "BYTE_COLOR": (0.2, 0.6, 0.7, 0.4),
    "QUATERNION": (0.1, 0.2, 0.3, 0.4),
    "INT32_2D": (3, 4),
    "FLOAT4": (0.1, 0.2, 0.3, 0.4),
}
MEMBERS = {
    "FLOAT2": "vector",
    "FLOAT_VECTOR": "vector",
    "FLOAT4": "vector",
    "FLOAT_COLOR": "color",
    "BYTE_COLOR": "color",
}


@pytest.fixture
def rng():
    return np.random.default_rng(32)


def showing(kind="Attribute", output="Color", **settings):
    """A material that shows an output of a node as it is."""
    made, tree, out = material("showing")
    emission = node(tree, "Emission", out.inputs["Surface"], Strength=1.0)
    shown = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in settings.items():
        setattr(shown, name, value)
    tree.links.new(next(s for s in shown.outputs if s.identifier == output), emission.inputs["Color"])
    return made


def swatch(column, shown, corners=((0, 0), (1, 0), (1, 1), (0, 1)), name="swatch", **settings):
    """An object in the unit square of a column, which a face fills."""
    mesh = mesh_of([(x + column, y, 0.0) for x, y in corners], [tuple(range(len(corners)))], name)
    mesh.materials.append(shown)
    return link(mesh, name, **settings)


def set_attribute(data, name, data_type, domain, values):
    made = data.attributes.new(name, data_type, domain)
    made.data.foreach_set(MEMBERS.get(data_type, "value"), np.ravel(values))


def look_at_columns(count):
    camera = add_camera(type="ORTHO", ortho_scale=float(count))
    camera.location = (count / 2.0, 0.5, 10.0)


def pictures(count, folder, margin=1):
    """What Conic and Cycles draw in each column, (count, pixels, pixels, 4), without the pixels at the border."""
    look_at_columns(count)
    for engine in ("CONIC", "CYCLES"):
        columns = rendered(engine, folder, count * PIXELS, PIXELS).reshape(PIXELS, count, PIXELS, 4)
        yield columns.transpose(1, 0, 2, 3)[:, margin : PIXELS - margin, margin : PIXELS - margin]


def assert_same(conic, cycles):
    """The same within 1e-3. Cycles looks nearly at the middle of a pixel, and once in a while a tenth of a pixel
    away: where a value runs over a face, a few pixels may differ by what it does on that way."""
    seen = cycles[..., 3] == 1.0
    assert seen.mean() > 0.9 and cycles[..., :3].max() > 0.1, "Cycles draws something in next to every pixel"
    error = np.abs(conic - cycles)[seen] / np.maximum(np.abs(cycles[seen]), 1.0)
    assert np.quantile(error, 0.98) < 1e-3 and error.max() < 0.05, f"largest error {error.max()}"


def assert_constants(conic, cycles):
    """The same within 1e-3 in every pixel."""
    assert (cycles[..., 3] == 1.0).all() and cycles[..., :3].max() > 0.1, "Cycles draws something in every pixel"
    np.testing.assert_allclose(conic, cycles, rtol=1e-3, atol=1e-3)


def test_types_are_read_as_cycles_reads_them(tmp_path):
    known = bpy.types.Attribute.bl_rna.properties["data_type"].enum_items.keys()
    cases = []
    for data_type in filter(known.__contains__, VALUES):
        for output in ("Color", "Fac", "Alpha"):
            obj = swatch(len(cases), showing(output=output, attribute_name="a"))
            made = obj.data.attributes.new("a", data_type, "POINT")
            for item in made.data:
                setattr(item, MEMBERS.get(data_type, "value"), VALUES[data_type])
            cases.append(
                (data_type, output, read_attribute(obj.data, "a", "" if output == "Color" else output.lower()))
            )
    look_at_columns(len(cases))
    cycles = rendered("CYCLES", tmp_path, len(cases) * 4, 4)
    for i, (data_type, output, read) in enumerate(cases):
        seen = cycles[2, 4 * i + 2, :3]
        if data_type == "INT32_2D":
            assert read is None and (output == "Alpha" or not seen.any())
        else:
            assert read[0][0, :3] == pytest.approx(seen, rel=1e-5), (data_type, output)


@pytest.mark.parametrize("data_type", ("FLOAT_COLOR", "BYTE_COLOR", "FLOAT_VECTOR", "FLOAT"))
def test_domains_of_a_mesh(data_type, tmp_path, rng):
    """Of points, faces and corners, on the triangles of a quad and of a polygon of five corners."""
    width = {"FLOAT": 1, "FLOAT_VECTOR": 3}.get(data_type, 4)
    five = ((0, 0), (1, 0), (1, 0.7), (0.5, 1), (0, 1))
    for i, domain in enumerate(("POINT", "FACE", "CORNER")):
        for k in range(2):
            obj = swatch(2 * i + k, showing(attribute_name="paint"), *([five] if k else []))
            size = 1 if domain == "FACE" else len(obj.data.vertices)
            set_attribute(obj.data, "paint", data_type, domain, rng.random((size, width), np.float32))
    conic, cycles = pictures(6, tmp_path)
    assert_same(conic, cycles)
    assert np.ptp(cycles[4, ..., 0]) > 0.1, "the corners differ"


def test_outputs_and_missing_attributes(tmp_path, rng):
    for i, settings in enumerate(({"output": "Fac"}, {"output": "Vector"}, {"output": "Alpha"}, {})):
        obj = swatch(i, showing(attribute_name="paint", **settings))
        if settings:
            set_attribute(obj.data, "paint", "FLOAT_COLOR", "CORNER", rng.random((4, 4), np.float32))
    for i, layer in enumerate(("second", "")):
        obj = swatch(4 + i, showing("VertexColor", layer_name=layer))
        for name in ("first", "second", "third"):
            set_attribute(obj.data, name, "BYTE_COLOR", "CORNER", rng.random((4, 4), np.float32))
        obj.data.color_attributes.render_color_index = 2
    assert_same(*pictures(6, tmp_path))


def test_values_of_objects(tmp_path):
    """What Object Info gives, and properties: of the object, of its data, by path."""
    outputs = ("Color", "Alpha", "Object Index", "Material Index", "Random", "Location")
    properties = [("OBJECT", name) for name in ("size", "of_data", "color", "nothing")] + [("INSTANCER", "tint")]
    shown = [showing("ObjectInfo", output) for output in outputs]
    shown += [showing(attribute_type=kind, attribute_name=name) for kind, name in properties]
    for i, made in enumerate(shown):
        made.pass_index = 2
        obj = swatch(i, made, name=f"swatch ü {i}", color=(0.3, 0.5, 0.7, 0.4), pass_index=3)
        obj.location.z = 0.25
        obj["size"], obj["tint"], obj.data["of_data"] = 0.5, (0.2, 0.4, 0.6), 2
    assert_constants(*pictures(len(shown), tmp_path))


def test_values_of_exact_shapes(tmp_path):
    """Spheres that are drawn as such: their objects' values, and an attribute that is the same on all of a mesh."""
    shown = [showing("ObjectInfo", "Color"), showing("ObjectInfo", "Random"), showing(attribute_name="even")]
    shown.append(showing(attribute_name="uneven"))
    for i, made in enumerate(shown):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.5, location=(i + 0.5, 0.5, 0.0))
        obj = bpy.context.object
        obj.data.shade_smooth()
        obj.color = (0.1 * i + 0.2, 0.5, 0.9, 1.0)
        obj.data.materials.append(made)
        points = len(obj.data.vertices)
        set_attribute(obj.data, "even", "FLOAT_COLOR", "POINT", np.tile((0.2, 0.4, 0.6, 1.0), (points, 1)))
        places = np.array([vertex.co for vertex in obj.data.vertices], np.float32)
        set_attribute(obj.data, "uneven", "FLOAT_VECTOR", "POINT", 0.5 + 0.5 * places)
    assert_same(*pictures(len(shown), tmp_path, margin=2))


def of_points(count, rng):
    """A mesh of points in the middle of the columns, with attributes, and a node tree on it."""
    mesh = bpy.data.meshes.new("points")
    mesh.vertices.add(count)
    places = np.stack([np.arange(count) + 0.5, np.full(count, 0.5), np.zeros(count)], axis=-1)
    mesh.attributes["position"].data.foreach_set("vector", places.astype(np.float32).ravel())
    set_attribute(mesh, "paint", "FLOAT_COLOR", "POINT", rng.random((count, 4), np.float32))
    return link(mesh, "points"), NodeTree("points")


@pytest.mark.parametrize(
    "settings",
    (
        {"attribute_name": "paint"},
        {"attribute_name": "paint", "output": "Fac"},
        {"kind": "PointInfo", "output": "Random"},
        {"kind": "ObjectInfo", "output": "Color"},
    ),
)
def test_points_of_a_point_cloud(settings, tmp_path, rng):
    shown = showing(**settings)
    obj, tree = of_points(6, rng)
    obj.color = (0.1, 0.5, 0.9, 1.0)
    made = tree.node("MeshToPoints", {"Mesh": tree.geometry, "Radius": 0.5})
    tree.on(obj, tree.node("SetMaterial", {"Geometry": made.outputs[0], "Material": shown}).outputs[0])
    assert_constants(*pictures(6, tmp_path, margin=2))


@pytest.mark.parametrize("settings", ({"attribute_name": "along"}, {"attribute_name": "each"}, {"kind": "HairInfo"}))
def test_hair_curves(settings, tmp_path, rng):
    """Straight strands through the columns. Cycles' values run along them evenly in the spline's parameter, Conic's as
    Blender's own curves have it, by the spline itself: a percent of difference."""
    count = 4
    x, y = np.meshgrid(np.arange(count) + 0.5, (-0.5, 1.5), indexing="ij")
    curves = bpy.data.hair_curves.new("hair")
    curves.add_curves([2] * count)
    curves.attributes["position"].data.foreach_set("vector", np.stack([x, y, 0 * x], -1).astype(np.float32).ravel())
    set_attribute(curves, "radius", "FLOAT", "POINT", np.full(2 * count, 0.45, np.float32))
    set_attribute(
        curves, "along", "FLOAT_COLOR", "POINT", np.tile(((0.1, 0.9, 0.5, 1.0), (0.9, 0.1, 0.5, 1.0)), (count, 1))
    )
    set_attribute(curves, "each", "FLOAT_COLOR", "CURVE", rng.random((count, 4), np.float32))
    curves.materials.append(showing(output="Random" if "kind" in settings else "Color", **settings))
    link(curves, "hair")
    conic, cycles = pictures(count, tmp_path, margin=2)
    if "along" in settings.values():
        np.testing.assert_allclose(conic, cycles, atol=0.02)
        assert np.ptp(cycles[..., 0], axis=1).max() > 0.1, "they run"
    else:
        assert_constants(conic, cycles)


@pytest.mark.parametrize(
    "settings",
    (
        {"attribute_type": "INSTANCER", "attribute_name": "paint"},
        {"attribute_type": "INSTANCER", "attribute_name": "paint", "output": "Fac"},
        {"attribute_type": "INSTANCER", "attribute_name": "of_the_maker"},
        {"attribute_type": "INSTANCER", "attribute_name": "of_the_instance"},
        {"attribute_type": "OBJECT", "attribute_name": "of_the_maker"},
        {"kind": "ObjectInfo", "output": "Random"},
        {"kind": "ObjectInfo", "output": "Location"},
        {"kind": "ObjectInfo", "output": "Color"},
    ),
)
@pytest.mark.parametrize("what", ("object", "geometry"))
def test_instances_of_geometry_nodes(what, settings, tmp_path, rng):
    if settings.get("attribute_name") == "paint" and bpy.app.version < (4, 5, 0):
        pytest.skip("Blender 4.2 gives no way to read them")
    shown = showing(**settings)
    obj, tree = of_points(5, rng)
    obj.color = (0.1, 0.5, 0.9, 1.0)
    obj["of_the_maker"] = (0.2, 0.4, 0.8)
    if what == "object":
        inner = swatch(
            20, shown, ((-20.4, -0.4), (-19.6, -0.4), (-19.6, 0.4), (-20.4, 0.4)), color=(0.7, 0.2, 0.1, 1.0)
        )
        inner["of_the_instance"] = 0.75
        inner.location.x = 40.0  # out of sight
        instance = tree.node("ObjectInfo", {"Object": inner, "As Instance": True}).outputs["Geometry"]
    else:
        made = tree.node("MeshGrid", {"Size X": 0.8, "Size Y": 0.8, "Vertices X": 2, "Vertices Y": 2})
        instance = tree.node("SetMaterial", {"Geometry": made.outputs[0], "Material": shown}).outputs[0]
    tree.on(obj, tree.node("InstanceOnPoints", {"Points": tree.geometry, "Instance": instance}).outputs[0])
    conic, cycles = pictures(5, tmp_path, margin=2)
    seen = settings["attribute_name"] if "attribute_name" in settings else settings["output"]
    absent = what == "object" and settings.get("attribute_type") == "OBJECT"
    if absent or (what, seen) == ("geometry", "of_the_instance"):
        assert not conic[..., :3].any() and not cycles[..., :3].any(), "no such property on the object itself"
        return
    assert_constants(conic, cycles)
    if seen in ("paint", "Random", "Location"):
        assert np.ptp(cycles[:, 0, 0, 0]) > 0.1, "they differ"
