# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's lights as the engine's, which have no extent."""

import numpy as np

from ..engine.scene import Light
from .closures import read_closure
from .compat import light_factor, node_tree
from .nodes import output_source
from .textures import NodeReader

#: Straight ahead, a small area light shines like a point light of four times its power: P / pi against P / 4 pi.
_AREA_AHEAD = 4.0
#: A light that seems smaller than this from the camera, in radians, casts shadows about as sharp as a point's.
_SHARP = 0.05
_AS_POINT = {
    "AREA": "an area light is rendered as a point at its center, bright all around",
    "SPOT": "a spot is rendered as a point light, bright all around",
}


class Lights:
    """Collects the lights of a scene, instanced ones too."""

    def __init__(self, scene, reports):
        self._scene, self._reports = scene, reports
        self._soft = {}
        self._as_point = {}

    def add(self, obj, matrix):
        """Add the light of a Blender object that stands in the world by `matrix` (4, 4)."""
        light = obj.data
        strength, falls_off = self._emission(light)
        color = np.multiply(light_factor(light), strength)
        if not np.isfinite([*matrix.ravel(), light.energy, *color]).all():
            self._reports.warn(f"light {obj.name!r} has a strength or a place that is not finite and gives no light")
            return
        position = tuple(float(x) for x in matrix[:3, 3])
        if light.type == "SUN":
            towards = matrix[:3, 2]
            if not np.linalg.norm(towards) > 0.0:
                self._reports.warn(f"light {obj.name!r} is scaled to zero and gives no light")
                return
            self._scene.add_light(Light.sun(towards, light.energy, color, shadow=light.use_shadow))
            self._note_soft(obj, light.angle)
            return
        watts = light.energy * (_AREA_AHEAD if light.type == "AREA" else 1.0)
        made = Light.point(position, watts, color, shadow=light.use_shadow)
        # One that does not fall off is as bright everywhere as the other at distance 1.
        self._scene.add_light(made if falls_off else Light.constant(position, made.color, shadow=made.shadow))
        if light.type in _AS_POINT:
            self._as_point.setdefault(light.type, {})[obj.name] = None
        if light.type != "AREA":
            self._note_soft(obj, self._seen_angle(position, 2.0 * light.shadow_soft_size))

    def finish(self):
        """Report the lights that are not rendered as they are: a message for each thing that is not."""
        for kind, names in self._as_point.items():
            self._reports.warn(f"light {_first_of(names)}: {_AS_POINT[kind]}")
        if self._soft:
            self._reports.info(f"light {_first_of(self._soft)}: the size of a light is not rendered, shadows are sharp")

    def _emission(self, light):
        """What the light's nodes multiply its energy by, color times strength of an Emission, and whether the light
        falls off with the distance."""
        tree = node_tree(light)
        surface = output_source(tree, "Surface") if tree is not None else None
        if surface is None or surface.node is None:
            return ((1.0, 1.0, 1.0) if tree is None else (0.0, 0.0, 0.0)), True
        reader = NodeReader(f"light {light.name!r}", None, self._reports)
        strength, falls_off = (1.0, 1.0, 1.0), True
        if surface.type == "EMISSION" and _is_falloff(surface.input("Strength"), light):
            strength, falls_off = _with_falloff(surface, reader)
        elif surface.type in ("EMISSION", "ADD_SHADER", "MIX_SHADER"):
            strength = read_closure(surface, reader).glow.average
        else:
            reader.not_understood(surface, "the light's own color")
        reader.finish()
        return strength, falls_off

    def _seen_angle(self, position, size):
        """The angle under which the camera sees something of `size`."""
        distance = np.linalg.norm(np.subtract(position, self._scene.camera.matrix[:3, 3]))
        return 2.0 * float(np.arctan2(size / 2.0, distance))

    def _note_soft(self, obj, angle):
        if angle > _SHARP and obj.data.use_shadow and obj.data.energy > 0.0:
            self._soft[obj.name] = None


def _is_falloff(source, light):
    """Whether a strength is that of a Light Falloff node, constant or quadratic, of a light that stands somewhere."""
    return (
        source.type == "LIGHT_FALLOFF" and source.output.identifier in ("Constant", "Quadratic") and light.type != "SUN"
    )


def _with_falloff(emission, reader):
    """(strength (3,), whether it falls off) of an Emission whose strength is that of a Light Falloff node."""
    falloff = emission.input("Strength")
    if reader.number(falloff.input("Smooth")) > 0.0:
        reader.warn(f"node {falloff.node.name!r}: its smoothing is not rendered")
    strength = reader.color(emission.input("Color")).times(reader.number(falloff.input("Strength")))
    return strength.average, falloff.output.identifier == "Quadratic"


def _first_of(names):
    others = len(names) - 1
    return repr(next(iter(names))) + (f" and {others} more" if others else "")
