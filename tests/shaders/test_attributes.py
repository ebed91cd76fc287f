"""Attributes of primitives and instances where a ray hits, against float64."""

import numpy as np
import pytest

from addon.engine.material import surface_attribute
from addon.engine.packing import pack
from addon.engine.primitives import Cones, Cylinders, Discs, Planes, Spheres, Triangles
from addon.engine.scene import Geometry, Instances, Material

from . import harness, scenes, shapes
from .test_traversal import random_rays

NAMES = ("geometry:a", "geometry:b")  # in the order of their numbers


def values(rng, *shape):
    return rng.uniform(-5.0, 5.0, (*shape, 4)).astype(np.float32)


def look_up(device, scene, origin, direction):
    """Attributes 0 and 1 (n, 4) of what rays hit, the number of its material (n,), -1 for none, and where (n, 3)."""
    packed = pack(scene, device.max_texture_size)
    first, second, hit = harness.run(
        device,
        "attribute_frag.glsl",
        len(origin),
        packed.textures | {"test_rays": harness.texels(harness.ray_records(origin - packed.origin, direction))},
        features=packed.features | {"HAS_ATTRIBUTES"},
        constants=packed.constants,
        outputs=("out_first", "out_second", "out_hit"),
        frame=harness.frame_record(**packed.frame),
    )
    return (first, second), hit[:, 0].astype(int), hit[:, 1:] + packed.origin


def numbered_scene():
    """An empty scene whose materials glow with their number and name both attributes."""
    scene = scenes.empty_scene()
    scene.materials = [Material(diffuse=surface_attribute(NAMES[0]), transmit=surface_attribute(NAMES[1]))]
    return scene


def every_kind(rng, widths):
    """A few hundred primitives of all kinds with both attributes, the first of these widths (1: one a primitive)."""
    for part in scenes.parts(rng, 300):
        width = widths.get(type(part), 1)
        attributes = {NAMES[0]: values(rng, len(part), width), NAMES[1]: values(rng, len(part))}
        columns = {column.name: getattr(part, column.name) for column in part.columns}
        yield type(part)(**columns, attributes=attributes)


ENDS = {Cylinders: 2, Cones: 2, Triangles: 3}


def expected_value(part, row, point, name):
    """The value (4,) of an attribute at a point on primitive `row`, in float64."""
    value = part.attributes[name][row].astype(np.float64)
    if len(value) == 1:
        return value[0]
    if isinstance(part, Triangles):
        p0, p1, p2 = (np.asarray(getattr(part, f"p{i}")[row], np.float64) for i in range(3))
        (v, w), *_ = np.linalg.lstsq(np.stack([p1 - p0, p2 - p0], axis=-1), point - p0, rcond=None)
        return (1.0 - v - w) * value[0] + v * value[1] + w * value[2]
    axis = np.asarray(part.apex[row] - part.base[row], np.float64)
    height = np.clip((point - part.base[row]) @ axis / (axis @ axis), 0.0, 1.0)
    return (1.0 - height) * value[0] + height * value[1]


@pytest.mark.parametrize("placed", [False, True], ids=["in world space", "instanced"])
@pytest.mark.parametrize("widths", [{}, ENDS], ids=["one a primitive", "at ends and corners"])
def test_every_kind_of_primitive(device, widths, placed):
    rng = np.random.default_rng([len(widths), placed])
    scene, parts = numbered_scene(), []
    for part in every_kind(rng, widths):
        first = scenes.new_materials(scene, len(part))
        parts += [(first, part)]
    if placed:  # a second geometry, so that bases are not 0; slots are the scene's materials
        other = Spheres(center=np.full((9, 3), 50.0), radius=np.ones(9), attributes={NAMES[0]: values(rng, 9)})
        scene.instances.append(Instances(Geometry(other), np.eye(4)))
        matrix = scenes.random_affine(rng)
        geometry = Geometry(
            *(part._with({"material": np.arange(f, f + len(part), dtype=np.int32)}) for f, part in parts)
        )
        scene.instances.append(Instances(geometry, matrix, None))
    else:
        matrix = np.eye(4)
        for first, part in parts:
            scene.add(part._with({"material": np.arange(first, first + len(part), dtype=np.int32)}))
    origin, direction = random_rays(rng, 4000)
    found, number, position = look_up(device, scene, origin, direction)
    inverse = np.linalg.inv(matrix)
    local = position @ inverse[:3, :3].T + inverse[:3, 3]
    kinds = set()
    for ray in np.flatnonzero(number > 0):
        first, part = next((f, p) for f, p in parts if f <= number[ray] < f + len(p))
        for name, value in zip(NAMES, found, strict=True):
            expected = expected_value(part, number[ray] - first, local[ray], name)
            assert np.abs(value[ray] - expected).max() < 5e-3, (part.kind, name)
        kinds.add(part.kind)
    assert len(kinds) == len({p.kind for _, p in parts})


