"""Recognition of meshes made here with numpy: what must be found exactly, and what must stay a mesh."""

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.sync.recognise import MeshArrays, recognise
from tests.exact_shapes import assert_exact


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


SHAPES = {
    "sphere": lambda n: uv_sphere(n, 9),
    "cylinder": lambda n: lattice([0.5, 0.5], [-1.0, 2.0], n, "NGON", "NGON"),
    "cylinder fan": lambda n: lattice([0.5, 0.5], [-1.0, 2.0], n, -1.0, 2.0),
    "cylinder, one cap": lambda n: lattice([0.5, 0.5], [-1.0, 2.0], n, None, 2.0),
    "cylinder, two kinds of caps": lambda n: lattice([0.5, 0.5], [-1.0, 2.0], n, -1.0, "NGON"),
    "cylinder, open": lambda n: lattice([0.5, 0.5], [-1.0, 2.0], n),
    "cylinder, loop cuts": lambda n: lattice([0.5] * 4, [-1.0, 0.1, 0.3, 2.0], n, "NGON", 2.0),
    "cylinder, loop cuts, open": lambda n: lattice([0.5] * 4, [-1.0, 0.1, 0.3, 2.0], n),
    "truncated": lambda n: lattice([1.0, 0.25], [-1.0, 1.0], n, "NGON", 1.0),
    "truncated, wide top": lambda n: lattice([0.25, 1.0], [-1.0, 1.0], n, None, "NGON"),
    "truncated, scaled uv": lambda n: lattice([0.25, 1.0], [0.0, 3.0], n, side_uv=(0.7, -0.5, 0.2, 0.9)),
    "cylinder, uv twice around": lambda n: lattice([2.0, 2.0], [0.0, 3.0], n, "NGON", side_uv=(-2, 3, 0.25, 0.1)),
    "cone": lambda n: lattice([1.0], [-1.0], n, "NGON", 1.0),
    "cone fan": lambda n: lattice([1.0], [-1.0], n, -1.0, 1.0),
    "cone, open": lambda n: lattice([1.0], [-1.0], n, None, 1.0),
    "cone, downward": lambda n: lattice([1.0], [-1.0], n, -2.0, "NGON"),
    "cone, loop cut": lambda n: lattice([1.0, 0.5], [-1.0, 0.0], n, "NGON", 1.0),
    "disc": lambda n: lattice([3.0], [0.5], n, top="NGON"),
    "disc fan": lambda n: lattice([3.0], [0.5], n, top=0.5),
    "disc, downward": lambda n: lattice([3.0], [0.5], n, bottom="NGON"),
}
KINDS = {"sphere": "SPHERE", "cylinder": "CYLINDER", "truncated": "CONE", "cone": "CONE", "disc": "DISC"}


@pytest.mark.parametrize("name", SHAPES)
@settings(max_examples=20)
@given(
    n=st.integers(12, 40),
    seed=st.integers(0, 2**16),
    size=st.floats(-4, 4).map(lambda e: 10**e),
    away=st.sampled_from([0.0, 1.0, 30.0]),
)
def test_found_exactly_at_any_size_and_place(name, n, seed, size, away):
    vertices, faces, uv = shuffled(SHAPES[name](n), seed)
    centre = np.random.default_rng(seed).normal(size=3) * away * size
    mesh = mesh_of(size * (vertices @ rotation(seed).T) + centre, faces, uv)
    found = recognise(mesh)
    assert found.kind == KINDS[name.replace(",", " ").split()[0]], found.reason
    assert found.local is None
    assert found.all_smooth
    assert_exact(mesh, found)


@pytest.mark.parametrize("name", SHAPES)
@settings(max_examples=20)
@given(
    n=st.integers(12, 40),
    seed=st.integers(0, 2**16),
    stretch=st.tuples(*[st.floats(0.3, 3)] * 3),
    shear=st.floats(-1, 1),
)
def test_stretched_shapes_carry_an_affine_map(name, n, seed, stretch, shear):
    vertices, faces, uv = shuffled(SHAPES[name](n), seed)
    affine = rotation(seed) @ np.diag(stretch) @ (np.eye(3) + shear * np.eye(3, k=1)) @ rotation(seed + 1)
    mesh = mesh_of(vertices @ affine.T + 1, faces, uv)
    found = recognise(mesh)
    assert found.kind == KINDS[name.replace(",", " ").split()[0]], found.reason
    assert_exact(mesh, found)


