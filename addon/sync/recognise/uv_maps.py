"""Fitting a mesh's uv map to the uv of an exact shape.

Each fit takes the uv of the part's corners and their exact places on the shape, so it holds between the
vertices too. Blender's maps to be found: bmo_primitive.cc, BM_mesh_calc_uvs_sphere, BM_mesh_calc_uvs_cone,
BM_mesh_calc_uvs_circle.
"""

import numpy as np

from .shapes import UvMap

UV_TOLERANCE = 5e-4  # of the map: half a texel of a 1k image

NO_MATCH = UvMap(matches=False)


def _turn(angle: float) -> np.ndarray:
    """(3, 3) rotation about z by ``angle`` radians."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def fit_sphere(uv: np.ndarray | None, direction: np.ndarray) -> tuple[UvMap, np.ndarray]:
    """The map, and the rotation (3, 3) to apply to the sphere's frame, for uv (c, 2) at directions (c, 3).

    The renderer's sphere has no uv transform: an offset of u turns the zero meridian, a map that runs the
    other way in both u and v turns the pole.
    """
    if uv is None:
        return UvMap(), np.eye(3)
    flip = np.diag([1.0, -1.0, -1.0]) if (uv[:, 1] - 0.5) @ direction[:, 2] < 0 else np.eye(3)
    x, y, z = (direction @ flip).T
    v = 1 - np.arccos(np.clip(z, -1, 1)) / np.pi
    meridian = np.abs(z) < 1 - 1e-12  # the poles have none
    turned = uv[meridian, 0] - np.arctan2(y, x)[meridian] / (2 * np.pi)
    offset = np.angle(np.exp(2j * np.pi * turned).mean()) / (2 * np.pi)
    off = turned - offset
    error = max(np.abs(off - np.rint(off)).max(), np.abs(uv[:, 1] - v).max())
    if not error <= UV_TOLERANCE:
        return NO_MATCH, np.eye(3)
    return UvMap(), flip @ _turn(-2 * np.pi * offset)


def fit_side(uv, cell, step, height, tip, segments) -> tuple[UvMap, int]:
    """The map of a cylinder's or cone's side, and the segment where theta = 0.

    uv (c, 2) or None; each corner is on meridian ``cell + step`` (cell (c,) int in [0, segments), the face's;
    step 0 or 1), at height (c,) in [0, 1]; tip (c,) bool: a cone's tip, which has no meridian.
    """
    if uv is None:
        return UvMap(), 0
    sv, ov, v_error = _line(height, uv[:, 1])
    u, cell, step = uv[~tip, 0], cell[~tip], step[~tip]
    begins = step == 0
    low = np.bincount(cell[begins], u[begins], segments) / np.bincount(cell[begins], minlength=segments)
    su = segments * (u[step == 1].mean() - low.mean())
    jump = low - np.roll(low, 1) - su / segments  # nothing, but -su where theta begins anew
    seam = int(np.argmin(jump * np.sign(su)))
    ou = low[seam]
    off = u - su * ((cell - seam) % segments + step) / segments - ou
    if abs(abs(su) - 1) <= UV_TOLERANCE:
        off = off - np.rint(off)  # a whole turn is a whole texture: any seam will do
    if not max(np.abs(off).max(), v_error) <= UV_TOLERANCE:
        return NO_MATCH, 0
    return UvMap((float(su), float(sv), float(ou), float(ov))), seam


def _line(x: np.ndarray, y: np.ndarray) -> tuple[float, float, float]:
    """Least squares y = slope * x + offset, and its largest error."""
    dx = x - x.mean()
    slope = dx @ y / (dx @ dx)
    offset = y.mean() - slope * x.mean()
    return slope, offset, float(np.abs(slope * x + offset - y).max())


def fit_planar(uv: np.ndarray | None, xy: np.ndarray, radius: float) -> tuple[UvMap, float]:
    """The map of a disc (or of a cone seen from above), and the angle of e0 in the plane, in radians.

    uv (c, 2) at xy (c, 2), places that are spread evenly around the axis: mesh_uv = A xy + b. With e0, e1
    orthonormal the rows of A must be multiples of them, and that is what chooses e0.
    """
    if uv is None:
        return UvMap(), 0.0
    offset = uv.mean(0)
    matrix = 2 * (uv.T @ xy) / (xy * xy).sum()
    (ux, uy), (vx, vy) = matrix
    by_u = np.hypot(ux, uy) >= np.hypot(vx, vy) / 2  # by v only where u hardly changes: so su is not negative
    angle = np.arctan2(uy, ux) if by_u else np.arctan2(-vx, vy)
    c, s = np.cos(angle), np.sin(angle)
    su, sv = 2 * radius * (ux * c + uy * s), 2 * radius * (vy * c - vx * s)
    p, q = (xy @ np.array([[c, -s], [s, c]])).T / (2 * radius)
    error = np.abs(np.stack([su * p, sv * q], 1) + offset - uv).max()
    if not error <= UV_TOLERANCE:
        return NO_MATCH, 0.0
    return UvMap((float(su), float(sv), float(offset[0] - su / 2), float(offset[1] - sv / 2))), float(angle)
