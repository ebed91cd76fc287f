"""NFF files in: what is read, what is refused and in which words."""

import os
import threading

import numpy as np
import pytest

from addon.engine import Cones, Cylinders, SceneError, Spheres, Triangles
from addon.engine.nff import NffError, read_nff, write_nff
from examples.standard_scenes import balls
from tests.unit.shape_arrays import corners, shapes

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
