"""The rays of Conic's camera for programs that are given rays."""

import numpy as np


def camera_rays(camera, size):
    """Origin (3,) and unit directions (size^2, 3), float32, through the pixels' centers of a perspective camera."""
    left, right, bottom, top = camera.window
    share = (np.arange(size) + 0.5) / size
    x, y = np.meshgrid(left + (right - left) * share, bottom + (top - bottom) * share)
    across, up, back, eye = camera.matrix[:3].T
    direction = x[..., None] * across + y[..., None] * up - back
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    return eye.astype(np.float32), direction.reshape(-1, 3).astype(np.float32)
