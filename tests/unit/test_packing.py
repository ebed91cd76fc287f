"""From a scene to textures: where records lie, what is refused and how it is said. Nothing is drawn here."""

import numpy as np
import pytest

from addon.engine import bvh, data_texture, layout, reference
from addon.engine.changes import Change
from addon.engine.errors import SceneError, StoppedError
from addon.engine.material import surface_image
from addon.engine.packing import pack
from addon.engine.primitives import Cylinders, Planes, Spheres, Triangles
from addon.engine.scene import Geometry, Image, Instances, Light, Material, Visibility, World
from addon.engine.tree_packing import QUICK_FROM
from tests.unit.packed_scenes import LIMIT, scene_of, spheres


def records(packed, record, count):
    """`count` records of a kind, read from the textures as the shader reads them."""
    first = packed.frame.get(f"{record.name}_first", 0) if layout.shared(record) else 0
    texels = packed.textures[record.texture].reshape(-1, 4)[first : first + count * record.texels]
    return texels.reshape(-1).view(record.dtype)


def leaves(packed):
    """(kind, first, count) of every leaf that is reached from node 0, and through instances from there."""
    instances = packed.textures.get("instances")
    todo, found = [0], []
    for root in todo:
        for kind, first, count in leaves_below(packed, root):
            if kind == "instance":
                roots = data_texture.records_of(instances, layout.INSTANCE)["root"][first : first + count].astype(int)
                todo += [root for root in roots.tolist() if root not in todo]
            else:
                found.append((kind, first, count))
    return found


def leaves_below(packed, root):
    """(kind, first, count) of every leaf of the tree that begins at a node."""
    nodes = data_texture.records_of(packed.textures["nodes"], layout.NODE)
    todo, seen = [root], set()
    while todo:
        index = todo.pop()
        assert index not in seen, "a node is reached twice"
        seen.add(index)
        for child in (0, 1):
            kind, count, high = map(int, reference.unpack_leaf(nodes[f"leaf_{child}"][index]))
            first = int(nodes[f"first_{child}"][index]) + (high << reference.LOW_BITS)
            if count:
                yield layout.KINDS[kind], first, count
            elif nodes[f"lower_{child}"][index][0] < 1e38:
                todo.append(first)


def mixed(number, rng):
    """A geometry of a few spheres, cylinders and triangles, not of all kinds, around (4 number, 0, 0)."""
    count = int(rng.integers(1, 120))
    point = np.add(rng.uniform(-0.3, 0.3, (3, count, 3)), [4.0 * number, 0, 0])
    parts = [
        Spheres(center=point[0], radius=0.01),
        Triangles(p0=point[0], p1=point[1], p2=point[2]),
        Cylinders(base=point[0], apex=point[1], radius=0.01),
    ]
    return Geometry(*(part for kind, part in enumerate(parts) if kind == number % 3 or rng.random() < 0.5))


@pytest.mark.parametrize("eye", [(0.0, -5.0, 0.0), (5e4, 0.0, 0.0)])
def test_trees_that_are_built_together_lead_to_their_own_primitives(eye):
    """Geometries of a few primitives of several kinds, some moved with the origin, beside a large one."""
    rng = np.random.default_rng(0)
    geometries = [mixed(number, rng) for number in range(400)]
    geometries[7] = Geometry(Spheres(center=np.add(rng.uniform(-0.3, 0.3, (5000, 3)), [28, 0, 0]), radius=0.01))
    scene = scene_of(eye=eye)
    twice = np.stack([np.eye(4)] * 2)
    scene.instances = [Instances(geometry, np.eye(4) if i % 2 else twice) for i, geometry in enumerate(geometries)]
    packed = pack(scene, LIMIT, keep=True)
    hits = data_texture.records_of(packed.textures["instances"], layout.INSTANCE)[:600]
    point = {
        "sphere": (layout.SPHERE, "center"),
        "triangle": (layout.TRIANGLE, "p0"),
        "cylinder": (layout.CYLINDER, "base"),
    }
    point = {kind: data_texture.records_of(packed.textures[r.texture], r)[name] for kind, (r, name) in point.items()}
    for number, geometry in enumerate(geometries):
        (root,) = set(hits["root"][hits["geometry"] == number + 1].astype(int).tolist())
        seen = dict.fromkeys(geometry.counts(), 0)
        for kind, first, count in leaves_below(packed, root):
            seen[kind] += count
            moved = packed.origin if number % 2 else np.zeros(3)
            assert (np.abs(point[kind][first : first + count] + moved - [4.0 * number, 0, 0]) < 0.5).all()
        assert seen == geometry.counts()


