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

#: Beside a smooth lobe one up to this roughness is drawn as smooth too; from the second on, not as a mirror at all.
SHARP, BLUNT = 0.1, 0.5
#: Lobes whose roughness differs by more than this look different.
_SAME_ROUGHNESS = 0.1
#: A reflection of less than this part of another is too weak to be told about.
_UNSEEN = 0.1


@dataclass(frozen=True)
class Lobes:
    """What a shader does with light; each share a `Value`.

    `mirror` and `clear` are constant shares that are reflected and go through, `coat` and `glass` the ones of a smooth
    dielectric of index `ior`, times Fresnel F and 1 - F. `metal` is reflected at normal incidence and grows to
    `grazing`, `edge` its F82 tint. `clear_ior` bends what goes through as `clear`: 1 for Transparent. `roughness` is
    that of all that is reflected, `transmit_roughness` of what goes through; `one_roughness` says that they replace
    others. `multiscatter`: what facets lose to each other is given back.
    """

    diffuse: Value = field(default_factory=Value)
    glow: Value = field(default_factory=Value)
    mirror: Value = field(default_factory=Value)
    metal: Value = field(default_factory=Value)
    grazing: Value = field(default_factory=Value)
    clear: Value = field(default_factory=Value)
    coat: Value = field(default_factory=Value)
    glass: Value = field(default_factory=Value)
    highlight: Value = field(default_factory=Value)
    shine: float = 1.0
    ior: float = 1.5
    clear_ior: float = 1.0
    edge: tuple = (1.0, 1.0, 1.0)
    roughness: float = 0.0
    transmit_roughness: float = 0.0
    multiscatter: bool = False
    one_roughness: bool = False

    def plus(self, other):
        """The sum; indices, exponent and roughness are those of the stronger part."""
        strong, weak = (self, other) if self.reflectance >= other.reflectance else (other, self)
        if weak.reflectance > 0.0 and strong.roughness <= SHARP < weak.roughness:
            told = strong.one_roughness or weak.one_roughness or weak.reflectance > _UNSEEN * strong.reflectance
            return replace(strong._sum(weak.as_highlight()), one_roughness=told)
        return strong._sum(weak)

    def _sum(self, other):
        """The sum with another that reflects less, or as smoothly."""
        shares = {
            f.name: getattr(self, f.name).plus(getattr(other, f.name)) for f in fields(self) if f.name not in _NUMBERS
        }
        return Lobes(
            **shares,
            edge=_of_stronger(self, other, "edge", "metal"),
            roughness=self.roughness if self.reflectance > 0.0 else other.roughness,
            multiscatter=self.multiscatter if self.reflectance > 0.0 else other.multiscatter,
            transmit_roughness=_of_stronger(self, other, "transmit_roughness", "clear", "glass"),
            one_roughness=self.one_roughness or other.one_roughness or _differ_in_roughness(self, other),
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
        coat = other.mirror.plus(other.metal).plus(other.coat)
        none = {"mirror": Value(), "metal": Value(), "grazing": Value()}
        over = replace(other.times(normal_reflectance(ior)), **none, coat=coat, ior=ior)
        return under.plus(over)

    @property
    def reflectance(self):
        """Share that is reflected at normal incidence."""
        return self.mirror.weight + self.metal.weight + normal_reflectance(self.ior) * self.coat.weight

    def as_highlight(self):
        """The same beside a smooth mirror: what is too rough for one is highlight of the lights and, in metals, the
        rougher the more, diffuse."""
        sharp, f0 = sharpness(self.roughness), normal_reflectance(self.ior)
        peak, exponent = phong_of(self.roughness)
        constant = self.mirror.plus(self.metal)
        metal, coat = constant.times(1.0 - sharp), self.coat.times((1.0 - sharp) * f0)
        taken = f0 * self.coat.weight  # by the blurred and by the sharp part
        left = max(0.0, (1.0 - (1.0 - sharp) * taken) * (1.0 - sharp * taken))
        return replace(
            self,
            mirror=constant.plus(self.coat.times(f0)).times(sharp),
            metal=Value(),
            grazing=Value(),
            coat=Value(),
            diffuse=self.diffuse.times(left).plus(metal.times(self.roughness)),
            highlight=self.highlight.plus(metal.times((1.0 - self.roughness) * peak)).plus(coat.times(peak)),
            shine=exponent,
            roughness=0.0,
        )

    @property
    def blurred(self):
        """Whether some share holds less of what varies in it than the node tree has."""
        return any(getattr(self, f.name).blurred for f in fields(self) if f.name not in _NUMBERS)

    def material(self, absorption=(0.0, 0.0, 0.0)):
        """The engine's material that comes nearest."""
        f0 = normal_reflectance(self.ior)
        by_fresnel = f0 * self.coat.weight + (1.0 - f0) * self.glass.weight
        constant = self.mirror.plus(self.metal)
        fresnel = by_fresnel > 0.0 and by_fresnel >= constant.weight + self.clear.weight
        grazing = (0.0, 0.0, 0.0)
        if fresnel:
            diffuse, reflect, transmit = self.diffuse, self.coat.plus(constant), self.glass.plus(self.clear)
            ior = self.ior
        else:
            diffuse = self.diffuse.times(max(0.0, 1.0 - f0 * self.coat.weight))
            reflect = constant.plus(self.coat.times(f0))
            transmit = self.clear.plus(self.glass.times(1.0 - f0))
            ior = self.clear_ior if self.clear.weight >= self.glass.weight else self.ior
            # Schlick's curve is too wide for indices near 1; of reflectances below 0.02 it is taken as less.
            rising = self.grazing.plus(self.coat.times(min(50.0 * f0, 1.0)))
            if rising.weight > 0.0:
                grazing = np.minimum(_rgb(rising.average + self.mirror.average), 1.0)
        return Material(
            **_colors(diffuse=diffuse, glow=self.glow, reflect=_at_most_one(reflect), transmit=_at_most_one(transmit)),
            highlight=_rgb(self.highlight.average),
            shine=self.shine,
            ior=ior,
            fresnel=fresnel,
            absorption=_rgb(absorption),
            roughness=self.roughness if reflect.weight > 0.0 else 0.0,
            transmit_roughness=self.transmit_roughness if transmit.weight > 0.0 else 0.0,
            grazing=tuple(grazing),
            edge=self.edge,
            multiscatter=self.multiscatter and not fresnel,
        )


_NUMBERS = ("shine", "ior", "clear_ior", "edge", "roughness", "transmit_roughness", "multiscatter", "one_roughness")


def _differ_in_roughness(a, b):
    """Whether two parts are rough in different ways, of which one roughness stays."""
    reflect = min(a.reflectance, b.reflectance) > 0.0 and abs(a.roughness - b.roughness) > _SAME_ROUGHNESS
    through = [lobes.clear.weight + lobes.glass.weight for lobes in (a, b)]
    return reflect or (min(through) > 0.0 and abs(a.transmit_roughness - b.transmit_roughness) > _SAME_ROUGHNESS)


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


def conductor_reflectance(cosine, index, extinction):
    """Unpolarised reflectance (3,) of a smooth metal of complex index `index` + i `extinction`, (3,) each (Born and
    Wolf 14.2)."""
    n, k = (np.maximum(np.asarray(x, np.float64), 0.0) for x in (index, extinction))
    inside = np.sqrt((n + 1j * k) ** 2 - (1.0 - cosine**2) + 0j)
    across = (cosine - inside) / (cosine + inside)
    along = ((n + 1j * k) ** 2 * cosine - inside) / ((n + 1j * k) ** 2 * cosine + inside)
    return (np.abs(across) ** 2 + np.abs(along) ** 2) / 2.0


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


def metal(color, roughness, edge=(1.0, 1.0, 1.0), multiscatter=False):
    """A conductor that reflects `color` (a Value) at normal incidence, more at grazing incidence, `edge` of that near
    82 degrees."""
    edge = tuple(np.clip(edge, 0.0, 1.0).tolist())
    white = Value((1.0, 1.0, 1.0))
    return Lobes(metal=color, grazing=white, edge=edge, roughness=_unit(roughness), multiscatter=multiscatter)


def mirror(color, roughness, multiscatter=False):
    """A surface that reflects the same share at all angles."""
    return Lobes(mirror=color, roughness=_unit(roughness), multiscatter=multiscatter)


def dielectric_coat(tint, roughness, ior):
    """The reflection of a dielectric surface."""
    return Lobes(coat=tint, roughness=_unit(roughness), ior=ior)


def dielectric_body(tint, color, roughness, ior):
    """Glass: its reflection times `tint`, what goes through times `color`."""
    rough = _unit(roughness)
    return Lobes(coat=tint, glass=color, ior=ior, roughness=rough, transmit_roughness=rough)


def _unit(number):
    return float(np.clip(np.nan_to_num(number), 0.0, 1.0))
