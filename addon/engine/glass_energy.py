"""What rough glass keeps of the light that falls on it where each ray meets one facet: a table for shaders."""

from functools import lru_cache

import numpy as np

from . import layout

#: Entries along each axis of the table: roughness, index of refraction, cosine.
SIDE = 16
#: Normals of facets along the two axes of the cap that they are taken from.
_ROWS, _COLUMNS = 24, 16
_LEAST, _MOST = 1e-4, 0.99


@lru_cache(maxsize=1)
def energy_records():
    """Records (n,) of `layout.GLASS_ENERGY`, read-only: from the thinner side all roughnesses, for each all indices,
    for each all cosines, then from the denser side. Along each axis the entries are even over 0 to 1, of roughness, of
    the root of |n - 1| / (n + 1) and of the cosine. A record has four neighbours together.
    """
    kept = np.stack([_kept(denser) for denser in (False, True)])
    kept = np.pad(kept, ((0, 0), (0, 0), (0, 1), (0, 1)), "edge")
    corners = [kept[..., :-1, :-1], kept[..., :-1, 1:], kept[..., 1:, :-1], kept[..., 1:, 1:]]
    records = np.stack(corners, axis=-1).astype(np.float32).reshape(-1, 4).view(layout.GLASS_ENERGY.dtype)[:, 0]
    records.flags.writeable = False
    return records


def _kept(denser):
    """Shares (roughness, index, cosine) float64 of light that leaves again, to either side."""
    axis = np.clip(np.arange(SIDE) / (SIDE - 1.0), _LEAST, 1.0)
    shares = np.empty((SIDE, SIDE, SIDE))
    for i, root in enumerate(np.minimum(axis, _MOST)):
        n = (1.0 + root**2) / (1.0 - root**2)
        for k, roughness in enumerate(axis):
            shares[k, i] = kept(axis, roughness**2, n if denser else 1.0 / n)
    return shares


def kept(cosines, alpha, eta):
    """Shares (n,) of light from directions of these cosines (n,) that facets reflect and refract and do not hide; `eta`
    is the index before the surface over the one beyond.

    The normals that a direction sees are a cap of even density (Dupuy and Benyoub 2023, Sampling Visible GGX Normals
    with Spherical Caps), what others hide of a ray is Smith's (Heitz 2014).
    """
    below, angle = np.meshgrid((np.arange(_ROWS) + 0.5) / _ROWS, (np.arange(_COLUMNS) + 0.5) / _COLUMNS * np.pi)
    below, angle = (values.reshape(1, -1).astype(np.float32) for values in (below, angle))
    cosine, alpha, eta = np.asarray(cosines, np.float32)[:, None], np.float32(alpha), np.float32(eta)
    sine = np.sqrt(1.0 - cosine**2)
    length = np.hypot(alpha * sine, cosine)
    side, up = alpha * sine / length, cosine / length  # the direction where facets form a sphere
    z = 1.0 - below * (1.0 + up)
    radius = np.sqrt(np.maximum(1.0 - z * z, 0.0))
    x, y, z = alpha * (radius * np.cos(angle) + side), alpha * radius * np.sin(angle), np.maximum(z + up, 0.0)
    x, z = (value / np.sqrt(x * x + y * y + z * z) for value in (x, z))
    cos_i = np.clip(x * sine + z * cosine, 0.0, 1.0)
    square = 1.0 - eta**2 * (1.0 - cos_i**2)
    cos_t = np.sqrt(np.maximum(square, 0.0))
    r_s, r_p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t), (cos_i - eta * cos_t) / (cos_i + eta * cos_t)
    fresnel = np.where(square > 0.0, (r_s**2 + r_p**2) / 2.0, 1.0)
    mirrored, bent = 2.0 * cos_i * z - cosine, (eta * cos_i - cos_t) * z - eta * cosine
    seen = 1.0 + _hidden(cosine, alpha)

    def passed(cos_out, there):
        return np.where(there, seen / (seen + _hidden(np.maximum(np.abs(cos_out), 1e-6), alpha)), 0.0)

    shares = fresnel * passed(mirrored, mirrored > 0.0) + (1.0 - fresnel) * passed(bent, bent < 0.0)
    return shares.mean(axis=1)


def _hidden(cosine, alpha):
    """Smith's Lambda."""
    return (np.sqrt(1.0 + alpha**2 * (1.0 / cosine**2 - 1.0)) - 1.0) / 2.0
