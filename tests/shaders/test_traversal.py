"""Nearest and any hit of whole scenes against brute force in float64."""

from dataclasses import dataclass

import numpy as np
import pytest

from addon.engine import layout, reference
from addon.engine.packing import pack
from addon.engine.primitives import Cylinders, Discs, Spheres, Triangles
from addon.engine.scene import Geometry, Instances, Visibility

from . import harness, scenes, shapes

each_seed = pytest.mark.parametrize("seed", range(2))

#: Evaluations of the reference in one test.
EVALUATIONS = 4_000_000


@dataclass(frozen=True)
class Traversed:
    t: np.ndarray  # (n,) nearest, inf for none
    number: np.ndarray  # (n,) of the material hit, -1 for none
    any: np.ndarray  # (n,) bool
    position: np.ndarray
    normal: np.ndarray
    error: np.ndarray
    spawned: np.ndarray


def traverse(device, scene, origin, direction, t_max=1e30, following=None, packed=None, kind=Visibility.CAMERA):
    packed = packed or pack(scene, device.max_texture_size)
    origin = origin - packed.origin
    hit, position, normal, spawned = harness.run(
        device,
        "traverse_frag.glsl",
        len(origin),
        packed.textures | {"test_rays": harness.texels(harness.ray_records(origin, direction, t_max, following, kind))},
        features=packed.features - {"HAS_IMAGES", "HAS_WORLD_IMAGE", "HAS_ABSORPTION"},
        constants=packed.constants,
        outputs=("out_hit", "out_position", "out_normal", "out_spawned"),
        frame=harness.frame_record(**packed.frame),
    )
    t = np.where(hit[:, 1] >= 0.0, hit[:, 0], np.inf)
    number = np.where(hit[:, 1] >= 0.0, normal[:, 3], -1).astype(int)
    at, spawned = position[:, :3] + packed.origin, spawned[:, :3] + packed.origin
    return Traversed(t, number, hit[:, 3] >= 0.0, at, normal[:, :3], position[:, 3], spawned)


