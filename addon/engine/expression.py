"""Values that vary over a surface: expressions that `node_programs` turns into GLSL.

An expression is a graph of calls over constants. There are two kinds of constants. A *literal* belongs to the
structure: it is written into the shader's text, and what it makes superfluous (x * 0, x + 0, x * 1) is left out. A
*parameter* is the user's: it lies in a texture, so that changing it compiles nothing, and nothing is decided by its
value. What is made of parameters alone is computed at once, in numpy, and is a parameter again.
"""

from dataclasses import dataclass

import numpy as np

from .glsl_functions import function
from .operators import OPERATORS

_SIZES = {"float": 1, "vec2": 2, "vec3": 3, "vec4": 4}
_TYPES = {size: name for name, size in _SIZES.items()}
_LARGEST = float(np.finfo(np.float32).max)


class Expression:
    """Base of all. `type`: of GLSL, float, vec2, vec3 or vec4 (int for what only functions take)."""

    type: str

    def __add__(self, other):
        a, b = self, expression(other)
        if _is_literal(b, 0.0):
            return _widened(a, b)
        return _widened(b, a) if _is_literal(a, 0.0) else _operate("add", a, b)

    def __sub__(self, other):
        b = expression(other)
        return _widened(self, b) if _is_literal(b, 0.0) else _operate("subtract", self, b)

    def __mul__(self, other):
        a, b = self, expression(other)
        for x, y in ((a, b), (b, a)):
            if _is_literal(x, 1.0):
                return _widened(y, x)
            if _is_literal(x, 0.0):
                return _widened(x, y)
        return _operate("multiply", a, b)

    def __truediv__(self, other):
        """The quotient, 0 where the divisor is."""
        b = expression(other)
        return _widened(self, b) if _is_literal(b, 1.0) else _operate("divide", self, b)

    def __neg__(self):
        return literal(0.0) - self

    def __radd__(self, other):
        return expression(other) + self

    def __rsub__(self, other):
        return expression(other) - self

    def __rmul__(self, other):
        return expression(other) * self

    def __rtruediv__(self, other):
        return expression(other) / self


@dataclass(frozen=True, eq=False)
class Literal(Expression):
    """A constant of the structure: `value` a tuple of floats, or of one int for the type int."""

    value: tuple
    type: str


@dataclass(frozen=True, eq=False)
class Parameter(Expression):
    """A constant of the user: a number, or a sequence of two to four. `type` "int" for what functions take as such, the
    number of an image say."""

    value: tuple
    type: str = ""

    def __post_init__(self):
        value = np.atleast_1d(np.asarray(self.value, np.float64)).tolist()
        value = tuple(x if abs(x) <= _LARGEST else 0.0 for x in value)  # neither NaN nor beyond float32
        object.__setattr__(self, "value", value)
        object.__setattr__(self, "type", self.type or _TYPES[len(value)])


@dataclass(frozen=True, eq=False)
class Table(Expression):
    """Texels (n, 4) of parameters; a function takes the number of the first one, for `fetch_tables`."""

    values: np.ndarray
    type: str = "int"


@dataclass(frozen=True, eq=False)
class AttributeNumber(Expression):
    """The number of the attribute `key`, for `attribute_value`."""

    key: str
    type: str = "int"


@dataclass(frozen=True, eq=False)
class Call(Expression):
    """Result number `output` of a function: of `glsl_functions` or of `OPERATORS`, by `name`. `beside`: 0, or the
    axis, 1 or 2, along which its `Point` is moved (see `beside`)."""

    name: str
    inputs: tuple
    type: str
    output: int = 0
    beside: int = 0


def literal(value):
    """A constant of the structure: a number or a sequence of two to four."""
    values = tuple(float(x) for x in np.atleast_1d(np.asarray(value, np.float64)))
    return Literal(values, _TYPES[len(values)])


def expression(value):
    """An Expression as it is; numbers and sequences of them as literals."""
    return value if isinstance(value, Expression) else literal(value)


def is_constant(value):
    return isinstance(value, (Literal, Parameter))


def constant_of(value):
    """The number (1,) or colour (3,) of a member of a material or world that is the same everywhere, be it plain or an
    Expression; None of one that varies."""
    if is_constant(value):
        return value.value
    return None if isinstance(value, Expression) else tuple(np.atleast_1d(value).tolist())


