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
    """One column: width (0: a scalar per row), default (None: must be given), whether it must be a unit vector, whether
    it is of integers, whether NaN stands for none."""

    name: str
    width: int = 0
    default: object = None
    unit: bool = False
    integer: bool = False
    optional: bool = False


class Primitives:
    """Columns of primitives of one kind; every argument is an array of one row a primitive, or one value for all rows.

    What is given as one value stays one: a view that repeats it. `attributes`: by name (n, 4), (4,) or (n, k, 4)
    float32 of any meaning, k values a primitive: one for all of it or, in kinds that say so, one at each of its
    `attribute_places`. Raises SceneError when a value is not finite, an array has the wrong shape or a shape is
    degenerate.
    """

    kind = ""
    attribute_places = 1
    #: Of testing a ray against one, where visiting a node of a tree costs 1: texels are most of it, a node has four.
    intersection_cost = 0.5
    #: The same where memory counts more, since there are very many of them.
    intersection_cost_of_many = 0.5
    columns: tuple[Column, ...] = ()
    record = None
    surface_record = None

    def __init__(self, *, attributes=None, **values):
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
        self.attributes = {name: self._checked_attribute(name, v, count) for name, v in (attributes or {}).items()}
        self._check()

    def _checked_attribute(self, name, values, count):
        """Values of an attribute as (n, k, 4) float32."""
        values = np.asarray(values, np.float32)
        given = values.shape
        if values.ndim in (1, 2):
            values = values.reshape(-1, 1, given[-1])
        places = sorted({1, self.attribute_places})
        if values.ndim != 3 or len(values) not in (1, count) or values.shape[1] not in places or values.shape[2] != 4:
            expected = " or ".join(f"({count}, {k}, 4)" for k in places)
            raise SceneError(f"{self.kind}: attribute {name!r} has shape {given}, expected {expected}")
        return np.broadcast_to(values, (count, *values.shape[1:]))

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
        if not column.integer and not column.optional and not np.isfinite(array).all():
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
        """The rows `order`, (k,) int, (n,) bool or a slice (of which the columns are views), in that order."""
        rows = {column.name: _rows(getattr(self, column.name), order) for column in self.columns}
        return self._with(rows | {"attributes": {name: _rows(v, order) for name, v in self.attributes.items()}})

    def _with(self, arrays):
        """A new object of this class from arrays that are known to be right (no check)."""
        new = object.__new__(type(self))
        for name in (*(column.name for column in self.columns), "attributes"):
            setattr(new, name, arrays.get(name, getattr(self, name)))
        return new

    @classmethod
    def concatenate(cls, parts, *, attributes=True):
        """All rows of several objects of this kind, in order. An attribute that some lack is 0 there; none at all
        without `attributes`."""
        if len(parts) == 1:
            return parts[0]
        new = object.__new__(cls)
        for column in cls.columns:
            setattr(new, column.name, _joined([getattr(part, column.name) for part in parts]))
        names = dict.fromkeys(name for part in parts for name in part.attributes) if attributes else ()
        new.attributes = {name: _joined(_widened(name, parts)) for name in names}
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


def is_one_value(array):
    """Whether an array (n, ...), n > 0, repeats one row."""
    return len(array) == 1 or (array.strides[0] == 0 and len(array) > 1)


def _rows(array, order):
    """array[order] of (n, ...); what repeats one row still does."""
    if isinstance(order, slice):
        return array[order]
    if not is_one_value(array):
        return array[order] if order.dtype == bool else np.take(array, order, axis=0)  # faster where rows are short
    count = np.count_nonzero(order) if order.dtype == bool else len(order)
    return np.broadcast_to(array[:1], (count, *array.shape[1:]))


def _joined(arrays):
    """Arrays (n, ...) one after the other; one row repeated where they all repeat the same."""
    if all(map(is_one_value, arrays)):
        rows = np.stack([array[0] for array in arrays])
        if np.array_equal(rows, np.broadcast_to(rows[:1], rows.shape), equal_nan=True):
            return np.broadcast_to(rows[:1], (sum(map(len, arrays)), *rows.shape[1:]))
    return np.concatenate(arrays)


def _widened(name, parts):
    """The values (n, k, 4) of an attribute in each of several parts, k alike; 0 in those that lack it."""
    lacking = np.zeros((1, 1, 4), np.float32)
    values = [part.attributes.get(name, lacking) for part in parts]
    width = max(v.shape[1] for v in values)
    return [np.broadcast_to(v, (len(part), width, 4)) for v, part in zip(values, parts, strict=True)]


def fill(records, **values):
    """Set fields of records (n,) to what broadcasts to them; vectors an axis at a time, faster than row by row."""
    for name, value in values.items():
        field = records[name]
        if field.ndim == 1:
            field[:] = value
            continue
        value = np.broadcast_to(value, field.shape)
        for axis in range(field.shape[1]):
            field[:, axis] = value[:, axis]


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
