"""What a ray finds on a surface: its picture at named points of every kind, its sides, the sky and the shadows."""

import numpy as np
import pytest

from addon.engine import (
    Camera,
    Geometry,
    Image,
    Instances,
    Light,
    Material,
    Scene,
    Settings,
    Spheres,
    World,
    render,
)
from addon.engine.material import surface_attribute, surface_image
from addon.engine.settings import SHADOWS

from .probe import along

SETTINGS = Settings(max_depth=8, weight_cutoff=0.0)
GRID = 64


def uv_image():
    """Red is u and green is v, at the texels' centres."""
    v, u = (np.mgrid[:GRID, :GRID] + 0.5) / GRID
    return Image(np.stack([u, v, np.zeros_like(u)], axis=-1), interpolation="CLOSEST")


def textured_scene(image):
    """A black world where material 0 glows with the image."""
    glowing = Material(diffuse=0.0, glow=surface_image(0))
    return Scene(world=World((0.0, 0.0, 0.0)), materials=[glowing], images=[image])


def polar(azimuth, elevation=0.0):
    """A unit vector from angles in degrees."""
    a, e = np.radians([azimuth, elevation])
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def gallery():
    """One of each kind, far from each other, and (point, outward direction, uv) on each, told by hand."""
    scene = textured_scene(uv_image())
    places = []

    def at(center, offset, outward, uv):
        places.append((np.add(center, offset), np.asarray(outward, float), uv))

    ball, turned, pipe, cone, disc, floor, corner, egg = (np.array([30.0 * i, 0.0, 0.0]) for i in range(8))
    scene.add_spheres(ball, 1.0)
    for azimuth, elevation in ((45.0, 0.0), (100.0, 45.0), (260.0, -60.0), (350.0, 80.0)):
        direction = polar(azimuth, elevation)
        at(ball, direction, direction, (azimuth / 360.0, 0.5 + elevation / 180.0))
    # Pole towards +X, meridian towards +Y: then u grows from Y to Z.
    scene.add_spheres(turned, 2.0, pole=(1.0, 0.0, 0.0), meridian=(0.0, 1.0, 0.0))
    at(turned, (0.0, np.sqrt(2.0), np.sqrt(2.0)), (0.0, 1.0, 1.0), (0.125, 0.5))
    at(turned, (np.sqrt(2.0), 0.0, np.sqrt(2.0)), (1.0, 0.0, 1.0), (0.25, 0.75))
    scene.add_cylinders(pipe, np.add(pipe, (0.0, 0.0, 2.0)), 0.5)
    at(pipe, (0.0, 0.5, 0.5), (0.0, 1.0, 0.0), (0.25, 0.25))
    at(pipe, (*(0.5 * polar(200.0)[:2]), 1.8), polar(200.0), (200.0 / 360.0, 0.9))
    scene.add_cones(cone, np.add(cone, (0.0, 0.0, 2.0)), 1.0, 0.5)
    at(cone, (0.0, -0.75, 1.0), (0.0, -1.0, 0.25), (0.75, 0.5))
    at(cone, (*(0.9 * polar(30.0)[:2]), 0.4), polar(30.0), (30.0 / 360.0, 0.2))
    scene.add_discs(disc, (0.0, 0.0, 1.0), 1.0)
    at(disc, (0.5, -0.25, 0.0), (0.0, 0.0, 1.0), (0.75, 0.375))
    at(disc, (-0.3, 0.6, 0.0), (0.2, 0.0, -1.0), (0.35, 0.8))  # the same from below
    scene.add_plane(floor - (0.0, 0.0, 3.0), (0.0, 0.0, 1.0), tile=2.0)
    at(floor, (0.5, 1.5, -3.0), (0.0, 0.0, 1.0), (0.25, 0.75))
    at(floor, (-0.5, -3.5, -3.0), (0.3, 0.0, 1.0), (0.75, 0.25))  # repeated
    ends = np.add(corner, (2.0, 0.0, 0.0)), np.add(corner, (0.0, 2.0, 0.0))
    scene.add_triangles(corner, *ends, uv0=(0.1, 0.2), uv1=(0.9, 0.2), uv2=(0.3, 0.8))
    at(corner, (0.5, 0.5, 0.0), (0.0, 0.1, 1.0), (0.5 * 0.1 + 0.25 * 0.9 + 0.25 * 0.3, 0.75 * 0.2 + 0.25 * 0.8))
    at(corner, (0.2, 1.4, 0.0), (0.1, 0.0, -1.0), (0.2 * 0.1 + 0.1 * 0.9 + 0.7 * 0.3, 0.3 * 0.2 + 0.7 * 0.8))
    matrix = np.diag([2.0, 1.0, 0.5, 1.0])
    matrix[:3, 3] = egg
    scene.instances.append(Instances(Geometry(Spheres(center=(0.0, 0.0, 0.0), radius=1.0)), matrix))
    at(
        egg,
        polar(60.0, 30.0) * (2.0, 1.0, 0.5),
        polar(60.0, 30.0) / (2.0, 1.0, 0.5),
        (60.0 / 360.0, 0.5 + 30.0 / 180.0),
    )
    return scene, places


