"""Light that molecules and aerosols scatter once, attenuated by both and by ozone, at 21 wavelengths.

Nishita, Sirai, Tadamura and Nakamae 1993, Display of the Earth Taking into Account Atmospheric Scattering. Lengths are
in metres.
"""

import numpy as np

from .table import ROWS, XYZ_TO_RGB, elevations, integrated, rayleigh_phase, solid_angle, towards, way_out, whole

_RADIUS, _TOP = 6360e3, 6420e3
_AIR_HEIGHT, _AEROSOL_HEIGHT = 8e3, 1.2e3
_AEROSOL = 2e-5  # scattering coefficient at the ground, 1/m
_AEROSOL_EXTINCTION = 1.11  # of which the rest is absorbed
_ASYMMETRY = 0.76
_STEPS = 32
#: nm
_WAVELENGTHS = np.linspace(380.0, 780.0, 21)
#: Colour matching functions of the CIE 1931 observer at these.
_MATCHING = np.array(
    [
        [0.001368, 0.000039, 0.006450],
        [0.014310, 0.000396, 0.067850],
        [0.134380, 0.004000, 0.645600],
        [0.348280, 0.023000, 1.747060],
        [0.290800, 0.060000, 1.669200],
        [0.095640, 0.139020, 0.812950],
        [0.004900, 0.323000, 0.272000],
        [0.063270, 0.710000, 0.078250],
        [0.290400, 0.954000, 0.020300],
        [0.594500, 0.995000, 0.003900],
        [0.916300, 0.870000, 0.001650],
        [1.062200, 0.631000, 0.000800],
        [0.854450, 0.381000, 0.000190],
        [0.447900, 0.175000, 0.000020],
        [0.164900, 0.061000, 0.0],
        [0.046770, 0.017000, 0.0],
        [0.011359, 0.004102, 0.0],
        [0.002899, 0.001047, 0.0],
        [0.000690, 0.000249, 0.0],
        [0.000166, 0.000060, 0.0],
        [0.000042, 0.000015, 0.0],
    ]
)
#: Absorption of ozone where it is densest, 1e-9 / m.
_OZONE = 1e-9 * np.ravel(
    (
        (3.25, 5.85, 19.77, 73.1, 200.8, 403.8, 635.5),
        (967.1, 1548.0, 2090.4, 2461.3, 2735.5, 2151.3, 1590.5),
        (1123.6, 735.3, 464.5, 331.0, 225.1, 148.8, 168.3),
    )
)


#: Sunlight above the atmosphere, W / (m^2 nm): of a black body of 5778 K, as large as the sun is seen.
_SUNLIGHT = 6.790167e-5 * 1e-9 * 1.191043e-16 / (_WAVELENGTHS * 1e-9) ** 5
_SUNLIGHT /= np.expm1(0.01438777 / (_WAVELENGTHS * 1e-9 * 5778.0))
#: Scattering by molecules at the ground, 1/m.
_RAYLEIGH = 1.809838e-5 * (500.0 / _WAVELENGTHS) ** 4
#: What a unit of air, aerosol and ozone takes away.
_EXTINCTION = np.stack([_RAYLEIGH, np.full_like(_RAYLEIGH, _AEROSOL_EXTINCTION * _AEROSOL), _OZONE])
#: From a spectrum to Rec. 709.
_TO_RGB = (_WAVELENGTHS[1] - _WAVELENGTHS[0]) * _MATCHING @ XYZ_TO_RGB.T
#: Places along a ray towards the sun, 1 where the atmosphere ends, and their weights: density falls like exp(-x).
_NODES, _WEIGHTS = np.polynomial.laguerre.laggauss(8)
_NODES, _WEIGHTS = _NODES / 25.0, _WEIGHTS * np.exp(_NODES) / 25.0


