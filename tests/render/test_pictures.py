"""Golden pictures: what the reference rasteriser drew, kept so that nothing changes unnoticed.

`--regenerate` writes them anew; look at them before they are taken. Other drivers round differently: they draw the same
scenes in the other tests, and only Mesa's llvmpipe is compared here.
"""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Picture

from addon.engine import Camera, Image, Light, Material, Scene, Settings, World, render

from .compare import encoded, save_difference, silhouette_distance
from .scenes import still_life

GOLDEN = Path(__file__).parent / "golden"
SIZE = (96, 72)
REFERENCE = "llvmpipe"


def everything():
    """All kinds, media and lights, one ray a pixel."""
    return still_life(), Settings(max_depth=8, shadows="TINTED")


def antialiased():
    """The same with 16 samples from above, in parallel, over nothing: alpha at the edges."""
    scene = still_life()
    scene.planes.clear()
    scene.camera = Camera.orthographic_at((1.0, -3.0, 5.0), (0.0, -0.2, 0.4), 4.0, aspect=SIZE[0] / SIZE[1])
    return scene, Settings(samples=16, film_transparent=True, shadows="TINTED")


def opaque_shadows():
    """The paper's shadows."""
    return still_life(eye=(-3.5, -4.0, 2.0)), Settings(max_depth=5)


def sky():
    """An image of a sky in mirrors and glass."""
    v, u = (np.mgrid[:16, :32] + 0.5) / [[[16]], [[32]]]
    day = np.stack([0.2 + 0.6 * v, 0.4 + 0.3 * np.cos(2 * np.pi * u), 0.9 - 0.5 * v], axis=-1)
    day[v < 0.5] *= 0.5  # the ground
    scene = Scene(camera=Camera.look_at((0.0, -4.5, 1.0), (0.0, 0.0, 0.0), angle=38.0, aspect=SIZE[0] / SIZE[1]))
    scene.materials = [Material.mirror(), Material.glass(), Material.plastic((0.6, 0.1, 0.1))]
    gold = scene.add_material(Material.mirror((0.8, 0.7, 0.4)))
    scene.world = World((1.0, 1.0, 1.0), scene.add_image(Image(day)))
    scene.add_spheres([(-0.9, 0.4, 0.0), (0.5, -0.9, -0.3)], [0.9, 0.45], [0, 1])
    scene.add_cylinders((1.2, 0.2, -0.8), (1.0, 0.3, 0.8), 0.4, 2)
    scene.add_cones((0.1, 0.9, 0.3), (0.1, 0.9, 1.3), 0.5, material=gold)
    scene.add_light(Light.sun((1.0, -1.0, 1.5), 2.0))
    return scene, Settings(samples=4)


PICTURES = (everything, antialiased, opaque_shadows, sky)


def test_reference_rasteriser(device):
    """The goldens are compared on this driver: a machine that silently draws on another would compare nothing."""
    assert REFERENCE in device.name and "Mesa" in device.name, (
        f"the pictures were drawn by {device.name!r}; golden pictures hold for Mesa's {REFERENCE} only, "
        "run with LIBGL_ALWAYS_SOFTWARE=1 and Mesa's EGL"
    )


@pytest.mark.parametrize("build", PICTURES, ids=lambda build: build.__name__)
def test_golden(device, regenerate, build):
    """Alpha within a pixel, then the colours where both are opaque: equal but for rounding and some pixels at edges."""
    if REFERENCE not in device.name:
        pytest.skip(f"golden pictures hold for {REFERENCE}; this is {device.name}")
    scene, settings = build()
    pixels = render(scene, *SIZE, settings, device=device).pixels
    alpha = (np.clip(pixels[::-1, :, 3:], 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
    drawn = np.concatenate([encoded(pixels), alpha], axis=-1)
    path = GOLDEN / f"{build.__name__}.png"
    if regenerate:
        GOLDEN.mkdir(exist_ok=True)
        Picture.fromarray(drawn).save(path, optimize=True)
        return
    assert path.is_file(), f"no golden picture {path.name}; make it with --regenerate and look at it"
    expected = np.asarray(Picture.open(path))
    body, expected_body = drawn[..., 3] > 127, expected[..., 3] > 127
    difference = np.abs(drawn[..., :3].astype(int) - expected[..., :3]).max(axis=-1)[body & expected_body]
    typical, changed = np.quantile(difference, 0.95), np.mean(difference > 4)
    if silhouette_distance(body, expected_body) > 1 or typical > 1 or changed > 0.01:
        ours, theirs = ((rgba[::-1, :, :3] / 255.0) ** 2.2 for rgba in (drawn, expected))
        picture = save_difference(f"golden_{build.__name__}", ours, theirs)
        pytest.fail(
            f"{build.__name__}: {changed:.1%} of it changed: drawn, golden, 16 times the difference in {picture}"
        )