def test_the_primitive_s_own_comes_before_the_instance_s(device):
    """Else the instance's, else 0; of a thousand instances of two geometries each its own."""
    rng = np.random.default_rng(7)
    scene = numbered_scene()
    n = 500
    places = np.tile(np.eye(4), (2 * n, 1, 1))
    places[:, :3, 3] = np.stack([np.arange(2 * n) * 3.0, np.zeros(2 * n), np.zeros(2 * n)], axis=-1)
    own = values(rng, 1)
    per_instance = values(rng, 2 * n)
    with_own = Geometry(Spheres(center=np.zeros((1, 3)), radius=[1.0], attributes={NAMES[0]: own}))
    without = Geometry(Discs(center=np.zeros((1, 3)), normal=[(0.0, 0.0, 1.0)], radius=[1.0]))
    scene.instances.append(Instances(with_own, places[:n], attributes={NAMES[0]: per_instance[:n]}))
    scene.instances.append(Instances(without, places[n:], attributes={NAMES[0]: per_instance[n:]}))
    scene.add_plane((0.0, 0.0, -5.0), (0.0, 0.0, 1.0))
    scene.add_spheres((-9.0, 0.0, 0.0), 1.0)
    above = np.array((0.1, 0.2, 4.0))
    origin = above + np.array([*places[:, :3, 3], (-3.0, 0.0, 0.0), (-9.0, 0.0, 0.0)])
    (first, second), number, _ = look_up(device, scene, origin, np.broadcast_to((0.0, 0.0, -1.0), origin.shape))
    assert (number == 0).all()
    assert np.array_equal(first[:n], np.broadcast_to(own, (n, 4)))
    assert np.array_equal(first[n:-2], per_instance[n:])
    assert (first[-2:] == 0.0).all(), "neither the plane nor the ball in world space has it"
    assert (second == 0.0).all(), "nothing has the other"


def test_planes_have_attributes(device):
    scene = numbered_scene()
    scene.add(Planes(point=(0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0)))
    value = np.array((1.0, 2.0, 3.0, 4.0), np.float32)
    scene.add(Planes(point=(0.0, 0.0, 1.0), normal=(0.0, 0.0, 1.0), attributes={NAMES[1]: value}))
    origin = np.array([(0.0, 0.0, 3.0), (0.0, 0.0, 0.5)])
    (first, second), _, _ = look_up(device, scene, origin, np.broadcast_to((0.0, 0.0, -1.0), origin.shape))
    assert (first == 0.0).all()
    assert np.array_equal(second, [value, 0.0 * value])


def test_equal_values_come_back_exactly(device):
    """At ends and corners too: a material's colour does not flicker by the last digit over a face."""
    rng = np.random.default_rng(11)
    value = np.array((0.1, 1.0 / 3.0, 0.7, 12345.678), np.float32)
    scene = numbered_scene()
    for make, width in ((shapes.triangles, 3), (shapes.cylinders, 2)):
        part = make(rng, 1)
        middle, extent = shapes.middle_and_extent(part)
        part = scenes.resized(part, middle, 1.0 / extent, np.array([[2.0 * width, 0.0, 0.0]]))
        columns = {column.name: getattr(part, column.name) for column in part.columns} | {"material": 0}
        scene.add(type(part)(**columns, attributes={NAMES[0]: np.broadcast_to(value, (1, width, 4))}))
    target = np.array([2.0 * rng.integers(2, 4, 20_000), *rng.uniform(-1.0, 1.0, (2, 20_000))]).T
    origin = shapes.single(target + 5.0 * shapes.unit_vectors(rng, len(target)))
    (first, _), number, _ = look_up(device, scene, origin, shapes.single(shapes.normalized(target - origin)))
    assert (number == 0).sum() > 1000
    assert (first[number == 0] == value).all()
