# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lights as the engine's."""

from dataclasses import replace

import numpy as np

from ..engine.expression import constant_of
from ..engine.primitives import invertible
from ..engine.scene import Light, Visibility
from .changes import ids_in
from .closures import read_closure
from .compat import flattened, light_factor
from .keys import original_key
from .nodes import output_source
from .tree_reader import TreeReader
from .visibility import seen_by


class Lights:
    """Collects the lights of a scene, instanced ones too. `memory`: of what their nodes are."""

    def __init__(self, scene, memory):
        self._scene, self._memory, self._reports = scene, memory, memory.reports

    def add(self, obj, matrix, links):
        """Add the light of a Blender object that stands in the world by `matrix` (4, 4); `links`: the `LightLinks`."""
        light = obj.data
        strength, falls_off = self._memory.get(("light", original_key(light)), lambda _: self._emission(light))
        color = np.multiply(light_factor(light, matrix), strength)
        if not np.isfinite([*matrix.ravel(), light.energy, *color]).all():
            self._reports.warn(f"light {obj.name!r} has a strength or a place that is not finite and gives no light")
            return
        watts = light.energy * color  # of a sun for each square metre
        if (watts <= 0.0).all() and (watts < 0.0).any():
            self._reports.warn(f"light {obj.name!r} has a negative strength and gives no light")
            return
        made = _MAKERS[light.type](light, np.asarray(matrix, np.float64), color)
        if made is None:
            self._reports.warn(f"light {obj.name!r} is scaled to zero or has no size and gives no light")
            return
        made = made if falls_off else made.without_falloff()
        seen, receivers, blockers = Visibility(seen_by(obj)), links.receivers(obj), links.blockers(obj)
        self._scene.add_light(replace(made, visibility=seen, receivers=receivers, blockers=blockers))

    def _emission(self, light):
        """What the light's nodes multiply its energy by, color times strength of an Emission, and whether the light
        falls off with the distance."""
        self._memory.depend(original_key(light), *ids_in(light.node_tree))
        tree, _kept = flattened(light)
        surface = output_source(tree, "Surface") if tree is not None else None
        if surface is None or surface.node is None:
            return ((1.0, 1.0, 1.0) if tree is None else (0.0, 0.0, 0.0)), True
        reader = TreeReader(f"light {light.name!r}", light, "LIGHT", None, self._reports)
        strength, falls_off = (1.0, 1.0, 1.0), True
        if surface.type == "EMISSION" and _is_falloff(surface.input("Strength"), light):
            strength, falls_off = _with_falloff(surface, reader)
        elif surface.type in ("EMISSION", "ADD_SHADER", "MIX_SHADER"):
            strength = _constant_color(read_closure(surface, reader).glow, reader)
        else:
            reader.not_understood(surface, "the light's own color")
        reader.finish()
        return strength, falls_off


def _constant_color(value, reader):
    """The colour (3,) of an Expression; of one that varies over the light white, reported."""
    color = constant_of(value)
    if color is None:
        reader.warn("its light varies over it or with the direction; it is rendered white")
        color = (1.0,)
    return np.broadcast_to(color, 3)


def _is_falloff(source, light):
    """Whether a strength is that of a Light Falloff node, constant or quadratic, of a light that stands somewhere."""
    return (
        source.type == "LIGHT_FALLOFF" and source.output.identifier in ("Constant", "Quadratic") and light.type != "SUN"
    )


def _with_falloff(emission, reader):
    """(strength (3,), whether it falls off) of an Emission whose strength is that of a Light Falloff node."""
    falloff = emission.input("Strength")
    if any(x > 0.0 for x in constant_of(reader.number(falloff.input("Smooth"))) or ()):
        reader.warn(f"node {falloff.name!r}: its smoothing is not rendered")
    strength = reader.color(emission.input("Color")) * reader.number(falloff.input("Strength"))
    return _constant_color(strength, reader), falloff.output.identifier == "Quadratic"


# The light of a Blender light that stands in the world by `matrix` (4, 4), None where it has no direction or no size.


def _point(light, matrix, color):
    return Light.point(_position(matrix), light.energy, color, **_ball(light))


def _spot(light, matrix, color):
    """Its cone is round before the object is scaled, about -Z."""
    if not invertible(matrix[None])[0]:
        return None
    axes = np.diag([1.0, 1.0, -1.0]) @ np.linalg.inv(matrix[:3, :3] / np.abs(matrix[:3, :3]).max())
    angle = min(light.spot_size, np.pi)  # both are pi in single precision, which is more than pi
    return Light.spot(_position(matrix), None, light.energy, angle, light.spot_blend, color, axes=axes, **_ball(light))


def _area(light, matrix, color):
    width, height = light.size, light.size_y if light.shape in ("RECTANGLE", "ELLIPSE") else light.size
    x, y, z = matrix[:3, 0] * width, matrix[:3, 1] * height, matrix[:3, 2]
    if not (np.linalg.norm(np.cross(x, y)) > 0.0 and np.linalg.norm(z) > 0.0):
        return None
    shape = "ELLIPSE" if light.shape in ("DISK", "ELLIPSE") else "RECTANGLE"
    spread = min(light.spread, np.pi)
    return Light.area(
        _position(matrix), x, y, light.energy, color, shape=shape, spread=spread, direction=-z, shadow=light.use_shadow
    )


def _sun(light, matrix, color):
    if not np.linalg.norm(matrix[:3, 2]) > 0.0:
        return None
    angle = min(light.angle, np.pi)
    return Light.sun(matrix[:3, 2], light.energy, color, angle=angle, shadow=light.use_shadow)


_MAKERS = {"POINT": _point, "SPOT": _spot, "AREA": _area, "SUN": _sun}


def _position(matrix):
    return tuple(float(x) for x in matrix[:3, 3])


def _ball(light):
    """What point lights and spots share. Their radius is not scaled with the object."""
    return {"radius": light.shadow_soft_size, "soft": light.use_soft_falloff, "shadow": light.use_shadow}
