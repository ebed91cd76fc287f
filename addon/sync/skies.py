# SPDX-License-Identifier: GPL-3.0-or-later
"""The Sky Texture node as a table of `engine.sky`, and the sun's disc."""

import numpy as np

from ..engine import sky as models
from ..engine.expression import Parameter, call, literal, maximum
from .color_spaces import from_rec_709

#: Cycles' smallest sun, radians.
_SMALLEST_SUN = 5e-4
_HIGHEST_TURBIDITY = 10.0
#: About how bright the sky of Hosek and Wilkie is in Blender, where that of Preetham is 1.
_HOSEK_BRIGHTNESS = 0.23


def sky(node, vector, images, warn):
    """The colour of a Sky Texture node in the direction `vector`, an Expression."""
    if node.sky_type == "PREETHAM":
        return _of_preetham(node, vector, images)
    if node.sky_type == "HOSEK_WILKIE":
        warn("the sky of Hosek and Wilkie is not rendered; that of Preetham, darkened, is used instead")
        return _of_preetham(node, vector, images) * _HOSEK_BRIGHTNESS
    return _of_atmosphere(node, vector, images)


def _looked_up(images, key, make, vector, rotation):
    """The colour of a table, which `make` gives in Rec. 709 and which is kept by `key`."""
    gamut = from_rec_709()
    place = call("sky_place", vector, Parameter(rotation), literal(float(models.ROWS)))
    return maximum(images.table(("sky", *key), lambda: make() @ gamut.astype(np.float32)).color(place), 0.0)


def _of_preetham(node, vector, images):
    x, y, z = np.array(node.sun_direction) / max(np.linalg.norm(node.sun_direction), 1e-20)
    elevation = float(np.arcsin(min(max(z, 0.0), 1.0)))
    given = (elevation, min(node.turbidity, _HIGHEST_TURBIDITY))
    return _looked_up(
        images, ("preetham", *given), lambda: models.preetham_table(*given), vector, float(np.arctan2(x, y))
    )


def _of_atmosphere(node, vector, images):
    is_multiple = node.sky_type == "MULTIPLE_SCATTERING"
    if is_multiple:
        model, model_sun, horizon = (
            models.multiple_scattering,
            models.multiple_scattering_sun,
            models.horizon(node.altitude),
        )
    else:
        model, model_sun, horizon = models.single_scattering, models.single_scattering_sun, 0.0
    aerosol = node.aerosol_density if hasattr(node, "aerosol_density") else node.dust_density
    given = (node.altitude, node.air_density, aerosol, node.ozone_density)
    elevation, rotation = _upright(node.sun_elevation, node.sun_rotation)
    seen = _looked_up(images, (node.sky_type, elevation, *given), lambda: model(elevation, *given), vector, rotation)
    if not node.sun_disc:
        return seen
    half_angle = max(node.sun_size, _SMALLEST_SUN) / 2.0
    lower, upper = np.maximum(model_sun(elevation, half_angle, *given) @ from_rec_709(), 0.0) * node.sun_intensity
    is_old = node.sky_type == "NISHITA"  # before 5.0 what has set does not count, and the sun hides the sky
    if is_old and -half_angle < elevation < half_angle:
        lower += (upper - lower) * (elevation - half_angle) / (elevation + half_angle)
    across = np.cos(elevation)
    towards = (across * np.sin(rotation), across * np.cos(rotation), np.sin(elevation))
    numbers = (towards, half_angle, horizon, lower, upper, 0.0 if is_old else 1.0)
    return call("sky_with_sun", seen, vector, *map(Parameter, numbers))


def _upright(elevation, rotation):
    """Elevation and rotation of the same sun with the first between -90 and 90 degrees."""
    elevation = (elevation + np.pi) % (2.0 * np.pi) - np.pi
    if abs(elevation) > np.pi / 2.0:
        return float(np.copysign(np.pi, elevation) - elevation), rotation + np.pi
    return float(elevation), rotation