def test_sphere_in_full():
    vertices, faces, uv = uv_sphere(phase=0.0)
    found = recognise(mesh_of(2 * vertices + [1, 2, 3], faces, uv, material=4))
    (part,) = found.parts
    assert (found.kind, found.reason) == ("SPHERE", "UV sphere, 32 segments, 16 rings")
    assert np.allclose(part.centre, [1, 2, 3], atol=1e-6) and abs(part.radius - 2) < 1e-6
    assert np.allclose(part.frame, np.eye(3), atol=1e-6)
    assert (part.material, part.uv.transform, found.uv_matches) == (4, (1, 1, 0, 0), True)


def test_offset_of_u_turns_the_sphere():
    vertices, faces, uv = uv_sphere(phase=0.0, side_uv=(1, 1, 0.25, 0))
    (part,) = recognise(mesh_of(vertices, faces, uv)).parts
    assert np.allclose(part.frame[:, 0], [0, -1, 0], atol=1e-6)


def test_mirrored_and_scaled_sphere_maps_do_not_match():
    for side_uv in ((-1, 1, 0, 0), (2, 1, 0, 0)):
        found = recognise(mesh_of(*uv_sphere(side_uv=side_uv)))
        assert found.kind == "SPHERE" and not found.uv_matches


def test_truncated_cone_in_full():
    mesh = mesh_of(*lattice([1.0, 0.25], [-1.0, 1.0], 16, "NGON", 1.0, phase=0.0, side_uv=(1, 0.5, 0, 0.5)))
    found = recognise(mesh)
    side, bottom, top = found.parts
    assert found.reason == "truncated cone, 16 sides, 2 caps"
    assert np.allclose([side.length, side.radius_base, side.radius_apex], [2, 1, 0.25], atol=1e-6)
    assert np.allclose([side.base, side.axis, side.e0], [[0, 0, -1], [0, 0, 1], [1, 0, 0]], atol=1e-6)
    assert np.allclose(side.uv.transform, [1, 0.5, 0, 0.5], atol=1e-6) and not side.uv.planar
    assert np.allclose([bottom.centre, bottom.normal], [[0, 0, -1], [0, 0, -1]], atol=1e-6)
    assert np.allclose([top.centre, top.normal], [[0, 0, 1], [0, 0, 1]], atol=1e-6)
    assert np.allclose([bottom.radius, top.radius], [1, 0.25], atol=1e-6)


@pytest.mark.parametrize("m", [2, 3, 4, 8])
@settings(max_examples=10)
@given(seed=st.integers(0, 2**16), stretch=st.tuples(*[st.floats(0.3, 3)] * 3), stretched=st.booleans())
def test_ico_spheres(m, seed, stretch, stretched):
    vertices, faces = ico_sphere(m)
    mesh = mesh_of(vertices @ rotation(seed).T * (stretch if stretched else stretch[0]) + 2, faces)
    found = recognise(mesh)
    assert found.kind == "SPHERE", found.reason
    if not stretched or max(stretch) > 1.001 * min(stretch):
        assert (found.local is not None) == stretched
    assert_exact(mesh, found)


def test_an_icosahedron_is_no_sphere():
    found = recognise(mesh_of(*ico_sphere(1)))
    assert found.kind == "MESH" and "icosahedron" in found.reason


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


def cylinder(n=32):
    return lattice([1.0, 1.0], [-1.0, 1.0], n, "NGON", "NGON")


def last_face(mesh, face):
    """The mesh with another last face (a list of indices, or a function of the old one)."""
    vertices, faces, uv = mesh
    face = face(faces[-1]) if callable(face) else face
    return vertices, [*faces[:-1], face], [*uv[:-1], uv[-1][: len(face)]]


