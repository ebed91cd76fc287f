"""Attributes in packing: a lookup in numpy as the shader does it finds, for each primitive and instance, its value."""

import numpy as np
import pytest

from addon.engine import data_texture, layout
from addon.engine.material import surface_attribute
from addon.engine.packing import pack
from addon.engine.primitives import Cylinders, Planes, Spheres, Triangles
from addon.engine.scene import Camera, Geometry, Instances, Material, Scene

LIMIT = 16384


def scene_of(*materials):
    return Scene(camera=Camera.look_at((0, -5, 0), (0, 0, 0)), materials=list(materials))


def spheres(count, name=None, seed=0):
    """Spheres told apart by their radii; an attribute whose values are those."""
    rng = np.random.default_rng(seed)
    radius = np.sort(rng.uniform(0.01, 0.05, count)).astype(np.float32)
    attributes = {name: np.repeat(radius[:, None], 4, axis=1)} if name else {}
    return Spheres(center=rng.uniform(-1, 1, (count, 3)), radius=radius, attributes=attributes)


def looked_up(packed, attribute, geometry, kind, index):
    """The texels (width, 4) of primitive `index` among the records of its kind; None where it has no such attribute."""
    directory = data_texture.records_of(packed.textures["tables"], layout.ATTRIBUTE, packed.frame["attribute_first"])
    kinds, rows = len(layout.KINDS), packed.frame["geometry_count"] + 1
    entry = directory[(attribute * rows + geometry) * kinds + layout.KINDS.index(kind)]
    first, base = (int(entry[n]) + (int(entry[f"{n}_high"]) << 24) for n in ("first", "base"))
    width = int(entry["width"])
    start = first + (index - base) * width
    return packed.textures["attributes"].reshape(-1, 4)[start : start + width] if width else None


def test_each_primitive_finds_its_value():
    """Two geometries and the world share a record texture; each tree has an order of its own."""
    scene = scene_of(Material(diffuse=surface_attribute("size")))
    scene.add(spheres(50, "size"))
    with_, without = Geometry(spheres(70, "size", 1)), Geometry(spheres(30, None, 2))
    scene.instances = [Instances(with_, np.eye(4)), Instances(without, np.eye(4))]
    packed = pack(scene, LIMIT)
    radius = data_texture.records_of(packed.textures["spheres"], layout.SPHERE)["radius"]
    for index in range(150):
        geometry = 0 if index < 50 else 1 if index < 120 else 2
        found = looked_up(packed, 0, geometry, "sphere", index)
        if geometry == 2:
            assert found is None
        else:
            assert found.tolist() == [[radius[index]] * 4]
    assert "HAS_ATTRIBUTES" in packed.features and packed.frame["geometry_count"] == 3


def test_attributes_of_many_small_geometries():
    """Trees that are built together, every third geometry without the attribute."""
    scene = scene_of(Material(diffuse=surface_attribute("size")))
    counts = np.random.default_rng(0).integers(1, 60, 150)
    geometries = [Geometry(spheres(n, "size" if i % 3 else None, i)) for i, n in enumerate(counts.tolist())]
    scene.instances = [Instances(geometry, np.eye(4)) for geometry in geometries]
    packed = pack(scene, LIMIT)
    radius = data_texture.records_of(packed.textures["spheres"], layout.SPHERE)["radius"]
    index = 0
    for number, count in enumerate(counts.tolist()):
        for _ in range(count):
            found = looked_up(packed, 0, number + 1, "sphere", index)
            assert found.tolist() == [[radius[index]] * 4] if number % 3 else found is None
            index += 1


