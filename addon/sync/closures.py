# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of shader nodes that scatter or give off light, each as `Lobes`."""

from dataclasses import dataclass, field

from ..engine.expression import clamped, expression, is_constant, less, maximum, minimum, select, settled, sqrt
from .lobes import (
    Lobes,
    clear_body,
    conductor_reflectance,
    ior_of_reflectance,
    metal,
    mirror,
    normal_reflectance,
    varnished,
)
from .shader_nodes.registry import Node, readers_into
from .tree_reader import listed

#: Functions by the type of the node: `read(n)` with a `ClosureNode` gives `Lobes`.
CLOSURES = {}
closure = readers_into(CLOSURES)
#: Inputs that change nothing here; linked, or set to something, they are reported once for each material.
_IGNORED = (
    "Coat Normal",
    "Subsurface Weight",
    "Anisotropic",
    "Anisotropy",
    "Sheen Weight",
    "Thin Film Thickness",
    "Thin Wall",
)
_GREY = (0.8, 0.8, 0.8)
_SMALLEST_IOR = 1e-3


@dataclass(frozen=True)
class ClosureNode(Node):
    """A shader node of a tree that is being read; `closures` has read the others."""

    closures: object

    def closure(self, name):
        """The `Lobes` of the shader that feeds an input."""
        return self.closures.read(self.input(name))

    def number(self, *names):
        return settled(super().number(*names))

    def color(self, *names):
        return settled(super().color(*names))

    def normal(self):
        """The shading normal that is linked; 0 for none."""
        return self.vector("Normal") if self.linked("Normal") else (0.0, 0.0, 0.0)


def read_closure(source, reader):
    """The `Lobes` of the shader that feeds a socket; nothing linked is black."""
    lobes = _Closures(reader).read(source)
    if lobes.one_roughness:
        reader.warn("its reflections of different roughness are rendered as one of their mean roughness")
    return lobes


@dataclass
class _Closures:
    """Reads each shader of a tree once."""

    reader: object
    known: dict = field(default_factory=dict)

    def read(self, source):
        if source is None or source.node is None:
            return Lobes()
        if source.key not in self.known:
            self.known[source.key] = None
            self.known[source.key] = self._read(source)
        elif self.known[source.key] is None:
            self.reader.warn(f"node {source.name!r} feeds itself; that link is left out")
            return Lobes()
        return self.known[source.key]

    def _read(self, source):
        if source.output.type != "SHADER":
            return Lobes(glow=maximum(self.reader.color(source), 0.0))  # as Cycles has it
        node = ClosureNode(source, self.reader, self)
        _report_ignored(node)
        return CLOSURES.get(source.type, _unknown)(node)


def _report_ignored(n):
    used = [name for name in _IGNORED if n.linked(name) or _is_set(n, name)]
    rough = n.linked("Roughness") or n.constant("Roughness") != 0.0
    if rough and getattr(n.node, "distribution", "GGX") in ("BECKMANN", "ASHIKHMIN_SHIRLEY"):
        n.warn("its distribution is rendered as GGX")
    if used:
        n.warn(f"{listed(used, 'is', 'are')} not rendered")


def _is_set(n, name):
    return n.has(name) and not name.endswith("Normal") and bool(n.input(name).constant)


@closure("BSDF_TOON", "BSDF_SHEEN", "BSDF_VELVET", "BSDF_HAIR", "BSDF_HAIR_PRINCIPLED", "SUBSURFACE_SCATTERING")
def _unknown(n):
    """A shader that is not rendered is diffuse, of its colour where it has one."""
    name = next((name for name in ("Color", "Base Color") if n.has(name)), None)
    n.instead("a diffuse surface" + (" of its color" if name else ""))
    return Lobes(diffuse=n.color(name) if name else _GREY, normal=n.normal())


@closure("BSDF_RAY_PORTAL")
def _ray_portal(n):
    n.instead("a transparent surface")
    return Lobes(clear=n.color("Color"))


@closure("VOLUME_ABSORPTION", "VOLUME_SCATTER", "VOLUME_COEFFICIENTS", "PRINCIPLED_VOLUME")
def _volume(n):
    n.instead("black, since it is no surface,")
    return Lobes()


@closure("BSDF_PRINCIPLED")
def _principled(n):
    lobes = principled(
        n.color("Base Color"),
        metallic=n.number("Metallic"),
        roughness=n.number("Roughness"),
        transmission=n.number("Transmission Weight"),
        ior=n.number("IOR"),
        specular=n.number("Specular IOR Level"),
        tint=n.color("Specular Tint"),
        multiscatter=_multiscatters(n),
        diffuse_roughness=n.number("Diffuse Roughness") if n.has("Diffuse Roughness") else 0.0,
        normal=n.normal(),
    )
    coat = Lobes(
        coat=clamped(n.number("Coat Weight")),
        coat_roughness=n.number("Coat Roughness"),
        coat_ior=maximum(n.number("Coat IOR"), 1.0),
        coat_tint=n.color("Coat Tint"),
        normal=lobes.normal,
    )
    glow = Lobes(glow=maximum(n.color("Emission Color") * n.number("Emission Strength"), 0.0))
    return Lobes(clear=(1.0, 1.0, 1.0)).mixed(lobes.plus(coat).plus(glow), n.number("Alpha"))