def _densities(height):
    """Of air, aerosol and ozone (..., 3) at heights above the ground, relative to where each is densest."""
    ozone = np.maximum(1.0 - np.abs(height - 25e3) / 15e3, 0.0)
    return np.stack([np.exp(-height / _AIR_HEIGHT), np.exp(-height / _AEROSOL_HEIGHT), ozone], axis=-1)


def _depth_to_the_sun(position, sun):
    """Air, aerosol and ozone (..., 3) in the way from positions (..., 3) towards the sun."""
    length = way_out(position, sun, _TOP)
    total = np.zeros((*length.shape, 3))
    for node, weight in zip(_NODES, _WEIGHTS, strict=True):
        place = position + (node * length)[..., None] * sun
        total += weight * _densities(np.linalg.norm(place, axis=-1) - _RADIUS)
    return total * length[..., None]


def _behind_the_earth(position, sun):
    if sun[2] >= 0.0:
        return np.zeros(position.shape[:-1], bool)
    along = position @ sun
    return along * along >= (position * position).sum(axis=-1) - _RADIUS**2


def _integrals(directions, sun, altitude, densities):
    """Colours (2, n, 3) of what air and aerosol scatter from directions (n, 3), without their phase functions."""
    eye = np.array((0.0, 0.0, _RADIUS + altitude))
    step = way_out(eye, directions, _TOP)[:, None] / _STEPS
    depth = np.zeros((len(directions), 3))
    spectra = np.zeros((2, len(directions), len(_WAVELENGTHS)))
    for k in range(_STEPS):
        position = eye + (k + 0.5) * step * directions
        density = densities * _densities(np.linalg.norm(position, axis=-1) - _RADIUS)
        depth += step * density
        in_the_way = depth + densities * _depth_to_the_sun(position, sun)
        reaches = np.exp(-in_the_way @ _EXTINCTION)
        reaches[_behind_the_earth(position, sun)] = 0.0
        spectra += (step * density[:, :2]).T[..., None] * reaches
    return spectra * _SUNLIGHT * np.stack([_RAYLEIGH, np.full_like(_RAYLEIGH, _AEROSOL)])[:, None] @ _TO_RGB


def _phases(mu):
    g = _ASYMMETRY
    aerosol = 3.0 * (1.0 - g * g) * (1.0 + mu * mu)
    return rayleigh_phase(mu), aerosol / (8.0 * np.pi * (2.0 + g * g) * (1.0 + g * g - 2.0 * g * mu) ** 1.5)


def table(elevation, altitude, air, aerosol, ozone):
    """The table for a sun at `elevation`, seen from `altitude`; the others multiply densities. Below the horizon its
    colour fades to black."""
    sun, altitude = towards(elevation), _above_ground(altitude)
    densities = np.array((air, aerosol, ozone))
    # Half a row lower than where they stand, as in Cycles.
    above = integrated(
        elevations(np.arange(ROWS // 2, ROWS) - 0.5),
        lambda directions: _integrals(directions, sun, altitude, densities),
        lambda directions: _phases(directions @ sun),
    )
    fade = np.maximum(1.0 + 2.5 * np.sin(elevations(np.arange(ROWS // 2))), 0.0) ** 3
    return whole(np.concatenate([above[:1] * fade[:, None, None], above]))


def sun(elevation, half_angle, altitude, air, aerosol, _ozone):
    """Colours (2, 3) of the disc's lowest and highest point, black where all of it has set. Ozone does not count."""
    if elevation + half_angle <= 0.0:
        return np.zeros((2, 3))
    ends = np.maximum((elevation - half_angle, elevation + half_angle), 0.0)
    eye = np.array((0.0, 0.0, _RADIUS + _above_ground(altitude)))
    depth = np.stack([_depth_to_the_sun(eye, towards(end)) for end in ends]) * (air, aerosol, 0.0)
    return np.exp(-depth @ _EXTINCTION) * _SUNLIGHT / solid_angle(half_angle) @ _TO_RGB


def _above_ground(altitude):
    return min(max(altitude, 1.0), _TOP - _RADIUS - 1.0)
