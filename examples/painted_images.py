# SPDX-License-Identifier: GPL-3.0-or-later
"""Images for pictures, painted with numpy by direction: a globe, and a photographer's studio as a world.

All are equirectangular: (height, 2 height, 3), bottom row first, longitude from -180 to 180 degrees from left to right,
which on a globe is eastwards and, a sky being seen from within, clockwise.
"""

import numpy as np


def srgb(code):
    """The channels (3,) in 0..1 of a colour as six hexadecimal digits."""
    return np.array([int(code[i : i + 2], 16) for i in (0, 2, 4)]) / 255.0


def linear(code):
    """The scene-linear colour (3,) of six hexadecimal digits (IEC 61966-2-1)."""
    channels = srgb(code)
    return np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)


def angles(height):
    """Latitude and longitude in degrees, each (height, 2 height), at the centres of the pixels."""
    latitude = ((np.arange(height) + 0.5) / height - 0.5) * 180.0
    longitude = ((np.arange(2 * height) + 0.5) / (2 * height) - 0.5) * 360.0
    return np.meshgrid(latitude, longitude, indexing="ij")


def globe(height=512, seed=3):
    """A globe with seas, land, polar caps and a graticule of 15 degrees, in sRGB."""
    latitude, longitude = angles(height)
    relief = _relief(latitude, longitude, seed)
    relief -= np.quantile(relief, 0.58)  # seas cover 58% of the map
    sea = _blend(srgb("0b2545"), srgb("2f7f9f"), np.clip(relief / 1.2 + 1.0, 0.0, 1.0) ** 2)
    land = _blend(srgb("5f8f4e"), srgb("c9a66b"), np.clip(relief, 0.0, 1.0))
    color = np.where(relief[..., None] > 0.0, land, sea)
    cap = np.abs(latitude) + 9.0 * np.tanh(relief) > 70.0
    color = np.where(cap[..., None], srgb("f4f7fa"), color)
    return np.where(_graticule(latitude, longitude)[..., None], 0.55 * color + 0.45, color)


def _relief(latitude, longitude, seed):
    """Heights without a seam: waves through space of random directions and phases, seen on the unit sphere."""
    random = np.random.default_rng(seed)
    up, along = np.radians(latitude), np.radians(longitude)
    point = np.stack([np.cos(up) * np.cos(along), np.cos(up) * np.sin(along), np.sin(up)], axis=-1)
    relief = np.zeros(latitude.shape)
    for octave in range(7):
        waves = random.normal(size=(12, 3))
        waves *= 1.6 * 1.9**octave / np.linalg.norm(waves, axis=1)[:, None]
        phases = random.uniform(0.0, 2.0 * np.pi, len(waves))
        relief += np.cos(point @ waves.T + phases).sum(axis=-1) / np.sqrt(len(waves)) / 1.75**octave
    return relief


def _graticule(latitude, longitude, step=15.0, width=0.35):
    """Where the lines are: `width` degrees to both sides of each, meridians as wide on the ground as parallels."""

    def near(angle):
        return np.abs((angle + step / 2.0) % step - step / 2.0)

    lines = np.minimum(near(latitude), near(longitude) * np.cos(np.radians(latitude))) < width
    return lines & (np.abs(latitude) < 90.0 - step + width)


def studio(horizon, zenith, softboxes, height=256):
    """A sky from `horizon` to `zenith`, darker below, with rectangular lamps, scene-linear.

    `softboxes`: rows of longitude, latitude, half width, half height (degrees) and radiance.
    """
    latitude, longitude = angles(height)
    sky = _blend(horizon, zenith, np.clip(latitude / 90.0, 0.0, 1.0) ** 0.6)
    color = np.where(latitude[..., None] < 0.0, horizon * (1.0 + latitude[..., None] / 180.0), sky)
    for along, up, width, tall, radiance in softboxes:
        across = np.abs((longitude - along + 180.0) % 360.0 - 180.0) / width
        edge = np.maximum(across, np.abs(latitude - up) / tall)
        color = color + radiance * np.clip((1.0 - edge) / 0.15, 0.0, 1.0)[..., None]
    return color


def _blend(a, b, factor):
    return a + (b - a) * factor[..., None]