def random_rays(rng, n, spread=1.0):
    """A third from outside, a third from within, a third along an axis; towards the cube of +-spread."""
    origin = rng.uniform(-spread, spread, (n, 3))
    origin[: n // 3] += shapes.unit_vectors(rng, n // 3) * 6.0 * spread
    direction = rng.uniform(-spread, spread, (n, 3)) - origin
    axis = rng.integers(0, 3, n - 2 * (n // 3))
    direction[2 * (n // 3) :] = np.eye(3)[axis] * rng.choice([-1.0, 1.0], len(axis))[:, None]
    origin[2 * (n // 3) :] -= direction[2 * (n // 3) :] * rng.uniform(0.0, 6.0, (len(axis), 1))
    return shapes.single(origin), shapes.single(shapes.normalized(direction))


def rays_for(rng, oracle, spread=1.0):
    return random_rays(rng, int(np.clip(EVALUATIONS / 5 / max(len(oracle), 1), 150, 10_000)), spread)


#: How far rays are moved to find out which answers hang on rounding, relative to the scene.
WOBBLE = 2.0**-17


def assert_as_brute_force(device, scene, oracle, origin, direction, unsure_at_most=0.02, packed=None):
    """Nearest, any and limited hits as the oracle's, where rays moved a little get the same answer."""
    direction64 = shapes.normalized(direction)
    t, number, second = oracle.nearest(origin, direction64)
    reach = np.linalg.norm(origin, axis=-1) + 2.0
    across = shapes.normalized(np.cross(direction64, np.eye(3)[np.argmin(np.abs(direction64), axis=-1)]))
    sure, spread = np.ones(len(t), bool), np.zeros(len(t))
    for side in (across, -across, np.cross(direction64, across), -np.cross(direction64, across)):
        t_moved, number_moved, _ = oracle.nearest(origin + (WOBBLE * reach)[:, None] * side, direction64)
        sure &= number_moved == number
        with np.errstate(invalid="ignore"):
            spread += np.where(np.isfinite(t) & np.isfinite(t_moved), np.abs(t - t_moved), 0.0)
    hit = np.isfinite(t)
    bound = spread + WOBBLE * reach
    packed = packed or pack(scene, device.max_texture_size)
    found = traverse(device, scene, origin, direction, packed=packed)
    tied = hit & (second - np.where(hit, t, 0.0) <= 2.0 * bound)
    sure |= tied & np.isfinite(found.t)
    assert sure.mean() >= 1.0 - unsure_at_most, f"{1.0 - sure.mean():.3f} of the rays depend on rounding"
    wrong = sure & ((found.number != number) & ~tied | (np.isfinite(found.t) != hit))
    assert not wrong.any(), explain(wrong, origin, direction, found, t, number)
    both = sure & hit
    with np.errstate(invalid="ignore"):
        off = both & (np.abs(found.t - t) > bound)
    assert not off.any(), explain(off, origin, direction, found, t, number)
    assert (found.any == np.isfinite(found.t)).all(), "any hit is found exactly where there is a nearest one"
    if both.any():
        assert_limited(device, scene, packed, origin[both], direction[both], found, both)
    return found, both


def assert_limited(device, scene, packed, origin, direction, found, rows):
    """Segments that end just before the hit miss, those that end just behind it find the same."""
    t = found.t[rows].astype(np.float32)
    short = traverse(
        device, scene, origin, direction, np.nextafter(t, np.float32(0.0)) * np.float32(0.99999), packed=packed
    )
    assert not np.isfinite(short.t).any() and not short.any.any()
    longer = traverse(device, scene, origin, direction, t * np.float32(1.00001), packed=packed)
    assert np.allclose(longer.t, t, rtol=3e-7, atol=0.0) and longer.any.all()


def explain(rows, origin, direction, found, t, number):
    i = int(np.argmax(rows))
    return (
        f"{int(rows.sum())} of {len(rows)}, number {i}: origin {origin[i].tolist()} direction {direction[i].tolist()} "
        f"found {found.t[i]!r} of {found.number[i]}, brute force {t[i]!r} of {number[i]}"
    )


@each_seed
@pytest.mark.parametrize("instances", [0, 5])
@pytest.mark.parametrize("count", [1, 20, 300, 5000])
def test_mixed_scenes(device, count, instances, seed):
    rng = np.random.default_rng([seed, count, instances])
    scene, oracle = scenes.mixed(rng, count, instances if count < 5000 else 1)
    _, hit = assert_as_brute_force(device, scene, oracle, *rays_for(rng, oracle))
    assert hit.mean() > 0.1


@each_seed
@pytest.mark.parametrize("instances", [0, 2])
def test_few_of_a_kind_stand_outside_of_the_tree(device, instances, seed):
    rng = np.random.default_rng([seed, instances])
    scene, oracle = scenes.mixed(rng, 0, instances)
    many = Spheres(center=rng.uniform(-1.0, 1.0, (5000, 3)), radius=rng.uniform(0.005, 0.03, 5000))
    for part in (many, *scenes.parts(rng, 12)):
        part = scenes.numbered(scene, part)
        scene.add(part)
        oracle.add(int(part.material[0]), part)
    packed = pack(scene, device.max_texture_size)
    few = {"CYLINDER", "CONE", "DISC", "TRIANGLE"}
    assert {f"HAS_{kind}_OUTSIDE" for kind in few} <= packed.features
    assert ("HAS_CONE_LEAVES" in packed.features) == (instances > 0)
    _, hit = assert_as_brute_force(device, scene, oracle, *rays_for(rng, oracle), packed=packed)
    assert hit.mean() > 0.1


@each_seed
def test_spheres_alone_and_beside_cylinders(device, seed):
    """Beside cylinders a leaf holds one sphere, without any it may hold several; one program draws both."""
    rng = np.random.default_rng(seed)
    scene, oracle = scenes.empty_scene(), scenes.Oracle()
    for part in scenes.parts(rng, 240)[:2]:
        part = scenes.numbered(scene, part)
        scene.add(part)
        oracle.add(int(part.material[0]), part)
    heap = scenes.slots(SPECIAL["heap"](rng), 0)
    first = scenes.new_materials(scene, len(heap))
    matrix = scenes.random_affine(rng)
    scene.instances.append(Instances(Geometry(heap), matrix, tuple(range(first, first + len(heap)))))
    oracle.add(first, heap, matrix)
    assert {"HAS_QUADRIC_LEAVES", "HAS_SPHERE_RUNS"} <= pack(scene, device.max_texture_size).features
    assert_as_brute_force(device, scene, oracle, *rays_for(rng, oracle), unsure_at_most=0.05)


@each_seed
def test_instances_alone_with_planes(device, seed):
    rng = np.random.default_rng(seed)
    scene, oracle = scenes.mixed(rng, 0, 12)
    scenes.with_planes(rng, scene, oracle)
    assert_as_brute_force(device, scene, oracle, *rays_for(rng, oracle))


@each_seed
def test_planes_only(device, seed):
    rng = np.random.default_rng(seed)
    scene, oracle = scenes.empty_scene(), scenes.Oracle()
    scenes.with_planes(rng, scene, oracle, 3)
    assert_as_brute_force(device, scene, oracle, *random_rays(rng, 5000))


def test_nothing(device):
    scene = scenes.empty_scene()
    scene.materials = [scenes.Material()]
    found = traverse(device, scene, *random_rays(np.random.default_rng(0), 500))
    assert not np.isfinite(found.t).any() and not found.any.any()


def one(primitives):
    scene, oracle = scenes.empty_scene(), scenes.Oracle()
    part = scenes.numbered(scene, primitives)
    scene.add(part)
    oracle.add(0, part)
    return scene, oracle


def flat_grid():
    """A floor of 2 x 400 triangles at z = 0.3, axis-aligned and without any height."""
    x, y = (g.ravel() / 10.0 - 1.0 for g in np.meshgrid(np.arange(20), np.arange(20)))
    corners = [
        np.stack([x + i, y + j, np.full(400, 0.3)], axis=-1) for i, j in ((0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1))
    ]
    a, b, c, d = corners
    return Triangles(p0=np.concatenate([a, a]), p1=np.concatenate([b, c]), p2=np.concatenate([c, d]))


SPECIAL = {
    "one sphere": lambda rng: Spheres(center=[[0.1, 0.2, 0.3]], radius=[0.7]),
    "concentric spheres": lambda rng: Spheres(center=np.zeros((40, 3)), radius=np.linspace(0.02, 0.8, 40)),
    "equal centroids": lambda rng: Cylinders(
        base=-(v := shapes.unit_vectors(rng, 60)), apex=v, radius=np.full(60, 0.05)
    ),
    "heap": lambda rng: Spheres(center=rng.normal(size=(300, 3)) * 0.05, radius=rng.uniform(0.3, 0.6, 300)),
    "flat floor": lambda rng: flat_grid(),
    "flat discs": lambda rng: Discs(
        center=np.concatenate([rng.uniform(-1, 1, (100, 2)), np.zeros((100, 1))], axis=1),
        normal=[0, 0, 1.0],
        radius=0.1,
    ),
    "duplicates": lambda rng: Spheres(
        center=np.repeat(rng.uniform(-1, 1, (5, 3)), 30, axis=0), radius=np.full(150, 0.3)
    ),
    "large and small": lambda rng: Spheres(
        center=rng.uniform(-1, 1, (200, 3)), radius=shapes.log_uniform(rng, 1e-3, 1.0, 200)
    ),
}


@each_seed
@pytest.mark.parametrize("name", SPECIAL)
def test_special_scenes(device, name, seed):
    rng = np.random.default_rng(seed)
    scene, oracle = one(SPECIAL[name](rng))
    _, hit = assert_as_brute_force(device, scene, oracle, *rays_for(rng, oracle), unsure_at_most=0.05)
    assert hit.any()


def test_rays_parallel_to_the_floor_and_through_its_edges(device):
    """Along z at the grid's vertices and edges nothing slips through; within the floor's plane nothing is hit."""
    scene, _ = one(flat_grid())
    x, y = (g.ravel() for g in np.meshgrid(*[np.linspace(-0.95, 0.95, 39)] * 2))
    points = np.stack([x, y, np.full_like(x, 2.0)], axis=-1).astype(np.float32)
    found = traverse(device, scene, points, np.broadcast_to([0.0, 0.0, -1.0], points.shape))
    assert np.allclose(found.t, 1.7, rtol=1e-6)
    points[:, 2] = np.float32(0.3)
    points[:, 0] -= 4.0
    assert not np.isfinite(traverse(device, scene, points, np.broadcast_to([1.0, 0.0, 0.0], points.shape)).t).any()


def icosphere(rng, levels):
    """A closed mesh of a bumpy ball: vertices (v, 3) float32 and faces (f, 3)."""
    vertices = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    faces = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
    for _ in range(levels):
        edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
        unique, back = np.unique(edges, axis=0, return_inverse=True)
        middle = len(vertices) + back.reshape(3, -1)
        vertices = np.concatenate([vertices, shapes.normalized(vertices[unique].sum(axis=1))])
        (a, b, c), (ab, bc, ca) = faces.T, middle
        faces = np.concatenate([np.stack(f, axis=-1) for f in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return (vertices * rng.uniform(0.8, 1.2, (len(vertices), 1))).astype(np.float32), faces


@each_seed
@pytest.mark.parametrize("scale", [1e-4, 1.0, 1e5])
@pytest.mark.parametrize("instanced", [False, True])
def test_a_closed_mesh_is_watertight(device, instanced, scale, seed):
    """Rays from the middle of a closed mesh at its vertices and at points of its edges never slip through."""
    rng = np.random.default_rng(seed)
    vertices, faces = icosphere(rng, 4)
    vertices = vertices * np.float32(scale)
    mesh = Triangles(**{f"p{i}": vertices[faces[:, i]] for i in range(3)})
    scene = scenes.empty_scene()
    scenes.new_materials(scene, 1)
    if instanced:
        scene.instances.append(Instances(Geometry(mesh), scenes.random_affine(rng), (0,)))
        matrix = scene.instances[0].matrices[0]
    else:
        scene.add(mesh)
        matrix = np.eye(4)
    share = rng.choice([0.5, 0.25, 0.1, rng.random()], len(faces))[:, None]
    targets = np.concatenate([vertices, vertices[faces[:, 0]] * share + vertices[faces[:, 1]] * (1.0 - share)])
    targets = targets.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    start = rng.normal(size=targets.shape) * 0.1 * scale * rng.choice([0.0, 1.0], (len(targets), 1))
    origin = shapes.single(start @ matrix[:3, :3].T + matrix[:3, 3])
    direction = shapes.single(shapes.normalized(targets - origin))
    found = traverse(device, scene, origin, direction)
    assert np.isfinite(found.t).all(), f"{(~np.isfinite(found.t)).sum()} of {len(origin)} slipped through"
    assert found.any.all()


@each_seed
@pytest.mark.parametrize("away", [3.0, 100.0, 1000.0])
def test_a_closed_mesh_is_watertight_from_afar(device, away, seed):
    """Rays from afar along a coordinate plane, at vertices that lie in it or beside them: there a box's face is told
    apart far better than the triangles that meet there."""
    rng = np.random.default_rng(seed)
    vertices, faces = icosphere(rng, 5)
    scene = scenes.empty_scene()
    scenes.new_materials(scene, 1)
    scene.add(Triangles(**{f"p{i}": vertices[faces[:, i]] for i in range(3)}))
    for axis in range(3):
        targets = np.repeat(vertices[np.abs(vertices[:, axis]) < 1e-12].astype(np.float64), 100, axis=0)
        outwards = shapes.normalized(targets) + 0.3 * shapes.unit_vectors(rng, len(targets))
        outwards[:, axis] = shapes.log_uniform(rng, 1e-9, 1e-3, len(targets)) * rng.choice([-1, 0, 1], len(targets))
        targets[:, axis] = shapes.log_uniform(rng, 1e-8, 1e-4, len(targets)) * rng.choice([-1, 0, 1], len(targets))
        origin = shapes.single(targets + away * shapes.normalized(outwards))
        direction = shapes.single(shapes.normalized(targets - origin))
        found = traverse(device, scene, origin, direction)
        assert np.isfinite(found.t).all(), f"{(~np.isfinite(found.t)).sum()} of {len(origin)} slipped through"
        assert found.any.all()


@each_seed
def test_surfaces_of_instances(device, seed):
    """Positions lie on the world's surface within the error; normals stand on it; spawned rays do not hit again."""
    rng = np.random.default_rng(seed)
    for _ in range(4):
        matrix = scenes.random_affine(rng)
        scene = scenes.empty_scene()
        scenes.new_materials(scene, 1)
        scene.instances.append(Instances(Geometry(Spheres(center=[[0.0, 0.0, 0.0]], radius=[1.0])), matrix, (0,)))
        origin, direction = random_rays(rng, 20_000)
        found = traverse(device, scene, origin, direction)
        hit = np.isfinite(found.t)
        assert hit.mean() > 0.05
        inverse = np.linalg.inv(matrix)
        local = found.position[hit] @ inverse[:3, :3].T + inverse[:3, 3]
        radius = np.linalg.norm(local, axis=-1)
        gradient = (local / radius[:, None]) @ inverse[:3, :3]
        distance = np.abs(radius - 1.0) / np.linalg.norm(gradient, axis=-1)
        assert (distance <= found.error[hit] / 4.0).all(), (distance / found.error[hit]).max()
        assert np.abs(found.normal[hit] - shapes.normalized(gradient)).max() < 1e-5
        following = shapes.single(shapes.normalized(found.normal[hit] + 0.9999 * shapes.unit_vectors(rng, hit.sum())))
        again = traverse(device, scene, origin[hit], direction[hit], following=following)
        outside = np.linalg.norm(again.spawned @ inverse[:3, :3].T + inverse[:3, 3], axis=-1)
        assert (outside > 1.0).all()
        assert not np.isfinite(traverse(device, scene, again.spawned, following).t).any()


def test_references_survive_the_gpu(device):
    """Indices past 2^23, kinds and counts as numpy packs them and as GLSL takes them apart."""
    rng = np.random.default_rng(0)
    last = 2**reference.INDEX_BITS - 1
    index = np.concatenate([[0, 1, 2**23 - 1, 2**23, 2**23 + 1, last], rng.integers(0, last, 5000, endpoint=True)])
    kind = rng.integers(0, layout.KINDS.index("instance"), len(index), endpoint=True)
    count = rng.integers(1, reference.MAX_LEAF_SIZE, len(index), endpoint=True)
    low, high = reference.split_index(index)
    leaf = reference.pack_leaf(kind, count, high)
    inner = reference.pack_leaf(0, 0, high)
    color, root = harness.run_values(
        device, "index_frag.glsl", low, leaf, low, inner, outputs=("out_color", "out_root")
    )
    assert np.array_equal(color[:, 0], kind) and np.array_equal(color[:, 1], count)
    assert np.array_equal(color[:, 2].astype(np.int64) + color[:, 3].astype(np.int64) * 65536, index)
    assert (root[:, 0] == 0).all() and (root[:, 1] == 1).all()
    assert np.array_equal(root[:, 2].astype(np.int64) + root[:, 3].astype(np.int64) * 65536, index)


@each_seed
@pytest.mark.parametrize("solid", ["cylinder", "cone"])
def test_a_solid_is_closed_at_its_rim(device, solid, seed):
    """Rays at the circle where the side meets its cap, on into the body, do not get in between the two."""
    rng = np.random.default_rng(seed)
    for _ in range(5):
        axis, base = shapes.unit_vectors(rng, 1), rng.uniform(-1, 1, (1, 3))
        scene = scenes.empty_scene()
        scenes.new_materials(scene, 1)
        if solid == "cylinder":
            scene.add_cylinders(base, base + axis, [0.5])
        else:
            scene.add_cones(base, base + axis, [0.5], [0.2])
        rim = base + 0.5 * shapes.normalized(np.cross(axis, shapes.unit_vectors(rng, 5000)))
        inside = base + 0.5 * axis + 0.1 * shapes.unit_vectors(rng, 5000)
        origin = shapes.single(rim - 3.0 * shapes.normalized(inside - rim))
        direction = shapes.single(shapes.normalized(rim - origin))
        found = traverse(device, scene, origin, direction)
        assert np.allclose(found.t, 3.0, atol=1e-4), f"{(np.abs(found.t - 3.0) > 1e-4).sum()} got in"
