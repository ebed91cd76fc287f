# SPDX-License-Identifier: GPL-3.0-or-later
"""Procedural textures: Noise, Voronoi, Gabor, White Noise, Wave, Magic, Gradient, Checker, Brick.

Choices that a heavy function makes at every place are parameters, not literals: all noise then is one program, and a
material that has none gets zeros, for which nothing is computed.
"""

import bpy

from ...engine.expression import Parameter, call, calls, component, literal, mean, mix, vanishes
from .coordinates import texture_vector
from .registry import reads

_NOISES = ("FBM", "MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HETERO_TERRAIN")
#: From 1 on: 0 is no texture.
_FEATURES = ("", "F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE", "N_SPHERE_RADIUS")
_METRICS = ("EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI")
_GRADIENTS = ("LINEAR", "QUADRATIC", "EASING", "DIAGONAL", "RADIAL", "SPHERICAL", "QUADRATIC_SPHERE")
_PROFILES = ("SIN", "SAW", "TRI")
_BANDS = {"X": (20.0, 0.0, 0.0), "Y": (0.0, 20.0, 0.0), "Z": (0.0, 0.0, 20.0), "DIAGONAL": (10.0, 10.0, 10.0)}
_RINGS = {"X": (0.0, 20.0, 20.0), "Y": (20.0, 0.0, 20.0), "Z": (20.0, 20.0, 0.0), "SPHERICAL": (20.0, 20.0, 20.0)}
_GABOR_IMPULSES = 8


def _choice(number):
    """A choice of a node for a heavy function."""
    return Parameter(number, "int")


def _place(n, dimensions, vector):
    """The coordinates that a function of so many ("1D" to "4D") takes, `vector` among them."""
    inputs = [] if dimensions == "1D" else [vector]
    return inputs + ([n.number("W")] if dimensions in ("1D", "4D") else [])


@reads("TEX_NOISE")
def noise(n):
    node = n.node
    inputs = [n.number(name) for name in ("Scale", "Detail", "Roughness", "Lacunarity", "Offset", "Gain", "Distortion")]
    channels = 3 if node.outputs["Color"].is_linked else 1
    value, color = calls(
        f"noise_texture_{node.noise_dimensions.lower()}",
        *_place(n, node.noise_dimensions, texture_vector(n)),
        *inputs,
        _choice(_NOISES.index(node.noise_type)),
        _choice(node.normalize),
        _choice(channels),
    )
    return {"Fac": value, "Factor": value, "Color": color}


@reads("TEX_VORONOI")
def voronoi(n):
    node = n.node
    inputs = ("Scale", "Detail", "Roughness", "Lacunarity", "Smoothness", "Exponent", "Randomness")
    of_version = "lookup3" if bpy.app.version < (5, 0, 0) else "texture"
    distance, color, position = calls(
        f"voronoi_{of_version}_{node.voronoi_dimensions.lower()}",
        *_place(n, node.voronoi_dimensions, texture_vector(n)),
        *(n.number(name) for name in inputs),
        _choice(_FEATURES.index(node.feature)),
        _choice(_METRICS.index(node.distance)),
        _choice(node.normalize),
    )
    return {
        "Distance": distance,
        "Radius": distance,
        "Color": color,
        "Position": position,
        "W": component(position, 3),
    }


@reads("TEX_GABOR")
def gabor(n):
    dimensions = n.node.gabor_type
    value, phase, intensity = calls(
        f"gabor_texture_{dimensions.lower()}",
        texture_vector(n),
        *(n.number(name) for name in ("Scale", "Frequency", "Anisotropy")),
        n.number("Orientation 2D") if dimensions == "2D" else n.vector("Orientation 3D"),
        _choice(_GABOR_IMPULSES),
    )
    return {"Value": value, "Phase": phase, "Intensity": intensity}


@reads("TEX_WHITE_NOISE")
def white_noise(n):
    dimensions = n.node.noise_dimensions  # not generated coordinates: where nothing is linked all is one color
    color = call(f"white_noise_{dimensions.lower()}", *_place(n, dimensions, n.vector("Vector")))
    return {"Value": component(color, 0), "Color": color}


@reads("TEX_GRADIENT")
def gradient(n):
    value = call("pattern_gradient", texture_vector(n), _GRADIENTS.index(n.node.gradient_type))
    return {"Fac": value, "Factor": value, "Color": value}


@reads("TEX_CHECKER")
def checker(n):
    value = call("pattern_checker", texture_vector(n) * n.number("Scale"))
    return {"Fac": value, "Factor": value, "Color": mix(n.color("Color2"), n.color("Color1"), value)}


@reads("TEX_BRICK")
def brick(n):
    node = n.node
    mortar, tint = calls(
        "pattern_brick",
        texture_vector(n) * n.number("Scale"),
        *(n.number(name) for name in ("Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height")),
        *map(n.parameter, (node.offset, node.offset_frequency, node.squash, node.squash_frequency)),
    )
    bricks = mix(n.color("Color1"), n.color("Color2"), tint)
    return {"Fac": mortar, "Factor": mortar, "Color": mix(bricks, n.color("Mortar"), mortar)}


@reads("TEX_MAGIC")
def magic(n):
    place, depth = texture_vector(n) * n.number("Scale"), n.parameter(n.node.turbulence_depth)
    color = call("pattern_magic", place, depth, n.number("Distortion"))
    return {"Fac": mean(color), "Factor": mean(color), "Color": color}


@reads("TEX_WAVE")
def wave(n):
    node = n.node
    place = call("pattern_off_unit", texture_vector(n) * n.number("Scale"))
    if node.wave_type == "BANDS":
        along = call("pattern_bands", place, literal(_BANDS[node.bands_direction]))
    else:
        along = call("pattern_rings", place, literal(_RINGS[node.rings_direction]))
    phase = along + n.number("Phase Offset") + _distortion(n, place)
    value = call("pattern_wave", phase, _PROFILES.index(node.wave_profile))
    return {"Fac": value, "Factor": value, "Color": value}


def _distortion(n, place):
    """What noise adds to the phase of a wave; where the strength is the constant 0 no time is lost with it."""
    strength = n.number("Distortion")
    scale, detail, roughness = (n.number(f"Detail{name}") for name in (" Scale", "", " Roughness"))
    choices = (
        _choice(_NOISES.index("FBM")),
        _choice(True),
        _choice(0 if vanishes(strength) else 1),
    )
    constants = map(literal, (2.0, 0.0, 0.0, 0.0))  # lacunarity, offset, gain, distortion
    return strength * (2.0 * call("noise_texture_3d", place, scale, detail, roughness, *constants, *choices) - 1.0)
