"""The path tracer as fragments and as a compute program: the same picture, and which one is taken."""

from types import SimpleNamespace

import numpy as np
import pytest

from addon.engine import DeviceError, Light, LightKind, LoadedScene, Session, Settings, entries, render
from addon.engine.devices import base
from addon.engine.film_options import DepthCue, Outlines

from .compare import save_difference
from .scenes import still_life

SIZE = (93, 71)  # tiles end within work groups
CASES = {
    "plain": {},
    "samples": {"samples": 3, "shadows": "TINTED"},
    "counted": {"corner_rays": True, "max_depth": 4, "count_rays": True, "shadows": "TRANSPARENT"},
    "dropped": {"stack_limit": 1, "max_depth": 6},
    "guided": {"outlines": Outlines(), "depth_cue": DepthCue(), "film_transparent": True, "samples": 2},
}


@pytest.fixture
def computing(device):
    if not device.can_compute:
        pytest.skip("this driver has no compute programs")
    return device


@pytest.fixture(autouse=True)
def _nothing_known(monkeypatch):
    """What one test finds out of a device, or pretends to, is not known to the next."""
    monkeypatch.setattr(entries, "_measured", {})
    monkeypatch.setattr(entries, "_refused", set())


def softly_lit():
    """The still life with a lamp of some size, so that samples differ by pixel."""
    scene = still_life()
    scene.add_light(Light(LightKind.POINT, position=(-4.0, -4.0, 5.0), color=(400.0,) * 3, radius=0.8))
    return scene


def drawn(device, scene, entry, size=SIZE, border=None, **settings):
    """Pixels and statistics of a picture, drawn in tiles of all sizes."""
    session = Session(device)
    try:
        session.load(scene, Settings(entry=entry, **settings))
        session.start(*size, border=border)
        for seconds in (1e-5, 1e-3):
            session.step(0.0, tile_seconds=seconds)
        while session.step(1.0, tile_seconds=0.01):
            pass
        return session.pixels(), session.statistics()
    finally:
        session.free()


def assert_same(name, fragment, compute):
    """Bit for bit on the software rasteriser; other drivers compile the two as they like."""
    pixels, expected = compute[0], fragment[0]
    assert (fragment[1]["entry"], compute[1]["entry"]) == ("FRAGMENT", "COMPUTE")
    assert np.ptp(expected[..., :3]) > 0.1, "something is to be seen"
    if "llvmpipe" in fragment[1]["device"]:
        assert np.array_equal(pixels, expected), save_difference(name, pixels, expected)
        assert fragment[1].get("rays") == compute[1].get("rays")
    else:
        differing = (np.abs(pixels - expected) > 1e-3).any(axis=-1)
        assert differing.mean() < 0.01, save_difference(name, pixels, expected)


@pytest.mark.parametrize("case", CASES)
def test_both_entries_draw_the_same_picture(computing, case):
    scene = softly_lit()
    pair = [drawn(computing, scene, entry, **CASES[case]) for entry in ("FRAGMENT", "COMPUTE")]
    assert_same(f"entries_{case}", *pair)


@pytest.fixture(scope="module")
def whole(device):
    """The whole picture (h, w, 4)."""
    return drawn(device, softly_lit(), "FRAGMENT")[0]


@pytest.mark.parametrize("border", [(5, 3, 40, 31), (0, 0, 1, 1), (91, 60, 2, 11)])
def test_a_border_is_the_part_of_the_whole_picture(computing, whole, border):
    x, y, width, height = border
    part, statistics = drawn(computing, softly_lit(), "COMPUTE", border=border)
    assert statistics["entry"] == "COMPUTE" and part.shape == (height, width, 4)
    assert np.abs(part - whole[y : y + height, x : x + width]).max() < 1e-3


def test_invocations_cover_a_tile_once_and_nothing_else(computing):
    """Two draws into a rectangle of a target that is twice as much there, and 0 around."""
    rectangle = x, y, width, height = (3, 5, 21, 10)
    source = entries._probe_source("probe_comp.glsl")
    texture, target = computing.texture(entries._probe_tree()), computing.target(40, 30, 1)
    program = computing.program(source)
    pictures = []
    for _ in range(2):
        computing.draw(program, target, rectangle, {"probe": texture}, np.zeros(4, np.float32))
        pictures.append(computing.read(target, 0, (0, 0, 40, 30)).copy())
    inside = pictures[0][y : y + height, x : x + width]
    assert np.array_equal(pictures[1], 2.0 * pictures[0]) and np.ptp(inside) > 1.0
    pictures[0][y : y + height, x : x + width] = 0.0
    assert not pictures[0].any()
    computing.release(target)
    computing.release(texture)