def test_of_trees_that_are_built_together_the_one_with_a_bad_box_is_named():
    geometries = [Geometry(spheres(10), name=f"number {i}") for i in range(20)]
    huge = Spheres(center=[[0, 0, 0], [1e30, 0, 0]], radius=1e39)
    geometries[13] = Geometry(huge, name="the bad one")
    scene = scene_of()
    scene.instances = [Instances(geometry, np.eye(4)) for geometry in geometries]
    with pytest.raises(SceneError, match="geometry 'the bad one': boxes: 2 of 2 are"):
        pack(scene, LIMIT)


def test_quick_trees_stand_until_better_ones_are_asked_for():
    """Those of few primitives are good from the start."""
    large, small = Geometry(spheres(QUICK_FROM)), Geometry(spheres(100))
    scene = scene_of()
    scene.instances = [Instances(large, np.eye(4)), Instances(small, np.eye(4))]
    quick = pack(scene, LIMIT, keep=True, quick=True)
    covered = np.zeros(QUICK_FROM + 100, int)
    for _, first, count in leaves(quick):
        covered[first : first + count] += 1
    assert (covered == 1).all()
    again = pack(scene, LIMIT, quick.residency, keep=True, quick=True)
    assert not again.change & Change.GEOMETRY and "nodes" not in again.uploads
    better = pack(scene, LIMIT, again.residency, keep=True)
    assert better.change & Change.GEOMETRY and better.uploads["sphere_surfaces"].count == QUICK_FROM
    assert better.statistics["bvh"] == pack(scene, LIMIT, keep=True).statistics["bvh"] != quick.statistics["bvh"]
    last = pack(scene, LIMIT, better.residency, keep=True, quick=True)
    assert not last.change & Change.GEOMETRY and "nodes" not in last.uploads


def test_a_quick_tree_has_every_primitive_where_its_leaf_says():
    """Of two kinds, near an origin that is far: records and boxes are made in one go, in the order of the tree."""
    far = np.array([3e6, 0, 0])
    base = spheres(QUICK_FROM, seed=1, offset=far).center
    rods = Cylinders(base=base, apex=base + 0.1, radius=0.01)
    balls = spheres(QUICK_FROM, offset=far)
    scene = scene_of(balls, rods, eye=far)
    packed = pack(scene, LIMIT, quick=True)
    assert packed.statistics["bvh"]["sah_cost"] < 1.4 * pack(scene, LIMIT).statistics["bvh"]["sah_cost"]
    nodes = records(packed, layout.NODE, packed.statistics["bvh"]["nodes"])
    center = records(packed, layout.SPHERE, QUICK_FROM)["center"]
    assert np.allclose(np.sort(center + packed.origin, axis=0), np.sort(balls.center, axis=0), atol=0.5)
    radius, covered = records(packed, layout.SPHERE, QUICK_FROM)["radius"], np.zeros(QUICK_FROM, int)
    for child in (0, 1):
        kind, count, high = reference.unpack_leaf(nodes[f"leaf_{child}"])
        first = nodes[f"first_{child}"].astype(np.int64) + (high << reference.LOW_BITS)
        leaf = np.flatnonzero((count > 0) & (kind == layout.KINDS.index("sphere")))
        rows = np.concatenate([np.arange(f, f + n) for f, n in zip(first[leaf], count[leaf], strict=True)])
        of = np.repeat(leaf, count[leaf])
        covered[rows] += 1
        assert (center[rows] - radius[rows, None] >= nodes[f"lower_{child}"][of]).all()
        assert (center[rows] + radius[rows, None] <= nodes[f"upper_{child}"][of]).all()
    assert (covered == 1).all()