def test_pictures_lie_where_they_should(device):
    """Every kind's uv at points told by hand, to half a texel and rounding."""
    scene, places = gallery()
    for point, outward, uv in places:
        outward = outward / np.linalg.norm(outward)
        color = along(device, scene, point + 0.5 * outward, -outward, SETTINGS)
        assert np.abs(color[:2] - uv).max() < 0.6 / GRID, f"at {point}: uv {color[:2]}, expected {uv}"


@pytest.mark.parametrize(
    ("interpolation", "extension", "u", "expected"),
    [
        ("CLOSEST", "REPEAT", 0.49, 0.2),
        ("CLOSEST", "REPEAT", 1.51, 0.8),
        ("CLOSEST", "REPEAT", -0.01, 0.8),
        ("LINEAR", "REPEAT", 0.25, 0.2),
        ("LINEAR", "REPEAT", 0.5, 0.5),
        ("LINEAR", "REPEAT", 1.0, 0.5),
        ("LINEAR", "EXTEND", 1.0, 0.8),
        ("LINEAR", "EXTEND", -7.3, 0.2),
        ("LINEAR", "CLIP", 1.0, 0.4),
        ("CLOSEST", "CLIP", 1.01, 0.0),
    ],
)
def test_between_and_beyond_texels(device, interpolation, extension, u, expected):
    """Two texels, 0.2 and 0.8, on a plane."""
    texels = np.array([[[0.2] * 3, [0.8] * 3]])
    scene = textured_scene(Image(texels, interpolation=interpolation, extension=extension))
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    assert along(device, scene, (u, 0.5, 1.0), (0.0, 0.0, -1.0), SETTINGS) == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("share", ["diffuse", "reflect", "transmit", "glow"])
def test_each_colour_may_come_from_an_image(device, share):
    """A grey image halves the colour that it belongs to and no other: each adds to what is seen."""
    colors = {"diffuse": 0.2, "reflect": 0.3, "transmit": 0.1, "glow": 0.05}
    images = {name: color * surface_image(0) for name, color in colors.items()}
    scene = Scene(world=World((1.0, 1.0, 1.0)), images=[Image(np.full((1, 1, 3), value)) for value in (1.0, 0.5)])
    scene.add_material(Material(**images, fresnel=False, ior=1.0))
    scene.add_light(Light.sun((0.0, 0.0, 1.0), np.pi))
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    ray = (0.3, 0.3, 1.0), (0.0, 0.0, -1.0)
    assert along(device, scene, *ray, SETTINGS) == pytest.approx(sum(colors.values()), abs=1e-6)
    scene.materials = [Material(**images | {share: colors[share] * surface_image(1)}, fresnel=False, ior=1.0)]
    expected = sum(colors.values()) - 0.5 * colors[share]
    assert along(device, scene, *ray, SETTINGS) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("share", ["diffuse", "reflect", "transmit", "glow"])
