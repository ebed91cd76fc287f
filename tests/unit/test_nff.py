"""NFF files in and out: what is read, what is refused and in which words, polygons to triangles, round trips."""

import os
import threading

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.engine import (
    Camera,
    Cones,
    Cylinders,
    Instances,
    Light,
    Material,
    Scene,
    SceneError,
    Spheres,
    Triangles,
    World,
)
from addon.engine.material import surface_image
from addon.engine.nff import NffError, read_nff, write_nff
from addon.engine.polygons import PolygonError, triangulate
from examples.standard_scenes import FAMILIES, balls

VIEW = "v\nfrom 0 -5 0\nat 0 0 0\nup 0 0 1\nangle 45\nhither 0.5\nresolution 40 20\n"
RED = "f 1 0.5 0.25 0.8 0.1 20 0 0\n"
GLASS = "f 1 1 1 0.1 0.2 30 0.9 1.5\n"


@pytest.fixture
def read(tmp_path):
    """Reads NFF text or bytes as a file."""

    def read_text(text):
        path = tmp_path / "scene.nff"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_nff(path)

    return read_text


def shapes(scene, cls):
    """The scene's primitives of one class; none: an empty list."""
    return next((part for _, part in scene.shapes.kinds() if isinstance(part, cls)), [])


def corners(triangles):
    return np.stack([triangles.p0, triangles.p1, triangles.p2], axis=1)


def areas(triangles):
    """Vector areas (n, 3) of corners (n, 3, 3)."""
    return np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) / 2.0


def test_view_becomes_the_camera(read):
    file = read(VIEW)
    assert (file.width, file.height) == (40, 20)
    camera = file.scene.camera
    half = np.tan(np.radians(22.5))
    assert camera.window == pytest.approx((-2 * half, 2 * half, -half, half))
    assert camera.clip == (0.5, 1e30)
    np.testing.assert_allclose(camera.matrix[:3, 3], (0, -5, 0))
    np.testing.assert_allclose(-camera.matrix[:3, 2], (0, 1, 0), atol=1e-15)
    assert file.scene.world.color == (0.0, 0.0, 0.0)


def test_another_size_keeps_the_vertical_angle(read):
    file = read(VIEW).resized(30, 60)
    half = np.tan(np.radians(22.5))
    assert (file.width, file.height) == (30, 60)
    assert file.scene.camera.window == pytest.approx((-half / 2, half / 2, -half, half))


def test_material_follows_the_field_names(read):
    material, glass = read(VIEW + RED + "s 0 0 0 1\n" + GLASS + "s 0 0 0 2\n").scene.materials
    assert material.diffuse == pytest.approx((0.8, 0.4, 0.2))
    assert material.reflect == material.highlight == (0.1, 0.1, 0.1)
    assert (material.shine, material.ior, material.fresnel) == (20.0, 1.0, False)
    assert material.transmit == (0.0, 0.0, 0.0)
    assert glass.transmit == (0.9, 0.9, 0.9)
    assert glass.ior == 1.5


def test_repeated_materials_are_one_each(read):
    scene = read(VIEW + (RED + "s 0 0 0 1\n" + GLASS + "s 1 0 0 1\n") * 50).scene
    assert len(scene.materials) == 2
    np.testing.assert_array_equal(shapes(scene, Spheres).material, [0, 1] * 50)


def test_lights_without_colour_share_one(read):
    lights = read(VIEW + "l 1 2 3\nl 4 5 6 0.1 0.2 0.3\nl 7 8 9\nl 0 0 9\n").scene.lights
    assert [light.color for light in lights] == [
        pytest.approx(c) for c in ([0.5] * 3, [0.1, 0.2, 0.3], [0.5] * 3, [0.5] * 3)
    ]
    assert lights[1].position == (4.0, 5.0, 6.0)


def test_cylinders_cones_and_insides(read):
    scene = read(
        VIEW + RED + "c 0 0 0 1 0 0 2 1\nc 0 0 0 -1 0 0 2 -1\nc 0 0 0 1 0 0 2 0\nc 0 0 0 -2 0 0 1 -1\ns 1 2 3 -4\n"
    ).scene
    assert scene.primitive_counts() == {"sphere": 1, "cylinder": 2, "cone": 2}  # and no caps
    np.testing.assert_array_equal(shapes(scene, Cylinders).radius, [1, -1])
    cones = shapes(scene, Cones)
    np.testing.assert_array_equal(cones.base_radius, [1, -2])
    np.testing.assert_array_equal(cones.apex_radius, [0, -1])
    assert shapes(scene, Spheres).radius[0] == -4.0


