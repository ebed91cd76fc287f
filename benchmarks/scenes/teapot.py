"""A pot of bicubic Bezier patches on a checkered floor, cut into smooth triangles as finely as wanted."""

import numpy as np

from examples.standard_scenes import nff_material, standard_scene

QUARTER = 4.0 / 3.0 * (np.sqrt(2.0) - 1.0)  # the control points' distance that makes a cubic a quarter of a circle
PATCHES = 36
SQUARES = 8

# Control points (radius, height) of the body and of the lid, cubics in a row.
_BODY = [
    (0.0, 0.0), (0.6, 0.0), (1.1, 0.02), (1.3, 0.3), (1.55, 0.65),
    (1.6, 1.1), (1.25, 1.5), (1.1, 1.67), (0.95, 1.75), (0.95, 1.9),
]  # fmt: skip
_LID = [(0.98, 1.9), (0.7, 2.1), (0.22, 2.05), (0.16, 2.2), (0.1, 2.35), (0.32, 2.5), (0.0, 2.55)]
# Control points (x, z) of the middles of spout and handle, and the radius at each.
_SPOUT = [(1.1, 0.55), (1.9, 0.5), (1.7, 1.2), (2.1, 1.6), (2.25, 1.75), (2.35, 1.8), (2.5, 1.82)]
_SPOUT_RADIUS = [0.42, 0.38, 0.2, 0.17, 0.16, 0.16, 0.17]
_HANDLE = [(-1.2, 1.55), (-1.8, 1.8), (-2.5, 1.7), (-2.4, 1.2), (-2.3, 0.7), (-1.8, 0.4), (-1.25, 0.4)]
_HANDLE_RADIUS = [0.11] * 7


def teapot(size=12):
    """36 patches of 2 n^2 triangles over a floor of 128 triangles: 10,496 by default less those at poles."""
    scene = standard_scene((3.2, -5.6, 3.8), (0.1, 0, 0.95), (0, 0, 1), 0.0, [(-3.1, -9.8, 12.1), (11.3, -5.1, 8.8)])
    _add_checkers(scene)
    china = scene.add_material(nff_material((0.9, 0.75, 0.6), 0.75, 0.25, 40.0))
    points, normals = _grids(_patches(), size)
    corners = _cells(points), _cells(normals)
    real = np.linalg.norm(np.cross(*(corners[0][:, i] - corners[0][:, 0] for i in (1, 2))), axis=-1) > 1e-12
    p, n = (np.moveaxis(corner[real], 1, 0) for corner in corners)
    scene.add_triangles(p[0], p[2], p[1], china, n0=n[0], n1=n[2], n2=n[1])  # their front is outside
    return scene


def _add_checkers(scene):
    edge = np.linspace(-6.0, 6.0, SQUARES + 1)
    x, y = np.meshgrid(edge, edge, indexing="ij")
    grid = np.stack([x, y, np.zeros_like(x)], axis=-1)
    cells = _cells(grid[None])
    light = np.repeat(np.indices((SQUARES, SQUARES)).sum(axis=0).ravel() % 2 == 0, 2)
    for color, chosen in (((0.9, 0.9, 0.85), light), ((0.15, 0.2, 0.3), ~light)):
        scene.add_triangles(*np.moveaxis(cells[chosen], 1, 0), scene.add_material(nff_material(color, 0.9, 0.1, 50.0)))


def _patches():
    """Control points (PATCHES, 4, 4, 3): along the profile, then around it."""
    parts = [_revolved(_cubics(_BODY)), _revolved(_cubics(_LID))]
    parts += [_swept(_SPOUT, _SPOUT_RADIUS), _swept(_HANDLE, _HANDLE_RADIUS)]
    return np.concatenate(parts)


def _cubics(points):
    """Control points (k, 4, d) of the cubics in a row that share their ends."""
    points = np.asarray(points, np.float64)
    return points[3 * np.arange((len(points) - 1) // 3)[:, None] + np.arange(4)]


def _quarters():
    """Control points (4, 4, 2) of a unit circle's quarters."""
    first = np.array([(1.0, 0.0), (1.0, QUARTER), (QUARTER, 1.0), (0.0, 1.0)])
    turns = [np.array([(c, -s), (s, c)]) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    return np.stack([first @ turn.T for turn in turns])


def _revolved(profile):
    """Patches (4 k, 4, 4, 3) of profiles (k, 4, 2) of radius and height about Z."""
    around = _quarters()
    xy = profile[:, None, :, None, :1] * around[None, :, None]
    z = np.broadcast_to(profile[:, None, :, None, 1:], (*xy.shape[:-1], 1))
    return np.concatenate([xy, z], axis=-1).reshape(-1, 4, 4, 3)


def _swept(middle, radius):
    """Patches (4 k, 4, 4, 3) of a tube in the plane y = 0; its circles stand across the control polygon."""
    middle = np.asarray(middle, np.float64)
    along = np.gradient(middle, axis=0)
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    across = np.stack([-along[:, 1], np.zeros(len(along)), along[:, 0]], axis=-1)
    center = np.stack([middle[:, 0], np.zeros(len(middle)), middle[:, 1]], axis=-1)
    circle = _quarters()[:, None]  # (4, 1, 4, 2)
    size = np.asarray(radius)[:, None, None]
    y = np.array([0.0, 1.0, 0.0])
    rows = center[:, None] + size * (circle[..., 1:] * across[:, None] + circle[..., :1] * y)  # (4, points, 4, 3)
    knots = 3 * np.arange((len(middle) - 1) // 3)[:, None] + np.arange(4)
    return rows[:, knots].reshape(-1, 4, 4, 3)


def _grids(patches, size):
    """Points and unit normals (n, size + 1, size + 1, 3) of patches at evenly spaced parameters."""
    even = np.linspace(0.0, 1.0, size + 1)
    points = np.einsum("ui,vj,nijk->nuvk", _bernstein(even), _bernstein(even), patches)
    inside = np.clip(even, 1e-4, 1.0 - 1e-4)  # at a pole a patch has no normal of its own
    along = np.einsum("ui,vj,nijk->nuvk", _slope(inside), _bernstein(inside), patches)
    around = np.einsum("ui,vj,nijk->nuvk", _bernstein(inside), _slope(inside), patches)
    normal = np.cross(around, along)
    return points, normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def _bernstein(t):
    """(n, 4) values of the cubic Bernstein polynomials."""
    s = 1.0 - t
    return np.stack([s**3, 3.0 * t * s**2, 3.0 * t**2 * s, t**3], axis=-1)


def _slope(t):
    """(n, 4) derivatives of the cubic Bernstein polynomials."""
    s = 1.0 - t
    return 3.0 * np.stack([-(s**2), s**2 - 2.0 * t * s, 2.0 * t * s - t**2, t**2], axis=-1)


def _cells(grid):
    """Triangles (m, 3, ...) of the cells of grids (n, k, l, ...), two a cell."""
    a, b, c, d = grid[:, :-1, :-1], grid[:, 1:, :-1], grid[:, 1:, 1:], grid[:, :-1, 1:]
    halves = np.stack([np.stack([a, b, c], axis=3), np.stack([a, c, d], axis=3)], axis=3)
    return halves.reshape(-1, 3, grid.shape[-1])
