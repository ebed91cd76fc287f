"""Light that is scattered any number of times: a fit to path-traced skies, at 630, 560, 490 and 430 nm.

Garcia Linan 2024, https://fgarlin.com/posts/2024-12-06-spectral_sky, with its constants. Lengths are in kilometres.
"""

import numpy as np

from .table import ROWS, XYZ_TO_RGB, elevations, integrated, rayleigh_phase, solid_angle, towards, way_out, whole

_GROUND, _THICKNESS = 6371.0, 100.0
_STEPS = 64
_SUNLIGHT = np.array((1.679, 1.828, 1.986, 1.307))
#: Scattering by air and by aerosol at the ground, and what a unit of air, aerosol and ozone takes away, 1/km.
_AIR = np.array((6.605e-3, 1.067e-2, 1.842e-2, 3.156e-2))
_AEROSOLS = 1.3681e20
_AEROSOL = _AEROSOLS * np.array((1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22))
_AEROSOL_ABSORBED = _AEROSOLS * np.array((2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23))
_OZONE = 3.78547397e20 * 334.5 * np.array((3.472e-25, 3.914e-25, 1.349e-25, 1.103e-26))
_EXTINCTION = np.stack([_AIR, _AEROSOL + _AEROSOL_ABSORBED, _OZONE])
_AEROSOL_HEIGHT, _BACKGROUND = 0.73, 2e6 / _AEROSOLS
_ASYMMETRY, _ALBEDO = 0.8, 0.3
_TO_RGB = (
    np.array(
        [
            [53.386917738564668, 22.981337506691025, 0.0],
            [43.904844466369358, 71.347795700053394, 0.102506867965741],
            [1.613727825160896, 18.422960591455485, 31.742921188390806],
            [20.762668673810577, 2.361421352331437, 110.480096432521403],
        ]
    )
    @ XYZ_TO_RGB.T
)
#: Of light that was scattered more often, at each wavelength.
_OFTEN = 0.02 * np.array((0.217, 0.347, 0.594, 1.0))
_LOOK_UPS = (64, 256)


def _densities(height):
    """Of air, aerosol and ozone (..., 3) at heights (...), relative to what the coefficients are for."""
    height = np.maximum(height, 0.0)
    log_height = np.log(np.maximum(height, 1e-4))
    air = np.exp(-0.07771971 * height**1.16364243)
    aerosol = np.exp(-height / _AEROSOL_HEIGHT) + _BACKGROUND
    ozone = np.exp(-5.55555555 * (log_height - 3.22261) ** 2 - log_height)
    return np.stack([air, aerosol, ozone], axis=-1)


def _transmittance(cosine, altitude, densities):
    """Share (..., 4) of sunlight that reaches altitudes (...) where the sun's zenith angle has a cosine (...)."""
    eye = np.stack([np.zeros_like(altitude), np.zeros_like(altitude), _GROUND + altitude], axis=-1)
    sun = np.stack([-np.sqrt(np.maximum(1.0 - cosine**2, 0.0)), np.zeros_like(cosine), cosine], axis=-1)
    step = way_out(eye, sun, _GROUND + _THICKNESS)[..., None] / _STEPS
    depth = 0.0
    for k in range(_STEPS):
        depth = depth + step * _densities(np.linalg.norm(eye + (k + 0.5) * step * sun, axis=-1) - _GROUND)
    return np.exp(-(depth * densities) @ _EXTINCTION)


class _Transmittances:
    """`_transmittance` looked up in a table."""

    def __init__(self, densities):
        altitude, cosine = np.meshgrid(
            np.linspace(0.0, _THICKNESS, _LOOK_UPS[0]), np.linspace(-1.0, 1.0, _LOOK_UPS[1]), indexing="ij"
        )
        self._table = _transmittance(cosine, altitude, densities).astype(np.float32)

    def at(self, cosine, altitude):
        """(n, 4) for cosines (n,) and altitudes (n,), mixed linearly."""
        places = np.stack([altitude / _THICKNESS, 0.5 + 0.5 * cosine]).clip(0.0, 1.0)
        places *= np.array(_LOOK_UPS)[:, None] - 1
        low = places.astype(np.int64)
        (fy, fx), (y, x) = (places - low).astype(np.float32)[..., None], low
        up, right = np.minimum(y + 1, _LOOK_UPS[0] - 1), np.minimum(x + 1, _LOOK_UPS[1] - 1)
        table = self._table
        lower = table[y, x] * (1.0 - fx) + table[y, right] * fx
        return lower * (1.0 - fy) + (table[up, x] * (1.0 - fx) + table[up, right] * fx) * fy


