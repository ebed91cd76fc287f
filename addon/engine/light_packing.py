"""Lights as records."""

import numpy as np

from . import layout
from .errors import SceneError
from .light import LightKind

_AREAS = (LightKind.RECTANGLE, LightKind.ELLIPSE)
#: 1 over the range of cosines in which the edge of a cone without blend grows bright: none.
_SHARP = 1e30


def pack_lights(lights, origin):
    """Records of `layout.LIGHT`, relative to an origin (3,), and of `layout.LIGHT_SHAPE`: of all lights where one has a
    shape, else none. Raises SceneError for lights that are not finite."""
    records = layout.LIGHT.zeros(len(lights))
    for record, light in zip(records, lights, strict=True):
        offset = 0.0 if light.kind == LightKind.SUN else origin
        record["position"] = np.subtract(light.position, offset)
        record["kind"], record["color"], record["shadow"] = light.kind, light.color, light.shadow
    shapes = layout.LIGHT_SHAPE.zeros(len(lights) if any(light.shaped for light in lights) else 0)
    for record, light in zip(shapes, lights, strict=False):
        _write_shape(record, light)
    for array in (records, shapes):
        if not np.isfinite(array.view(np.float32)).all():
            raise SceneError("a light has a position, a color or a shape that is not finite")
    return records, shapes


def _write_shape(record, light):
    record["axis_x"], record["axis_y"], record["axis_z"] = light.axes
    record["radius"], record["soft"], record["falls_off"] = light.radius, light.soft, light.falls_off
    if light.kind == LightKind.SPOT:
        edge = np.cos(light.angle / 2.0)
        record["edge"], record["slope"] = edge, 1.0 / max((1.0 - edge) * light.blend, 1.0 / _SHARP)
    if light.kind in _AREAS:
        record["spread"] = 1.0 / np.tan(light.angle / 2.0) if light.angle < np.pi else 0.0
