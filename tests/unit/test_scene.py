"""The plain data of a scene: units, checks, caps, counts."""

import re

import numpy as np
import pytest

from addon.engine.errors import SceneError
from addon.engine.primitives import Planes, Spheres
from addon.engine.scene import Camera, Geometry, Image, Instances, Light, LightKind, Material, Scene, World


def test_a_watt_is_blender_s():
    light = Light.point((1, 2, 3), 1000.0, (1.0, 0.5, 0.25))
    assert light.kind == LightKind.POINT and light.position == (1, 2, 3)
    assert np.allclose(light.color, 1000.0 / (4 * np.pi**2) * np.array([1.0, 0.5, 0.25]))


def test_a_sun_s_strength_is_an_irradiance():
    sun = Light.sun((0, 0, 5.0), 3.0)
    assert sun.position == (0, 0, 1) and np.allclose(sun.color, 3.0 / np.pi)
    assert Light.constant((1, 1, 1), (0.5, 0.5, 0.5)).color == (0.5, 0.5, 0.5)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"diffuse": (1, -1, 1)}, "material: diffuse is"),
        ({"glow": float("nan")}, "material: glow is"),
        ({"absorption": (0, 0, float("inf"))}, "material: absorption is"),
        ({"ior": 0.0}, "material: ior is 0.0; it must be positive"),
        ({"ior": float("nan")}, "material: ior is nan"),
        ({"shine": float("nan")}, "material: shine is nan"),
    ],
)
def test_a_material_that_cannot_be(values, message):
    with pytest.raises(SceneError, match=re.escape(message)):
        Material(**values)


def test_a_world_or_sun_that_cannot_be():
    with pytest.raises(SceneError, match="world: color is"):
        World((0.0, float("nan"), 0.0))
    with pytest.raises(SceneError, match="has no length"):
        Light.sun((0, 0, 0), 1.0)
    assert World(0.5).color == (0.5, 0.5, 0.5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Light.point((0, 0, 0), 1.0, radius=-1.0), "the radius -1.0 must be finite"),
        (lambda: Light.sun((0, 0, 1), 1.0, angle=4.0), "the angle 4.0 does not lie between 0 and pi"),
        (lambda: Light.spot((0, 0, 0), (0, 0, 0), 1.0, 1.0), "spot: the direction (0.0, 0.0, 0.0) has no length"),
        (lambda: Light.spot((0, 0, 0), (0, 0, 1), 1.0, 0.0), "spot: the angle 0.0 must lie between 0 and pi"),
        (lambda: Light.spot((0, 0, 0), (0, 0, 1), 1.0, 1.0, 2.0), "the blend 2.0 between 0 and 1"),
        (lambda: Light.area((0, 0, 0), (1, 0, 0), (2, 0, 0), 1.0), "have no area"),
        (lambda: Light.area((0, 0, 0), (1, 0, 0), (0, 1, 0), 1.0, shape="DISC"), "the shape 'DISC' is none of"),
        (lambda: Light.area((0, 0, 0), (1, 0, 0), (0, 1, 0), 1.0, spread=-1.0), "the spread -1.0"),
    ],
)
def test_a_light_that_cannot_be(make, message):
    with pytest.raises(SceneError, match=re.escape(message)):
        make()


def test_area_lights_and_spots_shine_where_they_are_told():
    area = Light.area((0, 0, 0), (2, 0, 0), (0, 4, 0), np.pi**2)
    assert area.kind == LightKind.RECTANGLE and area.axes == ((1, 0, 0), (0, 2, 0), (0, 0, 1))
    assert np.allclose(area.color, 1.0) and area.shaped
    # Behind slats, straight ahead, brighter: of 90 degrees by 1 / (1 - pi / 4).
    narrow = Light.area((0, 0, 0), (2, 0, 0), (0, 4, 0), np.pi**2, spread=np.pi / 2.0, direction=(0, 0, -2))
    assert np.allclose(narrow.color, 1.0 / (1.0 - np.pi / 4.0)) and narrow.axes[2] == (0, 0, -1)
    axes = np.array(Light.spot((0, 0, 0), (3, 0, -4), 1.0, 1.0).axes)
    assert np.allclose(axes @ (3, 0, -4), (0, 0, 5)) and np.allclose(axes @ axes.T, np.eye(3))
    assert not Light.point((0, 0, 0), 1.0).shaped and not Light.sun((0, 0, 1), 1.0).shaped


def test_a_number_is_a_grey_colour():
    assert Material(diffuse=0.5).diffuse == (0.5, 0.5, 0.5)
    assert Material.mirror().reflect == (1, 1, 1) and not Material.mirror().fresnel
    glass = Material.glass((0.9, 1, 1), 1.4)
    assert glass.transmit == (0.9, 1, 1) and glass.ior == 1.4 and glass.diffuse == (0, 0, 0)


