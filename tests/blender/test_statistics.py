"""What a render and a viewport say of themselves: figures that are right, and text that people can read."""

import re

import bpy
import pytest

from addon import render_session, statistics
from addon.statistics import Statistics


@pytest.mark.parametrize(
    "count, text",
    [
        (0, "0 B"),
        (1023, "1.0 KiB"),
        (999, "999 B"),
        (3250586, "3.1 MiB"),
        (48 << 20, "48 MiB"),
        (9.96 * 2**20, "10 MiB"),
        (999.6 * 2**20, "1.0 GiB"),
        (12 << 40, "12 TiB"),
    ],
)
def test_bytes(count, text):
    assert statistics.bytes_text(count) == text


@pytest.mark.parametrize(
    "seconds, text",
    [
        (0.0, "0.000 s"),
        (0.0042, "0.004 s"),
        (0.0999, "0.1 s"),
        (1.23, "1.2 s"),
        (9.96, "10 s"),
        (59.4, "59 s"),
        (59.6, "1 min 00 s"),
        (185.2, "3 min 05 s"),
        (3599.7, "1 h 00 min"),
        (7380.0, "2 h 03 min"),
    ],
)
def test_seconds(seconds, text):
    assert statistics.seconds_text(seconds) == text


def test_counts_and_plurals():
    assert statistics.counted(1, "sphere") == "1 sphere"
    assert statistics.counted(1234567, "sphere") == "1,234,567 spheres"
    assert statistics.counted(2, "geometry") == "2 geometries"
    assert statistics.primitives_text({"sphere": 66430, "cone": 1}) == "1 cone, 66,430 spheres"
    assert statistics.primitives_text({}) == "nothing to see"


def filled():
    return Statistics(
        "Render",
        device="Some GPU",
        entry="COMPUTE",
        width=1920,
        height=1080,
        samples=16,
        objects={"sphere": 3, "point cloud": 12, "disc": 0, "instances": 1000},
        primitives={"sphere": 66430, "triangle": 12},
        instances=1000,
        geometries=7,
        grids=2,
        seconds={"total": 12.3, "build": 0.2, "read": 0.1, "first_picture": 0.4},
        parts={"read": {"place": 0.022}},
        gpu_bytes={"sphere_surfaces": 3 << 20, "film": 120 << 10},
        peak_bytes=300 << 20,
    )


def test_log_line():
    assert statistics.log_line(filled()) == (
        "Conic | 66,430 spheres, 12 triangles, 1,000 instances | 3.1 MiB GPU | 300 MiB peak | "
        "read 0.1 s, tree 0.2 s, first picture 0.4 s, total 12 s | compute shader | Some GPU"
    )


def test_sections_of_the_panel():
    sections = dict(statistics.sections(filled()))
    assert sections["Objects"] == [("Instanced", "1,000"), ("Point cloud", "12"), ("Sphere", "3")]
    assert sections["Primitives"] == [("Spheres", "66,430"), ("Triangles", "12"), ("Grids in place of trees", "2")]
    assert sections["Instancing"] == [("Instances", "1,000"), ("Geometries", "7")]
    assert sections["Memory"] == [
        ("GPU", "3.1 MiB"),
        ("    sphere surfaces", "3.0 MiB"),
        ("    film", "120 KiB"),
        ("Blender's peak", "300 MiB"),
    ]
    assert sections["Time"][:3] == [("Read", "0.1 s"), ("    place", "0.022 s"), ("Tree", "0.2 s")]
    assert ("Size", "1,920 x 1,080") in sections["Render"] and ("Shader", "Compute") in sections["Render"]
    unknown = dict(statistics.sections(Statistics("Viewport")))
    assert "Objects" not in unknown and "Instancing" not in unknown, "nothing is said of what is not known"


def test_the_first_time_that_a_stage_is_reached_counts():
    figures = Statistics("Render")
    figures.reach("total")
    first = figures.seconds["total"]
    figures.reach("total")
    assert figures.seconds["total"] == first >= 0.0


def test_the_newer_ones_are_shown_and_observers_told(monkeypatch):
    told = []
    monkeypatch.setattr(statistics, "observers", [lambda: told.append(statistics.latest())])
    older, newer = Statistics("Render"), Statistics("Viewport")
    statistics.publish(older)
    statistics.publish(newer)
    assert told == [older, newer] and statistics.latest() is newer


@pytest.fixture
def scene():
    """Two spheres and a cube before a camera, small."""
    scene = bpy.context.scene
    bpy.ops.object.camera_add(location=(0.0, 0.0, 10.0))
    scene.camera = bpy.context.object
    for x in (-2.0, 2.0):
        bpy.ops.conic.sphere_add(location=(x, 0.0, 0.0))
    bpy.ops.mesh.primitive_cube_add()
    scene.render.engine = "CONIC"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 48, 100
    scene.conic.samples = 3
    return scene


def test_a_render_publishes_what_it_was_made_of(scene):
    bpy.ops.render.render()
    found = statistics.latest()
    assert (found.source, found.width, found.height, found.samples) == ("Render", 64, 48, 3)
    assert found.primitives == {"sphere": 2, "triangle": 12} and found.objects == {"sphere": 2, "mesh": 1}
    assert found.device and found.gpu_bytes["film"] == 64 * 48 * 16 < found.gpu_total
    seconds = found.seconds
    assert {"read", "build", "upload", "compile", "trace", "first_picture", "total"} <= set(seconds)
    assert seconds["read"] < seconds["first_picture"] <= seconds["total"]
    parts = sum(seconds[stage] for stage in ("read", "build", "upload", "compile", "trace"))
    assert parts <= seconds["total"]


@pytest.fixture
def console():
    """The lines about a render that Blender prints where it has no window."""
    lines = []

    def note(line, _nothing):
        lines.append(line)

    bpy.app.handlers.render_stats.append(note)
    yield lines
    bpy.app.handlers.render_stats.remove(note)


def test_a_render_ends_with_one_line_on_the_console(scene, console):
    bpy.ops.render.render()
    assert sum("first picture" in line for line in console) == 1
    pattern = r"Conic \| 2 spheres, 12 triangles.* \| [\d.]+ \w+ GPU \| .*read [\d.]+ s, tree"
    assert re.search(pattern, console[-1]), console


def test_a_stopped_render_publishes_nothing(scene, monkeypatch):
    published = []

    def stop(self, *_arguments):
        self.engine = Stopped(self.engine)

    monkeypatch.setattr(render_session, "publish", published.append)
    monkeypatch.setattr(render_session.LayerRender, "draw", stop)
    bpy.ops.render.render()
    assert not published


class Stopped:
    """A RenderEngine whose user has pressed Esc."""

    def __init__(self, engine):
        self._engine = engine

    def test_break(self):
        return True

    def __getattr__(self, name):
        return getattr(self._engine, name)
