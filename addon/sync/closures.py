# SPDX-License-Identifier: GPL-3.0-or-later
"""The shader nodes that are understood, each as `Lobes`."""

from .lobes import (
    Lobes,
    conductor_reflectance,
    dielectric_body,
    dielectric_coat,
    ior_of_reflectance,
    metal,
    mirror,
    normal_reflectance,
)
from .textures import listed
from .values import Value

GREY = Value((0.8, 0.8, 0.8))
#: Inputs that change nothing here; linked, or set to something, they are reported once for each material.
_IGNORED = (
    "Normal",
    "Coat Normal",
    "Diffuse Roughness",
    "Subsurface Weight",
    "Anisotropic",
    "Anisotropy",
    "Sheen Weight",
    "Thin Film Thickness",
    "Thin Wall",
)


def read_closure(source, reader):
    """The `Lobes` of the shader that feeds a socket; nothing linked is black."""
    if source is None or source.node is None:
        return Lobes()
    read = _NODES.get(source.type)
    if read is None:
        return _unknown(source, reader)
    _report_ignored(source, reader)
    return read(source, reader)


def _unknown(source, reader):
    """A shader that is not understood is diffuse, of its colour where it has one."""
    color = source.input("Color") or source.input("Base Color")
    reader.not_understood(source, "a diffuse surface" + (" of its color" if color else ""))
    return Lobes(diffuse=reader.color(color) if color else GREY)


def _report_ignored(source, reader):
    used = []
    for name in _IGNORED:
        socket = source.node.inputs.get(name)
        if socket is not None and socket.enabled and (socket.is_linked or _is_set(socket)):
            used.append(socket.name)
    roughness = source.node.inputs.get("Roughness")
    rough = roughness is not None and (roughness.is_linked or roughness.default_value > 0.0)
    if rough and getattr(source.node, "distribution", "GGX") in ("BECKMANN", "ASHIKHMIN_SHIRLEY"):
        reader.warn(f"node {source.node.name!r}: its distribution is rendered as GGX")
    if used:
        reader.warn(f"node {source.node.name!r}: {listed(used, 'is', 'are')} not rendered")


def _is_set(socket):
    return socket.type != "VECTOR" and bool(socket.default_value)


def _principled(source, reader):
    def number(name):
        return reader.number(source.input(name))

    alpha = reader.opacity(source.input("Alpha"))
    lobes = principled(
        reader.color(source.input("Base Color")),
        metallic=number("Metallic"),
        roughness=number("Roughness"),
        transmission=number("Transmission Weight"),
        ior=number("IOR"),
        specular=number("Specular IOR Level"),
        tint=reader.color(source.input("Specular Tint")),
        multiscatter=_multiscatters(source),
    )
    coat = number("Coat Weight")
    if coat > 0.0:
        tint = Value((coat,) * 3)
        lobes = lobes.plus(dielectric_coat(tint, number("Coat Roughness"), max(number("Coat IOR"), 1.0)))
    strength = reader.constant(source.input("Emission Strength"))
    if strength is None or strength > 0.0:
        glow = reader.scaled(source.input("Emission Color"), source.input("Emission Strength"))
        lobes = lobes.plus(Lobes(glow=glow))
    return lobes if alpha >= 1.0 else Lobes(clear=Value((1.0, 1.0, 1.0))).mixed(lobes, max(alpha, 0.0))


def principled(
    base, *, metallic=0.0, roughness=0.5, transmission=0.0, ior=1.5, specular=0.5, tint=None, multiscatter=False
):
    """Blender's Principled BSDF: metal, glass and a dielectric over a diffuse body, by weight.

    As in Cycles, glass takes the root of the base colour at each of its surfaces, and the specular level changes the
    index of refraction of the opaque body only.
    """
    m, w = (min(max(x, 0.0), 1.0) for x in (metallic, transmission))
    ior = max(ior, 1e-3)
    white = Value((1.0, 1.0, 1.0))
    coat_ior = ior_of_reflectance(2.0 * specular * normal_reflectance(ior)) if specular != 0.5 else ior
    coat = dielectric_coat(tint or white, roughness, coat_ior)
    lobes = Lobes(diffuse=base).plus(coat).times((1.0 - m) * (1.0 - w))
    if w > 0.0:
        lobes = lobes.plus(dielectric_body(white, base.sqrt(), roughness, ior).times((1.0 - m) * w))
    edge = tint.average if tint else (1.0, 1.0, 1.0)
    return lobes.plus(metal(base, roughness, edge, multiscatter).times(m)) if m > 0.0 else lobes


