"""Rays of every kind see what they are to see: whole scenes against brute force over what is left of them."""

import numpy as np
import pytest

from addon.engine.packing import pack
from addon.engine.primitives import Planes
from addon.engine.scene import Geometry, Instances, Visibility

from . import scenes, shapes
from .test_traversal import random_rays, traverse

#: As in ray_lib.glsl: a shadow ray that only shadow catchers stop.
SHADOW_OF_CATCHERS = int(Visibility.SHADOW | Visibility.SHADOW_CATCHER)
KINDS = (Visibility.CAMERA, Visibility.GLOSSY, Visibility.TRANSMISSION, Visibility.SHADOW, SHADOW_OF_CATCHERS)


def scene_of_visibilities(rng, world_shapes):
    """Forty instances and four planes of random visibility; first material, primitives, matrix, visibility of each."""
    scene, entries = scenes.empty_scene(), []

    def add(part, matrix, visibility):
        entries.append((len(scene.materials), part, matrix, visibility))
        return scenes.new_materials(scene, len(part))

    if world_shapes:
        for part in scenes.parts(rng, 30):
            first = add(part, None, int(Visibility.ALL))
            scene.add(part._with({"material": np.arange(first, first + len(part), dtype=np.int32)}))
    sphere = shapes.spheres(rng, 1)._with(
        {"center": np.zeros((1, 3)), "radius": np.ones(1), "material": np.zeros(1, int)}
    )
    geometry = Geometry(sphere)
    for _ in range(40):
        matrix = scenes.random_affine(rng)
        matrix[:3, :3] *= 0.3
        visibility = int(rng.integers(0, 128))
        first = add(sphere, matrix, visibility)
        scene.instances.append(Instances(geometry, matrix, (first,), visibility=Visibility(visibility)))
    for _ in range(4):
        visibility = int(rng.integers(0, 128))
        point, normal = rng.uniform(-2.0, 2.0, (1, 3)), shapes.unit_vectors(rng, 1)
        plane = Planes(point=point, normal=normal, visibility=visibility)
        first = add(plane, None, visibility)
        scene.add(plane._with({"material": np.array([first], np.int32)}))
    return scene, entries


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("world_shapes", [False, True])
def test_each_kind_of_ray(device, world_shapes, seed):
    rng = np.random.default_rng([seed, world_shapes])
    scene, entries = scene_of_visibilities(rng, world_shapes)
    packed = pack(scene, device.max_texture_size)
    assert "HAS_VISIBILITY" in packed.features
    origin, direction = random_rays(rng, 3000)
    numbers = set()
    for kind in KINDS:
        oracle = scenes.Oracle()
        for first, part, matrix, visibility in entries:
            if visibility & int(kind) == int(kind):
                oracle.add(first, part, matrix)
        t, number, second = oracle.nearest(origin, shapes.normalized(direction))
        found = traverse(device, scene, origin, direction, packed=packed, kind=kind)
        with np.errstate(invalid="ignore"):
            same = np.isclose(found.t, t, rtol=1e-4, atol=1e-4) & ((found.number == number) | (second - t < 1e-3))
        same |= np.isinf(t) & np.isinf(found.t)
        assert same.mean() > 0.995, f"kind {int(kind)}: {(~same).sum()} of {len(same)} differ"
        assert np.array_equal(found.any, np.isfinite(found.t))
        numbers.add(tuple(np.bincount(found.number + 1, minlength=len(scene.materials) + 1)))
    assert len(numbers) == len(KINDS), "each kind sees something else"


def test_nothing_is_tested_where_all_see_all(device):
    scene, _ = scenes.mixed(np.random.default_rng(0), 20, 2)
    features = pack(scene, device.max_texture_size).features
    assert not features & {"HAS_VISIBILITY", "HAS_HOLDOUT", "HAS_SHADOW_CATCHER"}


def test_catchers_among_shapes_without_instances(device):
    """With nothing but world shapes and planes, a catcher's shadow ray meets only the planes that are catchers."""
    rng = np.random.default_rng(3)
    scene, oracle = scenes.empty_scene(), scenes.Oracle()
    for part in scenes.parts(rng, 60):
        scene.add(scenes.numbered(scene, part))
    for visibility in (Visibility.ALL, Visibility.ALL | Visibility.SHADOW_CATCHER):
        plane = Planes(point=rng.uniform(-1, 1, (1, 3)), normal=shapes.unit_vectors(rng, 1), visibility=int(visibility))
        plane = scenes.numbered(scene, plane)
        scene.add(plane)
    oracle.add(int(plane.material[0]), plane)
    origin, direction = random_rays(rng, 2000)
    t, number, _ = oracle.nearest(origin, shapes.normalized(direction))
    found = traverse(device, scene, origin, direction, kind=SHADOW_OF_CATCHERS)
    assert np.isfinite(t).any() and np.array_equal(found.number, number)
    assert np.allclose(found.t, t, rtol=1e-4)