def test_a_box_that_no_quick_tree_can_hold_is_named():
    center = spheres(QUICK_FROM).center.copy()
    center[7] = 1e39
    with pytest.raises(SceneError, match=r"boxes: 1 of 16384 are not finite .* primitive 7:"):
        pack(scene_of(Spheres(center=center, radius=0.1)), LIMIT, quick=True)


def test_a_good_tree_is_built_once_even_if_it_comes_too_late(monkeypatch):
    """What was packed with it is thrown away: an edit came first, of something else or of the geometry."""
    built, build = [], bvh.build

    def counted(lower, *arguments, **options):
        built.extend([1] * (len(lower) >= QUICK_FROM))  # there is a tree of the instances too
        return build(lower, *arguments, **options)

    monkeypatch.setattr(bvh, "build", counted)
    large = Geometry(spheres(QUICK_FROM))
    scene = scene_of()
    scene.instances = [Instances(large, np.eye(4))]
    quick = pack(scene, LIMIT, keep=True, quick=True)
    assert not built and large.tree is None
    late = pack(scene, LIMIT, quick.residency, keep=True)
    assert len(built) == 1
    scene.add_spheres([[0, 0, 5]], 1.0)
    edited = pack(scene, LIMIT, quick.residency, keep=True, quick=True)
    better = pack(scene, LIMIT, edited.residency, keep=True)
    assert len(built) == 1 and better.statistics["bvh"]["sah_cost"] == late.statistics["bvh"]["sah_cost"]
    assert better.uploads["sphere_surfaces"].count == QUICK_FROM
    large.add(spheres(10))
    pack(scene, LIMIT, edited.residency, keep=True)
    assert len(built) == 2, "it is another geometry now"
    scene.forget_trees()
    assert large.tree is None


def test_a_quick_tree_of_instances_stands_until_a_better_one_is_asked_for():
    matrices = np.tile(np.eye(4), (QUICK_FROM, 1, 1))
    matrices[:, :3, 3] = np.random.default_rng(0).random((QUICK_FROM, 3)) * 100
    scene = scene_of()
    scene.instances = [Instances(Geometry(spheres(10)), matrices)]
    quick = pack(scene, LIMIT, keep=True, quick=True)
    again = pack(scene, LIMIT, quick.residency, keep=True, quick=True)
    assert "instances" not in again.uploads
    better = pack(scene, LIMIT, again.residency, keep=True)
    assert better.change & Change.INSTANCES and not better.change & Change.GEOMETRY
    assert better.statistics["bvh"] == pack(scene, LIMIT, keep=True).statistics["bvh"] != quick.statistics["bvh"]
    assert "instances" not in pack(scene, LIMIT, better.residency, keep=True, quick=True).uploads


def test_every_primitive_is_in_one_leaf():
    """Of two geometries and the world's shapes, each kind's records lie in one texture, geometry after geometry."""
    geometries = [
        Geometry(spheres(40), Cylinders(base=[[0, 0, 0]], apex=[[0, 0, 1]], radius=0.1)),
        Geometry(spheres(70)),
    ]
    scene = scene_of(spheres(30))
    scene.instances = [Instances(geometries[i], np.eye(4)) for i in (0, 1, 0)]
    packed = pack(scene, LIMIT)
    covered = {"sphere": np.zeros(140, int), "cylinder": np.zeros(1, int)}
    for kind, first, count in leaves(packed):
        covered[kind][first : first + count] += 1
    assert all((c == 1).all() for c in covered.values())
    radius = records(packed, layout.SPHERE, 140)["radius"]
    expected = np.sort(np.concatenate([np.linspace(0.01, 0.05, n) for n in (30, 40, 70)]))
    assert np.allclose(np.sort(radius), expected)
    assert packed.statistics["primitives"] == {"sphere": 180, "cylinder": 2}


