"""Blender's ico sphere: an icosahedron, each face divided into m x m triangles and pushed out.

Twelve vertices have five neighbours, the corners of the icosahedron; every other vertex is at the direction
of (i A + j B + k C) / m for a face A, B, C of it, with whole i + j + k = m. Blender makes m a power of two.
"""

from itertools import combinations
from math import isqrt

import numpy as np

from .profile import sphere_of
from .revolution import check_outward
from .shapes import POSITION_TOLERANCE, ROUNDING, MeshArrays, Recognition, StaysMesh, UvMap
from .uv_maps import fit_sphere

_TRIPLES = np.array(list(combinations(range(12), 3)))
IRREGULAR = "the vertices are not those of an ico sphere"


def divisions(mesh: MeshArrays) -> int:
    """m if the counts are those of an ico sphere with m divisions of an edge, else 0."""
    v, f, c = mesh.counts
    m = isqrt(f // 20)
    return m if m and f == 20 * m * m and v == 10 * m * m + 2 and c == 3 * f else 0


def recognise_icosphere(mesh: MeshArrays, m: int) -> Recognition:
    """The sphere or ellipsoid of an ico sphere with m divisions; StaysMesh where the mesh is not one."""
    v = len(mesh.positions)
    valence = np.bincount(mesh.corner_vertex, minlength=v)
    corners = np.flatnonzero(valence == 5)
    if (mesh.face_size != 3).any() or len(corners) != 12 or (valence == 6).sum() != v - 12:
        raise StaysMesh(IRREGULAR)
    points = mesh.positions.astype(np.float64)
    centre = points.mean(0)
    stretch, similar, noise = _stretch(points - centre, ROUNDING * np.abs(points).max())
    unit = np.linalg.solve(stretch, (points - centre).T).T
    tolerance = POSITION_TOLERANCE + noise
    worst = _off_lattice(unit, corners, m, tolerance)
    if not worst <= tolerance:
        raise StaysMesh(f"{IRREGULAR} (off by {worst:.2g} of the radius)")
    if m < 2:
        raise StaysMesh("an icosahedron is too coarse for a sphere (2 subdivisions or more)")
    check_outward(mesh, unit, np.zeros(3))
    _check_closed(mesh, unit)
    material = mesh.uniform_material(np.ones(mesh.counts[1], bool), "sphere")
    direction = unit / np.linalg.norm(unit, axis=1, keepdims=True)
    uv, turned = UvMap(), np.eye(3)
    if mesh.uv is not None:
        uv, turned = fit_sphere(mesh.uv.astype(np.float64), direction[mesh.corner_vertex])
    name = f"ico sphere, {mesh.counts[1]} triangles"
    if similar:
        radius = np.linalg.norm(points - centre, axis=1).mean()
        return sphere_of(name, mesh, radius, centre, turned, None, material, uv)
    return sphere_of(name, mesh, 1.0, centre, turned, stretch, material, uv)


def _stretch(spokes: np.ndarray, rounding: float) -> tuple[np.ndarray, bool, float]:
    """The symmetric (3, 3) map from the unit sphere, whether it only scales, and the rounding in radii.

    By the icosahedron's symmetry the unit directions scatter like the identity / 3, so the covariance of the
    vertices is a third of the map squared.
    """
    values, vectors = np.linalg.eigh(3 * spokes.T @ spokes / len(spokes))
    axes = np.sqrt(np.maximum(values, 0.0))
    if axes[0] <= rounding:
        raise StaysMesh(IRREGULAR)
    noise = rounding / axes[0]
    if axes[2] - axes[0] <= (POSITION_TOLERANCE + noise) * axes[2]:
        return axes.mean() * np.eye(3), True, noise
    return vectors @ np.diag(axes) @ vectors.T, False, noise


def _off_lattice(unit: np.ndarray, corners: np.ndarray, m: int, tolerance: float) -> float:
    """The largest distance of the points (v, 3) from the lattice that the corners (12,) int span."""
    twelve = unit[corners]
    cosine = twelve @ twelve.T
    expected = np.abs(np.abs(cosine) - np.where(np.abs(cosine) > 0.7, 1.0, 1 / np.sqrt(5))).max()
    adjacent = np.abs(cosine - 1 / np.sqrt(5)) < 0.1
    a, b, c = _TRIPLES.T
    faces = twelve[_TRIPLES[adjacent[a, b] & adjacent[b, c] & adjacent[a, c]]]
    if len(faces) != 20 or expected > 4 * tolerance:
        raise StaysMesh(IRREGULAR)
    face = np.argmax(unit @ faces.sum(1).T, axis=1)
    weights = np.einsum("vi,vij->vj", unit, np.linalg.inv(faces)[face])
    weights = np.rint(weights * (m / weights.sum(1, keepdims=True)))
    ideal = np.einsum("vi,vij->vj", weights, faces[face])
    ideal /= np.linalg.norm(ideal, axis=1, keepdims=True)
    return float(np.abs(ideal - unit).max())


def _check_closed(mesh: MeshArrays, unit: np.ndarray) -> None:
    """StaysMesh unless the faces, which look outward, close up and cover the sphere once (by their area)."""
    forward = mesh.directed_edges()
    a, b, c = unit[mesh.corner_vertex.reshape(-1, 3)].swapaxes(0, 1)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    twice = (forward[1:] == forward[:-1]).any()
    if twice or (forward != mesh.directed_edges(reverse=True)).any() or area > 5 * np.pi:
        raise StaysMesh("the faces of the ico sphere do not close up")