def test_each_colour_may_come_from_an_attribute(device, share):
    """It multiplies the colour that names it, and its image; where nothing has the attribute the colour is black."""
    colors = {"diffuse": 0.2, "reflect": 0.3, "transmit": 0.1, "glow": 0.05}
    tint = np.array((0.5, 0.25, 2.0))
    for attributes, image, factor in (
        ({"tint": (*tint, 1.0)}, False, tint),
        ({"tint": (*tint, 1.0)}, True, 0.5 * tint),
        ({}, False, 0.0 * tint),
    ):
        scene = Scene(world=World((1.0, 1.0, 1.0)))
        scene.add_image(Image(np.full((1, 1, 3), 0.5)))
        tinted = colors[share] * surface_attribute("tint") * (surface_image(0) if image else 1.0)
        scene.materials = [Material(**colors | {share: tinted}, fresnel=False, ior=1.0)]
        scene.add_discs((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 1.0, attributes=attributes)
        scene.add_light(Light.sun((0.0, 0.0, 1.0), np.pi))
        expected = sum(colors.values()) + (factor - 1.0) * colors[share]
        color = along(device, scene, (0.3, 0.3, 1.0), (0.0, 0.0, -1.0), SETTINGS)
        assert color == pytest.approx(expected, abs=1e-6), (attributes, image)


def test_sky_in_a_mirror(device):
    """An equirectangular sky, directly and in a mirror ball, against the direction's longitude and latitude."""
    scene = Scene(materials=[Material.mirror()])
    scene.world = World((1.0, 1.0, 1.0), scene.add_image(uv_image()))
    scene.add_spheres((0.0, 0.0, 0.0), 1.0)

    def expected(direction):
        x, y, z = direction / np.linalg.norm(direction)
        return (0.5 - np.arctan2(y, x) / (2.0 * np.pi)) % 1.0, 0.5 + np.arcsin(z) / np.pi

    assert expected(np.array([1.0, 0.0, 0.0])) == (0.5, 0.5)  # the middle is towards +X, its left towards +Y
    for azimuth, elevation in ((0.5, 10.0), (80.0, -30.0), (200.0, 60.0), (300.0, 5.0)):
        direction = polar(azimuth, elevation)
        color = along(device, scene, 5.0 * direction, direction, SETTINGS)
        assert np.abs(color[:2] - expected(direction)).max() < 0.6 / GRID
        for turn in (25.0, 50.0):  # look at the ball where its normal is turned away from the view
            normal = polar(azimuth + turn, elevation)
            mirrored = -direction + 2.0 * (direction @ normal) * normal
            color = along(device, scene, normal + 3.0 * direction, -direction, SETTINGS)
            assert np.abs(color[:2] - expected(mirrored)).max() < 0.6 / GRID


def test_one_sided_triangle(device):
    """From behind it is not seen and stops no shadow ray; a sphere of negative radius shows its inside only."""
    scene = Scene(world=World((0.0, 0.0, 0.5)), materials=[Material(diffuse=0.0, glow=1.0), Material(diffuse=1.0)])
    scene.add_triangles((-1.0, -1.0, 1.0), (1.0, -1.0, 1.0), (0.0, 1.0, 1.0), one_sided=1)
    scene.add_spheres((9.0, 0.0, 3.0), -1.0)
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 1)
    scene.add_light(Light.sun((0.0, 0.0, 1.0), np.pi))
    down, up = (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)
    assert along(device, scene, (0.0, 0.0, 3.0), down, SETTINGS) == pytest.approx(1.0)
    assert along(device, scene, (0.0, 0.0, 0.5), up, SETTINGS) == pytest.approx([0.0, 0.0, 0.5])
    assert along(device, scene, (0.0, 0.0, 0.5), down, SETTINGS) == pytest.approx(1.0)  # lit through its back
    assert along(device, scene, (9.0, 0.0, 6.0), down, SETTINGS) == pytest.approx(1.0)


@pytest.mark.parametrize("shadows", SHADOWS)
def test_shadow_of_an_absorbing_plate(device, shadows):
    """Opaque as in the paper, or what two surfaces and the way between them let through."""
    material = Material.glass((0.9, 0.8, 0.7), absorption=(0.2, 0.5, 1.0))
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material(diffuse=1.0), material, Material(diffuse=0.0)])
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0)
    scene.add_plane((0.0, 0.0, 2.0), (0.0, 0.0, 1.0), 1)
    scene.add_plane((0.0, 0.0, 1.0), (0.0, 0.0, -1.0), 1)
    scene.add_light(Light.sun((0.6, 0.0, 0.8), np.pi))
    settings = Settings(max_depth=8, weight_cutoff=0.0, shadows=shadows)
    color = along(device, scene, (0.0, 0.0, 0.5), (0.0, 0.0, -1.0), settings)
    through = 0.8 * np.array([0.9, 0.8, 0.7]) ** 2 * np.exp(-np.array([0.2, 0.5, 1.0]) / 0.8)
    assert color == pytest.approx(through if shadows == "TINTED" else 0.0, abs=1e-5)