def test_boxes_hold_what_is_below_them():
    packed = pack(scene_of(spheres(200)), LIMIT)
    root = packed.textures["nodes"].reshape(-1)[:16].view(layout.NODE.dtype)
    sphere = records(packed, layout.SPHERE, 200)
    lower = np.minimum(root["lower_0"], root["lower_1"])[0]
    upper = np.maximum(root["upper_0"], root["upper_1"])[0]
    assert (lower < (sphere["center"] - sphere["radius"][:, None]).min(axis=0)).all()
    assert (upper > (sphere["center"] + sphere["radius"][:, None]).max(axis=0)).all()


def test_what_shares_a_texture_begins_where_the_frame_says():
    scene = scene_of(spheres(2, material=1), materials=3)
    scene.materials[1] = Material(diffuse=(0.1, 0.2, 0.3), ior=1.7)
    scene.add(Planes(point=[[0, 0, -2.0], [0, 0, 7.0]], normal=[[0, 0, 2.0], [0, 0, -1.0]], material=[2, 1]))
    scene.lights = [Light.point((1, 2, 3), 10.0), Light.sun((0, 0, 1), 2.0)]
    scene.images = [Image(np.zeros((2, 3, 4))), Image(np.ones((5, 4, 4)), "CLOSEST", "CLIP")]
    packed = pack(scene, LIMIT)
    material = records(packed, layout.MATERIAL, 3)[1]
    assert np.allclose(material["diffuse"], [0.1, 0.2, 0.3]) and material["ior"] == np.float32(1.7)
    plane = records(packed, layout.PLANE, 2)
    assert np.allclose(plane["normal"], [[0, 0, 1], [0, 0, -1]]) and np.allclose(plane["offset"], [2.0, 7.0])
    assert records(packed, layout.PLANE_SURFACE, 2)["material"].tolist() == [2, 1]
    light = records(packed, layout.LIGHT, 2)
    assert light["kind"].tolist() == [0, 2] and light["position"].tolist() == [[1, 2, 3], [0, 0, 1]]
    image = records(packed, layout.IMAGE, 2)[1]
    assert (image["first"], image["width"], image["height"]) == (6, 4, 5)
    assert (image["interpolation"], image["extension"]) == (0, 2)
    assert packed.frame["plane_count"] == packed.frame["light_count"] == 2


def test_planes_only_and_nothing_at_all():
    packed = pack(scene_of(Planes(point=[[0, 0, 0]], normal=[[0, 0, 1]])), LIMIT)
    assert packed.frame["root_count"] == 0 and packed.features == {"HAS_PLANE"}
    packed = pack(scene_of(), LIMIT)
    assert packed.frame["root_count"] == 0 and not packed.features
    scene = scene_of()
    scene.instances = [Instances(Geometry(name="empty"), np.eye(4))]
    assert pack(scene, LIMIT).frame["root_count"] == 0


def test_features_are_those_that_the_scene_uses():
    scene = scene_of(spheres(3), world=World((1, 1, 1), 0), images=[Image(np.zeros((2, 2, 4)))])
    assert pack(scene, LIMIT).features == {"HAS_SPHERE", "HAS_SPHERE_LEAVES", "HAS_PROGRAMS"}
    scene.materials = [Material(diffuse=surface_image(0), absorption=(0, 1, 0))]
    scene.instances = [Instances(Geometry(Triangles(p0=[[0, 0, 0]], p1=[[1, 0, 0]], p2=[[0, 1, 0]])), np.eye(4))]
    kinds = {"HAS_SPHERE", "HAS_SPHERE_LEAVES", "HAS_TRIANGLE", "HAS_TRIANGLE_LEAVES"}
    assert pack(scene, LIMIT).features == kinds | {"HAS_PROGRAMS", "HAS_ABSORPTION", "HAS_INSTANCES"}


