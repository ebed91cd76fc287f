"""Transforms of shapes: those that keep them, and what can be said of matrices in bulk."""

import numpy as np

from .base import any_perpendicular, dot, is_one_value


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
        x, y, z = _columns(matrices)
        scale = np.cbrt(dot(x, np.cross(y, z)))
        return cls(matrices[..., :3, :3] / scale[..., None, None], scale, matrices[..., :3, 3])

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
    x, y, z = _columns(np.asarray(matrices, np.float64))
    lengths = [dot(column, column) for column in (x, y, z)]
    squared = sum(lengths) / 3.0
    deviations = [dot(x, y), dot(y, z), dot(z, x), *(length - squared for length in lengths)]
    deviation = np.max(np.abs(deviations), axis=0)
    return (deviation <= 2.0 * _CONFORMAL * squared) & (dot(x, np.cross(y, z)) > 0.0)


class AxialStretch(Similarity):
    """A transform that stretches along one axis of a shape, and keeps cylinders, cones and discs around that axis.

    `scale` is what it does to their radii; `linear` (n, 3, 3) moves points.
    """

    def __init__(self, linear, rotation, scale, translation):
        super().__init__(rotation, scale, translation)
        self.linear = linear

    @classmethod
    def of(cls, matrices, axis):
        """From matrices (n, 4, 4) for which `keeps_round` holds with the unit vector `axis` (3,)."""
        matrices = np.asarray(matrices, np.float64)
        frame = _frame(axis)
        linear = matrices[:, :3, :3]
        axes = linear @ frame
        lengths = np.linalg.norm(axes, axis=1, keepdims=True)
        return cls(linear, (axes / lengths) @ frame.T, lengths[:, 0, :2].mean(axis=1), matrices[:, :3, 3])

    def repeated(self, count):
        arrays = (self.linear, self.rotation, self.scale, self.translation)
        return AxialStretch(*(np.repeat(a, count, axis=0) for a in arrays))

    def points(self, points):
        return np.einsum("nij,nj->ni", self.linear, points) + self.translation


def keeps_round(matrices, axis):
    """Which of matrices (n, 4, 4) leave a body of revolution around the unit vector `axis` (3,) one: (n,) bool. They
    may stretch along the axis, but neither mirror nor shear."""
    x, y, z = _columns(np.asarray(matrices, np.float64)[:, :3, :3] @ _frame(axis))
    xx, yy, zz = (dot(column, column) for column in (x, y, z))
    squared = (xx + yy) / 2.0
    across = np.max(np.abs([dot(x, y), xx - squared, yy - squared]), axis=0)
    along = np.max(np.abs([dot(y, z), dot(z, x)]), axis=0)
    upright = (across <= 2.0 * _CONFORMAL * squared) & (along <= 2.0 * _CONFORMAL * np.sqrt(squared * zz))
    return upright & (dot(x, np.cross(y, z)) > 0.0)


def _columns(matrices):
    """The three axes (..., 3) of matrices (..., 3 or 4, 3 or 4)."""
    return (matrices[..., :3, column] for column in range(3))


def _frame(axis):
    """A rotation matrix (3, 3) whose last column is a unit vector (3,)."""
    axis = np.asarray(axis, np.float64)
    side = any_perpendicular(axis)
    return np.stack([side, np.cross(axis, side), axis], axis=-1)


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