def principled(
    base,
    *,
    metallic=0.0,
    roughness=0.5,
    transmission=0.0,
    ior=1.5,
    specular=0.5,
    tint=(1.0, 1.0, 1.0),
    multiscatter=0.0,
    diffuse_roughness=0.0,
    normal=(0.0, 0.0, 0.0),
):
    """Blender's Principled BSDF without its coat: metal, glass and a dielectric over a diffuse body, by weight.

    As in Cycles, glass takes the root of the base colour at each of its surfaces, and the specular level changes the
    index of refraction of the opaque body only.
    """
    m, w, base, tint = clamped(metallic), clamped(transmission), maximum(base, 0.0), clamped(tint)
    ior, roughness = maximum(ior, _SMALLEST_IOR), clamped(roughness)
    body = Lobes(diffuse=base, diffuse_roughness=clamped(diffuse_roughness))
    rough = {"roughness": roughness, "multiscatter": multiscatter}
    body = varnished(body, tint, _specular_ior(ior, specular), **rough)
    glass = clear_body(tint, sqrt(base), ior, **rough)
    conductor = metal(minimum(base, 1.0), edge=tint, **rough)
    return body.times((1.0 - m) * (1.0 - w)).plus(glass.times((1.0 - m) * w)).plus(conductor.times(m)).bumped(normal)


def _specular_ior(ior, level):
    """The index whose reflectance is twice `level` times as much."""
    raised = ior_of_reflectance(maximum(2.0 * expression(level), 0.0) * normal_reflectance(ior))
    return select(less(ior, 1.0), 1.0 / raised, raised)


def _multiscatters(n):
    """Whether a node's distribution is Multiscatter GGX; the others are all drawn as GGX."""
    return 1.0 if n.node.distribution == "MULTI_GGX" else 0.0


@closure("BSDF_DIFFUSE")
def _diffuse(n):
    return Lobes(diffuse=n.color("Color"), diffuse_roughness=n.number("Roughness"), normal=n.normal())


@closure("BSDF_TRANSLUCENT")
def _translucent(n):
    return Lobes(translucent=n.color("Color"), normal=n.normal())


@closure("BSDF_GLOSSY")
def _glossy(n):
    numbers = {"roughness": clamped(n.number("Roughness")), "multiscatter": _multiscatters(n), "normal": n.normal()}
    return mirror(clamped(n.color("Color")), **numbers)


@closure("BSDF_METALLIC")
def _metallic(n):
    numbers = {"roughness": clamped(n.number("Roughness")), "multiscatter": _multiscatters(n), "normal": n.normal()}
    if n.node.fresnel_type == "F82":
        return metal(clamped(n.color("Base Color")), edge=clamped(n.color("Edge Tint")), **numbers)
    index, extinction = n.vector("IOR"), n.vector("Extinction")
    normal, near_edge = (conductor_reflectance(cosine, index, extinction) for cosine in (1.0, 1.0 / 7.0))
    # Schlick's approximation there, of which F82's tint is the share.
    return metal(normal, edge=clamped(near_edge / (normal + (1.0 - normal) * (6.0 / 7.0) ** 5)), **numbers)


@closure("BSDF_GLASS")
def _glass(n):
    color, ior = clamped(n.color("Color")), maximum(n.number("IOR"), _SMALLEST_IOR)
    return clear_body(color, color, ior, clamped(n.number("Roughness")), _multiscatters(n)).bumped(n.normal())


@closure("BSDF_REFRACTION")
def _refraction(n):
    numbers = {"ior": maximum(n.number("IOR"), _SMALLEST_IOR), "transmit_roughness": clamped(n.number("Roughness"))}
    return Lobes(bent=clamped(n.color("Color")), normal=n.normal(), **numbers)


@closure("BSDF_TRANSPARENT")
def _transparent(n):
    return Lobes(clear=n.color("Color"))


@closure("HOLDOUT")
def _holdout(n):
    return Lobes(holdout=1.0)


@closure("EMISSION", "BACKGROUND")
def _emission(n):
    return Lobes(glow=maximum(n.color("Color") * n.number("Strength"), 0.0))


@closure("MIX_SHADER")
def _mix(n):
    return n.closure(1).mixed(n.closure(2), n.number(0))


@closure("ADD_SHADER")
def _add(n):
    return n.closure(0).plus(n.closure(1))


def read_absorption(source, reader):
    """Beer-Lambert coefficient of what is linked to the Volume socket, as Cycles has it: density * (1 - colour)."""
    if source is None or source.node is None:
        return (0.0, 0.0, 0.0)
    n = Node(source, reader)
    if source.type == "VOLUME_ABSORPTION":
        absorption = maximum(n.number("Density") * (1.0 - n.color("Color")), 0.0)
    elif source.type == "VOLUME_COEFFICIENTS":
        absorption = maximum(n.vector("Absorption Coefficients"), 0.0)
        others = [
            name
            for name in ("Scatter Coefficients", "Emission Coefficients")
            if n.linked(name) or any(n.input(name).constant)
        ]
        if others:
            n.warn(f"{listed(others, 'is', 'are')} not rendered")
    else:
        reader.left_out(source, "its volume")
        return (0.0, 0.0, 0.0)
    if not is_constant(absorption):
        n.warn("an absorption that varies is not rendered; it is left out")
        return (0.0, 0.0, 0.0)
    return absorption