def test_few_of_a_kind_beside_many_stand_outside_of_the_tree():
    """Their records are there, and where they lie; no leaf leads to them. The box of all holds them."""
    floor = Triangles(p0=[[-9, -9, -2], [9, 9, -2]], p1=[[9, -9, -2], [-9, 9, -2]], p2=[[9, 9, -2], [-9, -9, -2]])
    center = np.random.default_rng(0).uniform(-1, 1, (4096, 3))
    for count, outside in ((4096, True), (4000, False)):
        scene = scene_of(Spheres(center=center[:count], radius=0.01), floor)
        packed = pack(scene, LIMIT, keep=True)
        assert {kind for kind, _, _ in leaves(packed)} == ({"sphere"} if outside else {"sphere", "triangle"})
        assert ("HAS_TRIANGLE_OUTSIDE" in packed.features) == outside != ("HAS_TRIANGLE_LEAVES" in packed.features)
        assert np.allclose(packed.bounds, [[-9, -9, -2], [9, 9, 1]], atol=0.05)
        found = records(packed, layout.TRIANGLE, 2)
        assert np.array_equal(np.sort(found["p0"], axis=0), np.sort(floor.p0, axis=0))
        if outside:
            assert packed.frame["outside_triangle"].tolist() == [0, 0, 2]
            assert packed.frame["outside_sphere"][2] == 0


def test_instances_share_geometry_and_materials():
    geometry = Geometry(Spheres(center=np.zeros((2, 3)), radius=1.0, material=[0, 1]))
    scene = scene_of(materials=4)
    matrix = np.diag([1.0, 2.0, -3.0, 1.0])
    scene.instances = [Instances(geometry, matrix, (2, 3)), Instances(geometry, np.eye(4), (2, 3))]
    packed = pack(scene, LIMIT)
    assert len(records(packed, layout.SPHERE, 2)) == 2 and packed.textures["spheres"].shape[:2] == (1, 2)
    first = records(packed, layout.INSTANCE, 2)["first_material"]
    assert first[0] == first[1] == 4, "one block of materials in the order of the slots"
    placed = records(packed, layout.INSTANCE_SURFACE, 2)
    to_object = records(packed, layout.INSTANCE, 2)
    for i in (0, 1):
        there, back = (
            np.stack([*(r[f"{name}_{axis}"][i] for axis in "xyz"), [0, 0, 0, 1]])
            for r, name in ((placed, "to_world"), (to_object, "to_object"))
        )
        assert np.allclose(there @ back, np.eye(4), atol=1e-6)


# The origin


@pytest.mark.parametrize("away", [0.0, 1e3, 1e6, 1e9])
def test_positions_are_relative_to_an_origin_near_the_camera(away):
    """A million metres away the records are as exact as at 0."""
    offset = np.array([away, -2.0 * away, away])
    packed = pack(scene_of(spheres(50, offset=offset), eye=np.add(offset, [0, -5, 0])), LIMIT)
    assert (packed.origin == 0.0).all() if away == 0.0 else np.abs(packed.origin - offset).max() < 40.0
    sphere = records(packed, layout.SPHERE, 50)
    exact = spheres(50, offset=offset)
    back = sphere["center"].astype(np.float64) + packed.origin
    order = np.argsort(sphere["radius"])
    assert np.abs(back[order] - exact.center).max() < 4e-6


def test_the_origin_stays_while_the_camera_moves_a_little():
    first = pack(scene_of(spheres(50, offset=1e6), eye=(1e6, 1e6 - 5, 1e6)), LIMIT).origin
    for step in np.linspace(0, 1, 10):
        packed = pack(scene_of(spheres(50, offset=1e6), eye=(1e6 + step, 1e6 - 5, 1e6)), LIMIT)
        assert (packed.origin == first).all()


def test_what_stands_in_the_world_by_the_identity_is_as_exact_as_the_shapes():
    """As what not all rays see, and a mesh whose transform was applied."""
    offset = np.array([1e6, 0.0, 0.0])
    scene = scene_of(eye=np.add(offset, [0, -5, 0]))
    scene.instances = [Instances(Geometry(spheres(50, offset=offset)), np.eye(4), visibility=Visibility.CAMERA)]
    packed = pack(scene, LIMIT)
    sphere, exact = records(packed, layout.SPHERE, 50), spheres(50, offset=offset)
    back = sphere["center"].astype(np.float64) + packed.origin
    assert np.abs(back[np.argsort(sphere["radius"])] - exact.center).max() < 4e-6
    placed = records(packed, layout.INSTANCE_SURFACE, 1)
    assert all(placed[f"to_world_{axis}"][0, 3] == 0.0 for axis in "xyz")


