"""Meshes made with numpy, and damage done to them. A mesh is (vertices (v, 3), faces, uv), the last two lists."""

import numpy as np

from addon.sync.recognise import MeshArrays


def mesh_of(vertices, faces, uv=None, smooth=True, material=0) -> MeshArrays:
    """MeshArrays of vertices (v, 3), faces (lists of vertex indices) and uv (a list of pairs for each face)."""
    sizes = [len(face) for face in faces]
    return MeshArrays(
        np.array(vertices, np.float32),
        np.concatenate(faces).astype(np.int32),
        np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32),
        np.full(len(faces), smooth),
        np.full(len(faces), material, np.int32),
        None if uv is None else np.concatenate(uv).astype(np.float32),
    )


def lattice(radius, z, n, bottom=None, top=None, phase=0.3, side_uv=(1, 1, 0, 0), cap_uv=(0.48, 0.48, 0.01, 0.01)):
    """Vertices, faces and uv of rings with radius (m,) at z (m,); bottom and top: None, "NGON" or the tip's height.

    The side's uv is side_uv of (theta / 2 pi, height), theta from ``phase``; flat ends have cap_uv of a disc's.
    """
    m, angle = len(z), phase + 2 * np.pi * np.arange(n) / n
    around = np.stack([np.cos(angle), np.sin(angle)], 1)
    rings = [np.column_stack([r * around, np.full(n, h)]) for r, h in zip(radius, z, strict=True)]
    tips = [h for h in (bottom, top) if isinstance(h, float)]
    vertices = np.concatenate([*rings, np.reshape([[0, 0, h] for h in tips], (-1, 3))])
    low, high = (min([*z, *tips]), max([*z, *tips]))

    def of_side(j, h):
        return side_uv[0] * j / n + side_uv[2], side_uv[1] * (h - low) / ((high - low) or 1) + side_uv[3]

    def of_cap(xy, r, sign):
        return [cap_uv[k] * ([1, sign][k] * xy[k] / (2 * r) + 0.5) + cap_uv[2 + k] for k in (0, 1)]

    faces, uv = [], []
    for k in range(m - 1):
        for j in range(n):
            i = (j + 1) % n
            faces.append([k * n + j, k * n + i, (k + 1) * n + i, (k + 1) * n + j])
            uv.append([of_side(j, z[k]), of_side(j + 1, z[k]), of_side(j + 1, z[k + 1]), of_side(j, z[k + 1])])
    tip_vertex = m * n
    for end, k, sign in ((bottom, 0, -1), (top, m - 1, 1)):
        ring = [k * n + j for j in range(n)][::sign]
        if end == "NGON":
            faces.append(ring)
            uv.append([of_cap(vertices[v, :2], radius[k], sign) for v in ring])
        elif end is not None:
            for j in range(n):
                a, b = (j, (j + 1) % n)[::sign]
                faces.append([k * n + a, k * n + b, tip_vertex])
                if end == z[k]:
                    uv.append([of_cap(vertices[v, :2], radius[k], sign) for v in faces[-1]])
                else:
                    uv.append([of_side(x, h) for x, h in zip((j, j + 1)[::sign], (z[k], z[k]), strict=True)])
                    uv[-1].append(of_side(j + 0.5, end))
            tip_vertex += 1
    return vertices, faces, uv


def uv_sphere(n=32, rings=16, **settings):
    """A UV sphere of radius 1 with the paper's uv (whose v is linear in the angle, not in the height)."""
    theta = np.pi * np.arange(rings - 1, 0, -1) / rings
    vertices, faces, uv = lattice(np.sin(theta), np.cos(theta), n, -1.0, 1.0, **settings)
    height = np.arccos(np.clip(vertices[:, 2], -1, 1))
    uv = [[(u, 1 - height[v] / np.pi) for (u, _), v in zip(c, f, strict=True)] for c, f in zip(uv, faces, strict=True)]
    return vertices, faces, uv


