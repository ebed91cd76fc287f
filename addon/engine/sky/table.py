"""What tables of skies have in common.

Rows run from the nadir to the zenith, close to each other at the horizon; the sun stands above the middle column.
Angles are in radians.
"""

import numpy as np

COLUMNS, ROWS = 256, 256
#: Where atmospheres are integrated, from opposite the sun to it: but for phase functions little changes in between.
_AZIMUTHS = np.linspace(-np.pi, 0.0, 25)

XYZ_TO_RGB = np.array(
    [[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]]
)


def elevations(rows):
    """Elevation of the middle of rows counted from 0."""
    height = (np.asarray(rows) + 0.5) * (2.0 / ROWS) - 1.0
    return np.sign(height) * height**2 * (np.pi / 2.0)


def towards(elevation, azimuth=0.0):
    """Unit vectors (..., 3); those of azimuth 0 are in the plane of X and Z."""
    across = np.cos(elevation)
    parts = np.broadcast_arrays(across * np.cos(azimuth), across * np.sin(azimuth), np.sin(elevation))
    return np.stack(parts, axis=-1)


def directions(elevation):
    """Unit vectors (n, COLUMNS / 2, 3) for elevations (n,): half of the circle, up to the sun's azimuth, which is 0."""
    return towards(elevation[:, None], _fine_azimuths())


def whole(half):
    """Both halves of the circle (n, COLUMNS, 3) float32."""
    return np.concatenate([half, half[:, ::-1]], axis=1).astype(np.float32)


def integrated(elevation, integrals, phases):
    """Colours (n, COLUMNS / 2, 3) for elevations (n,): the sum of what is scattered, each part times its phase.

    `integrals(directions)`: the parts (k, m, 3) without phase for directions (m, 3). `phases(directions)`: theirs
    (k, n, COLUMNS / 2), or numbers.
    """
    coarse = towards(elevation[:, None], _AZIMUTHS)
    parts = integrals(coarse.reshape(-1, 3))
    parts = parts.reshape(len(parts), *coarse.shape)
    place = (_fine_azimuths() - _AZIMUTHS[0]) / (_AZIMUTHS[1] - _AZIMUTHS[0])
    low = place.astype(int)
    share = (place - low)[:, None]
    fine = parts[:, :, low] * (1.0 - share) + parts[:, :, low + 1] * share
    return sum(
        part * np.asarray(phase)[..., None] for part, phase in zip(fine, phases(directions(elevation)), strict=True)
    )


def way_out(position, direction, radius):
    """How far it is from positions (..., 3) inside a sphere around the origin to it."""
    along = (position * direction).sum(axis=-1)
    beyond = radius**2 - (position * position).sum(axis=-1)
    return -along + np.sqrt(np.maximum(along * along + beyond, 0.0))


def rayleigh_phase(mu):
    return 3.0 / (16.0 * np.pi) * (1.0 + mu * mu)


def solid_angle(half_angle):
    return 2.0 * np.pi * (1.0 - np.cos(half_angle))


def _fine_azimuths():
    return (np.arange(COLUMNS // 2) + 0.5) * (2.0 * np.pi / COLUMNS) - np.pi
