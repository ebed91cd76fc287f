"""Transforms of shapes: those that keep them, and what can be said of matrices in bulk."""

import numpy as np

from .base import is_one_value


class Similarity:
    """A transform that keeps shapes: uniform scale, rotation and translation; one for all primitives, or one a row.

    `rotation` (3, 3) or (n, 3, 3), `scale` a number or (n,), `translation` (3,) or (n, 3).
    """

    def __init__(self, rotation, scale, translation):
        self.rotation, self.scale, self.translation = rotation, scale, translation

    @classmethod
    def of(cls, matrices):
        """From matrices (4, 4) or (n, 4, 4) for which `keeps_shapes` holds."""
        matrices = np.asarray(matrices, np.float64)
        linear = matrices[..., :3, :3]
        scale = np.cbrt(np.linalg.det(linear))
        return cls(linear / scale[..., None, None], scale, matrices[..., :3, 3])

    def repeated(self, count):
        """Each of n transforms `count` times in a row."""
        return Similarity(*(np.repeat(a, count, axis=0) for a in (self.rotation, self.scale, self.translation)))

    def points(self, points):
        return self.directions(points) * np.asarray(self.scale)[..., None] + self.translation

    def directions(self, directions):
        if np.ndim(self.rotation) == 2 and is_one_value(directions):
            return np.broadcast_to(directions[:1] @ np.transpose(self.rotation), directions.shape)
        return np.einsum("...ij,...j->...i", self.rotation, directions)


#: Largest relative deviation from conformal that still counts as such: about the rounding of a float32 matrix.
_CONFORMAL = 2e-6


def keeps_shapes(matrices):
    """Which of matrices (n, 4, 4) are similarities: (n,) bool. Those that shear, stretch or mirror (which would turn
    the uv around) are not: what they move has to be instanced."""
    linear = np.asarray(matrices, np.float64)[:, :3, :3]
    gram = np.swapaxes(linear, 1, 2) @ linear
    squared = np.trace(gram, axis1=1, axis2=2) / 3.0
    deviation = np.abs(gram - squared[:, None, None] * np.eye(3)).max(axis=(1, 2))
    return (deviation <= 2.0 * _CONFORMAL * squared) & (np.linalg.det(linear) > 0.0)


#: Volume of the box of a matrix's unit axes below which float32 cannot invert it.
_SINGULAR = 1e-6


def invertible(matrices):
    """Which of affine matrices (n, 4, 4) are finite and can be inverted in float32: (n,) bool.

    Each axis counts by its direction, so that no scale is too small, but axes in one plane are found.
    """
    x, y, z = (np.asarray(matrices)[:, :3, column].astype(np.float64) for column in range(3))
    with np.errstate(all="ignore"):
        # Each to length 1 before they are multiplied, which would leave the range of float64.
        x, y, z = (axis / np.linalg.norm(axis, axis=1, keepdims=True) for axis in (x, y, z))
        volume = np.abs(np.einsum("ni,ni->n", x, np.cross(y, z)))
    return (volume >= _SINGULAR) & np.isfinite(matrices).all(axis=(1, 2))  # NaN, of an axis without length, is not


#: Thickness given to what is flattened, relative to its largest scale: thin to the eye, well within float32.
_THICKNESS = 1e-4


def thickened(matrices):
    """Affine matrices (n, 4, 4) float64 in which those flattened along exactly one direction have got a thickness:
    a flattened sphere is then an ellipsoid as thin as a sheet. All others are as they were."""
    matrices = np.array(matrices, np.float64)
    rows = np.flatnonzero(~invertible(matrices) & np.isfinite(matrices).all(axis=(1, 2)))
    u, scale, v = np.linalg.svd(matrices[rows, :3, :3])
    flat = scale[:, 1] > _SINGULAR * scale[:, 0]
    rows, u, scale, v = rows[flat], u[flat], scale[flat], v[flat]
    across = np.einsum("ni,nj->nij", u[:, :, 2], v[:, 2])  # from the direction that is lost to the one it would go to
    side = np.sign(np.linalg.det(u) * np.linalg.det(v))  # not mirrored
    growth = side * _THICKNESS * scale[:, 0] - scale[:, 2]
    matrices[rows, :3, :3] += growth[:, None, None] * across
    return matrices
