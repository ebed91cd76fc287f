# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers and colours that feed a shader: constants, images, attributes, and what value nodes make of them."""

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from .expressions import Constant, Made, made
from .value_nodes import ValueNodes, chosen_item, constant
from .values import Value

_IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)


@dataclass(frozen=True)
class UvSource:
    """Where images take their uv: the uv map called `map` (empty: the active one), then the affine `transform`, the
    rows of a (2, 3) matrix one after the other, as a Mapping node gives it."""

    map: str = ""
    transform: tuple = _IDENTITY

    @property
    def plain(self):
        return self.transform == _IDENTITY

    def applied(self, uv):
        """uv (n, 2) float32 through the transform."""
        if self.plain:
            return uv
        matrix = np.reshape(self.transform, (2, 3)).astype(np.float32)
        return uv @ matrix[:, :2].T + matrix[:, 2]


class NodeReader:
    """Reads the nodes of one material, world or light, called `user` in reports; notes the uv that its images take.

    `images` (an `Images`) may be None where only the uv is wanted: no image is then read. `attributes`: the
    `AttributeNodes` of a material, None where there are no attributes. `panorama`: colours are looked up by
    direction, as in a world. Once all is read, `finish` sends the rest of the reports; `made` has the expressions of
    colours by their key, `opacities` those that are taken as 1.
    """

    def __init__(self, user, images, reports, *, attributes=None, panorama=False):
        self.user, self._images, self._reports = user, images, reports
        self._panorama = panorama
        self._values = ValueNodes(attributes, self.not_understood)
        self._replaced = {}
        self.uv = None
        self.made, self.opacities = {}, []

    def warn(self, message):
        self._reports.warn(f"{self.user}: {message}")

    def not_understood(self, source, instead):
        """Report the node of `source` with what is used instead of it: all of that in one message."""
        cause = self._values.to_blame(source)
        node = repr(cause.node.name)
        if cause is not source:
            node += f" ({cause.output.name}), before {source.node.name!r},"
        replacements = self._replaced.setdefault(node, [])
        if instead not in replacements:
            replacements.append(instead)

    def finish(self):
        """Report the nodes that were not understood."""
        for node, replacements in self._replaced.items():
            self.warn(f"node {node} is not rendered; {listed(replacements, 'is', 'are')} used instead")

    def left_out(self, source, what):
        """Report the node of `source`, once, and that there is nothing instead of `what` it makes."""
        self.warn(f"node {source.node.name!r} is not rendered; {what} is left out")

    def number(self, source):
        """The number that feeds a socket; where it varies over the surface, the socket's own value, reported."""
        found = self.constant(source)
        if found is not None:
            return found
        own = _mean(source.constant)
        self.not_understood(source, f"the value {own:.3g} of {source.socket.name}")
        return own

    def constant(self, source):
        """The number that feeds a socket; None where it varies over the surface."""
        found = self._values.read(source, is_number=True)
        return found.value[0] if isinstance(found, Constant) else None

    def opacity(self, source):
        """The alpha that feeds a socket. One made from attributes is taken as 1: see `opacities`."""
        found = self._values.read(source, is_number=True)
        if found is None or isinstance(found, Constant):
            return self.number(source)
        self.opacities.append(found)
        return 1.0

    def color(self, source):
        """The `Value` that feeds a color socket."""
        found = self._values.read(source)
        if found is not None:
            return self._value(found)
        if source.type == "TEX_IMAGE" or (source.type == "TEX_ENVIRONMENT" and self._panorama):
            return self._image(source)
        if source.type == "AMBIENT_OCCLUSION":
            return self.color(source.input("Color"))
        if source.type == "MENU_SWITCH" and (chosen := chosen_item(source)) is not None:
            return self.color(chosen)
        read = self._mixed(source) if source.type in ("MIX", "MIX_RGB") else None
        if read is not None:
            return read
        own = _constant(source.constant)
        self.not_understood(source, f"the socket's own color {_shown(own.rgb)} for {source.socket.name}")
        return own

    def scaled(self, color, factor):
        """The `Value` of a color socket times the number that feeds another."""
        found = self._values.read(factor, is_number=True), self._values.read(color)
        if None in found or isinstance(found[0], Constant):
            return self.color(color).times(self.number(factor))
        return self._value(made(np.multiply, (), found))

    def _value(self, expression):
        """The `Value` of an expression."""
        if isinstance(expression, Constant):
            return Value(tuple(np.broadcast_to(expression.value, 3).tolist()))
        if isinstance(expression, Made):
            self.made[expression.key] = expression
        return Value.of_attribute(expression.key)

    def _image(self, source):
        if source.output.identifier == "Alpha":
            self.not_understood(source, "white for its alpha")
            return Value((1.0, 1.0, 1.0))
        node = source.node
        if source.type == "TEX_IMAGE":
            if node.projection != "FLAT":
                self.warn(
                    f"node {node.name!r}: {node.projection.lower()} projection is not rendered, flat is used instead"
                )
            self._use_uv(self.uv_source(source.input("Vector")))
        if self._images is None:
            return Value((1.0, 1.0, 1.0))
        alpha = node.outputs.get("Alpha")
        return self._images.value(node, self.user, keep_straight=alpha is not None and alpha.is_linked)

    def _use_uv(self, uv):
        if self.uv is None:
            self.uv = uv
        elif self.uv != uv:
            self.warn("its images use different coordinates; those of the first are used for all")

    def uv_source(self, source):
        """The `UvSource` of an image's vector input."""
        if source.node is None or (source.type == "TEX_COORD" and source.output.identifier == "UV"):
            return UvSource()
        if source.type == "UVMAP":
            return UvSource(source.node.uv_map)
        if source.type == "ATTRIBUTE":
            return UvSource(source.node.attribute_name)
        if source.type == "MAPPING":
            return self._mapped(source)
        of_node = f"coordinates of node {source.node.name!r}"
        what = f"{source.output.name.lower()} coordinates" if source.type == "TEX_COORD" else of_node
        self.warn(f"images by {what} are not rendered; the uv map is used instead")
        return UvSource()

    def _mapped(self, source):
        """What a Mapping node with constant inputs does in the plane of the uv."""
        inner = self.uv_source(source.input("Vector"))
        matrix = mapping_matrix(source, self)
        before = np.vstack([np.reshape(inner.transform, (2, 3)), (0.0, 0.0, 1.0)])
        after = matrix[:2][:, (0, 1, 3)] @ before
        return UvSource(inner.map, tuple(float(x) for x in np.round(after, 7).ravel()))

    def _mixed(self, source):
        """A Mix node of colours that blends, adds or multiplies by a constant factor; None where it does not."""
        node = source.node
        new = source.type == "MIX"
        if new and node.data_type != "RGBA":
            return None
        enabled = [i for i, s in enumerate(node.inputs) if s.enabled]
        if len(enabled) < 3 or node.blend_type not in ("MIX", "MULTIPLY", "ADD"):
            return None
        inputs = [source.input(i) for i in enabled[:3]]
        factor = min(max(self.number(inputs[0]), 0.0), 1.0)
        a, b = (self.color(i) for i in inputs[1:])
        if node.blend_type == "ADD":
            return a.plus(b.times(factor))
        if node.blend_type == "MIX":
            return a.times(1.0 - factor).plus(b.times(factor))
        product = a.product(b)
        return None if product is None else a.times(1.0 - factor).plus(product.times(factor))