CUBE = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
CUBE_FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
NAN = [float("nan"), 0, 0]
MESHES = {
    "sphere, a vertex moved out": (moved(uv_sphere(), 100, [0.01, 0, 0]), "not on the regular rings"),
    "sphere, a vertex moved along": (moved(uv_sphere(), 240, [0, 0, 0.01]), "not on the regular rings"),
    "sphere, a pole moved": (moved(uv_sphere(), 480, [0, 0, 0.01]), "neither a circle nor a straight line"),
    "sphere, a face missing": (removed(uv_sphere(), [100]), "faces of a UV or ico sphere are missing"),
    "sphere, its cap missing": (removed(uv_sphere(), range(448, 480)), "missing"),
    "sphere, a face twice and one missing": (last_face(uv_sphere(), uv_sphere()[1][-2]), "do not join"),
    "sphere, inside out": (flipped(uv_sphere()), "normals point inward"),
    "sphere, one face inside out": (one_flipped(uv_sphere()), "rings"),
    "sphere, a face twisted": (twisted(uv_sphere()), "do not join neighbouring vertices"),
    "sphere, few rings": (uv_sphere(12, 5), "5 rings are too few for a sphere (6 or more)"),
    "sphere, few segments": (uv_sphere(10, 8), "10 sides are too few for a sphere (12 or more)"),
    "sphere, a vertex at NaN": (moved(uv_sphere(), 100, NAN), "NaN"),
    "two spheres": (joined(uv_sphere(), moved(uv_sphere(), slice(None), [3, 0, 0])), ""),
    "capsule": (capsule(), "neither a circle nor a straight line"),
    "octagonal prism": (cylinder(8), "8 sides are too few for a cylinder (12 or more)"),
    "hexagonal pyramid": (
        lattice([1.0], [0.0], 6, "NGON", 1.0),
        "6 sides are too few for a cone (12 or more)",
    ),
    "octagon": (lattice([1.0], [0.0], 8, "NGON"), "8 sides are too few for a disc (12 or more)"),
    "cylinder, a vertex moved": (moved(cylinder(), 3, [0, 0, 0.02]), "not on the regular rings"),
    "cylinder, a side missing": (removed(cylinder(), [3]), ""),
    "cylinder, inside out": (flipped(cylinder()), "normals point inward"),
    "cylinder, a cap inside out": (last_face(cylinder(), lambda face: face[::-1]), "do not join"),
    "cylinder, a raised cap": (lattice([1.0, 1.0], [-1.0, 1.0], 32, "NGON", 1.3), "neither a circle"),
    "bevelled cylinder": (
        lattice([0.9, 1.0, 1.0, 0.9], [-1.0, -0.9, 0.9, 1.0], 32, "NGON", "NGON"),
        "neither a circle",
    ),
    "waisted cylinder": (lattice([1.0, 0.9, 1.0], [-1.0, 0.0, 1.0], 32, "NGON", "NGON"), "neither a circle"),
    "double cone": (lattice([1.0], [0.0], 32, -1.0, 1.0), "two cones"),
    "two-sided disc": (lattice([1.0], [0.0], 32, "NGON", 0.0), "two sides"),
    "flat ring": (lattice([1.0, 0.5], [0.0, 0.0], 32), ""),
    "cube": ((CUBE, CUBE_FACES), "not those of a sphere, cylinder, cone or disc"),
    "torus": (torus(), "not those of"),
    "plane": (([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]]), "not those of"),
}


@pytest.mark.parametrize("name", MESHES)
def test_stays_a_mesh_with_a_reason(name):
    mesh, reason = MESHES[name]
    found = recognise(mesh_of(*mesh))
    assert found.kind == "MESH" and not found.parts
    assert found.reason.startswith("mesh: ") and reason in found.reason, found.reason


