"""Rays counted under the databases' rules, beside the numbers that their author publishes for 513 x 513 corner rays."""

from itertools import pairwise
from pathlib import Path

import pytest

from addon.engine import Session, Settings
from addon.engine.nff import read_nff
from benchmarks import scenes
from benchmarks.peers import Conic, ConicCasting
from benchmarks.traversal import matte
from examples.standard_scenes import FAMILIES

# Eye rays that hit, mirror rays, refracted rays, shadow rays. Any classical ray tracer is to come within 10%.
PUBLISHED = {
    "balls": (263169, 175095, 0, 954368),
    "tetra": (49788, 0, 0, 46112),
    "tree": (169836, 0, 0, 1097419),
}
PUBLISHED_MOUNT = (173125, 354769, 354769, 412922)  # of the author's own landscape
# The databases' own files, where a folder beside this checkout holds them.
FILES = {path.stem: path for path in Path(__file__).resolve().parents[3].glob("*/scenes/nff/*.nff")}
COLUMNS = ("eye_hit", "reflect", "refract", "shadow")


def count(device, scene, side=512):
    """The counters of a strict picture of side x side pixels."""
    session = Session(device)
    try:
        session.load(scene, Settings.strict())
        session.start(side, side)
        while session.step(1.0):
            pass
        assert session.warnings == []
        return session.statistics()["rays"]
    finally:
        session.free()


@pytest.mark.parametrize("family", PUBLISHED)
def test_published_counts(device, family):
    rays = count(device, FAMILIES[family]())
    assert rays["eye"] == 513 * 513
    # Two counters differ by far less than the 10% that are granted: by rounding along silhouettes.
    assert [rays[name] for name in COLUMNS] == pytest.approx(PUBLISHED[family], rel=0.01)
    assert rays["dropped"] == 0


@pytest.mark.parametrize("name", sorted(FILES.keys() & {*PUBLISHED, "mount"}))
def test_published_counts_of_the_databases_files(device, name):
    rays = count(device, read_nff(FILES[name]).resized(512, 512).scene)
    assert [rays[column] for column in COLUMNS] == pytest.approx(
        (PUBLISHED | {"mount": PUBLISHED_MOUNT})[name], rel=0.01
    )


def test_mountain(device):
    """Its published counts belong to its author's random numbers; what holds for every landscape is looked at here."""
    rays = count(device, FAMILIES["mount"]())
    hits, reflect, refract, shadow = (rays[name] for name in COLUMNS)
    assert reflect == refract  # every hit on glass sends both, within and at total reflection too
    assert [hits, reflect, shadow] == pytest.approx([173125, 354769, 412922], rel=0.35)
    # At most four generations of two rays follow an eye ray, and one light gets at most one ray from each hit.
    assert reflect + refract <= hits * (2 + 4 + 8 + 16)
    assert shadow <= hits + reflect + refract


def test_a_smaller_picture_counts_in_proportion(device):
    rays = count(device, FAMILIES["balls"](), 256)
    share = 257 * 257 / (513 * 513)
    assert [rays[name] / share for name in COLUMNS] == pytest.approx(PUBLISHED["balls"], rel=0.02)


def test_other_sizes_of_a_family(device):
    """Deeper flakes show more mirrors, by ever less as they end in smaller balls; the square fills the view in any."""
    rays = [count(device, FAMILIES["balls"](depth), 256) for depth in (2, 3, 4, 5)]
    assert {r["eye_hit"] for r in rays} == {257 * 257}
    reflect = [r["reflect"] for r in rays]
    steps = [after - before for before, after in pairwise(reflect)]
    assert steps[0] > steps[1] > steps[2] > 0


def test_lattice_counts(device):
    """Every strut is matt, every joint half a mirror; six lights each get a ray from what they face."""
    rays = count(device, FAMILIES["lattice"](4), 128)
    assert rays["refract"] == 0
    assert 0 < rays["reflect"] <= 4 * rays["eye_hit"]
    assert rays["shadow"] <= 6 * (rays["eye_hit"] + rays["reflect"])


@pytest.mark.parametrize("name", ["balls:2", "gears:1"])
def test_the_benchmark_of_traversal_traces_the_rays_of_the_picture(device, monkeypatch, name):
    """It has a program of its own, which must look for shapes wherever they are."""
    monkeypatch.setattr(Conic, "_device", device)
    scene = matte(scenes.make(name))
    casting, shading = ConicCasting(scene, 64), Conic(scene, 64, 1, shadows="OPAQUE")
    casting.trace()
    rays, expected = casting.rays(), shading.rays()
    casting.close()
    shading.close()
    assert rays["eye_hit"] == expected["eye_hit"] > 4000
    assert rays["shadow"] == expected["shadow"] > rays["lit"] > 0