def is_zero(value):
    """Whether something is zero by its structure: a plain number or colour, or a literal."""
    if isinstance(value, Literal):
        return not any(value.value)
    return not isinstance(value, Expression) and not np.any(value)


def _is_literal(value, number):
    return isinstance(value, Literal) and value.type != "int" and all(x == number for x in value.value)


def _size(value):
    return _SIZES[value.type]


def _widened(value, like):
    """A value as wide as itself or `like`, whichever is wider."""
    return as_type(value, like.type) if _size(like) > _size(value) else value


def as_type(value, kind):
    """A value as another type: numbers are repeated, vectors lose components at the end or gain 0, and 1 as the
    fourth; of one number it is the mean."""
    value = expression(value)
    if value.type == kind:
        return value
    if is_constant(value):
        return type(value)(_resized(value.value, _SIZES[kind]), kind)
    if kind == "float":
        return _operate("mean", as_type(value, "vec3"))
    return _operate(f"{value.type}_{kind}", value)


def _resized(values, size):
    """The components of a constant as so many: numbers are repeated, vectors lose some or gain 0, and 1 as the fourth;
    of one number it is the mean."""
    if len(values) == 1:
        return values * size
    if size == 1:
        return (sum(values[:3]) / len(values[:3]),)
    return (*values, *(0.0, 0.0, 0.0, 1.0)[len(values) :])[:size]


def _operate(name, *inputs):
    operator = OPERATORS[name]
    kind = operator.type or max((x.type for x in inputs[operator.narrow :]), key=_SIZES.get)
    if not operator.type:
        wide = tuple(x if x.type == "float" else as_type(x, kind) for x in inputs[operator.narrow :])
        inputs = (*(as_type(x, "float") for x in inputs[: operator.narrow]), *wide)
    folded = _folded(operator.twin, inputs, kind)
    if folded is None and not operator.type and not operator.takes_numbers:
        narrow, wide = inputs[: operator.narrow], inputs[operator.narrow :]
        inputs = (*narrow, *(_repeated(x, kind) for x in wide))
    return folded or Call(name, inputs, kind)


def _repeated(value, kind):
    """A number as a vector, a parameter as the same parameter."""
    return (
        as_type(value, kind)
        if value.type == kind or isinstance(value, Literal)
        else Call(f"float_{kind}", (value,), kind)
    )


def _folded(twin, inputs, kind):
    """What a numpy function makes of inputs that are all constants; else None."""
    if twin is None or not all(map(is_constant, inputs)):
        return None
    with np.errstate(all="ignore"):
        values = np.atleast_1d(twin(*(np.array(x.value) for x in inputs))).tolist()
    made = Parameter(tuple(values * _SIZES[kind] if len(values) == 1 else values), kind)
    return made if any(isinstance(x, Parameter) for x in inputs) else Literal(made.value, kind)


def minimum(a, b):
    return _operate("minimum", expression(a), expression(b))


def maximum(a, b):
    return _operate("maximum", expression(a), expression(b))


def clamped(x, low=0.0, high=1.0):
    return minimum(maximum(x, low), high)


def mix(a, b, t):
    """a where the number t is 0, b where it is 1."""
    t = expression(t)
    if _is_literal(t, 0.0):
        return expression(a)
    return expression(b) if _is_literal(t, 1.0) else _operate("mix", t, expression(a), expression(b))


def select(condition, a, b):
    """a where the number `condition` is more than 0.5, else b."""
    condition, a, b = expression(condition), expression(a), expression(b)
    if isinstance(condition, Literal):
        return _widened(a, b) if condition.value[0] > 0.5 else _widened(b, a)
    return a if a is b else _operate("select", condition, a, b)


def less(a, b):
    """1 where the number a is less than b, else 0."""
    return _operate("less", as_type(a, "float"), as_type(b, "float"))


def sqrt(x):
    """The root, 0 of what is negative."""
    return _operate("sqrt", expression(x))


def exp(x):
    return _operate("exp", expression(x))


def absolute(x):
    return _operate("absolute", expression(x))


def mean(x):
    """The mean of a colour's components; a number as it is."""
    x = expression(x)
    return x if x.type == "float" else _operate("mean", as_type(x, "vec3"))


