"""Preetham, Shirley and Smits 1999, A Practical Analytic Model for Daylight."""

import numpy as np

from .table import ROWS, XYZ_TO_RGB, directions, elevations, towards, whole

#: Of Y, x and y: rows of the distribution's coefficients, a + b * turbidity.
_PEREZ = np.array(
    [
        [(-1.4630, 0.1787), (0.4275, -0.3554), (5.3251, -0.0227), (-2.5771, 0.1206), (0.3703, -0.0670)],
        [(-0.2592, -0.0193), (0.0008, -0.0665), (0.2125, -0.0004), (-0.8989, -0.0641), (0.0452, -0.0033)],
        [(-0.2608, -0.0167), (0.0092, -0.0950), (0.2102, -0.0079), (-1.6537, -0.0441), (0.0529, -0.0109)],
    ]
)
#: Of x and y at the zenith: powers of turbidity, 2 to 0, times powers of the sun's zenith angle, 3 to 0.
_ZENITH = np.array(
    [
        [
            (0.00166, -0.00375, 0.00209, 0.0),
            (-0.02903, 0.06377, -0.03202, 0.00394),
            (0.11693, -0.21196, 0.06052, 0.25886),
        ],
        [
            (0.00275, -0.00610, 0.00317, 0.0),
            (-0.04214, 0.08970, -0.04153, 0.00516),
            (0.15346, -0.26756, 0.06670, 0.26688),
        ],
    ]
)
#: From the model's kilocandela to Blender's brightness.
_PREETHAM_SCALE = 0.06


def _perez(coefficients, theta, gamma):
    a, b, c, d, e = coefficients
    return (1.0 + a * np.exp(b / np.cos(theta))) * (1.0 + c * np.exp(d * gamma) + e * np.cos(gamma) ** 2)


def table(elevation, turbidity):
    """The table for a sun at `elevation`; below the horizon as at it."""
    zenith_angle = np.pi / 2.0 - elevation
    sun = towards(elevation)
    seen = directions(elevations(np.arange(ROWS)))
    theta = np.minimum(np.arccos(np.clip(seen[..., 2], -1.0, 1.0)), np.pi / 2.0 - 0.001)
    gamma = np.arccos(np.clip(seen @ sun, -1.0, 1.0))
    chi = (4.0 / 9.0 - turbidity / 120.0) * (np.pi - 2.0 * zenith_angle)
    brightness = (4.0453 * turbidity - 4.9710) * np.tan(chi) - 0.2155 * turbidity + 2.4192
    powers = turbidity ** np.array((2.0, 1.0, 0.0)), zenith_angle ** np.array((3.0, 2.0, 1.0, 0.0))
    at_zenith = (_PREETHAM_SCALE * brightness, *(powers[0] @ table @ powers[1] for table in _ZENITH))
    luminance, x, y = (
        value * _perez(c, theta, gamma) / _perez(c, 0.0, zenith_angle)
        for value, c in zip(at_zenith, _PEREZ @ (1.0, turbidity), strict=True)
    )
    y = np.maximum(y, 1e-6)
    return whole(np.stack([x / y, np.ones_like(x), (1.0 - x - y) / y], axis=-1) * luminance[..., None] @ XYZ_TO_RGB.T)
