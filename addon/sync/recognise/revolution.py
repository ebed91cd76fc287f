"""Lattices of revolution: rings of equally spaced vertices around an axis, closed by tips, caps or nothing.

Blender's UV sphere, cylinder, cone and circle are all of this kind. With ``rings`` m, ``segments`` n,
``fans`` (ends closed by triangles around one vertex) and ``ngons`` (ends closed by one face), the counts are

    vertices = m n + fans,  faces = (m - 1) n + fans n + ngons,  corners = 4 (m - 1) n + 3 fans n + ngons n

which rejects nearly every other mesh without a look at its data. What is left is checked vertex by vertex and
edge by edge. A lattice may be stretched and sheared: it is fitted up to an affine map.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .shapes import POSITION_TOLERANCE, ROUNDING, MeshArrays, StaysMesh

LEAST_SEGMENTS = 5  # fewer cannot be told from quads and triangles, and are no round shape
OPEN, NGON, FAN = range(3)
IRREGULAR = "the vertices are not on the regular rings of a sphere, cylinder or cone"


@dataclass(frozen=True)
class Counts:
    """The numbers that a lattice's vertex, face and corner counts follow from."""

    rings: int
    segments: int
    fans: int
    ngons: int


def candidates(mesh: MeshArrays) -> Iterator[Counts]:
    """The lattices whose counts are the mesh's (at most one each way of closing the ends)."""
    v, f, c = mesh.counts
    for fans, ngons in ((0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (2, 0)):
        if fans == 1 and ngons == 1:
            n = int(mesh.face_size.max()) if f == v and c == 4 * (v - 1) else 0
        elif fans == 1:
            n = 4 * (v - 1) - c
        else:
            n = v - f + ngons if fans == 0 else f - v + 2
        if n < LEAST_SEGMENTS or (v - fans) % n or v == fans:
            continue
        m = (v - fans) // n
        two_faced = m == 1 and ngons == 2
        counted = (m - 1 + fans) * n + ngons == f and (4 * (m - 1) + ngons + 3 * fans) * n == c
        if counted and not two_faced and not (m == 1 and fans == 2 and not _few_in_sample(mesh)):
            yield Counts(m, n, fans, ngons)


def _few_in_sample(mesh: MeshArrays, sample: int = 64) -> bool:
    """Whether the faces could be two fans, by a sample: every closed triangle mesh counts like two fans."""
    faces = np.unique(np.linspace(0, mesh.counts[1] - 1, sample).astype(np.int64))
    corners = mesh.corner_vertex[mesh.face_offset[faces][:, None] + np.arange(3)]
    return len(np.unique(corners)) <= 2 + 2 * len(faces)


@dataclass
class Revolution:
    """A fitted lattice. In lattice space the axis is z; object space = origin + basis @ lattice space.

    ``similar``: the basis is a rotation (lengths are object space's), else it stretches or shears. ring (v,)
    int: the vertex's ring, -1 and m for the tips; meridian (v,) int in [0, n) (0 for tips); phase: the angle
    of meridian 0, radians; z, radius (m,): the rings. ends: how the bottom and the top are closed; tip_z:
    heights of the tips there (NaN where there is none); raised: whether a tip is off its ring's plane.
    """

    counts: Counts
    origin: np.ndarray
    basis: np.ndarray
    similar: bool
    points: np.ndarray
    ring: np.ndarray
    meridian: np.ndarray
    phase: float
    z: np.ndarray
    radius: np.ndarray
    ends: tuple[int, int]
    tip_z: tuple[float, float]
    raised: tuple[bool, bool]
    tolerance: float


def fit(mesh: MeshArrays, counts: Counts) -> Revolution:
    """Fit the lattice to the mesh; StaysMesh where vertices or faces are not the lattice's."""
    tips, end = _tips_and_end(mesh, counts)
    points = mesh.positions.astype(np.float64)
    grid, ends, tips, normal = _rings(points, counts, tips, end)
    lattice = _place(points, grid, tips, normal, ends, counts)
    _meridians(lattice, grid, tips)
    _check_faces(mesh, lattice)
    return lattice


def _tips_and_end(mesh: MeshArrays, counts: Counts) -> tuple[np.ndarray, np.ndarray]:
    """The vertices in the middle of fans, (fans,), and the vertices of one end ring, (n,)."""
    n, v, offset, size = counts.segments, len(mesh.positions), mesh.face_offset, mesh.face_size
    quads, ngons = (size == 4).sum(), np.flatnonzero(size == n)
    if quads != (counts.rings - 1) * n or len(ngons) != counts.ngons:
        raise StaysMesh(IRREGULAR)
    triangles = mesh.corner_vertex[offset[:-1][size == 3][:, None] + np.arange(3)]
    tips = np.flatnonzero(np.bincount(triangles.ravel(), minlength=v) == n)
    if len(tips) != counts.fans:
        raise StaysMesh(IRREGULAR)
    if counts.rings == 1:
        end = np.setdiff1d(np.arange(v), tips)
    elif counts.ngons:
        first = offset[ngons[0]]
        end = mesh.corner_vertex[first : first + n]
    elif counts.fans:
        end = np.setdiff1d(triangles[(triangles == tips[0]).any(1)], tips)
    else:
        end = _boundary_loop(mesh)
    if len(end) != n:
        raise StaysMesh(IRREGULAR)
    return tips, end


def _boundary_loop(mesh: MeshArrays) -> np.ndarray:
    """The vertices of one of the loops of edges that have a face on one side only."""
    v = len(mesh.positions)
    keys = np.setdiff1d(mesh.directed_edges(), mesh.directed_edges(reverse=True))
    start, end = keys // v, keys % v
    following = np.arange(v)
    following[start] = end
    label = np.arange(v)
    for _ in range(v.bit_length()):  # pointer doubling: each vertex learns the least index of its loop
        label = np.minimum(label, label[following])
        following = following[following]
    return start[label[start] == label[start[0]]] if len(start) else start


def _rings(points: np.ndarray, counts: Counts, tips: np.ndarray, end: np.ndarray):
    """Sort the vertices into rings from the bottom to the top.

    Returns grid (m, n) int, the ends' kinds, the tips' vertices at bottom and top (-1 for none), and the
    rings' normal. A cone with a tip stands on its base; anything else points along the positive side of its
    main axis.
    """
    m, n = counts.rings, counts.segments
    on_ring = np.ones(len(points), bool)
    on_ring[tips] = False
    ring_vertices = np.flatnonzero(on_ring)
    offset = points[end] - points[end].mean(0)
    normal = np.linalg.eigh(offset.T @ offset)[1][:, 0]
    height = (points - points[end].mean(0)) @ normal
    bottom_tip = tips[:1] if not counts.ngons else tips[:0]
    if m == 1 and len(tips):  # a tip that is in the ring's plane closes it, the other one is a cone's
        tips = tips[np.argsort(np.abs(height[tips]))]
        bottom_tip = tips[:1] if counts.fans == 2 else tips[:0]
    top_tip = np.setdiff1d(tips, bottom_tip)
    above = height[top_tip].sum() if m == 1 else height[ring_vertices].sum()
    if above < 0:
        normal, height = -normal, -height
    grid = ring_vertices[np.argsort(height[ring_vertices], kind="stable")].reshape(m, n)
    kinds = [NGON if counts.ngons else FAN if len(bottom_tip) else OPEN]
    kinds.append(FAN if len(top_tip) else NGON if counts.ngons == 2 else OPEN)
    tip_at = [int(t[0]) if len(t) else -1 for t in (bottom_tip, top_tip)]
    size = np.abs(height).max()
    raised = [
        t >= 0 and abs(height[t] - height[row].mean()) > POSITION_TOLERANCE * size
        for t, row in zip(tip_at, grid[[0, -1]], strict=True)
    ]
    down = raised[0] if raised[0] != raised[1] else normal[np.argmax(np.abs(normal))] < 0
    if down and m > 1:
        grid, normal = grid[::-1], -normal
        kinds.reverse()
        tip_at.reverse()
    return grid, (kinds[0], kinds[1]), np.array(tip_at), normal


def _place(points, grid, tips, normal, ends, counts) -> Revolution:
    """The lattice's space and its rings in it, from the vertices of the rings (m, n) and the tips (2,)."""
    rows = points[grid]
    centres = rows.mean(1)
    spokes = (rows - centres[:, None]).reshape(-1, 3)
    low = points[tips[0]] if tips[0] >= 0 else centres[0]
    high = points[tips[1]] if tips[1] >= 0 else centres[-1]
    rounding = ROUNDING * np.abs(points).max()
    basis, similar, length = _basis(spokes, high - low, normal, rounding, counts.rings == 1)
    inverse = np.linalg.inv(basis)
    local = (points - low) @ inverse.T
    x, y, z = np.moveaxis(local[grid], -1, 0)
    z, radius = z.mean(1), np.hypot(x, y).mean(1)
    tolerance = POSITION_TOLERANCE * min(radius.max(), length) + rounding * max(1.0, np.linalg.norm(inverse, 2))
    tip_z = tuple(float(local[t, 2]) if t >= 0 else np.nan for t in tips)
    raised = tuple(bool(abs(h - ring) > tolerance) for h, ring in zip(tip_z, z[[0, -1]], strict=True))
    zero = np.zeros(len(points), np.int64)
    return Revolution(
        counts, low, basis, similar, local, zero, zero.copy(), 0.0, z, radius, ends, tip_z, raised, tolerance
    )


def _basis(spokes, axis, normal, rounding, may_be_flat) -> tuple[np.ndarray, bool, float]:
    """The basis of lattice space, whether it is a rotation, and its height (infinite if it is flat).

    The spokes (m n, 3) from the rings' centres to their vertices scatter like a disc's rim, stretched into an
    ellipse by the in-plane part of the affine map; the axis (3,) from the lowest centre to the highest gives
    the rest.
    """
    values, vectors = np.linalg.eigh(2 * spokes.T @ spokes / len(spokes))
    narrow, wide = np.sqrt(np.maximum(values[1:], 0.0))
    normal = vectors[:, 0] * np.sign(vectors[:, 0] @ normal)
    length, radius = axis @ normal, np.sqrt((spokes * spokes).sum(1).max())
    if narrow <= rounding:
        raise StaysMesh(IRREGULAR)
    if may_be_flat and length <= POSITION_TOLERANCE * radius + rounding:
        axis, length = normal, np.inf
    elif length <= rounding:
        raise StaysMesh("it is flat")
    lean = np.linalg.norm(axis - axis @ normal * normal)
    upright = lean <= (POSITION_TOLERANCE * min(radius, length) + rounding) * max(1.0, axis @ normal / radius)
    side = vectors[:, 2]
    if upright and wide - narrow <= POSITION_TOLERANCE * wide + rounding:
        up = axis / np.linalg.norm(axis) if axis @ normal > radius else normal  # whichever is known better
        side = side - (side @ up) * up
        side /= np.linalg.norm(side)
        return np.stack([side, np.cross(up, side), up], 1), True, length
    mean = np.sqrt(wide * narrow)
    columns = side * wide / mean, np.cross(normal, side) * narrow / mean, axis / (axis @ normal)
    return np.stack(columns, 1), False, length


def _meridians(lattice: Revolution, grid: np.ndarray, tips: np.ndarray) -> None:
    """Give each vertex its ring and meridian; StaysMesh where one is off its place, or two share it."""
    (m, n), local = grid.shape, lattice.points
    x, y, z = np.moveaxis(local[grid], -1, 0)
    angle = np.arctan2(y, x)
    widest = np.argmax(lattice.radius)
    steps = (angle - angle[widest, 0]) * n / (2 * np.pi)
    weight = np.broadcast_to(lattice.radius[:, None] ** 2, (m, n))
    lattice.phase = float(angle[widest, 0] + np.average(steps - np.rint(steps), weights=weight) * 2 * np.pi / n)
    meridian = np.rint(steps).astype(np.int64) % n
    ideal = lattice.phase + 2 * np.pi * meridian / n
    radius = lattice.radius[:, None]
    off = np.hypot(np.hypot(x - radius * np.cos(ideal), y - radius * np.sin(ideal)), z - lattice.z[:, None])
    tip = tips[tips >= 0]
    worst = max(off.max(), np.hypot(*local[tip, :2].T).max(initial=0.0))
    if not worst <= lattice.tolerance:
        raise StaysMesh(f"{IRREGULAR} (off by {worst / lattice.radius.max():.2g} of the radius)")
    if np.bincount((np.arange(m)[:, None] * n + meridian).ravel(), minlength=m * n).max() > 1:
        raise StaysMesh(IRREGULAR)
    lattice.ring[grid] = np.arange(m)[:, None]
    lattice.meridian[grid] = meridian
    lattice.ring[tips[:1][tips[:1] >= 0]] = -1
    lattice.ring[tips[1:][tips[1:] >= 0]] = m


def _check_faces(mesh: MeshArrays, lattice: Revolution) -> None:
    """StaysMesh unless each face is a cell of the lattice, each cell once.

    Each edge must be one step of the lattice and each directed edge occur once; with the counts given, and
    faces that all look outward (``facing``), no other set of faces is possible.
    """
    m, n = lattice.counts.rings, lattice.counts.segments
    start, end = mesh.corner_vertex, mesh.edge_end
    k0, k1 = lattice.ring[start], lattice.ring[end]
    across = np.abs(k1 - k0)
    around = (lattice.meridian[end] - lattice.meridian[start]) % n
    at_tip = (k0 < 0) | (k0 == m) | (k1 < 0) | (k1 == m)
    step = np.where(
        across == 0, ((around == 1) | (around == n - 1)) & ~at_tip, (across == 1) & ((around == 0) | at_tip)
    )
    capping = np.repeat(mesh.face_size == n, mesh.face_size)
    keys = mesh.directed_edges()
    if not step.all() or (keys[1:] == keys[:-1]).any() or across[capping].any():
        raise StaysMesh("its faces do not join neighbouring vertices of the rings")


def facing(mesh: MeshArrays, points: np.ndarray, inside: np.ndarray | None) -> np.ndarray:
    """(f,) float, positive where a face looks away from ``inside`` (3,), or along +z where that is None."""
    first, size = mesh.face_offset[:-1], mesh.face_size
    p0, p1, p2 = (points[mesh.corner_vertex[first + size * i // 3]] for i in range(3))
    a, b = p1 - p0, p2 - p0
    if inside is None:
        return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return np.einsum("fi,fi->f", np.cross(a, b), p0 - inside)


def check_outward(mesh: MeshArrays, points: np.ndarray, inside: np.ndarray) -> None:
    """StaysMesh unless every face looks away from the point ``inside`` (3,)."""
    side = facing(mesh, points, inside)
    if (side < 0).all():
        raise StaysMesh("its normals point inward (Mesh > Normals > Recalculate Outside)")
    if not (side > 0).all():
        raise StaysMesh("its normals point both inward and outward (Mesh > Normals > Recalculate Outside)")