def ico_sphere(m):
    """An icosahedron with its faces divided into m x m triangles, pushed out to the unit sphere."""
    g = (1 + 5**0.5) / 2
    corners = np.array([[0, s, t * g] for s in (-1, 1) for t in (-1, 1)])
    corners = np.concatenate([np.roll(corners, i, 1) for i in range(3)]) / np.hypot(1, g)
    index, vertices, faces = {}, [], []
    near = corners @ corners.T > 0.4
    triples = [
        (a, b, c) for a in range(12) for b in range(a) for c in range(b) if near[a, b] and near[b, c] and near[a, c]
    ]
    for triple in triples:
        a, b, c = corners[list(triple)]
        if np.dot(np.cross(b - a, c - a), a) < 0:
            b, c = c, b
        place = {}
        for i in range(m + 1):
            for j in range(m + 1 - i):
                p = a * (m - i - j) + b * i + c * j
                p /= np.linalg.norm(p)
                key = tuple(np.round(p, 6) + 0.0)
                place[i, j] = index.setdefault(key, len(vertices))
                if place[i, j] == len(vertices):
                    vertices.append(p)
        for i, j in place:
            if i + j < m:
                faces.append([place[i, j], place[i + 1, j], place[i, j + 1]])
            if i and i + j < m:
                faces.append([place[i, j], place[i, j + 1], place[i - 1, j + 1]])
    return np.array(vertices), faces


def shuffled(mesh: tuple, seed: int):
    """The mesh with vertices and faces in another order, and each face beginning at another corner."""
    vertices, faces, uv = mesh
    rng = np.random.default_rng(seed)
    order, place = rng.permutation(len(vertices)), np.empty(len(vertices), int)
    place[order] = np.arange(len(vertices))
    starts = rng.integers(0, 3, len(faces))
    rows = rng.permutation(len(faces))
    new_faces = [np.roll(place[faces[f]], starts[f]) for f in rows]
    return vertices[order], new_faces, [np.roll(uv[f], starts[f], axis=0) for f in rows]


def rotation(seed: int) -> np.ndarray:
    """A random rotation (3, 3)."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q * np.sign(np.linalg.det(q))


def removed(mesh, faces):
    """The mesh without the faces with these indices."""
    vertices, old, uv = mesh
    keep = [f for f in range(len(old)) if f not in faces]
    return vertices, [old[f] for f in keep], [uv[f] for f in keep]


def moved(mesh, vertex, by):
    """The mesh with one vertex moved."""
    vertices = mesh[0].copy()
    vertices[vertex] += by
    return vertices, *mesh[1:]


def capsule():
    theta = np.pi * np.arange(15, 0, -1) / 16
    z = np.cos(theta) + np.where(theta < 1.6, 1.0, -1.0)
    return lattice(np.sin(theta), z, 32, -2.0, 2.0)


def torus(m=16, n=12):
    a, b = np.meshgrid(2 * np.pi * np.arange(m) / m, 2 * np.pi * np.arange(n) / n, indexing="ij")
    r = 1 + 0.25 * np.cos(b)
    faces = [
        [i * n + j, (i + 1) % m * n + j, (i + 1) % m * n + (j + 1) % n, i * n + (j + 1) % n]
        for i in range(m)
        for j in range(n)
    ]
    return np.stack([r * np.cos(a), r * np.sin(a), 0.25 * np.sin(b)], -1).reshape(-1, 3), faces


def joined(a, b):
    """Two meshes in one."""
    return np.concatenate([a[0], b[0]]), a[1] + [list(np.add(f, len(a[0]))) for f in b[1]], a[2] + b[2]


def flipped(mesh):
    vertices, faces, uv = mesh
    return vertices, [f[::-1] for f in faces], [c[::-1] for c in uv]


def one_flipped(mesh):
    vertices, faces, uv = mesh
    return vertices, [faces[0][::-1], *faces[1:]], uv


def twisted(mesh):
    """The mesh with one face joined to another vertex of the next ring."""
    vertices, faces, uv = mesh
    return vertices, [[*faces[0][:3], faces[2][3]], *faces[1:]], uv


def edge_turned(mesh):
    """The mesh with the edge between its first two quads turned, so that it joins the corners before and after."""
    vertices, faces, uv = mesh
    (a, b, e, f), (_, c, d, _) = faces[:2]
    return vertices, [[a, b, c, d], [a, d, e, f], *faces[2:]], uv


def cylinder(n=32):
    return lattice([1.0, 1.0], [-1.0, 1.0], n, "NGON", "NGON")


def last_face(mesh, face):
    """The mesh with another last face (a list of indices, or a function of the old one)."""
    vertices, faces, uv = mesh
    face = face(faces[-1]) if callable(face) else face
    return vertices, [*faces[:-1], face], [*uv[:-1], uv[-1][: len(face)]]


CUBE = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
CUBE_FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