def test_values_at_corners_and_ends():
    """Triangles have three texels, cylinders two, in the order of their corners and ends."""
    rng = np.random.default_rng(3)
    corners = rng.random((40, 3, 3)).astype(np.float32)
    colors = np.concatenate([corners, np.ones((40, 3, 1), np.float32)], axis=-1)
    scene = scene_of(Material(glow=surface_attribute("place")))
    scene.add(Triangles(**{f"p{i}": corners[:, i] for i in range(3)}, attributes={"place": colors}))
    scene.add(Cylinders(base=corners[:, 0], apex=corners[:, 1], radius=0.1, attributes={"place": colors[:, :2]}))
    packed = pack(scene, LIMIT)
    triangle = data_texture.records_of(packed.textures["triangles"], layout.TRIANGLE)
    cylinder = data_texture.records_of(packed.textures["cylinders"], layout.CYLINDER)
    for index in range(40):
        found = looked_up(packed, 0, 0, "triangle", index)
        assert (found[:, :3] == [triangle[f"p{i}"][index] for i in range(3)]).all()
        found = looked_up(packed, 0, 0, "cylinder", index)
        assert found.shape == (2, 4) and (found[0, :3] == cylinder["base"][index]).all()
        assert np.allclose(found[1, :3], cylinder["base"][index] + cylinder["axis"][index], atol=1e-6)


@pytest.mark.parametrize("shapes", [False, True])
def test_each_instance_finds_its_value(shapes):
    scene = scene_of(Material(reflect=surface_attribute("id")))
    if shapes:
        scene.add(spheres(5))
    geometries = [Geometry(spheres(2)), Geometry(spheres(3))]
    matrices = np.tile(np.eye(4), (30, 1, 1))
    matrices[:, 0, 3] = np.random.default_rng(4).permutation(30) - 15.0
    ids = np.repeat(matrices[:, 0, 3, None], 4, axis=1)
    scene.instances = [
        Instances(geometries[0], matrices[:10], attributes={"id": ids[:10]}),
        Instances(geometries[1], matrices[10:20]),
        Instances(geometries[0], matrices[20:], attributes={"id": (7, 7, 7, 7)}),
    ]
    packed = pack(scene, LIMIT)
    count = 30 + shapes
    x = data_texture.records_of(
        packed.textures["instances"], layout.INSTANCE_SURFACE, packed.frame["instance_surface_first"]
    )
    number = data_texture.records_of(packed.textures["instances"], layout.INSTANCE)["geometry"]
    for index in range(count):
        place = x["to_world_x"][index][3]
        row = int(np.flatnonzero(matrices[:, 0, 3] == place)[0])
        expected = 0.0 if number[index] == 0 or 10 <= row < 20 else place if row < 10 else 7.0
        assert looked_up(packed, 0, packed.frame["geometry_count"], "instance", index).tolist() == [[expected] * 4]


def test_planes_have_attributes_too():
    scene = scene_of(Material(diffuse=surface_attribute("color")))
    scene.add(Planes(point=[0, 0, 0], normal=[0, 0, 1]))
    scene.add(Planes(point=[[0, 0, 1]] * 2, normal=[0, 0, 1], attributes={"color": [[1, 2, 3, 4], [5, 6, 7, 8]]}))
    packed = pack(scene, LIMIT)
    found = [looked_up(packed, 0, 0, "plane", index).tolist() for index in range(3)]
    assert found == [[[0] * 4], [[1, 2, 3, 4]], [[5, 6, 7, 8]]]


def test_only_what_materials_name_is_uploaded():
    scene = scene_of(
        Material(diffuse=surface_attribute("size")),
        Material(glow=surface_attribute("absent"), reflect=surface_attribute("size")),
    )
    part = spheres(20, "size")
    part.attributes["unused"] = np.ones((20, 1, 4), np.float32)
    scene.add(part)
    packed = pack(scene, LIMIT)
    assert packed.textures["attributes"].size == 20 * 4
    constants = data_texture.records_of(packed.textures["tables"], layout.CONSTANT, int(packed.frame["constant_first"]))
    assert constants["value"][:2, :2].tolist() == [[1.0, 0.0], [1.0, 0.0]]  # the second has both, reflect before glow