def test_the_pixels_of_a_group_are_all_different():
    """The Z curve of `PIXEL_OF_COMPUTE` in Python: 64 invocations, 8 x 8 pixels, each 8 in a row 4 x 2 of them."""
    text = base.PIXEL_OF_COMPUTE
    inner = text[text.rindex("ivec2(") + len("ivec2") : text.rindex("+ 0.5") - 2]
    places = [eval(inner, {"gl_LocalInvocationIndex": i}) for i in range(base.GROUP_SIZE)]
    assert sorted(places) == [(x, y) for x in range(8) for y in range(8)]
    for first in range(0, base.GROUP_SIZE, 8):
        block = np.array(places[first : first + 8])
        assert list(np.ptp(block, axis=0)) == [3, 1]


# Which one is taken


def picture_of(device, entry):
    return render(softly_lit(), 16, 12, Settings(entry=entry), device=device)


def test_without_compute_programs_fragments_are_drawn(device, monkeypatch):
    monkeypatch.setattr(device, "can_compute", False)
    for entry in entries.ENTRIES:
        found = picture_of(device, entry)
        assert found.statistics["entry"] == "FRAGMENT" and not found.warnings


def test_where_a_driver_refuses_a_compute_program_fragments_are_drawn(computing, monkeypatch):
    asked = []

    def program(source, build=computing.program):
        asked.append(source.is_compute)
        if source.is_compute:
            raise DeviceError("no")
        return build(source)

    monkeypatch.setattr(computing, "program", program)
    found = [picture_of(computing, "COMPUTE") for _ in range(2)]
    assert [each.statistics["entry"] for each in found] == ["FRAGMENT"] * 2
    assert [w for w in found[0].warnings if w.startswith("fragment shaders are used") and w.endswith(": no")]
    assert sum(asked) == 1, "it is not asked again"


def test_automatic_means_fragments_on_a_software_rasteriser(device, monkeypatch):
    monkeypatch.setattr(entries, "measure", lambda device: pytest.fail("nothing is to be measured"))
    device = SimpleNamespace(name="llvmpipe (LLVM 15)", can_compute=True)
    entries.settle(device, "AUTO")
    assert entries.known(device, "AUTO") == "FRAGMENT" and entries.known(device, "COMPUTE") == "COMPUTE"


def test_a_device_is_measured_once_and_only_if_asked(monkeypatch):
    measured = []
    monkeypatch.setattr(entries, "measure", lambda device: measured.append(device.name) or "COMPUTE")
    first, second = (SimpleNamespace(name=name, can_compute=True) for name in ("A", "B"))
    for entry in ("FRAGMENT", "COMPUTE"):
        entries.settle(first, entry)
    assert not measured and entries.known(first, "AUTO") == "FRAGMENT"
    for device in (first, first, second):
        entries.settle(device, "AUTO")
    assert measured == ["A", "B"] and entries.known(first, "AUTO") == "COMPUTE"


@pytest.mark.parametrize(
    ("seconds", "error", "expected"),
    [(0.5, 0.0, "COMPUTE"), (0.99, 0.0, "FRAGMENT"), (2.0, 0.0, "FRAGMENT"), (0.5, 1.0, "FRAGMENT")],
)
def test_compute_must_be_faster_and_right(monkeypatch, seconds, error, expected):
    picture = np.ones((4, 4, 4), np.float32)
    pictures = {"FRAGMENT": picture, "COMPUTE": picture + error}
    monkeypatch.setattr(entries, "probe", lambda device: ({"FRAGMENT": 1.0, "COMPUTE": seconds}, pictures))
    assert entries.measure(None) == expected


def test_a_probe_that_fails_means_fragments():
    assert entries.measure(SimpleNamespace()) == "FRAGMENT"


def test_the_probe_draws_the_same_with_both(computing):
    seconds, pictures = entries.probe(computing)
    assert seconds.keys() == pictures.keys() == {"FRAGMENT", "COMPUTE"} and min(seconds.values()) > 0.0
    bounces = pictures["FRAGMENT"][..., 3]
    assert 1.0 < bounces.mean() < 4.0, "rays meet spheres, and leave"
    assert np.mean(np.abs(pictures["FRAGMENT"] - pictures["COMPUTE"]) > 1e-2) < 0.01


def test_the_entry_can_change_between_pictures_of_a_scene(computing, monkeypatch):
    """Another program, the same textures; what means the same anyway changes nothing."""
    monkeypatch.setattr(entries, "_SOFTWARE", ())
    monkeypatch.setattr(entries, "measure", lambda device: "COMPUTE")
    loaded, scene, seen = LoadedScene(computing), softly_lit(), []
    for entry in ("FRAGMENT", "FRAGMENT", "AUTO", "COMPUTE", "FRAGMENT", "AUTO"):
        version, update = loaded.version, loaded.prepare(scene, Settings(entry=entry))
        assert loaded.apply(update)
        seen.append((loaded.drawn.entry, loaded.version > version))
        assert len(seen) == 1 or not update.bytes
    fragment, compute = ("FRAGMENT", True), ("COMPUTE", True)
    assert seen == [fragment, ("FRAGMENT", False), compute, ("COMPUTE", False), fragment, compute]
    loaded.free()
