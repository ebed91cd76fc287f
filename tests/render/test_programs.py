"""Materials of different structure side by side in one shader look as each does alone."""

import numpy as np
import pytest

from addon.engine import Camera, Image, Material, Scene, Settings, World, render
from addon.engine.expression import Parameter, call, calls, clamped, combine, component, mix, settled
from addon.engine.material import surface_image

POSITION = call("point_position")
#: Roughness, lacunarity, offset, gain, distortion; the type, whether it is normalized, channels.
NOISE = (Parameter(0.6), Parameter(2.1), Parameter(0.0), Parameter(1.0), Parameter(0.3), 1, True, 3)


def noise(place, scale, detail=2.0):
    """A colour."""
    return calls("noise_texture_3d", place, Parameter(scale), Parameter(detail), *NOISE)[1]


def voronoi(place, scale):
    numbers = map(Parameter, (1.0, 0.5, 2.0, 1.0, 0.5, 1.0))
    return calls("voronoi_texture_3d", place, Parameter(scale), *numbers, 0, 0, False)[1]


def painted(factor, share, first, second):
    """What several materials make of settled values that come from elsewhere."""
    return mix(Parameter(first), Parameter(second), clamped(settled(factor))) * clamped(settled(share), 0.2, 1.0)


def glows():
    """What the balls give off; those of one kind do not stand side by side."""
    early = component(POSITION, 0) * Parameter(0.3) + Parameter(0.5)  # kept until the last block
    folded = noise(noise(POSITION, 1.5) * Parameter(2.0), 3.0)
    place = POSITION * Parameter(0.9)
    moved = noise(place, 1.0) * Parameter(3.0)  # kept from where `place` is needed for the last time
    red, blue, image = (1.0, 0.2, 0.1), (0.0, 0.4, 1.0), component(surface_image(0), 1)
    return {
        "painted by noise": painted(component(noise(POSITION, 2.5), 0), early, red, blue),
        "constant": (0.3, 0.5, 0.7),
        "noise": noise(POSITION, 3.0),
        "painted by place": painted(component(POSITION, 2), component(POSITION, 0), (0.9, 0.8, 0.1), blue),
        "noise of noise": folded * early,
        "two noises": place * Parameter(0.2) + noise(POSITION, 3.0, 0.0) * noise(place, 5.0),
        "painted by image": painted(image, component(noise(POSITION, 4.0), 1), (0.1, 0.9, 0.3), red),
        "voronoi of noise": voronoi(noise(POSITION, 1.0), 6.0) + early * noise(POSITION * early, 2.0),
        "moved noise": moved * noise(moved + place, 2.0),
        "image": surface_image(0),
    }


SIDE = 32
NAMES = list(glows())


def scene_of(names):
    """A ball for each name in a row, each on its own square of the picture, those not in `names` left out."""
    camera = Camera.look_at((2.0 * len(NAMES) - 2.0, -50.0, 0.0), (2.0 * len(NAMES) - 2.0, 0.0, 0.0))
    camera = Camera(camera.matrix, window=(-2.0 * len(NAMES), 2.0 * len(NAMES), -2.0, 2.0), orthographic=True)
    texels = np.random.default_rng(3).random((8, 8, 3))
    scene = Scene(camera, world=World((0.0, 0.0, 0.0)), images=[Image(texels)])
    for place, name in enumerate(NAMES):
        if name in names:
            material = scene.add_material(Material(diffuse=0.0, glow=glows()[name]))
            scene.add_spheres((4.0 * place, 0.0, 0.0), 1.9, material)
    return scene


def drawn(device, names):
    """(place, row, column, channel) of the squares."""
    pixels = render(scene_of(names), SIDE * len(NAMES), SIDE, Settings(), device=device).pixels[..., :3]
    return pixels.reshape(SIDE, len(NAMES), SIDE, 3).swapaxes(0, 1)


@pytest.fixture(scope="module")
def together(device):
    return drawn(device, NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_a_material_looks_the_same_among_others(device, together, name):
    place = NAMES.index(name)
    alone = drawn(device, [name])[place]
    assert alone.max() > 0.1 and (name == "constant" or alone[SIDE // 4 : -SIDE // 4].std() > 0.01)
    np.testing.assert_allclose(together[place], alone, atol=2e-4)


def test_no_two_look_the_same(together):
    for place, square in enumerate(together):
        assert all(abs(square - other).max() > 0.1 for other in together[:place])


def test_values_that_later_blocks_need(device):
    """A picture of slopes at places that another one moved, against numpy; `place` is needed for the last time where
    `moved` is for the first."""
    slopes = (np.arange(64) + 0.5) / 64.0
    image = Image(np.stack([*np.meshgrid(slopes, slopes), np.full((64, 64), 0.3)], axis=-1))

    def picture(at):
        return call("image_sample", Parameter(0, "int"), at)

    place = combine(component(POSITION, 0), component(POSITION, 2), Parameter(0.1)) * Parameter(0.4)
    moved = combine(*(component(picture(place), axis) for axis in range(3))) * Parameter(0.5)
    glow = moved * picture(moved + place)
    matrix = Camera.look_at((1.0, -5.0, 1.0), (1.0, 0.0, 1.0)).matrix
    camera = Camera(matrix, window=(-0.4, 0.4, -0.4, 0.4), orthographic=True)
    scene = Scene(camera, world=World((0.0, 0.0, 0.0)), images=[image])
    scene.add_discs((1.0, 0.0, 1.0), (0.0, -1.0, 0.0), 1.0, scene.add_material(Material(diffuse=0.0, glow=glow)))
    drawn = render(scene, 8, 8, device=device).pixels[..., :3]
    x, z = np.meshgrid(*[0.6 + 0.8 * (np.arange(8) + 0.5) / 8.0] * 2)
    first = 0.5 * np.stack([0.4 * x, 0.4 * z, np.full_like(x, 0.3)], axis=-1)
    second = np.stack([first[..., 0] + 0.4 * x, first[..., 1] + 0.4 * z, np.full_like(x, 0.3)], axis=-1)
    np.testing.assert_allclose(drawn, first * second, atol=1e-5)