def test_lights_planes_and_instances_move_with_the_origin():
    offset = np.array([1e6, 0.0, 0.0])
    scene = scene_of(spheres(5, offset=offset), eye=np.add(offset, [0, -5, 0]))
    scene.add(Planes(point=[np.add(offset, [0, 0, -1.0])], normal=[[1.0, 0, 0]]))
    scene.lights = [Light.point(np.add(offset, [0, 0, 3.0]), 1.0), Light.sun((0, 0, 1), 1.0)]
    matrix = np.eye(4)
    matrix[:3, 3] = np.add(offset, [0, 2.0, 0])
    scene.instances = [Instances(Geometry(spheres(1)), matrix)]
    packed = pack(scene, LIMIT)
    light = records(packed, layout.LIGHT, 2)
    assert np.allclose(light["position"][0], np.add(offset, [0, 0, 3.0]) - packed.origin)
    assert np.allclose(light["position"][1], [0, 0, 1]), "a direction has no place"
    assert np.allclose(records(packed, layout.PLANE, 1)["offset"], packed.origin[0] - offset[0])
    placed = records(packed, layout.INSTANCE_SURFACE, 2)
    places = np.stack([placed[f"to_world_{axis}"][:, 3] for axis in "xyz"], axis=-1)
    assert any(np.allclose(place, np.add(offset, [0, 2.0, 0]) - packed.origin) for place in places)
    assert any(np.allclose(place, 0.0) for place in places), "the world's shapes are moved themselves"


def test_packing_stops_between_geometries():
    asked = []

    def stopped():
        asked.append(True)
        return len(asked) > 1

    blocks = [Instances(Geometry(spheres(5)), np.eye(4)[None]) for _ in range(3)]
    with pytest.raises(StoppedError):
        pack(scene_of(spheres(5), instances=blocks), LIMIT, stopped=stopped)
    assert len(asked) == 2


def test_an_image_too_large_is_reduced_and_said_so():
    picture = np.random.default_rng(0).random((100, 63, 4)).astype(np.float32)
    scene = scene_of(images=[Image(picture, name="wood.png"), Image(np.ones((8, 8, 4)), name="small")])
    packed = pack(scene, 1)
    assert packed.warnings == ["image 'wood.png' of 63 x 100 is too large for this device and was reduced to 31 x 50"]
    image = records(packed, layout.IMAGE, 2)
    assert (image["width"].tolist(), image["height"].tolist()) == ([31, 8], [50, 8])
    texels = packed.textures["images"].reshape(-1, 4)[: 31 * 50]
    assert np.allclose(texels.mean(axis=0), picture.mean(axis=(0, 1)), atol=0.01)
    assert np.allclose(texels[0], picture[:2, :2].mean(axis=(0, 1)), atol=1e-6)
    assert not pack(scene, LIMIT).warnings


def test_lights_have_shapes_where_one_of_them_does():
    scene = scene_of(lights=[Light.point((1, 2, 3), 1.0), Light.constant((0, 0, 1)), Light.sun((0, 0, 1), 1.0)])
    packed = pack(scene, LIMIT)
    assert "HAS_LIGHT_SHAPES" not in packed.features
    scene.lights.append(Light.area((0, 0, 0), (2, 0, 0), (0, 3, 0), 1.0, spread=np.pi / 2.0))
    packed = pack(scene, LIMIT)
    shapes = records(packed, layout.LIGHT_SHAPE, 4)
    assert "HAS_LIGHT_SHAPES" in packed.features
    assert packed.frame["seen_lamp_count"] == 1, "it comes first"
    assert shapes["axis_y"][0].tolist() == [0, 1.5, 0] and shapes["spread"] == pytest.approx([1, 0, 0, 0])
    assert shapes["seen_area"] == pytest.approx([6, 0, 0, 0])
