"""What a recognised shape promises, checked against its mesh: places, directions and uv of every face corner.

The formulas are the renderer's conventions, written down again here: nothing of the recognition is used.
"""

import numpy as np

SIDES = ("SPHERE", "CYLINDER", "CONE")


def frame_of(part) -> np.ndarray:
    """(3, 3): columns e0, e1, and the pole, axis or normal."""
    if part.kind == "SPHERE":
        return part.frame
    axis = part.normal if part.kind == "DISC" else part.axis
    return np.stack([part.e0, np.cross(axis, part.e0), axis], 1)


def radii(part) -> tuple[float, float]:
    """The radius at the base and at the top of a cylinder or cone."""
    return (part.radius, part.radius) if part.kind == "CYLINDER" else (part.radius_base, part.radius_apex)


def local_points(part, points: np.ndarray) -> np.ndarray:
    """(k, 3) points seen from the part's own frame and centre."""
    origin = part.base if part.kind in ("CYLINDER", "CONE") else part.centre
    return (points - origin) @ frame_of(part)


def distance(part, points: np.ndarray) -> np.ndarray:
    """(k,): how far the points are off the part's surface, or beyond its ends."""
    x, y, z = local_points(part, points).T
    if part.kind == "SPHERE":
        return np.abs(np.sqrt(x * x + y * y + z * z) - part.radius)
    if part.kind == "DISC":
        return np.hypot(z, np.maximum(np.hypot(x, y) - part.radius, 0))
    base, apex = radii(part)
    beyond = np.maximum(np.maximum(-z, z - part.length), 0)
    return np.hypot(np.hypot(x, y) - (base + (apex - base) * z / part.length), beyond)


def normals(part, points: np.ndarray) -> np.ndarray:
    """(k, 3): the outward unit normals at points near the surface; zero in the middle, where there is none."""
    x, y, z = local_points(part, points).T
    if part.kind == "DISC":
        local = np.stack([0 * x, 0 * x, 1 + 0 * x], 1)
    elif part.kind == "SPHERE":
        local = np.stack([x, y, z], 1)
    else:
        base, apex = radii(part)
        rim = np.hypot(x, y)
        slope = (base - apex) / part.length
        local = np.stack([x, y, slope * rim], 1) * (rim > 1e-6 * max(base, apex))[:, None]
    return local / np.maximum(np.linalg.norm(local, axis=1, keepdims=True), 1e-30) @ frame_of(part).T


def mesh_uv(part, points: np.ndarray, inside: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The uv map (k, 2) that the part claims at points, and where u means something (not at poles and tips).

    inside (k, 3): a point of the same face for each; u is unwrapped so that it is continuous in the face.
    """
    su, sv, ou, ov = part.uv.transform
    (x, y, z), (cx, cy, _) = local_points(part, points).T, local_points(part, inside).T
    if part.kind == "DISC" or part.uv.planar:
        size = 2 * (part.radius if part.kind == "DISC" else max(radii(part)))
        return np.stack([su * (x / size + 0.5) + ou, sv * (y / size + 0.5) + ov], 1), np.ones(len(x), bool)
    middle = np.arctan2(cy, cx) % (2 * np.pi)
    turn = middle + (np.arctan2(y, x) - middle + np.pi) % (2 * np.pi) - np.pi
    if part.kind == "SPHERE":
        v = 1 - np.arccos(np.clip(z / part.radius, -1, 1)) / np.pi
        size = part.radius
    else:
        v, size = z / part.length, max(radii(part))
    return np.stack([su * turn / (2 * np.pi) + ou, sv * v + ov], 1), np.hypot(x, y) > 1e-3 * size


def assert_exact(mesh, recognition, tolerance: float = 2e-4, uv: bool = True) -> None:
    """Every face belongs to one part: its corners lie on it, it looks the same way, and the uv maps agree."""
    points = mesh.positions.astype(np.float64)
    if recognition.local is not None:
        points = np.linalg.solve(recognition.local[:, :3], (points - recognition.local[:, 3]).T).T
    first, size = mesh.face_offset[:-1], np.diff(mesh.face_offset)
    corners = points[mesh.corner_vertex]
    centre = np.add.reduceat(corners, first) / size[:, None]
    second, third = (corners[first + size * i // 3] - corners[first] for i in (1, 2))
    facing = np.cross(second, third)
    facing /= np.linalg.norm(facing, axis=1, keepdims=True)
    scale = np.ptp(points, axis=0).max()
    fits = []
    for part in recognition.parts:
        off = np.maximum.reduceat(distance(part, corners), first) / scale
        alike = np.einsum("fi,fi->f", normals(part, centre), facing)
        fits.append(np.where(off < tolerance, alike, -1.0))
    owner = np.argmax(fits, axis=0)
    assert np.max(fits, axis=0).min() > 0.8, f"a face is on no part: {np.max(fits, axis=0).min()}"
    for i, part in enumerate(recognition.parts):
        faces = owner == i
        assert faces.any(), f"no face is on the {part.kind}"
        assert (mesh.material[faces] == part.material).all()
        frame = frame_of(part)
        assert np.allclose(frame.T @ frame, np.eye(3), atol=1e-6) and np.linalg.det(frame) > 0
        if uv and mesh.uv is not None:
            assert part.uv.matches, f"the uv map of the {part.kind} is not found"
            mine = np.repeat(faces, size)
            claimed, meaningful = mesh_uv(part, corners[mine], np.repeat(centre, size, 0)[mine])
            off = claimed - mesh.uv[mine]
            if part.kind in SIDES and not part.uv.planar and abs(abs(part.uv.transform[0]) - 1) < 1e-3:
                off[:, 0] -= np.rint(off[:, 0])
            off[~meaningful, 0] = 0
            assert np.abs(off).max() < 1e-3, f"the uv map of the {part.kind} is off by {np.abs(off).max()}"
