"""What tests ask of the primitives of a scene."""

import numpy as np


def shapes(scene, cls):
    """The scene's primitives of one class; none: an empty list."""
    return next((part for _, part in scene.shapes.kinds() if isinstance(part, cls)), [])


def corners(triangles):
    return np.stack([triangles.p0, triangles.p1, triangles.p2], axis=1)


def areas(triangles):
    """Vector areas (n, 3) of corners (n, 3, 3)."""
    return np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) / 2.0
