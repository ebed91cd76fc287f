# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of a shader, added and mixed as node trees do, and how they become one material of the engine.

The engine's material has one set of shares: either the mirror and refracted rays follow Fresnel, or their shares are
constants. A shader of several parts is drawn by whichever kind sends more light straight on or back at normal
incidence; parts of the other kind join with the share that they have at normal incidence.
"""

from dataclasses import dataclass, field, fields, replace

import numpy as np

from ..engine.scene import Material
from .values import Value

#: A lobe up to this roughness is drawn as a perfect mirror; from the second on, not as a mirror at all.
SHARP, BLUNT = 0.1, 0.5


@dataclass(frozen=True)
class Lobes:
    """What a shader does with light; each share a `Value`.

    `mirror` and `clear` are constant shares that are reflected and go through, `coat` and `glass` the ones of a smooth
    dielectric of index `ior`, times Fresnel F and 1 - F. `clear_ior` bends what goes through as `clear`: 1 for
    Transparent.
    """

    diffuse: Value = field(default_factory=Value)
    glow: Value = field(default_factory=Value)
    mirror: Value = field(default_factory=Value)
    clear: Value = field(default_factory=Value)
    coat: Value = field(default_factory=Value)
    glass: Value = field(default_factory=Value)
    highlight: Value = field(default_factory=Value)
    shine: float = 1.0
    ior: float = 1.5
    clear_ior: float = 1.0

    def plus(self, other):
        """The sum; indices and exponent are those of the stronger part."""
        shares = {
            f.name: getattr(self, f.name).plus(getattr(other, f.name)) for f in fields(self) if f.name not in _NUMBERS
        }
        return Lobes(
            **shares,
            shine=_of_stronger(self, other, "shine", "highlight"),
            ior=_of_stronger(self, other, "ior", "coat", "glass"),
            clear_ior=_of_stronger(self, other, "clear_ior", "clear"),
        )

    def times(self, factor):
        """All shares multiplied by a number."""
        shares = {f.name: getattr(self, f.name).times(factor) for f in fields(self) if f.name not in _NUMBERS}
        return replace(self, **shares)

    def mixed(self, other, factor):
        """(1 - factor) of this and `factor` of the other, as Mix Shader has it."""
        return self.times(1.0 - factor).plus(other.times(factor))

    def mixed_by_fresnel(self, other, ior):
        """What Mix Shader does with a Fresnel node of index `ior` in its factor: this one under the other as a coat."""
        under = replace(self, glass=self.glass.plus(self.clear), clear=Value(), coat=Value(), ior=ior)
        over = replace(
            other.times(normal_reflectance(ior)), mirror=Value(), coat=other.mirror.plus(other.coat), ior=ior
        )
        return under.plus(over)

    @property
    def blurred(self):
        """Whether some share holds less of what varies in it than the node tree has."""
        return any(getattr(self, f.name).blurred for f in fields(self) if f.name not in _NUMBERS)

    def material(self, absorption=(0.0, 0.0, 0.0)):
        """The engine's material that comes nearest."""
        f0 = normal_reflectance(self.ior)
        by_fresnel = f0 * self.coat.weight + (1.0 - f0) * self.glass.weight
        fresnel = by_fresnel > 0.0 and by_fresnel >= self.mirror.weight + self.clear.weight
        if fresnel:
            diffuse, reflect, transmit = self.diffuse, self.coat.plus(self.mirror), self.glass.plus(self.clear)
            ior = self.ior
        else:
            diffuse = self.diffuse.times(max(0.0, 1.0 - f0 * self.coat.weight))
            reflect = self.mirror.plus(self.coat.times(f0))
            transmit = self.clear.plus(self.glass.times(1.0 - f0))
            ior = self.clear_ior if self.clear.weight >= self.glass.weight else self.ior
        return Material(
            **_colors(diffuse=diffuse, glow=self.glow, reflect=_at_most_one(reflect), transmit=_at_most_one(transmit)),
            highlight=_rgb(self.highlight.average),
            shine=self.shine,
            ior=ior,
            fresnel=fresnel,
            absorption=_rgb(absorption),
        )


_NUMBERS = ("shine", "ior", "clear_ior")


def _of_stronger(a, b, name, *shares):
    """The number `name` of the one of two Lobes whose `shares` weigh more."""
    weights = [sum(getattr(lobes, share).weight for share in shares) for lobes in (a, b)]
    return getattr(a if weights[0] >= weights[1] else b, name)


def _colors(**values):
    """Arguments of Material: each colour, the number of its image and its attribute."""
    colors = {name: _rgb(value.rgb) for name, value in values.items()}
    colors |= {f"{name}_image": value.image for name, value in values.items()}
    return colors | {f"{name}_attribute": value.attribute for name, value in values.items()}


def _rgb(color):
    """A colour (3,) that the engine takes: finite, not negative."""
    return tuple(float(c) for c in np.maximum(np.nan_to_num(color), 0.0))


def _at_most_one(value):
    """A share that gives back no more light than comes in."""
    return replace(value, rgb=tuple(np.minimum(value.rgb, 1.0)))


def normal_reflectance(ior):
    """Fresnel reflectance at normal incidence."""
    return ((ior - 1.0) / (ior + 1.0)) ** 2


def ior_of_reflectance(f0):
    """The index of refraction above 1 whose reflectance at normal incidence is f0."""
    root = float(np.sqrt(np.clip(f0, 0.0, 0.99)))
    return (1.0 + root) / (1.0 - root)


def sharpness(roughness):
    """Share of a lobe that is drawn as a mirror: 1 up to SHARP, 0 from BLUNT on, smooth between them."""
    x = float(np.clip((BLUNT - roughness) / (BLUNT - SHARP), 0.0, 1.0))
    return x * x * (3.0 - 2.0 * x)


def phong_of(roughness):
    """(weight, exponent) of the lights' highlight that looks like a microfacet lobe of this roughness.

    Blinn's exponent is n = 2 / alpha^2 - 2 with alpha = roughness^2 (Walter et al. 2007). The angle to the mirror
    direction is twice the one to the half vector, which makes Phong's exponent n / 4. The peak of pi D / 4, where
    D = (n + 2) / 2 pi, is (n + 2) / 8 in units of a white diffuse surface.
    """
    alpha = max(float(roughness), 0.05) ** 2
    blinn = max(2.0 / alpha**2 - 2.0, 0.0)
    return (blinn + 2.0) / 8.0, max(blinn / 4.0, 1.0)


def metal(color, roughness):
    """A conductor that reflects `color` (a Value). What is too rough for a mirror is highlight and, the rougher the
    more, diffuse, so that a rough metal among point lights is not black."""
    sharp = sharpness(roughness)
    peak, exponent = phong_of(roughness)
    blunt = 1.0 - sharp
    return Lobes(
        mirror=color.times(sharp),
        diffuse=color.times(blunt * min(roughness, 1.0)),
        highlight=color.times(blunt * (1.0 - min(roughness, 1.0)) * peak),
        shine=exponent,
    )


def dielectric_coat(tint, roughness, ior):
    """The reflection of a dielectric surface: a mirror where it is smooth, the lights' highlight where it is rough."""
    sharp = sharpness(roughness)
    peak, exponent = phong_of(roughness)
    highlight = tint.times((1.0 - sharp) * normal_reflectance(ior) * peak)
    return Lobes(coat=tint.times(sharp), highlight=highlight, shine=exponent, ior=ior)
