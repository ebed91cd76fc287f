"""Eye rays against numpy."""

import numpy as np
import pytest

from addon.engine.film import Film
from addon.engine.scene import Camera

from . import harness


class NoDevice:
    """What a film needs of a device to tell its raster."""

    def target(self, *size):
        return size


def eye_rays(device, camera, raster, pixels):
    matrix = np.asarray(camera.matrix, np.float64)
    frame = harness.frame_record(
        camera_origin=matrix[:3, 3],
        camera_right=matrix[:3, 0],
        camera_up=matrix[:3, 1],
        camera_forward=-matrix[:3, 2],
        orthographic=camera.orthographic,
        clip_start=camera.clip[0],
        clip_end=camera.clip[1],
        raster=raster,
    )
    zero = np.zeros(len(pixels))
    origin, direction = harness.run_values(
        device, "camera_frag.glsl", *pixels.T, *[zero] * 6, outputs=("out_origin", "out_direction"), frame=frame
    )
    return origin[:, :3], direction[:, :3], origin[:, 3]


CAMERAS = {
    "perspective": Camera.look_at((3.0, -5.0, 2.0), (0.1, 0.2, 0.3), angle=40.0, aspect=1.5, clip=(0.1, 100.0)),
    "off centre": Camera(np.eye(4), (-0.2, 0.7, -0.5, 0.1), clip=(0.0, 50.0)),
    "orthographic": Camera.orthographic_at((3.0, -5.0, 2.0), (0.0, 0.0, 0.0), 4.0, aspect=1.5, clip=(0.5, 20.0)),
}


@pytest.mark.parametrize("name", CAMERAS)
@pytest.mark.parametrize("border", [None, (10, 20, 40, 30)])
def test_eye_rays(device, name, border):
    """A ray meets the window where its pixel is, starts at the near plane and ends at the far one."""
    camera, size = CAMERAS[name], (120, 80)
    pixels = np.random.default_rng(0).uniform(0.0, 1.0, (2000, 2)) * (border[2:] if border else size)
    raster = Film(NoDevice(), *size, border=border).raster(0, camera.window)
    origin, direction, t_max = eye_rays(device, camera, raster, pixels)
    share = (pixels + (border[:2] if border else (0, 0))) / size  # of the whole frame, from the lower left corner
    left, right, bottom, top = camera.window
    window = np.stack([left + share[:, 0] * (right - left), bottom + share[:, 1] * (top - bottom)], axis=-1)
    world = np.asarray(camera.matrix)
    local_origin = (origin - world[:3, 3]) @ world[:3, :3]
    local_direction = direction @ world[:3, :3]
    assert np.abs(np.linalg.norm(direction, axis=-1) - 1.0).max() < 3e-7
    near, far = camera.clip
    assert np.allclose(-local_origin[:, 2], near, atol=3e-6)
    end = local_origin + t_max[:, None] * local_direction
    assert np.allclose(-end[:, 2], far, rtol=3e-6)
    if camera.orthographic:
        assert np.allclose(local_origin[:, :2], window, atol=3e-6)
        assert np.allclose(local_direction, [0.0, 0.0, -1.0], atol=1e-6)
    else:
        assert np.allclose(local_direction[:, :2] / -local_direction[:, 2:], window, atol=2e-6)
        assert np.allclose(local_origin[:, :2], window * near, atol=3e-6)


def test_sample_0_goes_through_the_centre_of_the_pixel(device):
    camera = CAMERAS["perspective"]
    raster = Film(NoDevice(), 3, 1).raster(0, camera.window)
    _, direction, _ = eye_rays(device, camera, raster, np.array([[1.5, 0.5]]))
    assert np.allclose(direction, -np.asarray(camera.matrix)[:3, 2], atol=1e-7)
