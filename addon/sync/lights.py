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


class Lights:
    """Collects the lights of a scene, instanced ones too."""

    def __init__(self, scene, reports):
        self._scene, self._reports = scene, reports
        self._soft = []

    def add(self, obj, matrix):
        """Add the light of a Blender object that stands in the world by `matrix` (4, 4)."""
        light = obj.data
        color = np.multiply(light_factor(light), self._strength(light))
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
            self._note_soft(obj.name, light.angle)
            return
        self._report_kind(light, obj.name)
        watts = light.energy * (_AREA_AHEAD if light.type == "AREA" else 1.0)
        self._scene.add_light(Light.point(position, watts, color, shadow=light.use_shadow))
        if light.type != "AREA":
            self._note_soft(obj.name, light.shadow_soft_size)

    def finish(self):
        """Report, in one message, the lights whose soft shadows are not drawn."""
        if self._soft:
            others = len(self._soft) - 1
            whose = f" and {others} more: their" if others else ": its"
            self._reports.info(f"light {self._soft[0]!r}{whose} size is not rendered, shadows are sharp")

    def _strength(self, light):
        """What the light's nodes multiply its energy by: colour times strength of an Emission."""
        tree = node_tree(light)
        surface = output_source(tree, "Surface") if tree is not None else None
        if surface is None or surface.node is None:
            return (1.0, 1.0, 1.0) if tree is None else (0.0, 0.0, 0.0)
        reader = NodeReader(f"light {light.name!r}", None, self._reports)
        if surface.type not in ("EMISSION", "ADD_SHADER", "MIX_SHADER"):
            reader.not_understood(surface, "the light's own color")
            return (1.0, 1.0, 1.0)
        return read_closure(surface, reader).glow.average

    def _report_kind(self, light, name):
        if light.type == "AREA":
            self._reports.warn(f"light {name!r}: an area light is rendered as a point at its center, bright all around")
        elif light.type == "SPOT":
            self._reports.warn(f"light {name!r}: a spot is rendered as a point light, bright all around")

    def _note_soft(self, name, size):
        if size > 0.0 and name not in self._soft:
            self._soft.append(name)