def _integrals(directions, sun, altitude, densities):
    """Colours (3, n, 3) of what air and aerosol scatter once from directions (n, 3), without their phase functions, and
    of what is scattered more often."""
    known = _Transmittances(densities)
    eye = np.array((0.0, 0.0, _GROUND + altitude))
    step = _reach(eye, directions)[:, None] / _STEPS
    radiance, passes = np.zeros((3, len(directions), 4)), np.ones((len(directions), 4))
    ground_to_space = known.at(np.ones(1), np.zeros(1))
    for k in range(_STEPS):
        position = eye + (k + 0.5) * step * directions
        distance = np.linalg.norm(position, axis=-1)
        height = np.maximum(distance - _GROUND, 0.0)
        cosine = position @ sun / distance
        density = _densities(height) * densities
        by_air, by_aerosol = density[:, :1] * _AIR, density[:, 1:2] * _AEROSOL
        extinction = density @ _EXTINCTION
        sunlight = known.at(cosine, height)
        from_ground = known.at(cosine, np.zeros_like(cosine)) * ground_to_space / known.at(np.ones_like(cosine), height)
        earth = 0.5 * (1.0 - np.sqrt(np.maximum(1.0 - (_GROUND / distance) ** 2, 0.0)))  # its share of all directions
        often = _OFTEN / (1.0 + 5.0 * np.exp(-17.92 * cosine))[:, None]
        often = often + (earth * cosine)[:, None] * (_ALBEDO / np.pi) * from_ground
        through = np.exp(-step * extinction)
        length = passes * (1.0 - through) / np.maximum(extinction, 1e-7)
        radiance += length * np.stack([by_air * sunlight, by_aerosol * sunlight, (by_air + by_aerosol) * often])
        passes *= through
    return (radiance * _SUNLIGHT) @ _TO_RGB


def _reach(eye, directions):
    """How far rays (n, 3) from the eye go: to the ground or out of the atmosphere."""
    along = directions @ eye
    under_root = along * along + _GROUND**2 - eye @ eye
    ground = -along - np.sqrt(np.maximum(under_root, 0.0))
    meets = (under_root >= 0.0) & (along < 0.0)
    return np.where(meets, ground, way_out(eye, directions, _GROUND + _THICKNESS))


def _phases(mu):
    g = _ASYMMETRY
    aerosol = (1.0 - g * g) / (4.0 * np.pi * (1.0 + g * g - 2.0 * g * mu) ** 1.5)
    return rayleigh_phase(mu), aerosol, 1.0


def table(elevation, altitude, air, aerosol, ozone):
    """The table for a sun at `elevation`, seen from `altitude` in metres; the others multiply densities. Below the
    horizon is the ground."""
    sun, altitude = towards(elevation), _above_ground(altitude)
    half = integrated(
        elevations(np.arange(ROWS)),
        lambda directions: _integrals(directions, sun, altitude, (air, aerosol, ozone)),
        lambda directions: _phases(directions @ sun),
    )
    return whole(half)


def sun(elevation, half_angle, altitude, air, aerosol, ozone):
    """Colours (2, 3) of the disc's lowest and highest point."""
    ends = np.sin((elevation - half_angle, elevation + half_angle))
    light = _transmittance(ends, np.full(2, _above_ground(altitude)), (air, aerosol, ozone)) * _SUNLIGHT
    return light / solid_angle(half_angle) @ _TO_RGB


def horizon(altitude):
    """Elevation of the horizon seen from an altitude in metres: negative."""
    return -np.arccos(_GROUND / (_GROUND + max(altitude, 0.0) / 1000.0))


def _above_ground(altitude):
    """An altitude in metres as kilometres."""
    return min(max(altitude, 1.0), 1000.0 * _THICKNESS - 1.0) / 1000.0
