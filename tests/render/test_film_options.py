"""Outlines, depth cue and flat colours against what the geometry says."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine import (
    Camera,
    Geometry,
    Instances,
    Light,
    Material,
    Scene,
    SceneError,
    Session,
    Settings,
    Spheres,
    Triangles,
    World,
    render,
)
from addon.engine.film_options import DepthCue, Outlines

WIDTH, HEIGHT = 160, 120
#: One unit is ten pixels.
CAMERA = Camera.orthographic_at((0.0, -10.0, 0.0), (0.0, 0.0, 0.0), height=12.0, aspect=WIDTH / HEIGHT)
THIN = Outlines(width=1.0, inner_width=1.0)


def scene_of(*colors, camera=CAMERA):
    """An empty scene before a black sky with materials that glow."""
    materials = [Material(diffuse=0.0, glow=color) for color in colors]
    return Scene(camera=camera, world=World((0.0, 0.0, 0.0)), materials=materials)


def pixel_places():
    """Where the middle of each pixel is on the plane y = 0: x (h, w) and z (h, w)."""
    columns, rows = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    return (columns + 0.5 - WIDTH / 2) / 10.0, (rows + 0.5 - HEIGHT / 2) / 10.0


def lines_of(device, scene, outlines, samples=1, **settings):
    """The lines alone, (h, w, 4), and the picture with them."""
    session = Session(device)
    session.load(scene, Settings(samples=samples, outlines=outlines, **settings))
    session.start(WIDTH, HEIGHT)
    while session.step(1.0):
        pass
    lines, pixels = session._outlines.pixels(), session.pixels()
    session.free()
    return lines, pixels


def test_a_circle_is_outlined_where_it_ends(device):
    scene = scene_of((1.0, 1.0, 1.0))
    scene.add_spheres((0.4, 0.0, -0.3), 3.0)
    lines, pixels = lines_of(device, scene, THIN, film_transparent=True)
    x, z = pixel_places()
    beyond = 10.0 * (np.hypot(x - 0.4, z + 0.3) - 3.0)  # pixels outside of the circle
    line = lines[..., 3] > 0.0
    assert beyond[line].min() > 0.0 and beyond[line].max() < 1.5
    assert (lines[..., 3][(beyond > 0.05) & (beyond < 0.65)] >= 0.4).all(), "without a gap"
    assert (pixels[line & (lines[..., 3] == 1.0)] == (0.0, 0.0, 0.0, 1.0)).all(), "lines have an alpha"
    assert (pixels[beyond < -0.1] == 1.0).all() and (pixels[beyond > 2.0] == 0.0).all()


@pytest.mark.parametrize("width", [0.5, 1.0, 2.0, 3.5])
@pytest.mark.parametrize("angle", [0.0, 26.0, 45.0])
def test_a_line_covers_its_width_at_any_angle(device, width, angle):
    scene, turn = scene_of((1.0, 1.0, 1.0)), np.radians(angle)
    across, along = np.array([np.cos(turn), 0.0, np.sin(turn)]), np.array([-np.sin(turn), 0.0, np.cos(turn)])
    scene.add_triangles(-40 * along, 40 * along, -60 * across)
    lines, _ = lines_of(device, scene, replace(THIN, width=width), samples=32)
    length = HEIGHT / np.cos(turn)
    assert lines[..., 3].sum() / length == pytest.approx(width, rel=0.2, abs=0.05)
    assert lines[..., 3].max() <= 1.0 + 1e-5


def test_each_atom_has_an_outline_where_two_meet(device):
    """Balls that overlap meet in a circle, seen from the side as a line."""
    scene = scene_of((1.0, 1.0, 1.0))
    scene.add_spheres([(-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)], 2.5)
    lines, _ = lines_of(device, scene, THIN)
    columns = lines[HEIGHT // 2 - 15 : HEIGHT // 2 + 15, :, 3] > 0.9
    seen = columns[:, WIDTH // 2 - 2 : WIDTH // 2 + 2]
    assert seen.any(axis=1).all() and (seen.sum(axis=1) <= 2).all()
    assert not columns[:, WIDTH // 2 + 4 : WIDTH // 2 + 34].any(), "and none on the balls"


def test_pieces_of_one_curve_have_no_lines_between_them(device):
    scene = scene_of((1.0, 1.0, 1.0))
    ends = [(x, 0.0, 0.0) for x in (-4.0, -1.0, 1.5, 4.0)]
    scene.add_cylinders(ends[:-1], ends[1:], 1.0, caps=False)
    lines, _ = lines_of(device, scene, THIN)
    assert not (lines[HEIGHT // 2 - 8 : HEIGHT // 2 + 8, WIDTH // 2 - 35 : WIDTH // 2 + 35, 3] > 0.0).any()
    assert (lines[HEIGHT // 2 + 10 : HEIGHT // 2 + 12, WIDTH // 2 - 35 : WIDTH // 2 + 35, 3].max(axis=0) > 0.9).all()


def box():
    """A cube of side 4 as twelve triangles."""
    corners = np.array([[x, y, z] for x in (-2.0, 2.0) for y in (-2.0, 2.0) for z in (-2.0, 2.0)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([(q[0], q[1], q[2]) for q in quads] + [(q[0], q[2], q[3]) for q in quads])
    return Triangles(**{f"p{i}": corners[triangles[:, i]] for i in range(3)})


def test_a_mesh_has_lines_along_its_edges_and_none_across_its_faces(device):
    """The cube seen towards an edge: that edge is in the middle of the picture."""
    scene = scene_of((1.0, 1.0, 1.0))
    turned = np.eye(4)
    turned[:2, :2] = np.sqrt(0.5) * np.array([[1.0, -1.0], [1.0, 1.0]])
    scene.instances.append(Instances(Geometry(box()), turned))
    lines, _ = lines_of(device, scene, THIN)
    faces = lines[HEIGHT // 2 - 18 : HEIGHT // 2 + 18, :, 3] > 0.0
    middle = np.abs(np.arange(WIDTH) - WIDTH / 2 + 0.5) < 1.5
    inside = np.abs(np.arange(WIDTH) - WIDTH / 2 + 0.5) < 26.0
    assert faces[:, middle].any(axis=1).all() and not faces[:, inside & ~middle].any()
    lines, _ = lines_of(device, scene, replace(THIN, crease_angle=np.radians(100.0)))
    assert not (lines[HEIGHT // 2 - 18 : HEIGHT // 2 + 18, inside, 3] > 0.0).any()


def test_outlines_go_around_the_values_of_an_attribute(device):
    """Three balls in a row that overlap, of two chains: between balls of one chain the line is an inner one."""
    scene, chain = scene_of((1.0, 1.0, 1.0)), np.zeros((3, 1, 4), np.float32)
    chain[2] = 1.0
    places = [(-3.0, 0.0, 0.0), (0.0, 0.0, 0.0), (3.0, 0.0, 0.0)]
    scene.add(Spheres(center=places, radius=2.0, attributes={"chain": chain}))
    scene.outline_attribute = "chain"
    lines, _ = lines_of(device, scene, Outlines(around="ATTRIBUTE", width=1.0, inner_width=0.0))
    row = lines[HEIGHT // 2, :, 3] > 0.0
    assert row[WIDTH // 2 + 13 : WIDTH // 2 + 17].any() and not row[WIDTH // 2 - 20 : WIDTH // 2 - 10].any()
    lines, _ = lines_of(device, scene, Outlines(around="ATTRIBUTE", width=0.0, inner_width=1.0))
    row = lines[HEIGHT // 2, :, 3] > 0.0
    assert row[WIDTH // 2 - 17 : WIDTH // 2 - 13].any() and not row[WIDTH // 2 + 10 : WIDTH // 2 + 20].any()


@pytest.mark.parametrize("samples", [1, 3])
@pytest.mark.parametrize("corner_rays", [False, True])
def test_lines_of_no_width_change_nothing(device, samples, corner_rays):
    scene = scene_of((1.0, 0.5, 0.2), (0.1, 0.5, 0.9))
    scene.add_spheres([(-1.0, 0.0, 0.0), (1.5, 0.4, 0.3)], 2.0, [0, 1])
    settings = Settings(samples=samples, corner_rays=corner_rays)
    plain = render(scene, WIDTH, HEIGHT, settings, device=device).pixels
    for outlines in (Outlines(width=0.0, inner_width=0.0), Outlines(color=(1.0, 0.0, 0.0, 0.0))):
        pixels = render(scene, WIDTH, HEIGHT, replace(settings, outlines=outlines), device=device).pixels
        assert np.array_equal(pixels, plain)


def test_a_border_has_the_lines_of_the_whole(device):
    scene = scene_of((1.0, 0.5, 0.2))
    scene.add_spheres([(-1.0, 0.0, 0.0), (1.5, 0.4, 0.3)], 2.0)
    session = Session(device)
    session.load(scene, Settings(samples=4, outlines=Outlines()))
    pictures = []
    for border in (None, (30, 20, 90, 70)):
        session.start(WIDTH, HEIGHT, border=border)
        while session.step(1.0):
            pass
        pictures.append(session.pixels())
    session.free()
    whole, part = pictures
    different = np.abs(whole[22:88, 32:118] - part[2:-2, 2:-2]).max(axis=-1) > 1e-3
    assert different.mean() < 0.005


def wall(depth, material):
    """A sphere so large that it is a wall at this depth from the eye at y = -10."""
    return {"center": (0.0, depth - 10.0 + 1000.0, 0.0), "radius": 1000.0, "material": material}


@pytest.mark.parametrize("color", [(0.2, 0.4, 0.8), None])
@pytest.mark.parametrize("transparent", [False, True])
@pytest.mark.parametrize("depth, share", [(4.0, 0.0), (8.0, 0.25), (14.0, 0.625), (30.0, 0.75)])
def test_depth_cue_by_depth(device, color, transparent, depth, share):
    """From 5 to 14 + 2: a share of 0.75 at the end; what is behind is the sky, or nothing."""
    scene = scene_of((1.0, 0.5, 0.1))
    scene.world = World((0.1, 0.1, 0.3))
    scene.add_spheres(**wall(depth, 0))
    cue = DepthCue(color, start=4.0, end=16.0, strength=0.75)
    settings = Settings(film_transparent=transparent, depth_cue=cue)
    pixels = render(scene, WIDTH, HEIGHT, settings, device=device).pixels[HEIGHT // 2, WIDTH // 2]
    behind = np.array([*color, 1.0] if color else [0.0] * 4 if transparent else [0.1, 0.1, 0.3, 1.0])
    expected = (1.0 - share) * np.array([1.0, 0.5, 0.1, 1.0]) + share * behind
    assert pixels == pytest.approx(expected, abs=2e-3)


def test_depth_cue_takes_the_range_of_the_scene(device):
    """Two balls along the view: the front of the nearer is as it is, the middle of the picture between fades half."""
    scene = scene_of((1.0, 1.0, 1.0))
    scene.add_spheres([(-3.0, -2.0, 0.0), (3.0, 6.0, 0.0)], 1.0)
    settings = Settings(depth_cue=DepthCue((0.0, 0.0, 0.0)))
    pixels = render(scene, WIDTH, HEIGHT, settings, device=device).pixels[..., 0]
    assert pixels[HEIGHT // 2, WIDTH // 2 - 30] == pytest.approx(1.0, abs=0.01)
    assert pixels[HEIGHT // 2, WIDTH // 2 + 30] == pytest.approx(1.0 - 8.0 / 10.0, abs=0.01)


def test_flat_colors_are_those_of_the_materials(device):
    scene = Scene(camera=CAMERA, materials=[Material(diffuse=(0.7, 0.3, 0.1))])
    scene.add_spheres((0.0, 0.0, 0.0), 3.0)
    scene.add_light(Light.sun((0.0, 0.0, 1.0), 3.0))
    pixels = render(scene, WIDTH, HEIGHT, Settings(flat_colors=True), device=device).pixels
    x, z = pixel_places()
    inside = np.hypot(x, z) < 2.9
    assert np.abs(pixels[inside][:, :3] - (0.7, 0.3, 0.1)).max() < 1e-5


def test_a_picture_without_film_options_has_nothing_of_them_in_its_program(device):
    scene = scene_of((1.0, 1.0, 1.0))
    scene.add_spheres((0.0, 0.0, 0.0), 1.0)
    session = Session(device)
    session.load(scene, Settings())
    assert "guide" not in session.loaded.drawn.source.text and session.loaded.drawn.outputs == ("out_color",)
    session.free()


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: Outlines(width=-1.0), "width of outlines is -1"),
        (lambda: Outlines(around="CHAINS"), "'CHAINS'"),
        (lambda: DepthCue(strength=2.0), "strength of the depth cue is 2"),
        (lambda: DepthCue(start=3.0, end=2.0), "ends at 2"),
    ],
)
def test_values_out_of_range_are_named(make, message):
    with pytest.raises(SceneError, match=message):
        make()


def test_outlines_around_an_attribute_that_the_scene_does_not_name(device):
    scene = scene_of((1.0, 1.0, 1.0))
    scene.add_spheres((0.0, 0.0, 0.0), 1.0)
    with pytest.raises(SceneError, match="does not say of which"):
        render(scene, 8, 8, Settings(outlines=Outlines(around="ATTRIBUTE")), device=device)