def luminance(x):
    x = expression(x)
    return x if x.type == "float" else _operate("luminance", as_type(x, "vec3"))


def largest(x):
    """The largest component of a colour."""
    x = expression(x)
    return x if x.type == "float" else _operate("largest", as_type(x, "vec3"))


def component(x, i):
    x = expression(x)
    return x if x.type == "float" else _operate("xyzw"[i], x)


def combine(x, y, z):
    """A vector of three numbers."""
    return _operate("combine", *(as_type(a, "float") for a in (x, y, z)))


def settled(x):
    """A value as it is. What is made of settled values alone is compiled once for all programs that make the same of
    theirs (see `program_writer`): mark what node trees hand to the part that many have in common."""
    return _operate("settled", x) if isinstance(x, Call) else x


def call(name, *inputs, fold=None):
    """What the GLSL function `name` of the shader folder returns; `fold`: its numpy twin, used on constants."""
    return _call(name, inputs, fold, 0)


def calls(name, *inputs):
    """All results of a GLSL function: what it returns, then its `out` parameters."""
    return tuple(_call(name, inputs, None, output) for output in range(len(function(name).results)))


def _call(name, inputs, fold, output):
    known = function(name)
    if len(inputs) != len(known.inputs):
        raise TypeError(f"{name} takes {len(known.inputs)} inputs, not {len(inputs)}")
    inputs = tuple(_argument(x, kind) for x, kind in zip(inputs, known.inputs, strict=True))
    kind = known.results[output]
    return _folded(fold, inputs, kind) or Call(name, inputs, kind, output)


def _argument(value, kind):
    """An input of a function's parameter of a GLSL type."""
    if kind in ("int", "bool"):
        if not isinstance(value, Expression):
            return Literal((int(value),), "int")
        if value.type == "int":
            return value
        if isinstance(value, Parameter):
            return Parameter(value.value[:1], "int")
        raise TypeError(f"a {value.type} cannot be an int")
    value = expression(value)
    return _repeated(value, kind) if value.type == "float" else as_type(value, kind)


def beside(value, axis):
    """A value as it is a little beside the point, along its first (1) or second (2) direction: for slopes."""
    memo = {}
    for node in in_order((value,)):
        if isinstance(node, Call):
            inputs = tuple(memo[id(x)] for x in node.inputs)
            memo[id(node)] = Call(node.name, inputs, node.type, node.output, node.beside or axis)
        else:
            memo[id(node)] = node
    return memo[id(value)]


def in_order(roots, until=""):
    """All expressions below and with `roots`, inputs before what uses them, each once; not what lies below calls of the
    name `until`."""
    seen, found, waiting = set(), [], [(root, False) for root in reversed(roots)]
    while waiting:
        node, ready = waiting.pop()
        if ready:
            found.append(node)
        elif id(node) not in seen:
            seen.add(id(node))
            waiting.append((node, True))
            inputs = getattr(node, "inputs", ()) if not until or getattr(node, "name", "") != until else ()
            waiting += [(x, False) for x in reversed(inputs) if id(x) not in seen]
    return found


def attribute_keys(values):
    """The keys of the attributes that expressions need."""
    return {node.key for node in in_order(values) if isinstance(node, AttributeNumber)}


def vanishes(value):
    """Whether an expression is zero everywhere, as far as its constants tell; for what costs time, not for
    structure."""
    memo = {}
    for node in in_order((value,)):
        of_inputs = [memo[id(x)] for x in getattr(node, "inputs", ())]
        if is_constant(node):
            memo[id(node)] = not any(node.value)
        elif not isinstance(node, Call):
            memo[id(node)] = False
        elif node.name in ("multiply", "minimum"):
            memo[id(node)] = any(of_inputs)
        elif node.name in ("select", "mix"):
            memo[id(node)] = all(of_inputs[1:])
        elif node.name in _KEEP_ZERO or (node.name.startswith(("float_", "vec")) and node.name in OPERATORS):
            memo[id(node)] = all(of_inputs)
        else:
            memo[id(node)] = False
    return memo[id(value)]


_KEEP_ZERO = (
    *("add", "subtract", "divide", "maximum", "sqrt", "absolute", "mean", "luminance", "largest", "settled"),
    *"xyz",
)
