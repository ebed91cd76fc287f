"""What the kinds of primitives have in common: checked columns of numpy arrays.

A kind is one class whose attributes are columns, one row a primitive. It knows its bounding boxes, how its rows
become GPU records, how it moves with a similarity transform, and a float64 reference of its intersection that exists
to test the GLSL.
"""

from dataclasses import dataclass

import numpy as np

from ..errors import SceneError


@dataclass(frozen=True)
class Column:
    """One column: width (0: a scalar per row), default (None: must be given), whether it must be a unit vector."""

    name: str
    width: int = 0
    default: object = None
    unit: bool = False
    integer: bool = False


class Primitives:
    """Columns of primitives of one kind; every argument is an array of one row a primitive, or one value for all rows.

    Raises SceneError when a value is not finite, an array has the wrong shape or a shape is degenerate.
    """

    kind = ""
    columns: tuple[Column, ...] = ()
    record = None
    surface_record = None

    def __init__(self, **values):
        unknown = set(values) - {column.name for column in self.columns}
        if unknown:
            raise TypeError(f"{self.kind}: unknown argument {sorted(unknown)[0]!r}")
        arrays = {column.name: self._checked(column, values.get(column.name)) for column in self.columns}
        counts = {len(a) for column in self.columns if (a := arrays[column.name]).ndim > (column.width > 0)}
        if len(counts - {1}) > 1:
            sizes = {name: len(a) for name, a in arrays.items() if a.ndim}
            raise SceneError(f"{self.kind}: the arrays have different numbers of rows: {sizes}")
        count = max(counts, default=1) if 0 not in counts else 0
        for column in self.columns:
            shape = (count, column.width) if column.width else (count,)
            setattr(self, column.name, np.broadcast_to(arrays[column.name], shape))
        self._check()

    def _checked(self, column, value):
        if value is None:
            value = column.default
        if value is None:
            raise TypeError(f"{self.kind}: argument {column.name!r} is missing")
        array = np.asarray(value)
        if column.integer:
            array = array.astype(np.int32, copy=False)
        elif array.dtype not in (np.float32, np.float64):
            array = array.astype(np.float64)
        if column.width and (array.ndim == 0 or array.shape[-1] != column.width or array.ndim > 2):
            raise SceneError(f"{self.kind}: {column.name} has shape {array.shape}, expected (n, {column.width})")
        if not column.width and array.ndim > 1:
            raise SceneError(f"{self.kind}: {column.name} has shape {array.shape}, expected (n,)")
        if not column.integer and not np.isfinite(array).all():
            bad = ~np.isfinite(array if not column.width else array.sum(axis=-1))
            raise SceneError(f"{self.kind}: {column.name} of number {int(np.argmax(bad))} is not finite")
        if column.unit:
            array = self._normalized(column, array)
        return array

    def _normalized(self, column, array):
        length = np.linalg.norm(array, axis=-1, keepdims=True)
        if (length == 0).any():
            raise SceneError(f"{self.kind}: {column.name} of number {int(np.argmin(length))} has no length")
        return array / length

    def _check(self):
        """Raise SceneError for rows that are no proper shape; kinds override it."""

    def _refuse(self, bad, what):
        """Raise SceneError naming the first row where `bad` (n,) bool holds."""
        if bad.any():
            raise SceneError(f"{self.kind} number {int(np.argmax(bad))}: {what} ({int(bad.sum())} in all)")

    def __len__(self):
        return len(getattr(self, self.columns[0].name))

    def take(self, order):
        """The rows `order` (k,) int, in that order."""
        return self._with({column.name: getattr(self, column.name)[order] for column in self.columns})

    def _with(self, arrays):
        """A new object of this class from arrays that are known to be right (no check)."""
        new = object.__new__(type(self))
        for column in self.columns:
            setattr(new, column.name, arrays.get(column.name, getattr(self, column.name)))
        return new

    @classmethod
    def concatenate(cls, parts):
        """All rows of several objects of this kind, in order."""
        if len(parts) == 1:
            return parts[0]
        new = object.__new__(cls)
        for column in cls.columns:
            setattr(new, column.name, np.concatenate([getattr(part, column.name) for part in parts]))
        return new

    def bounds(self):
        """Axis-aligned boxes: lower (n, 3) and upper (n, 3), float64."""
        raise NotImplementedError

    def transformed(self, similarity):
        """The same shapes moved by `similarity` (a `Similarity`)."""
        raise NotImplementedError

    def records(self):
        """The two GPU records of each row: structured arrays (n,) of `record` and of `surface_record`."""
        raise NotImplementedError

    def reference_hit(self, origin, direction, t_min=0.0):
        """Nearest intersection in float64, row by row: origin (n, 3), direction (n, 3) unit.

        Returns t (n,), inf where row i of the rays misses row i of the primitives.
        """
        raise NotImplementedError

    def reference_surface(self, point):
        """Outward unit normal (n, 3) and uv (n, 2) at points (n, 3) on the surface, in float64."""
        raise NotImplementedError


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
    matrices = np.asarray(matrices, np.float64)
    finite = np.isfinite(matrices).all(axis=(1, 2))
    linear = np.where(finite[:, None, None], matrices[:, :3, :3], 0.0)
    lengths = np.linalg.norm(linear, axis=1)
    return np.abs(np.linalg.det(linear / np.where(lengths > 0.0, lengths, 1.0)[:, None, :])) >= _SINGULAR


def any_perpendicular(axis):
    """A unit vector (n, 3) perpendicular to each unit vector of `axis` (n, 3), continuous almost everywhere.

    Duff et al. 2017, Building an Orthonormal Basis, Revisited: the first of the two vectors.
    """
    x, y, z = np.moveaxis(axis, -1, 0)
    sign = np.where(z < 0.0, -1.0, 1.0)
    a = -1.0 / (sign + z)
    return np.stack([1.0 + sign * x * x * a, sign * x * y * a, -sign * x], axis=-1)


def perpendicular_part(vector, axis):
    """The unit vectors (n, 3) of `vector` made perpendicular to the unit vectors `axis`; any one where they are
    parallel."""
    part = vector - np.sum(vector * axis, axis=-1, keepdims=True) * axis
    length = np.linalg.norm(part, axis=-1, keepdims=True)
    usable = length > 1e-6 * np.maximum(np.linalg.norm(vector, axis=-1, keepdims=True), 1e-300)
    return np.where(usable, part / np.where(usable, length, 1.0), any_perpendicular(axis))


def angle_u(x, y):
    """The paper's u = phi / 2 pi in [0, 1) of the direction (x, y), equations (32), (39) and (45)."""
    u = np.arctan2(y, x) / (2.0 * np.pi)
    return u - np.floor(u)


def dot(a, b):
    """Row-wise scalar product."""
    return np.einsum("...i,...i->...", a, b)


def nearest_root(t0, t1, valid0, valid1, t_min):
    """The smallest valid root above t_min, inf where there is none."""
    first = np.where(valid0 & (t0 > t_min), t0, np.inf)
    second = np.where(valid1 & (t1 > t_min), t1, np.inf)
    return np.minimum(first, second)
