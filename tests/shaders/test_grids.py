"""Grids against brute force in float64, and against the trees whose place they take."""

import numpy as np
import pytest

from addon.engine import Session, Settings, grid, grid_packing, layout, reference
from addon.engine.leaves import MANY
from addon.engine.packing import pack
from addon.engine.primitives import Cylinders, Spheres, Triangles
from addon.engine.scene import Geometry, Instances, Material

from . import scenes, shapes
from .test_traversal import assert_as_brute_force, each_seed, random_rays, rays_for, traverse

COUNT = 5000

each_crowd = pytest.mark.parametrize("crowd", ["spheres", "both", "cylinders", "inside out"])


def crowd_of(rng, name):
    """Parts of shapes that crowd evenly in a cube."""
    scale = COUNT ** (-1 / 3)
    center, radius = rng.uniform(-1.0, 1.0, (COUNT, 3)), rng.uniform(0.1, 0.6, COUNT) * scale
    if name == "inside out":
        return [Spheres(center=center, radius=radius * rng.choice([-1.0, 1.0], COUNT))]
    spheres = Spheres(center=center, radius=radius)
    away = rng.uniform(0.5, 2.0, (COUNT, 1)) * scale * shapes.unit_vectors(rng, COUNT)
    cylinders = Cylinders(base=center, apex=center + away, radius=0.3 * radius)
    return {"spheres": [spheres], "cylinders": [cylinders], "both": [spheres, cylinders]}[name]


def crowded(rng, name, matrices=None):
    """A scene of such parts, in world space or instanced; its oracle."""
    scene, oracle = scenes.empty_scene(), scenes.Oracle()
    parts = crowd_of(rng, name)
    if matrices is None:
        for part in parts:
            part = scenes.numbered(scene, part)
            scene.add(part)
            oracle.add(int(part.material[0]), part)
        return scene, oracle
    parts = [scenes.slots(part, start * COUNT) for start, part in enumerate(parts)]
    geometry = Geometry(*parts)
    for matrix in matrices:
        first = scenes.new_materials(scene, COUNT * len(parts))
        scene.instances.append(Instances(geometry, matrix, tuple(range(first, first + COUNT * len(parts)))))
        for start, part in enumerate(parts):
            oracle.add(first + start * COUNT, part, matrix)
    return scene, oracle


@each_seed
@each_crowd
def test_a_crowd_alone(device, crowd, seed):
    rng = np.random.default_rng(seed)
    scene, oracle = crowded(rng, crowd)
    packed = pack(scene, device.max_texture_size)
    assert "HAS_GRID_ALONE" in packed.features
    assert ("HAS_GRID_CYLINDERS" in packed.features) == (crowd in ("both", "cylinders"))
    _, hit = assert_as_brute_force(device, scene, oracle, *rays_for(rng, oracle), unsure_at_most=0.1, packed=packed)
    assert hit.mean() > 0.5


@each_seed
@each_crowd
def test_instances_of_a_crowd(device, crowd, seed):
    rng = np.random.default_rng(seed)
    scene, oracle = crowded(rng, crowd, [scenes.random_affine(rng) for _ in range(2)])
    packed = pack(scene, device.max_texture_size)
    assert {"HAS_GRID", "HAS_INSTANCES"} <= packed.features and "HAS_GRID_ALONE" not in packed.features
    assert packed.statistics["bvh"]["grids"] == 1
    assert_as_brute_force(device, scene, oracle, *rays_for(rng, oracle), unsure_at_most=0.15, packed=packed)


@each_seed
def test_a_crowd_among_instances_with_trees(device, seed):
    """A program draws the world's grid, another one within an instance, and a tree."""
    rng = np.random.default_rng(seed)
    scene, oracle = crowded(rng, "both")
    for part in (crowd_of(rng, "spheres")[0], scenes.parts(rng, 600)[-1]):
        matrix, first = scenes.random_affine(rng), scenes.new_materials(scene, len(part))
        part = scenes.slots(part, 0)
        scene.instances.append(Instances(Geometry(part), matrix, tuple(range(first, first + len(part)))))
        oracle.add(first, part, matrix)
    packed = pack(scene, device.max_texture_size)
    assert packed.statistics["bvh"]["grids"] == 2 and "HAS_TRIANGLE_LEAVES" in packed.features
    assert_as_brute_force(device, scene, oracle, *rays_for(rng, oracle), unsure_at_most=0.15, packed=packed)


@each_seed
@each_crowd
@pytest.mark.parametrize("away", [0.0, 100.0, 1e4, 1e5])
def test_rays_meet_the_same_as_in_a_tree(device, crowd, away, seed):
    """Up to 100,000 times as far off as the crowd is large. Of spheres the tests are the same, bit by bit; a cylinder's
    unit axis is rounded elsewhere."""
    rng = np.random.default_rng(seed)
    scene, _ = crowded(rng, crowd)
    origin, direction = random_rays(rng, 20_000)
    origin = shapes.single(origin - away * direction)
    direction = shapes.single(shapes.normalized(rng.uniform(-1.0, 1.0, origin.shape) - origin))
    tree = traverse(device, scene, origin, direction, packed=pack(scene, device.max_texture_size, keep=True))
    found = traverse(device, scene, origin, direction)
    same = np.isclose(found.t, tree.t, rtol=0.0 if crowd in ("spheres", "inside out") else 1e-5)
    assert np.mean(~same) <= (1e-3 if away >= 1e4 or crowd in ("both", "cylinders") else 0.0)
    assert np.mean(found.any != tree.any) <= np.mean(~same)
    assert np.mean(found.number != tree.number) < 2e-2  # two at the same distance