def _multiscatters(source):
    """Whether a node's distribution is Multiscatter GGX; the others are all drawn as GGX."""
    return source.node.distribution == "MULTI_GGX"


def _diffuse(source, reader):
    if reader.number(source.input("Roughness")) > 0.0:
        reader.warn(f"node {source.node.name!r}: the roughness of a diffuse surface is not rendered")
    return Lobes(diffuse=reader.color(source.input("Color")))


def _glossy(source, reader):
    color, roughness = reader.color(source.input("Color")), reader.number(source.input("Roughness"))
    return mirror(color, roughness, _multiscatters(source))


def _metallic(source, reader):
    roughness, multiscatter = reader.number(source.input("Roughness")), _multiscatters(source)
    if source.node.fresnel_type != "F82":
        index, extinction = (reader.color(source.input(name)).average for name in ("IOR", "Extinction"))
        normal, near_edge = (conductor_reflectance(cosine, index, extinction) for cosine in (1.0, 1.0 / 7.0))
        # Schlick's approximation there, of which F82's tint is the share.
        edge = near_edge / (normal + (1.0 - normal) * (6.0 / 7.0) ** 5)
        return metal(Value(tuple(normal)), roughness, edge, multiscatter)
    edge = reader.color(source.input("Edge Tint")).average
    return metal(reader.color(source.input("Base Color")), roughness, edge, multiscatter)


def _glass(source, reader):
    color = reader.color(source.input("Color"))
    ior = max(reader.number(source.input("IOR")), 1e-3)
    return dielectric_body(color, color, reader.number(source.input("Roughness")), ior)


def _refraction(source, reader):
    ior = max(reader.number(source.input("IOR")), 1e-3)
    rough = min(max(reader.number(source.input("Roughness")), 0.0), 1.0)
    return Lobes(clear=reader.color(source.input("Color")), clear_ior=ior, transmit_roughness=rough)


def _transparent(source, reader):
    return Lobes(clear=reader.color(source.input("Color")), clear_ior=1.0)


def _emission(source, reader):
    return Lobes(glow=reader.scaled(source.input("Color"), source.input("Strength")))


def _mix(source, reader):
    factor, a, b = source.input(0), source.input(1), source.input(2)
    first, second = read_closure(a, reader), read_closure(b, reader)
    if factor.type == "FRESNEL":
        return first.mixed_by_fresnel(second, max(reader.number(factor.input("IOR")), 1.0))
    if factor.type == "LAYER_WEIGHT" and factor.output.identifier == "Fresnel":
        # Cycles: the index of refraction of a blend is 1 / (1 - blend).
        blend = min(max(reader.number(factor.input("Blend")), 0.0), 0.99)
        return first.mixed_by_fresnel(second, 1.0 / (1.0 - blend))
    share = reader.constant(factor)
    if share is None:
        reader.not_understood(factor, "half of each shader")
        share = 0.5
    return first.mixed(second, min(max(share, 0.0), 1.0))


def _add(source, reader):
    return read_closure(source.input(0), reader).plus(read_closure(source.input(1), reader))


_NODES = {
    "BSDF_PRINCIPLED": _principled,
    "BSDF_DIFFUSE": _diffuse,
    "BSDF_GLOSSY": _glossy,
    "BSDF_METALLIC": _metallic,
    "BSDF_GLASS": _glass,
    "BSDF_REFRACTION": _refraction,
    "BSDF_TRANSPARENT": _transparent,
    "EMISSION": _emission,
    "BACKGROUND": _emission,
    "MIX_SHADER": _mix,
    "ADD_SHADER": _add,
}