def test_images_get_an_alpha_and_are_checked():
    assert Image(np.full((2, 3, 3), 0.5)).pixels[0, 0].tolist() == [0.5, 0.5, 0.5, 1.0]
    assert Image(np.zeros((2, 3, 4))).pixels.dtype == np.float32
    for pixels in (np.zeros((2, 3)), np.zeros((2, 3, 2)), np.zeros((0, 3, 4))):
        with pytest.raises(SceneError, match=re.escape(f"image 'wood': shape {pixels.shape}")):
            Image(pixels, name="wood")
    with pytest.raises(SceneError, match="interpolation 'SINC'"):
        Image(np.zeros((1, 1, 4)), "SINC")
    bytes_alone = Image(np.zeros((2, 3, 3), np.uint8)).pixels
    assert bytes_alone.dtype == np.uint8 and bytes_alone[0, 0].tolist() == [0, 0, 0, 255]


def test_a_camera_looks_at_its_target():
    camera = Camera.look_at((3.0, -4.0, 2.0), (0.5, 0.25, 0.0), angle=90.0, aspect=2.0)
    matrix = camera.matrix
    assert np.allclose(matrix[:3, :3].T @ matrix[:3, :3], np.eye(3)) and np.linalg.det(matrix) == pytest.approx(1.0)
    view = np.array([0.5, 0.25, 0.0]) - [3.0, -4.0, 2.0]
    assert np.allclose(-matrix[:3, 2], view / np.linalg.norm(view)) and np.allclose(matrix[:3, 3], [3, -4, 2])
    assert matrix[2, 0] == pytest.approx(0.0) and matrix[2, 1] > 0.0, "the horizon is level, up is up"
    assert np.allclose(camera.window, (-2.0, 2.0, -1.0, 1.0))
    assert np.allclose(Camera.orthographic_at((0, 0, 5), (0, 0, 0), 3.0, up=(0, 1, 0)).window, (-1.5, 1.5, -1.5, 1.5))


@pytest.mark.parametrize(
    ("eye", "target", "up"),
    [((1, 1, 1), (1, 1, 1), (0, 0, 1)), ((0, 0, 5), (0, 0, 0), (0, 0, 1)), ((0, 0, 5), (0, 1, 0), (0, 0, 0))],
)
def test_a_camera_without_a_view_is_refused(eye, target, up):
    with pytest.raises(
        SceneError, match="gives no view; the two points must differ and up must not lie along the view"
    ):
        Camera.look_at(eye, target, up)


def test_solid_cylinders_and_cones_have_caps_that_face_outwards():
    scene = Scene()
    scene.add_cylinders([[0, 0, 0]], [[0, 0, 2.0]], [0.5], material=3)
    scene.add_cones([[5, 0, 0]], [[5, 0, 2.0]], [0.5])
    scene.add_cones([[9, 0, 0]], [[9, 0, 2.0]], [-0.5], [-0.25])
    scene.add_cylinders([[0, 9, 0]], [[0, 9, 2.0]], [0.5], caps=False)
    assert scene.primitive_counts() == {"cylinder": 2, "cone": 2, "disc": 5}
    discs = next(part for _, part in scene.shapes.kinds() if part.kind == "disc")
    assert discs.normal[:2].tolist() == [[0, 0, -1], [0, 0, 1]] and discs.material[:2].tolist() == [3, 3]
    assert discs.radius.tolist() == [0.5, 0.5, 0.5, 0.5, 0.25], "no cap where the radius is 0, positive ones elsewhere"


def test_counts_count_instances_each_time():
    scene = Scene()
    geometry = Geometry(Spheres(center=np.zeros((4, 3)), radius=1.0))
    scene.instances += [Instances(geometry, np.eye(4))] * 3
    scene.add_spheres([[0, 0, 0]], 1.0)
    scene.add_plane([[0, 0, 0]], [[0, 0, 1]])
    assert scene.primitive_counts() == {"sphere": 13, "plane": 1}


def test_a_plane_stands_in_no_geometry():
    with pytest.raises(SceneError, match="Planes cannot stand in a geometry"):
        Geometry(Planes(point=[[0, 0, 0]], normal=[[0, 0, 1]]))


def test_a_geometry_joins_what_is_added():
    geometry = Geometry(name="two")
    for x in (0.0, 1.0):
        geometry.add(Spheres(center=[[x, 0, 0]], radius=1.0))
    geometry.add(Spheres(center=np.zeros((0, 3)), radius=np.zeros(0)))
    ((label, part),) = geometry.kinds()
    assert label == 0 and part.center[:, 0].tolist() == [0.0, 1.0] and len(geometry) == 2