@given(seed=st.integers(0, 2**16), name=st.sampled_from(list(SHAPES)), by=st.floats(0.01, 0.5))
def test_any_vertex_moved_by_a_hundredth_is_seen(seed, name, by):
    vertices, faces, uv = SHAPES[name](24)
    rng = np.random.default_rng(seed)
    direction = rng.normal(size=3)
    reach = np.ptp(vertices, axis=0).max()
    vertices = vertices.copy()
    if "disc" in name:
        direction[2] = abs(direction[2]) + 1  # along its plane, the middle of a fan could move unseen but for the uv
    vertices[rng.integers(len(vertices))] += by * reach * direction / np.linalg.norm(direction)
    found = recognise(mesh_of(vertices, faces, uv))
    sheared = found.kind == "CONE" and found.local is not None  # a cone whose tip moved is an oblique cone
    assert found.kind == "MESH" or sheared, found.reason


@given(seed=st.integers(0, 2**16), name=st.sampled_from(list(SHAPES)))
def test_any_face_removed_or_turned_is_seen(seed, name):
    vertices, faces, uv = SHAPES[name](24)
    rng = np.random.default_rng(seed)
    chosen = int(rng.integers(len(faces)))
    if len(faces) == 1 or len(faces[chosen]) == 24:
        return  # a cap less is an open cylinder
    assert recognise(mesh_of(*removed((vertices, faces, uv), [chosen]))).kind == "MESH"
    faces[chosen] = faces[chosen][::-1]
    assert recognise(mesh_of(vertices, faces, uv)).kind == "MESH"


def test_no_faces():
    mesh = MeshArrays(
        np.zeros((3, 3), np.float32),
        *(np.zeros(n, np.int32) for n in (0, 1)),
        np.zeros(0, bool),
        np.zeros(0, np.int32),
    )
    assert recognise(mesh).reason == "mesh: it has no faces"


def test_materials_may_differ_between_parts_only():
    mesh = mesh_of(*cylinder())
    mesh.material[-2:] = [1, 2]
    assert [part.material for part in recognise(mesh).parts] == [0, 1, 2]
    mesh.material[3] = 5
    assert recognise(mesh).reason == "mesh: the side has faces of more than one material"


def test_smooth_is_asked_of_the_curved_faces():
    mesh = mesh_of(*cylinder())
    mesh.smooth[-2:] = False
    assert recognise(mesh).all_smooth
    mesh.smooth[3] = False
    assert not recognise(mesh).all_smooth


def test_planar_map_of_a_cone():
    vertices, faces, _ = lattice([1.0], [-1.0], 20, "NGON", 1.0)
    uv = [[(0.3 * vertices[v, 0] + 0.5, -0.2 * vertices[v, 1] + 0.25) for v in face] for face in faces]
    mesh = mesh_of(vertices, faces, uv)
    found = recognise(mesh)
    assert found.parts[0].uv.planar
    assert_exact(mesh, found)


def test_an_unrelated_map_does_not_match():
    rng = np.random.default_rng(1)
    for name, make in SHAPES.items():
        vertices, faces, uv = make(16)
        found = recognise(mesh_of(vertices, faces, [rng.random((len(c), 2)) for c in uv]))
        assert found.kind != "MESH" and not found.uv_matches, name
        found = recognise(mesh_of(vertices, faces))
        assert found.kind != "MESH" and found.uv_matches, name


def seconds(mesh: MeshArrays) -> float:
    """The shortest of a few recognitions."""
    times = []
    for _ in range(5):
        fresh = MeshArrays(mesh.positions, mesh.corner_vertex, mesh.face_offset, mesh.smooth, mesh.material, mesh.uv)
        start = time.perf_counter()
        recognise(fresh)
        times.append(time.perf_counter() - start)
    return min(times)


def test_a_million_vertices_are_refused_at_a_glance():
    side = 1000
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    quads = np.stack([corner, corner + 1, corner + side + 1, corner + side], 1).astype(np.int32)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    points = np.random.default_rng(0).random((side * side, 3), np.float32)
    for faces in (quads, triangles, triangles[: 2 * (side * side - 2)]):
        count, size = faces.shape
        offset = np.arange(0, count * size + 1, size, dtype=np.int32)
        mesh = MeshArrays(points, faces.ravel(), offset, np.ones(count, bool), np.zeros(count, np.int32))
        assert recognise(mesh).kind == "MESH"
        assert seconds(mesh) < 0.02


def test_a_thousand_spheres_take_about_a_second():
    assert seconds(mesh_of(*uv_sphere())) < 0.005
