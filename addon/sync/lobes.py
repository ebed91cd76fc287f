# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of a shader, added and mixed as node trees do, and how they become one material of the engine.

All are expressions: their arithmetic is done where a ray hits, at once in numpy among a user's constants, and left out
where a node lacks a part, which is then a literal zero.
"""

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from ..engine.expression import (
    Expression,
    Literal,
    call,
    clamped,
    expression,
    is_constant,
    is_zero,
    largest,
    less,
    maximum,
    mean,
    select,
    sqrt,
)
from ..engine.scene import Material

_BLACK, _WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
#: Lobes whose roughness differs by more than this look different.
_SAME_ROUGHNESS = 0.1


@dataclass(frozen=True)
class Lobes:
    """What a shader does with light. First the shares, of which those of two shaders add up:

    `diffuse` and, from the other side, `translucent`; `metal` is mirrored at normal incidence and grows to `grazing`;
    `varnish` and `glass` are mirrored times Fresnel's F, by the surface of a body that is not clear and of one that is;
    `bent` goes through bent by the index `ior`, `clear` straight; `coat` is mirrored times F by a second surface that
    lies on top; `glow` is given off, `holdout` cut out of the picture; `body` is the weight of `glass` with its `bent`.

    Then what is one number for all: that of two shaders is their mean, by the shares that it belongs to. `edge` is the
    F82 tint of the metal, `multiscatter` 1 where facets give back what they lose to each other. Of what is diffuse the
    part `diffuse_covered` loses to the varnish what that mirrors, of what is bent the part `bent_covered` to the
    glass.
    """

    diffuse: Expression = _BLACK
    translucent: Expression = _BLACK
    metal: Expression = _BLACK
    grazing: Expression = _BLACK
    varnish: Expression = _BLACK
    glass: Expression = _BLACK
    bent: Expression = _BLACK
    clear: Expression = _BLACK
    coat: Expression = _BLACK
    glow: Expression = _BLACK
    holdout: Expression = 0.0
    body: Expression = 0.0

    diffuse_roughness: Expression = 0.0
    diffuse_covered: Expression = 0.0
    roughness: Expression = 0.0
    edge: Expression = _WHITE
    multiscatter: Expression = 0.0
    varnish_ior: Expression = 1.5
    ior: Expression = 1.5
    bent_covered: Expression = 0.0
    transmit_roughness: Expression = 0.0
    coat_roughness: Expression = 0.0
    coat_ior: Expression = 1.5
    coat_tint: Expression = _WHITE
    normal: Expression = _BLACK  # 0: the surface's own
    one_roughness: bool = False  # whether mirrors that look different were made one

    def __post_init__(self):
        for name in (*_SHARES, *_MEANS):
            object.__setattr__(self, name, expression(getattr(self, name)))

    def plus(self, other):
        """The sum."""
        summed = {name: getattr(self, name) + getattr(other, name) for name in _SHARES}
        if not _same(self.normal, other.normal):
            self, other = self._with_normal(), other._with_normal()
        for name, weigh in _MEANS.items():
            mine, its = getattr(self, name), getattr(other, name)
            summed[name] = mine if _same(mine, its) else _mean_of(mine, weigh(self), its, weigh(other))
        told = self.one_roughness or other.one_roughness or _look_different(self, other)
        return Lobes(**summed, one_roughness=told)

    def times(self, factor):
        """All shares multiplied by a number."""
        return replace(self, **{name: getattr(self, name) * factor for name in _SHARES})

    def mixed(self, other, factor):
        """(1 - factor) of this and `factor` of the other, as Mix Shader has it."""
        factor = clamped(factor)
        return self.times(1.0 - factor).plus(other.times(factor))

    def bumped(self, normal):
        """The same with a shading normal, 0 for the surface's own."""
        return replace(self, normal=normal)

    @cached_property
    def reflectance(self):
        """Share that is reflected at normal incidence, but by the coat."""
        by_fresnel = _reflected(self.varnish, self.varnish_ior) + _reflected(self.glass, self.ior)
        return mean(self.metal) + by_fresnel

    def _with_normal(self):
        return replace(self, normal=call("point_normal")) if is_zero(self.normal) else self

    def material(self, absorption=_BLACK):
        """The engine's material."""
        body = self._body()
        return Material(
            diffuse=self.diffuse,
            translucent=self.translucent,
            reflect=self.varnish + self.glass,
            metallic=self.metal,
            glow=self.glow,
            fresnel=0.0 if is_zero(self.varnish) and is_zero(self.glass) else 1.0,
            absorption=absorption,
            coat=self.coat,
            straight=self.clear,
            **body,
            **{name: getattr(self, name) for name in _AS_THEY_ARE},
        )

    def _body(self):
        """What goes through, and the indices of refraction."""
        straight, bent = not is_zero(self.clear), not is_zero(self.bent)
        ior = expression(1.0) if straight else self.varnish_ior
        if bent:
            ior = select(less(mean(self.bent), mean(self.clear)), 1.0, self.ior)
        opaque_ior = 0.0 if ior is self.varnish_ior else self.varnish_ior
        if not is_zero(self.glass):
            opaque_ior = select(less(mean(self.glass), mean(self.varnish)), opaque_ior, 0.0)
        return {
            "transmit": self.bent + self.clear,
            "transmit_covered": _mean_of(self.bent_covered, mean(self.bent), expression(0.0), mean(self.clear)),
            "ior": ior,
            "fresnel_ior": opaque_ior,
        }