@each_seed
def test_rays_along_the_faces_and_edges_of_cells(device, seed, monkeypatch):
    rng = np.random.default_rng(seed)
    made, build = [], grid_packing.grid.build
    monkeypatch.setattr(grid_packing.grid, "build", lambda *shapes: made.append(build(*shapes)) or made[-1])
    scene, oracle = crowded(rng, "spheres")
    packed = pack(scene, device.max_texture_size)
    (cells,) = made
    number = rng.integers(-1, cells.resolution + 2, (800, 3))
    origin = cells.lower + cells.size * (number + rng.choice([0.0, 0.0, 0.5], number.shape)) + packed.origin
    axis = rng.integers(0, 3, len(origin))
    direction = np.eye(3)[axis] * rng.choice([-1.0, 1.0], (len(origin), 1))
    direction[::4] = shapes.normalized(direction[::4] + np.eye(3)[(axis[::4] + 1) % 3])
    origin, direction = shapes.single(origin), shapes.single(direction)
    assert_as_brute_force(device, scene, oracle, origin, direction, unsure_at_most=0.1, packed=packed)


def test_what_does_not_crowd_keeps_its_tree():
    rng = np.random.default_rng(0)
    scene = scenes.empty_scene()
    scenes.new_materials(scene, 1)
    middle = rng.uniform(-1.0, 1.0, (20, 3))[rng.integers(0, 20, COUNT)]
    scene.add(Spheres(center=middle + 0.05 * rng.uniform(-1.0, 1.0, (COUNT, 3)), radius=np.full(COUNT, 0.001)))
    assert not {"HAS_GRID"} & pack(scene, 16384).features


def test_a_crowd_with_triangles_and_one_that_will_move_have_trees():
    rng = np.random.default_rng(0)
    scene, _ = crowded(rng, "spheres")
    assert "HAS_GRID" in pack(scene, 16384).features
    assert "HAS_GRID" not in pack(scene, 16384, keep=True).features
    corners = rng.uniform(-1.0, 1.0, (3, 20, 3))
    scene.add(Triangles(p0=corners[0], p1=corners[1], p2=corners[2]))
    assert "HAS_GRID" not in pack(scene, 16384).features


@pytest.mark.parametrize(("limit", "most"), [("grid_packing.MANY", COUNT), ("tree_packing._MOST_IN_GRIDS", COUNT - 1)])
def test_trees_where_there_are_too_many(limit, most, monkeypatch):
    scene, _ = crowded(np.random.default_rng(0), "spheres")
    assert "HAS_GRID" in pack(scene, 16384).features
    monkeypatch.setattr(f"addon.engine.{limit}", most)
    assert "HAS_GRID" not in pack(scene, 16384).features


def test_a_crowd_that_comes_to_a_scene_that_is_there(device):
    """Its grid lies behind the trees of the scene before; nothing in it is moved there as a node is."""

    def picture(*scenes_in_turn):
        session = Session(device)
        for scene in scenes_in_turn:
            session.load(scene, Settings(max_depth=1))
        session.start(64, 48)
        while session.step(1.0):
            pass
        found = session.pixels().copy()
        session.free()
        return found

    rng = np.random.default_rng(0)
    first, _ = scenes.mixed(rng, 0, 3)
    both = scenes.empty_scene()
    both.materials, both.instances = list(first.materials), list(first.instances)
    slot = scenes.new_materials(both, 1)
    both.materials[slot] = Material(glow=0.5)
    both.instances.append(Instances(Geometry(*crowd_of(rng, "both")), np.eye(4), (slot,)))
    assert np.array_equal(picture(first, both), picture(both))


def test_trees_where_grids_have_no_room():
    scene = scenes.empty_scene()
    scenes.new_materials(scene, 1)
    scene.add(*crowd_of(np.random.default_rng(0), "spheres"))
    assert "HAS_GRID" in pack(scene, 4096).features
    packed = pack(scene, 16)
    assert "HAS_GRID" not in packed.features
    assert packed.textures["nodes"].shape[0] <= 16


def test_integers_of_the_largest_grids_have_room():
    cells = grid.DENSITY * ((grid.LEAST_CELLS + 2) / (grid.LEAST_CELLS - 0.5)) ** 3
    texels = (cells + layout.GRID_ITEM.texels * grid.MOST_ITEMS) * MANY
    assert texels < 1 << reference.LOW_BITS


def test_references_of_items_have_room():
    """Beyond what an item can refer to there are trees."""
    hits = {0: layout.SPHERE.zeros(64)}
    hits[0]["center"], hits[0]["radius"] = np.indices((4, 4, 4)).reshape(3, -1).T, 0.4
    bases = np.zeros(5, np.int64)
    assert grid_packing.better_grid(hits, bases, 1e9) is not None
    bases[0] = (1 << 22) - 64
    assert grid_packing.better_grid(hits, bases, 1e9) is not None
    bases[0] += 1
    assert grid_packing.better_grid(hits, bases, 1e9) is None
