"""Where a picture's rays go: scale and place of the scene, samples, borders, corners."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine import (
    Camera,
    Geometry,
    Instances,
    Light,
    LightKind,
    Material,
    Scene,
    Session,
    Settings,
    Triangles,
    World,
    render,
)
from addon.engine.primitives import Similarity

from .compare import psnr, save_difference
from .scenes import still_life

SIZE = (96, 72)
SETTINGS = Settings(max_depth=8, weight_cutoff=0.0, shadows="TINTED")


def moved(scene, scale, offset):
    """The scene scaled about the origin, then moved by offset (3,): lights and absorption with it."""
    similarity = Similarity(np.eye(3), scale, np.asarray(offset, np.float64))
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = offset
    camera = scene.camera.matrix.copy()
    camera[:3, 3] = similarity.points(camera[:3, 3])
    new = replace(
        scene,
        camera=replace(scene.camera, matrix=camera),
        lights=[_moved_light(light, similarity) for light in scene.lights],
        materials=[replace(m, absorption=np.divide(m.absorption, scale)) for m in scene.materials],
        shapes=Geometry(*(part.transformed(similarity) for _, part in scene.shapes.kinds())),
        planes=[part.transformed(similarity) for part in scene.planes],
        instances=[replace(i, matrices=matrix @ i.matrices) for i in scene.instances],
    )
    return new


def _moved_light(light, similarity):
    if light.kind == LightKind.SUN:
        return light
    brighter = similarity.scale**2 if light.kind == LightKind.POINT else 1.0
    return replace(
        light, position=similarity.points(np.array(light.position)), color=np.multiply(light.color, brighter)
    )


@pytest.mark.parametrize(
    ("scale", "offset"),
    [(1e-4, (0, 0, 0)), (1e5, (0, 0, 0)), (1.0, (1e5, -1e5, 3e4)), (1e-4, (10.0, 20.0, 5.0))],
    ids=["tiny", "huge", "far", "tiny_and_far"],
)
def test_scale_and_place_do_not_matter(device, scale, offset):
    scene = still_life()
    expected = render(scene, *SIZE, SETTINGS, device=device).pixels
    pixels = render(moved(scene, scale, offset), *SIZE, SETTINGS, device=device).pixels
    ratio = psnr(pixels[..., :3], expected[..., :3], np.ones(pixels.shape[:2], bool))
    typical = np.quantile(np.abs(pixels - expected), 0.98)
    assert ratio > 40.0 and typical < 1e-3, save_difference(f"scale_{scale:g}_{offset[0]:g}", pixels, expected)


def small_things():
    """Shapes of a tenth of a unit that touch the ground at z = 0, which is to be added; two lamps."""
    scene = Scene(world=World((0.2, 0.3, 0.4)), materials=[Material(diffuse=0.8), Material(diffuse=(0.8, 0.3, 0.2))])
    scene.camera = Camera.look_at((0.3, -0.8, 0.35), (0.0, 0.0, 0.05), angle=30.0, aspect=4 / 3)
    scene.add_spheres([(0.0, 0.0, 0.05), (0.13, 0.02, 0.03)], [0.05, 0.03], 1)
    scene.add_cones((-0.12, 0.0, 0.0), (-0.12, 0.0, 0.1), 0.04, material=1, caps=False)
    scene.add_light(Light.constant((1.0, -0.7, 1.5)))
    scene.add_light(Light.sun((-1.0, -0.3, 0.4), 1.0))
    return scene


def square(half, height=0.0):
    """Two triangles from -half to half at a height."""
    a, b, c, d = ((x * half, y * half, height) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    return Triangles(p0=[a, a], p1=[b, c], p2=[c, d])


def disc_floor(scene, half):
    scene.add_discs((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), half)


def triangle_floor(scene, half):
    scene.add(square(half))


def stretched_floor(scene, half):
    """A unit square below its origin, stretched and lifted."""
    matrix = np.diag([half, half, 3.0, 1.0])
    matrix[2, 3] = 0.75
    scene.instances.append(Instances(Geometry(square(1.0, -0.25)), matrix))


@pytest.mark.parametrize("half", [10.0, 1e3, 1e4])
@pytest.mark.parametrize("floor", [disc_floor, triangle_floor, stretched_floor])
def test_large_floor_is_as_exact_as_a_plane(device, floor, half):
    """Small things throw shadows right up to where they touch a floor that reaches far."""
    expected, scene = small_things(), small_things()
    expected.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    floor(scene, half)
    wanted, pixels = (render(each, *SIZE, SETTINGS, device=device).pixels for each in (expected, scene))
    ground = wanted[..., :3].max(axis=-1) > 0.0
    assert psnr(pixels[..., :3], wanted[..., :3], ground) > 60.0, save_difference(f"{floor.__name__}", pixels, wanted)


def test_samples_converge(device):
    """16 samples come near to 64 by brute force, nearer than one, and are not brighter or darker."""
    scene = still_life()
    width, height = 48, 36
    fine = render(scene, 8 * width, 8 * height, SETTINGS, device=device).pixels[..., :3]
    exact = fine.reshape(height, 8, width, 8, 3).mean(axis=(1, 3))
    errors = {}
    for samples in (1, 16):
        pixels = render(scene, width, height, replace(SETTINGS, samples=samples), device=device).pixels[..., :3]
        errors[samples] = float(np.sqrt(np.mean((pixels - exact) ** 2)))
        assert abs(np.mean(pixels - exact)) < 5e-3
    assert errors[16] < 0.3 * errors[1]
    assert errors[16] < 0.02


def test_first_sample_is_the_pixel_centre(device):
    """One sample is the Whitted picture; the samples that follow keep it."""
    scene = still_life()
    session = Session(device)
    session.load(scene, replace(SETTINGS, samples=4))
    session.start(*SIZE)
    while session.sample == 0:
        session.step(0.0)
    single = render(scene, *SIZE, SETTINGS, device=device).pixels
    assert np.array_equal(session.pixels()[-1], single[-1])  # the last row has one sample so far
    session.free()


def test_border_is_a_part_of_the_picture(device):
    scene = still_life()
    whole = render(scene, *SIZE, SETTINGS, device=device).pixels
    session = Session(device)
    session.load(scene, SETTINGS)
    x, y, width, height = border = (21, 13, 40, 29)
    session.start(*SIZE, border=border)
    while session.step(1.0):
        pass
    pixels = session.pixels()
    session.free()
    part = whole[y : y + height, x : x + width]
    assert pixels.shape == part.shape
    different = np.abs(pixels - part).max(axis=-1) > 1e-4
    assert different.mean() < 0.005  # silhouettes that a rounded raster moves


def test_corner_rays(device):
    """The mean of a pixel's four corners, which are the centres of a picture larger by half a pixel on each side."""
    scene = still_life()
    pixels = render(scene, *SIZE, replace(SETTINGS, corner_rays=True), device=device).pixels
    left, right, bottom, top = scene.camera.window
    x, y = (right - left) / SIZE[0] / 2.0, (top - bottom) / SIZE[1] / 2.0
    scene.camera = replace(scene.camera, window=(left - x, right + x, bottom - y, top + y))
    corners = render(scene, SIZE[0] + 1, SIZE[1] + 1, SETTINGS, device=device).pixels
    expected = (corners[1:, 1:] + corners[1:, :-1] + corners[:-1, 1:] + corners[:-1, :-1]) / 4.0
    assert pixels.shape == expected.shape
    assert (np.abs(pixels - expected).max(axis=-1) > 1e-4).mean() < 0.01


def test_clip_distances(device):
    """Nothing nearer or farther along the view is seen, by planes and not by spheres around the eye."""
    camera = Camera.look_at((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), angle=80.0, aspect=4.0 / 3.0, clip=(1.0, 2.0))
    scene = Scene(
        camera=camera, world=World((0.0, 0.0, 1.0)), materials=[Material(diffuse=0.0, glow=g) for g in (1, 0.5, 2)]
    )
    for distance, material in ((0.99, 0), (2.01, 2), (1.99, 1)):
        scene.add_plane((0.0, distance, 0.0), (0.0, -1.0, 0.0), material)
    assert np.abs(render(scene, *SIZE, SETTINGS, device=device).pixels[..., :3] - 0.5).max() < 1e-6
    scene.planes.pop()
    assert np.abs(render(scene, *SIZE, SETTINGS, device=device).pixels[..., :3] - (0.0, 0.0, 1.0)).max() < 1e-6
