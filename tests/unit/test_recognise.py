"""Recognition of meshes made here with numpy: what must be found exactly, and what must stay a mesh."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.sync.recognise import MeshArrays, recognise
from tests.exact_shapes import assert_exact
from tests.made_meshes import (
    CUBE,
    CUBE_FACES,
    capsule,
    cylinder,
    edge_turned,
    flipped,
    ico_sphere,
    joined,
    last_face,
    lattice,
    mesh_of,
    moved,
    one_flipped,
    removed,
    rotation,
    shuffled,
    torus,
    twisted,
    uv_sphere,
)

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
    "sphere, an edge turned": (edge_turned(uv_sphere()), "do not join neighbouring vertices"),
    "sphere, few rings": (uv_sphere(12, 5), "5 rings are too few for a sphere (6 or more)"),
    "sphere, few segments": (uv_sphere(10, 8), "10 sides are too few for a sphere (12 or more)"),
    "sphere, a vertex at NaN": (moved(uv_sphere(), 100, [np.nan, 0, 0]), "NaN"),
    "two spheres": (joined(uv_sphere(), moved(uv_sphere(), slice(None), [3, 0, 0])), "not those of"),
    "capsule": (capsule(), "neither a circle nor a straight line"),
    "octagonal prism": (cylinder(8), "8 sides are too few for a cylinder (12 or more)"),
    "hexagonal pyramid": (
        lattice([1.0], [0.0], 6, "NGON", 1.0),
        "6 sides are too few for a cone (12 or more)",
    ),
    "octagon": (lattice([1.0], [0.0], 8, "NGON"), "8 sides are too few for a disc (12 or more)"),
    "cylinder, a vertex moved": (moved(cylinder(), 3, [0, 0, 0.02]), "not on the regular rings"),
    "cylinder, a side missing": (removed(cylinder(), [3]), "not those of"),
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
    "flat ring": (lattice([1.0, 0.5], [0.0, 0.0], 32), "it is flat"),
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


def test_a_million_vertices_are_refused():
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
