"""The benchmark's scenes: as many shapes as their formulas and the databases' author say, where they belong."""

import numpy as np
import pytest

from benchmarks import scenes
from benchmarks.scenes import crystal, gears, rings, shells, teapot
from examples.standard_scenes import balls


def _parts(scene):
    return {part.kind: part for _, part in scene.shapes.kinds()}


@pytest.mark.parametrize("depth, spheres", [(0, 1), (1, 10), (4, 7381), (6, 597871)])
def test_sphereflakes_have_the_published_numbers(depth, spheres):
    assert balls(depth).primitive_counts()["sphere"] == spheres


def test_balls_touch_the_ones_that_carry_them():
    part = _parts(balls(1))["sphere"]
    distance = np.linalg.norm(part.center[1:] - part.center[0], axis=-1)
    np.testing.assert_allclose(distance, part.radius[0] + part.radius[1:], rtol=1e-12)


@pytest.mark.parametrize("size", [1, 2, 7])
def test_rings_have_the_published_numbers(size):
    knots = size * (size + 1) * (2 * size + 1) // 6
    assert rings(size).primitive_counts() == {"sphere": 30 * knots, "cylinder": 30 * knots, "triangle": 2}


def test_the_pentagons_of_a_ring_do_not_touch():
    part = _parts(rings(1))["cylinder"]
    share = np.linspace(0.0, 1.0, 101)[:, None]
    points = part.base[:, None] + share * (part.apex - part.base)[:, None]
    pentagon = np.arange(30) // 5
    apart = np.linalg.norm(points[:, None, :, None] - points[None, :, None], axis=-1).min(axis=(2, 3))
    assert apart[pentagon[:, None] != pentagon[None]].min() > 2.0 * part.radius.max()


@pytest.mark.parametrize("size", [1, 4])
def test_gears_are_closed_and_face_outward(size):
    part = _parts(gears(size))["triangle"].take(slice(2, None))
    assert len(part) == 576 * size**3
    volume = np.einsum("ni,ni->", part.p0, np.cross(part.p1, part.p2)) / 6.0
    wheel = np.pi * (0.5 * 1.5 / size) ** 2 * 0.3 * 1.5 / size
    assert volume == pytest.approx(wheel * size**3, rel=0.1)


def test_gears_mesh_without_touching():
    """Teeth reach into the neighbour's gaps: closer than the tips' radii, and no corner lies within the other wheel."""
    part = _parts(gears(2))["triangle"].take(slice(2, None))
    corners = np.concatenate([part.p0, part.p1, part.p2])
    left = corners[(corners[:, 0] < 0.4) & (np.abs(corners[:, 1] + 0.375) < 0.41) & (corners[:, 2] < 0)]
    assert left[:, 0].max() > 0.0  # past the middle between the axes at -0.375 and 0.375


def test_a_teapot_is_smooth_and_its_normals_look_outward():
    part = _parts(teapot(6))["triangle"]
    pot = part.take(part.n0.any(axis=-1))
    assert 0.95 * 36 * 2 * 6**2 <= len(pot) <= 36 * 2 * 6**2
    flat = np.cross(pot.p1 - pot.p0, pot.p2 - pot.p0)
    assert (np.einsum("ni,ni->n", flat, pot.n0) > 0.0).mean() > 0.97
    body = pot.take(np.hypot(*pot.p0[:, :2].T) < 1.0)
    top = body.p0[:, 2] > 2.5
    assert top.any() and (body.n0[top, 2] > 0.0).all()


def test_shells_spheres_overlap_and_stand_on_the_square():
    part = _parts(shells(2))["sphere"]
    assert len(part) == 480 * 4
    steps = np.linalg.norm(np.diff(part.center[:480], axis=0), axis=-1)
    assert (steps < part.radius[:479] + part.radius[1:480]).all()
    assert (part.center[:, 2] - part.radius).min() == pytest.approx(-0.5, abs=1e-12)


@pytest.mark.parametrize("size", [1, 2, 5])
def test_crystal_counts_and_bonds(size):
    parts = _parts(crystal(size))
    assert len(parts["sphere"]) == 8 * size**3
    assert len(parts["cylinder"]) == 16 * size**3 - 12 * size**2 + 3 * size
    centers = {tuple(np.round(c, 9)) for c in parts["sphere"].center}
    ends = np.concatenate([parts["cylinder"].base, parts["cylinder"].apex])
    assert {tuple(np.round(c, 9)) for c in ends} <= centers


def test_a_box_fills_a_tenth():
    part = _parts(scenes.random_box(100_000))["sphere"]
    assert len(part) == 100_000
    assert (np.abs(part.center) <= 1.0).all()
    assert (4.0 / 3.0 * np.pi * part.radius.astype(float) ** 3).sum() / 8.0 == pytest.approx(0.065, abs=0.05)


@pytest.mark.parametrize("family", scenes.FAMILIES)
def test_every_family_is_made_as_all_peers_can_draw_it(family):
    size = {"box": 100, "teapot": 2, "balls": 1}.get(family, 2)
    scene = scenes.make(f"{family}:{size}")
    assert scene.camera.clip == (0.0, 1e30)
    assert scene.lights
    for material in scene.materials:
        assert not (any(material.transmit) and any(material.diffuse))
    triangles = _parts(scene).get("triangle")
    assert triangles is None or not triangles.one_sided.any()


def test_an_unknown_family_is_named():
    with pytest.raises(ValueError, match="bolls"):
        scenes.make("bolls:3")