def test_polygons_are_two_sided_only_where_they_transmit(read):
    triangle = "p 3\n0 0 0\n1 0 0\n0 1 0\n"
    found = shapes(read(VIEW + RED + triangle + GLASS + triangle + RED + triangle).scene, Triangles)
    np.testing.assert_array_equal(found.one_sided, [1, 0, 1])
    np.testing.assert_array_equal(found.material, [0, 1, 0])
    np.testing.assert_array_equal(corners(found)[0], [(0, 0, 0), (1, 0, 0), (0, 1, 0)])


def test_patches_keep_their_normals(read):
    patch = "pp 4\n0 0 0 -1 0 2\n1 0 0 1 0 2\n1 1 0 1 0 2\n0 1 0 -1 0 2\n"
    found = shapes(read(VIEW + RED + patch).scene, Triangles)
    assert len(found) == 2
    normals = np.stack([found.n0, found.n1, found.n2], axis=1)
    expected = np.where(corners(found)[..., :1] > 0, 1.0, -1.0) * (1, 0, 0) + (0, 0, 2)
    np.testing.assert_allclose(normals, expected / np.sqrt(5.0))


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_free_form(read, newline):
    """Records over lines, several on a line, tabs, comments, a byte order mark, numbers in every notation."""
    text = (
        "# a scene\n"
        + VIEW
        + "f 1 1 1\t.8 0 1e0\n\t0 1 # material\ns 1e-3 +2 -3.\n.5 s 0 0 0 1E2\np 3 0 0 0\n1 0 0 0 1 0"
    )
    scene = read("\ufeff" + text.replace("\n", newline)).scene
    assert scene.primitive_counts() == {"sphere": 2, "triangle": 1}
    np.testing.assert_array_equal(shapes(scene, Spheres).center, [(1e-3, 2, -3), (0, 0, 0)])
    np.testing.assert_array_equal(shapes(scene, Spheres).radius, [0.5, 100])


