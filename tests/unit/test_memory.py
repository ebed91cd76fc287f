"""What many spheres cost: bytes of GPU memory, and of the host's at the peak, for each of them."""

import tracemalloc

import numpy as np
import pytest

from addon.engine.packing import pack
from addon.engine.scene import Camera, Light, Material, Scene

COUNT = 200_000


def scene_of_spheres(away=0.0):
    rng = np.random.default_rng(0)
    scene = Scene(camera=Camera.look_at((2.2 + away, -3.1, 1.7), (away, 0, 0)), materials=[Material()])
    center = rng.random((COUNT, 3), np.float32) * 2.0 - np.float32([1.0 - away, 1.0, 1.0])
    scene.add_spheres(center, rng.uniform(0.2, 0.7, COUNT).astype(np.float32) * np.float32(COUNT ** (-1 / 3)))
    scene.add_light(Light.sun((0, 0, 1), 1.0))
    return scene


@pytest.mark.parametrize("away", [0.0, 1000.0])
def test_a_sphere_and_its_share_of_the_tree_take_48_bytes(away):
    """Also where everything is moved towards the camera."""
    scene = scene_of_spheres(away)
    packed = pack(scene, 16384)
    assert packed.origin.any() == (away > 0.0)
    assert sum(texels.nbytes for texels in packed.textures.values()) / COUNT <= 48.0


@pytest.mark.parametrize("away", [0.0, 1000.0])
def test_building_takes_a_few_times_what_it_makes(away):
    """10 million spheres on a small machine: no copies of the columns in a wider type, none that stay."""
    scene = scene_of_spheres(away)
    tracemalloc.start()
    packed = pack(scene, 16384)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert packed.textures["spheres"].dtype == np.float32
    assert peak / COUNT <= 240.0  # of it the textures 48, the boxes 24 as given and 24 along the curve
