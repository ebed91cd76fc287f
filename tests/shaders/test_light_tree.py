"""Choosing among many lights: what is chosen is as probable as is said, nothing that gives light is left out."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine import Light
from addon.engine.light_packing import lamp_bounds
from addon.engine.light_tree import build_light_tree

from . import harness
from .test_lights import seen


def lamps(count, seed=0):
    """Lights of all kinds around the origin."""
    rng = np.random.default_rng(seed)
    made = []
    for number, place in enumerate(rng.normal(size=(count, 3)) * 5.0):
        direction, watts = rng.normal(size=3), 10.0 ** rng.uniform(1.0, 3.0)
        made.append(
            (
                lambda p, d, w: Light.point(p, w, radius=0.2),
                lambda p, d, w: Light.point(p, w, radius=1e-3),
                lambda p, d, w: Light.spot(p, d, w, 1.0, 0.5, radius=0.1),
                lambda p, d, w: Light.area(p, (1, 0, 0), (0, 1, 0), w, spread=2.0),
                lambda p, d, w: Light.sun(d, w / 100.0, angle=0.2),
                lambda p, d, w: replace(Light.point(p, w / 30.0, radius=0.1), falls_off=False),
                lambda p, d, w: Light.area(p, (1, 0, 0), (0, 1, 1), w),
            )[number % 7](place, direction, watts)
        )
    return made


def asked(device, lights, points, normals, around=0.0, u=0.0, angle=0.35):
    """(light, probability (n,), importance of node i for input i (n,), color of the cut (n, 3), its rays (n,))."""
    nodes = build_light_tree(lamp_bounds(lights, np.zeros(3)))
    count = len(nodes)
    columns = np.broadcast_arrays(*np.transpose(points), around, *np.transpose(normals), u)
    pick, importance, cut = harness.run_values(
        device,
        "light_tree_frag.glsl",
        *(np.ravel(column) for column in columns),
        textures={"tables": harness.texels(nodes)},
        outputs=("out_pick", "out_importance", "out_cut"),
        frame=harness.frame_record(light_node_count=count, light_cut_end=count, light_cut_angle=angle),
    )
    return pick[:, 0].astype(int), pick[:, 1].astype(np.float64), importance[:, 0], cut[:, :3], cut[:, 3]


@pytest.mark.parametrize("around", [0.0, 1.0])
@pytest.mark.parametrize("seed", range(3))
def test_lights_are_chosen_as_often_as_is_said(device, around, seed):
    lights, rng = lamps(60, seed), np.random.default_rng(seed)
    point, normal, count = rng.normal(size=3), rng.normal(size=3), 40_000
    normal /= np.linalg.norm(normal)
    tile = np.ones((count, 1))
    u = (np.arange(count) + 0.5) / count
    light, probability, *_ = asked(device, lights, tile * point, tile * normal, around, u)
    chosen = np.unique(light[light >= 0])
    often = np.bincount(light + 1, minlength=61)[1:][chosen] / count
    said = np.array([probability[light == number][0] for number in chosen])
    assert np.ptp(probability[light == chosen[0]]) < 1e-5, "the same for the same light"
    assert often == pytest.approx(said, abs=3e-4)
    assert said.sum() == pytest.approx(np.mean(light >= 0), abs=5e-3) and np.mean(light >= 0) > 0.3


def test_what_gives_light_is_chosen(device):
    """The mean of what is chosen over its probability is what all give, from their sampled points."""
    lights, rng, count = lamps(42, 5), np.random.default_rng(6), 20_000
    point, normal = rng.normal(size=3), np.array([0.0, 0.6, 0.8])
    u = rng.uniform(size=(count, 3))
    tile = np.ones((count, 1))
    chosen, probability, *_ = asked(device, lights, tile * point, tile * normal, 0.0, u[:, 0])
    total, estimate = 0.0, np.zeros(count)
    for number, light in enumerate(lights):
        radiance, _, direction, _ = seen(device, light, tile * point, u[:, 1:])
        given = radiance[:, 0] * np.maximum(direction @ normal, 0.0)
        total += given.mean()
        rows = chosen == number
        estimate[rows] = given[rows] / probability[rows]
    error = estimate.std() / np.sqrt(count)
    assert estimate.mean() == pytest.approx(total, abs=5.0 * error) and error < 0.02 * total


def test_a_point_within_or_behind_everything(device):
    lights = [Light.point((0, 0, 5), 10.0, radius=0.5), Light.point((0, 1, 5), 10.0), Light.point((1, 0, 4), 10.0)]
    below = asked(device, lights, [(0, 0, 0.0)], [(0, 0, -1.0)], 0.0, 0.3)
    assert below[0][0] == -1 and below[4][0] == 0, "nothing is asked behind the surface"
    within = asked(device, lights, [(0, 0, 5.2)] * 9, [(0, 0, 1.0)] * 9, 0.0, np.linspace(0.0, 0.99, 9))
    assert (within[0] >= 0).all() and np.isfinite(within[1]).all(), "a ball is all around who is in it"


@pytest.mark.parametrize("angle", [-1.0, 0.1, 0.35, 1.0])
def test_a_cut_holds_every_light_that_is_not_dark_once(device, angle):
    """Point lights, around: each is somewhere in the cut; the wider the angle, the fewer rays."""
    rng = np.random.default_rng(8)
    lights = [Light.point(place, 10.0, (1.0, 2.0, 3.0)) for place in rng.uniform(-10.0, 10.0, (500, 3))]
    total = np.sum([light.color for light in lights], axis=0)
    points = rng.uniform(-12.0, 12.0, (200, 3))
    *_, color, rays = asked(device, lights, points, np.tile((0.0, 0.0, 1.0), (200, 1)), 1.0, 0.0, angle)
    assert np.allclose(color, total, rtol=1e-4)
    fewest, most = {-1.0: (500, 500), 0.1: (150, 480), 0.35: (20, 160), 1.0: (2, 60)}[angle]
    assert (rays >= fewest).all() and (rays <= most).all(), (rays.min(), rays.max())