_SHARES = tuple(f.name for f in fields(Lobes))[:12]
#: Members of the engine's material of the same name and meaning.
_AS_THEY_ARE = (
    "grazing",
    "edge",
    "multiscatter",
    "roughness",
    "transmit_roughness",
    "diffuse_roughness",
    "diffuse_covered",
    "coat_roughness",
    "coat_ior",
    "coat_tint",
    "normal",
    "holdout",
    "body",
)


def _diffuse(lobes):
    return mean(lobes.diffuse) + mean(lobes.translucent)


def _bent(lobes):
    return mean(lobes.bent)


def _coat(lobes):
    return mean(lobes.coat)


def _metal(lobes):
    return mean(lobes.metal)


#: The weight of one shader's number in the mean of two.
_MEANS = {
    "diffuse_roughness": _diffuse,
    "diffuse_covered": _diffuse,
    "roughness": lambda lobes: lobes.reflectance,
    "edge": _metal,
    "multiscatter": lambda lobes: lobes.reflectance + _bent(lobes),
    "varnish_ior": lambda lobes: mean(lobes.varnish),
    "ior": lambda lobes: mean(lobes.bent) + mean(lobes.glass),
    "bent_covered": _bent,
    "transmit_roughness": _bent,
    "coat_roughness": _coat,
    "coat_ior": _coat,
    "coat_tint": _coat,
    "normal": lambda lobes: _diffuse(lobes) + lobes.reflectance + _bent(lobes) + _coat(lobes),
}


def _same(a, b):
    """Whether two expressions are one by their structure."""
    return a is b or (isinstance(a, Literal) and isinstance(b, Literal) and a.value == b.value)


def _mean_of(a, weight_a, b, weight_b):
    if _same(a, b) or is_zero(weight_b):
        return a
    return b if is_zero(weight_a) else (a * weight_a + b * weight_b) / (weight_a + weight_b)


def _look_different(a, b):
    """Whether two mirrors differ in roughness for certain, and how much of each there is."""
    values = (a.roughness, b.roughness, a.reflectance, b.reflectance)
    if not all(map(is_constant, values)):
        return False
    rough, other, share, other_share = (value.value[0] for value in values)
    return abs(rough - other) > _SAME_ROUGHNESS and min(share, other_share) > 0.0


def _reflected(share, ior):
    return share if is_zero(share) else mean(share) * normal_reflectance(ior)


def normal_reflectance(ior):
    """Fresnel reflectance at normal incidence."""
    root = (expression(ior) - 1.0) / (expression(ior) + 1.0)
    return root * root


def ior_of_reflectance(f0):
    """The index of refraction above 1 whose reflectance at normal incidence is f0."""
    root = sqrt(clamped(f0, 0.0, 0.99))
    return (1.0 + root) / (1.0 - root)


def conductor_reflectance(cosine, index, extinction):
    """Unpolarised reflectance (3,) of a smooth metal of complex index `index` + i `extinction` (Born and Wolf 14.2)."""
    return call("optics_conductor", expression(cosine), maximum(index, 0.0), maximum(extinction, 0.0), fold=_conductor)


def _conductor(cosine, index, extinction):
    inside = np.sqrt((index + 1j * extinction) ** 2 - (1.0 - cosine**2) + 0j)
    squared = (index + 1j * extinction) ** 2
    across = (cosine - inside) / (cosine + inside)
    along = (squared * cosine - inside) / (squared * cosine + inside)
    return (np.abs(across) ** 2 + np.abs(along) ** 2) / 2.0


def metal(color, **numbers):
    """A conductor that reflects `color` at normal incidence, more at grazing incidence, `edge` of that near 82
    degrees."""
    return Lobes(metal=color, grazing=_WHITE, **numbers)


def mirror(color, **numbers):
    """A surface that reflects the same share at all angles."""
    return Lobes(metal=color, grazing=color, **numbers)


def varnished(lobes, tint, ior, **numbers):
    """Diffuse lobes under the surface of a dielectric, whose reflection is tinted."""
    return replace(lobes, diffuse_covered=largest(tint), varnish=tint, varnish_ior=ior, **numbers)


def clear_body(tint, color, ior, roughness, multiscatter=0.0):
    """Glass: its reflection times `tint`, what goes through times `color`."""
    rough = {"roughness": roughness, "transmit_roughness": roughness, "multiscatter": multiscatter}
    return Lobes(glass=tint, bent=color, body=1.0, bent_covered=1.0, ior=ior, **rough)