@pytest.mark.parametrize(
    "shadows, passed",
    [
        ("OPAQUE", (0.0, 0.0, 0.0)),
        ("TRANSPARENT", (0.5 * 0.3, 0.2 * 0.1, 0.0)),
        ("TINTED", (0.5 * 0.5, 0.2 * 0.4, 0.0)),
    ],
)
def test_shadow_of_what_transmits(device, shadows, passed):
    """Of a sheet, of one that bends a part of the light and of a body without index: what passes each straight, or all
    that passes."""
    sheet = Material(diffuse=0.2, transmit=(0.5, 0.2, 0.0), ior=1.0)
    body = Material(diffuse=0.0, transmit=0.9, ior=1.0)
    mixed = Material(diffuse=0.0, transmit=(0.5, 0.4, 0.0), straight=(0.3, 0.1, 0.0), fresnel=False)
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material(diffuse=1.0), sheet, body, mixed])
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0)
    scene.add_discs([(0.0, 0.0, 1.0), (0.0, 0.0, 1.5)], (0.0, 0.0, 1.0), 1.0, [1, 3])
    scene.add_spheres((0.0, 0.0, 4.0), 1.0, 2)
    scene.add_light(Light.sun((0.0, 0.0, 1.0), np.pi))
    settings = Settings(max_depth=8, weight_cutoff=0.0, shadows=shadows)
    color = along(device, scene, (0.0, 0.0, 0.5), (0.0, 0.0, -1.0), settings)
    assert color == pytest.approx(0.9**2 * np.array(passed))


@pytest.mark.parametrize("shadow", [True, False])
def test_light_without_shadow(device, shadow):
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material(diffuse=0.5)])
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    scene.add_spheres((0.0, 0.0, 3.0), 1.0)
    scene.add_light(Light.sun((0.0, 0.0, 1.0), np.pi, shadow=shadow))
    color = along(device, scene, (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), Settings())
    assert color == pytest.approx(0.0 if shadow else 0.5)


def test_scene_without_light_says_so(device):
    scene = Scene(camera=Camera.look_at((0.0, -3.0, 0.0), (0.0, 0.0, 0.0)), materials=[Material()])
    assert not render(scene, 4, 4, device=device).warnings, "an empty scene is as it should be"
    scene.add_spheres((0.0, 0.0, 0.0), 1.0)
    (warning,) = render(scene, 4, 4, device=device).warnings
    assert "add a light" in warning


def test_light_within_an_absorbing_body(device):
    """What lies between the light and its body's border absorbs, and so does an outer body on the way to an inner."""
    inner, outer = (Material.glass(absorption=a) for a in ((0.1, 0.2, 0.4), (0.5, 0.2, 0.0)))
    scene = Scene(world=World((0.0, 0.0, 0.0)), materials=[Material(diffuse=1.0), inner, outer])
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0)
    scene.add_spheres([(0.0, 0.0, 5.0), (0.0, 0.0, 5.0)], [1.0, 3.0], [1, 2])
    scene.add_light(Light.constant((0.0, 0.0, 5.0)))
    settings = Settings(max_depth=8, weight_cutoff=0.0, shadows="TINTED")
    color = along(device, scene, (0.0, 0.0, 0.5), (0.0, 0.0, -1.0), settings)
    assert color == pytest.approx(
        np.exp(-1.0 * np.array(inner.absorption) - 2.0 * np.array(outer.absorption)), rel=5e-5
    )


def test_transparent_film(device):
    """Alpha is 0 in the sky, the sky's colour is not there, and a body that does not bend light is looked through."""
    scene = Scene(world=World((1.0, 1.0, 1.0)), materials=[Material(diffuse=0.0, glow=0.5), Material.glass(ior=1.0)])
    scene.camera = Camera.orthographic_at((0.0, -5.0, 0.0), (0.0, 0.0, 0.0), 4.0, aspect=2.0)
    scene.add_spheres([(-2.0, 0.0, 0.0), (2.0, 0.0, 0.0)], 1.0, [0, 1])
    settings = Settings(max_depth=8, weight_cutoff=0.0, film_transparent=True)
    pixels = render(scene, 32, 16, settings, device=device).pixels
    x, z = np.meshgrid((np.arange(32) + 0.5) / 4.0 - 4.0, (np.arange(16) + 0.5) / 4.0 - 2.0)
    body = np.hypot(x + 2.0, z) < 1.0
    assert (pixels[body] == (0.5, 0.5, 0.5, 1.0)).all()
    assert np.abs(pixels[~body]).max() < 1e-6