def mapping_matrix(source, reader):
    """The (4, 4) matrix of a Mapping node, its linked inputs by their own values."""
    node = source.node
    if node.vector_type == "NORMAL":
        reader.left_out(source, "its mapping")
        return np.eye(4)
    location, angles, scale = (_vector(reader, source.input(name)) for name in ("Location", "Rotation", "Scale"))
    matrix = np.eye(4)
    matrix[:3, :3] = _rotation(angles) * scale
    if node.vector_type in ("POINT", "TEXTURE"):
        matrix[:3, 3] = location
    if node.vector_type == "TEXTURE":  # the texture moves, not the point
        if abs(np.linalg.det(matrix)) < 1e-12:
            reader.warn(f"node {node.name!r} has a scale of 0; its mapping is left out")
            return np.eye(4)
        return np.linalg.inv(matrix)
    return matrix


def _vector(reader, source):
    """A constant vector (3,); the socket's own where something is linked, zeros where the input is not there."""
    if source is None:
        return np.zeros(3)
    if source.node is not None:
        reader.not_understood(source, f"the socket's own {source.socket.name}")
    return np.array(tuple(source.constant)[:3], np.float64)


def _rotation(angles):
    """Rotation matrix of Euler angles XYZ in radians, as Blender: about x first."""
    (cx, cy, cz), (sx, sy, sz) = ([f(a) for a in angles] for f in (cos, sin))
    x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return z @ y @ x


def _constant(value):
    """The `Value` of a socket's default: a colour, a vector or a number."""
    return Value(tuple(np.broadcast_to(constant(value).value, 3).tolist()))


def _mean(value):
    """The number of a socket's default."""
    if value is None:
        return 0.0
    return float(value) if isinstance(value, (int, float)) else float(np.mean(tuple(value)[:3]))


def _shown(rgb):
    return "(" + ", ".join(f"{c:.2f}" for c in rgb) + ")"


def listed(things, verb, plural_verb):
    """Things in a sentence, with its verb."""
    *most, last = things
    return f"{', '.join(most)} and {last} {plural_verb}" if most else f"{last} {verb}"