HEAD = VIEW + RED  # eight lines
WRONG = {
    "empty": ("", 1, "the file is empty"),
    "only a comment": ("# nothing\n", 1, "the file is empty"),
    "binary": (b"\x89PNG\r\n\x1a\n\0\0\0", 1, "binary data"),
    "binary without zeros": (b"\xff\xd8\xe1\x80", 1, "unknown record"),
    "number first": ("1 2 3\n" + VIEW, 1, "begins with '1', expected a record"),
    "unknown record": (HEAD + "sphere 0 0 0 1\n", 9, "unknown record 'sphere', expected one of b v l f s c p pp"),
    "upper case": (HEAD + "S 0 0 0 1\n", 9, "unknown record 'S'"),
    "no number": (HEAD + "s 0 0 0 1..5\n", 9, "'1..5' is not a number"),
    "underscore": (HEAD + "s 0 0 0 1_0\n", 9, "'1_0' is not a number"),
    "nan": (HEAD + "s 0 0\n nan 1\n", 10, "the number 'nan' is not finite"),
    "inf": (HEAD + "s 0 0 -inf 1\n", 9, "the number '-inf' is not finite"),
    "overflow": (HEAD + "s 0 0 0 1e999\n", 9, "the number '1e999' is not finite"),
    "too large": (HEAD + "s 1e30 0 0 1\n", 9, "larger than 1e+18"),
    "too few": (HEAD + "s 0 0 0\ns 0 0 0 1\n", 9, "'s' has 3 numbers, expected 4 (x y z radius)"),
    "too many": (HEAD + "s 0 0 0 1 5\n", 9, "'s' has 5 numbers, expected 4"),
    "light of four": (HEAD + "l 0 0 0 1\ns 0 0 0 1\n", 9, "'l' has 4 numbers, expected 3 or 6"),
    "truncated": (HEAD + "s 0 0 0 1\nc 0 0 0 1 0 0", 10, "the file ends within this 'c'"),
    "truncated polygon": (HEAD + "p 4\n0 0 0\n1 0 0\n", 9, "within this 'p': it has 7 numbers, expected 13"),
    "truncated count": (HEAD + "p", 9, "the file ends within this 'p'"),
    "two vertices": (HEAD + "p 2\n0 0 0\n1 0 0\n", 9, "'p' is to have 2 vertices, expected a whole number from 3 up"),
    "half a vertex": (HEAD + "p 3.5\n0 0 0\n1 0 0\n", 9, "3.5 vertices"),
    "absurd polygon": (HEAD + "p 1e17\n0 0 0\ns 0 0 0 1\n", 9, "'p' has 4 numbers"),
    "no area": (HEAD + "p 3\n0 0 0\n1 1 1\n2 2 2\n", 9, "the polygon has no area"),
    "one point": (HEAD + "p 3\n1 1 1\n1 1 1\n1 1 1\n", 9, "the polygon has no area"),
    "not planar": (HEAD + "p 4\n0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n", 9, "the polygon is not planar"),
    "crossing": (HEAD + "p 5\n0 0 0\n4 0 0\n4 4 0\n2 -1 0\n0 4 0\n", 9, "the polygon crosses itself"),
    "no normal": (HEAD + "pp 3\n0 0 0 0 0 1\n1 0 0 0 0 0\n0 1 0 0 0 1\n", 9, "a vertex normal is 0"),
    "zero radius": (HEAD + "s 0 0 0 1\ns 0 0 0 0\n", 10, "the sphere's radius is 0, expected one that is not 0"),
    "zero radii": (HEAD + "c 0 0 0 0 0 0 1 0\n", 9, "the radii are 0 and 0"),
    "mixed radii": (HEAD + "c 0 0 0 1 0 0 1 -1\n", 9, "the radii are 1 and -1, expected both of the same sign"),
    "no length": (HEAD + "c 0 0 1 1 0 0 1 1\n", 9, "base and apex are the same point"),
    "no view": (RED + "s 0 0 0 1\n", 2, "the view is missing"),
    "second view": (HEAD + VIEW, 9, "a second view"),
    "no up": (VIEW.replace("up 0 0 1\n", ""), 1, "the view has no 'up', expected one"),
    "two from": (VIEW.replace("at 0", "from 0"), 3, "the view has 2 'from', expected one"),
    "from outside": (HEAD + "from 0 0 0\n", 9, "'from' stands outside the view"),
    "from is at": (VIEW.replace("-5", "0"), 1, "the two points must differ"),
    "up along the view": (VIEW.replace("up 0 0 1", "up 0 3 0"), 1, "up must not lie along the view"),
    "angle 0": (VIEW.replace("45", "0"), 5, "the angle is 0, expected more than 0 and less than 180 degrees"),
    "angle 180": (VIEW.replace("45", "180"), 5, "the angle is 180"),
    "hither": (VIEW.replace("0.5", "-0.5"), 6, "hither is -0.5, expected a distance from 0 up"),
    "no pixels": (VIEW.replace("40 20", "40 0"), 7, "the resolution is 40 x 0"),
    "half pixels": (VIEW.replace("40 20", "40.5 20"), 7, "the resolution is 40.5 x 20"),
    "no material": (VIEW + "s 0 0 0 1\n" + RED, 8, "a primitive without a material, expected an 'f' before it"),
    "negative material": (VIEW + "f 1 1 1 -0.5 0 0 0 1\n", 8, "Kd is -0.5"),
    "index of refraction": (VIEW + "f 1 1 1 0.5 0 0 0.5 0\n", 8, "the index of refraction is 0 for T 0.5"),
    "two backgrounds": (VIEW + "b 0 0 0\nb 1 1 1\n", 9, "a second background"),
    "negative background": (VIEW + "b 0 -1 0\n", 8, "the background is negative"),
    "negative light": (VIEW + "l 0 0 0 1 -1 1\n", 8, "the light is negative"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_errors_name_line_and_cause(read, tmp_path, case):
    text, line, message = WRONG[case]
    with pytest.raises(NffError) as caught:
        read(text)
    assert str(caught.value).startswith(f"{tmp_path / 'scene.nff'}:{line}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_error_line_is_found_far_into_a_large_file(read, tmp_path):
    """Beyond the first of the pieces that the reader takes at once."""
    spheres = 600_000
    text = HEAD + "s 0.123456 0.123456 0.123456 1\n" * spheres + "s 0 0 0 0\n"
    assert len(text) > 1 << 24
    with pytest.raises(NffError, match=f":{8 + spheres + 1}: the sphere's radius is 0"):
        read(text)


def test_a_file_that_cannot_be_read(tmp_path):
    for path in (tmp_path / "missing.nff", tmp_path):
        with pytest.raises(SceneError, match="cannot be read"):
            read_nff(path)


def test_an_error_in_a_pipe_has_its_line(tmp_path):
    """What comes out of a pipe cannot be read a second time to look for the line."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    writer = threading.Thread(target=pipe.write_text, args=(HEAD + "s 0 0 0 0\n",))
    writer.start()
    with pytest.raises(NffError, match="pipe:9: the sphere's radius is 0"):
        read_nff(pipe)
    writer.join()


def test_large_file(tmp_path):
    path = tmp_path / "balls.nff"
    write_nff(balls(6), path, 512, 512)
    scene = read_nff(path).scene
    assert scene.primitive_counts() == {"sphere": 597871, "triangle": 2}


# -- polygons ---------------------------------------------------------------------------------------------------------


def turned(flat, random, scale):
    """Points (n, 2) somewhere in space, at any orientation and size: (n, 3)."""
    frame, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return scale * (flat @ frame[:, :2].T + random.normal(size=3))


@given(st.integers(0, 1 << 32), st.integers(3, 40), st.floats(-4.0, 5.0))
def test_triangles_cover_a_star_shaped_polygon_once(seed, n, exponent):
    random = np.random.default_rng(seed)
    angle = (np.arange(n) + random.uniform(0.0, 0.7, n)) * 2.0 * np.pi / n
    flat = random.uniform(0.3, 1.0, (n, 1)) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    points = turned(flat, random, 10.0**exponent)
    owner, index = triangulate(points[None])
    part = areas(points[index])
    whole = np.cross(points - points[0], np.roll(points - points[0], -1, axis=0)).sum(axis=0) / 2.0
    # All turn as the polygon does, and their areas sum to its own: so none lies outside, and no two overlap.
    assert (part @ whole > 0.0).all()
    np.testing.assert_allclose(part.sum(axis=0), whole, atol=1e-9 * np.linalg.norm(whole))
    assert len(index) <= n - 2
    assert not owner.any()


DART = np.array([(0, 0), (2, 1), (0, 2), (1, 1)], np.float64)
CROSS = np.array(
    [(1, 0), (2, 0), (2, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3), (1, 2), (0, 2), (0, 1), (1, 1)], np.float64
)
WITH_HOLE = np.array([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)], np.float64)
SPIRAL = np.array(
    [(0, 0), (5, 0), (5, 5), (1, 5), (1, 2), (3, 2), (3, 3), (2, 3), (2, 4), (4, 4), (4, 1), (0, 1)], np.float64
)


@pytest.mark.parametrize("flat, area", [(DART, 1.0), (CROSS, 5.0), (WITH_HOLE, 12.0), (SPIRAL, 15.0)])
@pytest.mark.parametrize("reverse", [False, True])
def test_concave_polygons_from_every_first_vertex(flat, area, reverse):
    for first in range(len(flat)):
        points = turned(np.roll(flat, first, axis=0), np.random.default_rng(first), 7.0)
        points = points[::-1] if reverse else points
        _, index = triangulate(points[None])
        part = areas(points[index])
        assert np.linalg.norm(part, axis=-1).sum() == pytest.approx(49.0 * area)
        assert np.linalg.norm(part.sum(axis=0)) == pytest.approx(49.0 * area)


def test_many_quads_at_once_keep_their_order():
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float64)
    dart = np.pad(DART, ((0, 0), (0, 1)))
    owner, index = triangulate(np.stack([square, dart, square, np.roll(dart, 1, axis=0)]))
    np.testing.assert_array_equal(owner, np.repeat(np.arange(4), 2))
    assert all(3 in row and 1 in row for row in index[2:4])  # from its inward corner


def test_rounded_digits_count_as_planar_and_more_does_not():
    points = turned(CROSS, np.random.default_rng(5), 3.0)
    rounded = np.array([[float(f"{x:.5g}") for x in point] for point in points])
    assert len(triangulate(rounded[None])[1]) == 10
    bent = rounded.copy()
    normal = areas(points[None, :3])[0]
    bent[4] += 0.5 * normal / np.linalg.norm(normal)
    with pytest.raises(PolygonError, match="polygon 1: the polygon is not planar"):
        triangulate(np.stack([rounded, bent]))


# -- writing ----------------------------------------------------------------------------------------------------------

NUMBER = st.floats(-1e5, 1e5, allow_subnormal=False).map(lambda x: round(x, 9))


@st.composite
def scenes(draw):
    """Scenes that NFF can hold, of all kinds of primitives."""
    random = np.random.default_rng(draw(st.integers(0, 1 << 32)))
    camera = Camera.look_at(
        random.normal(size=3) * 10.0 ** random.uniform(-4, 5),
        random.normal(size=3),
        random.normal(size=3),
        random.uniform(1.0, 170.0),
        aspect=1.5,
        clip=(random.uniform(0.0, 2.0), 1e30),
    )
    scene = Scene(camera=camera, world=World(color=tuple(random.random(3))))
    for _ in range(draw(st.integers(0, 3))):
        scene.add_light(Light.constant(random.normal(size=3), random.random(3)))
    for transmit in (0.0, 0.5):
        mirror = random.random()
        material = Material(
            diffuse=random.random(3), reflect=mirror, highlight=mirror, shine=random.random() * 99.0,
            transmit=transmit, ior=random.uniform(1.0, 2.0), fresnel=False,
        )  # fmt: skip
        index, n = scene.add_material(material), draw(st.integers(1, 5))
        a, b, c = 10.0 ** random.uniform(-4, 5) * random.normal(size=(3, n, 3))
        sign = np.where(random.random(n) < 0.5, -1.0, 1.0)
        scene.add_spheres(a, sign * random.uniform(0.1, 1.0, n), index)
        scene.add_cylinders(a, b, sign * random.uniform(0.1, 1.0, n), index, caps=False)
        scene.add_cones(a, b, sign * random.uniform(0.1, 0.5, n), sign * random.uniform(0.6, 1.0, n), index, caps=False)
        scene.add_triangles(a, b, c, index, one_sided=int(transmit == 0.0))
        normals = random.normal(size=(3, n, 3))
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        scene.add_triangles(a, c, b, index, one_sided=int(transmit == 0.0), n0=normals[0], n1=normals[1], n2=normals[2])
    return scene


@given(scenes())
def test_round_trip(tmp_path_factory, scene):
    path = tmp_path_factory.mktemp("nff") / "scene.nff"
    write_nff(scene, path, 60, 40)
    file = read_nff(path)
    assert (file.width, file.height) == (60, 40)
    back = file.scene
    assert back.materials == scene.materials
    assert back.lights == scene.lights
    assert back.world == scene.world
    np.testing.assert_allclose(back.camera.matrix, scene.camera.matrix, rtol=1e-12, atol=1e-11)
    np.testing.assert_allclose(back.camera.window, scene.camera.window, rtol=1e-12)
    assert back.camera.clip == scene.camera.clip
    for (_, before), (_, after) in zip(scene.shapes.kinds(), back.shapes.kinds(), strict=True):
        names = [c.name for c in before.columns if not c.name.startswith(("uv", "meridian", "pole"))]
        np.testing.assert_allclose(_sorted_rows(after, names), _sorted_rows(before, names), rtol=1e-13, atol=1e-15)


def _sorted_rows(primitives, names):
    rows = np.concatenate([np.reshape(getattr(primitives, name), (len(primitives), -1)) for name in names], axis=1)
    return rows[np.lexsort(np.round(rows, 9).T)]


def test_two_sided_opaque_triangles_are_written_both_ways(tmp_path):
    scene = Scene(camera=Camera.look_at((0, -5, 0), (0, 0, 0)))
    scene.add_material(Material(fresnel=False))
    scene.add_triangles([(0, 0, 0)], [(1, 0, 0)], [(0, 0, 1)])
    write_nff(scene, tmp_path / "a.nff", 8, 8)
    found = shapes(read_nff(tmp_path / "a.nff").scene, Triangles)
    normals = areas(corners(found))
    assert found.one_sided.all()
    np.testing.assert_allclose(normals, [(0, -0.5, 0), (0, 0.5, 0)])


def _plain_scene():
    scene = Scene(camera=Camera.look_at((0, -5, 0), (0, 0, 0)))
    scene.add_material(Material(fresnel=False))
    scene.add_spheres([(0, 0, 0)], 1.0)
    return scene


def _with_material(**values):
    def change(scene):
        scene.materials[0] = Material(**{"fresnel": False} | values)

    return change


def _with_camera(**values):
    def change(scene):
        scene.camera = Camera(**vars(scene.camera) | values)

    return change


CANNOT = {
    "Fresnel": _with_material(fresnel=True),
    "glow": _with_material(glow=1.0),
    "absorption": _with_material(absorption=1.0),
    "values that vary over the surface": _with_material(diffuse=surface_image(0)),
    "a coloured mirror": _with_material(reflect=(1, 0, 0)),
    "a coloured transmittance": _with_material(transmit=(1, 0, 0)),
    "a highlight other than the mirror": _with_material(reflect=1.0),
    "an orthographic camera": _with_camera(orthographic=True),
    "a camera with a shift": _with_camera(window=(-0.5, 1, -1, 1)),
    "a camera of aspect 2": _with_camera(window=(-2, 2, -1, 1)),
    "a far clip": _with_camera(clip=(0, 10)),
    "a scene without a camera": lambda scene: setattr(scene, "camera", None),
    "an image as the world": lambda scene: setattr(scene, "world", World(image=0)),
    "a light of kind SUN": lambda scene: scene.add_light(Light.sun((0, 0, 1), 1.0)),
    "infinite planes": lambda scene: scene.add_plane([(0, 0, 0)], [(0, 0, 1)]),
    "discs": lambda scene: scene.add_discs([(0, 0, 0)], [(0, 0, 1)], 1.0),
    "instances": lambda scene: scene.instances.append(Instances(scene.shapes, np.eye(4))),
    "whose material is not in the scene": lambda scene: scene.add_spheres([(0, 0, 0)], 1.0, 1),
}


@pytest.mark.parametrize("what", CANNOT)
def test_what_nff_cannot_hold_is_named_and_nothing_written(tmp_path, what):
    scene = _plain_scene()
    write_nff(scene, tmp_path / "plain.nff", 8, 8)
    CANNOT[what](scene)
    with pytest.raises(SceneError, match="NFF cannot hold .*" + what):
        write_nff(scene, tmp_path / "wrong.nff", 8, 8)
    assert [path.name for path in tmp_path.iterdir()] == ["plain.nff"]


# -- the standard families --------------------------------------------------------------------------------------------

COUNTS = {
    "balls": {"sphere": 7381, "triangle": 2},
    "tree": {"sphere": 4095, "cone": 4095, "triangle": 2},
    "tetra": {"triangle": 4096},
    "mount": {"sphere": 4, "triangle": 8192},
    "lattice": {"sphere": 2197, "cylinder": 6084},
}


@pytest.mark.parametrize("family", FAMILIES)
def test_standard_scenes_have_the_published_sizes(tmp_path, family):
    scene = FAMILIES[family]()
    assert scene.primitive_counts() == COUNTS[family]
    write_nff(scene, tmp_path / "scene.nff", 512, 512)
    assert read_nff(tmp_path / "scene.nff").scene.primitive_counts() == COUNTS[family]


def test_sphereflake_balls_touch_their_parents():
    spheres = shapes(balls(3), Spheres)
    child = np.arange(1, len(spheres))
    distance = np.linalg.norm(spheres.center[child] - spheres.center[(child - 1) // 9], axis=1)
    np.testing.assert_allclose(distance, spheres.radius[child] * 4.0, rtol=1e-12)


def test_tetra_is_closed():
    """Every solid's four faces look outwards: their vector areas cancel, and the volume is positive."""
    faces = corners(shapes(FAMILIES["tetra"](3), Triangles))
    normals = areas(faces)
    np.testing.assert_allclose(normals.reshape(-1, 4, 3).sum(axis=1), 0.0, atol=1e-15)
    center = faces.reshape(-1, 12, 3).mean(axis=1).repeat(4, axis=0)
    assert (np.einsum("ni,ni->n", faces.mean(axis=1) - center, normals) > 0.0).all()
