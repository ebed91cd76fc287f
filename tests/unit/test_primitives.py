"""The columns of primitives: what is checked, what the messages say, how shapes move."""

import re

import numpy as np
import pytest

from addon.engine.errors import SceneError
from addon.engine.primitives import (
    BY_KIND,
    AxialStretch,
    Cones,
    Cylinders,
    Discs,
    Planes,
    Similarity,
    Spheres,
    Triangles,
    invertible,
    keeps_round,
    keeps_shapes,
    thickened,
)

ALL = {
    "sphere": lambda n=2: Spheres(center=np.zeros((n, 3)), radius=np.ones(n)),
    "cylinder": lambda n=2: Cylinders(base=np.zeros((n, 3)), apex=np.tile([0, 0, 2.0], (n, 1)), radius=np.ones(n)),
    "cone": lambda n=2: Cones(base=np.zeros((n, 3)), apex=np.tile([0, 0, 2.0], (n, 1)), base_radius=np.ones(n)),
    "disc": lambda n=2: Discs(center=np.zeros((n, 3)), normal=np.tile([0, 0, 1.0], (n, 1)), radius=np.ones(n)),
    "triangle": lambda n=2: Triangles(
        p0=np.zeros((n, 3)), p1=np.tile([1.0, 0, 0], (n, 1)), p2=np.tile([0, 1.0, 0], (n, 1))
    ),
    "plane": lambda n=2: Planes(point=np.zeros((n, 3)), normal=np.tile([0, 0, 1.0], (n, 1))),
}
each = pytest.mark.parametrize("kind", ALL)


@each
def test_a_kind_knows_itself(kind):
    made = ALL[kind](3)
    assert made.kind == kind and len(made) == 3
    hit, surface = made.records()
    assert hit.dtype == made.record.dtype and surface.dtype == made.surface_record.dtype
    assert len(hit) == len(surface) == 3
    for column in made.columns:
        assert getattr(made, column.name).shape == ((3, column.width) if column.width else (3,))


@each
def test_none_at_all(kind):
    made = ALL[kind](0)
    assert len(made) == 0 and len(made.records()[0]) == 0


def test_one_value_stands_for_all_rows():
    spheres = Spheres(center=[[0, 0, 0], [1, 0, 0], [2, 0, 0]], radius=0.5, material=7)
    assert spheres.radius.tolist() == [0.5] * 3 and spheres.material.tolist() == [7] * 3
    assert Spheres(center=[0, 0, 0], radius=1.0).center.shape == (1, 3)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Spheres(center=[[0, 0]], radius=[1]), "sphere: center has shape (1, 2), expected (n, 3)"),
        (lambda: Spheres(center=[[0, 0, 0]], radius=[[1]]), "sphere: radius has shape (1, 1), expected (n,)"),
        (
            lambda: Spheres(center=np.zeros((3, 3)), radius=[1, 1]),
            "sphere: the arrays have different numbers of rows: {'center': 3, 'radius': 2",
        ),
        (lambda: Spheres(center=[[0, 0, 0], [0, np.nan, 0]], radius=1), "sphere: center of number 1 is not finite"),
        (lambda: Spheres(center=[[0, 0, 0]] * 3, radius=[1, 2, np.inf]), "sphere: radius of number 2 is not finite"),
        (lambda: Spheres(center=[[0, 0, 0]] * 3, radius=[1, 0, 0]), "sphere number 1: the radius is 0"),
        (lambda: Spheres(center=[[0, 0, 0]] * 3, radius=[1, 0, 0]), "(2 in all)"),
        (lambda: Spheres(center=[[0, 0, 0]], radius=1, pole=[[0, 0, 0]]), "sphere: pole of number 0 has no length"),
        (lambda: Cylinders(base=[[0, 0, 0]], apex=[[0, 0, 0]], radius=1), "cylinder number 0: both ends are the same"),
        (lambda: Cylinders(base=[[0, 0, 0]], apex=[[0, 0, 1]], radius=0), "cylinder number 0: the radius is 0"),
        (lambda: Cones(base=[[0, 0, 0]], apex=[[0, 0, 1]], base_radius=0), "cone number 0: both radii are 0"),
        (
            lambda: Cones(base=[[0, 0, 0]], apex=[[0, 0, 1]], base_radius=1, apex_radius=-1),
            "cone number 0: one radius is negative, the other positive",
        ),
        (lambda: Cones(base=[[1, 1, 1]], apex=[[1, 1, 1]], base_radius=1), "cone number 0: both ends are the same"),
        (
            lambda: Discs(center=[[0, 0, 0]], normal=[[0, 0, 1]], radius=-1),
            "disc number 0: the radius must be positive",
        ),
        (lambda: Discs(center=[[0, 0, 0]], normal=[[0, 0, 0]], radius=1), "disc: normal of number 0 has no length"),
        (
            lambda: Planes(point=[[0, 0, 0]], normal=[[0, 0, 1]], tile=0),
            "plane number 0: the tile size must be positive",
        ),
    ],
)
def test_what_is_no_shape_is_refused(make, message):
    with pytest.raises(SceneError, match=re.escape(message)):
        make()


def test_arguments_that_are_missing_or_unknown():
    with pytest.raises(TypeError, match="sphere: argument 'radius' is missing"):
        Spheres(center=[[0, 0, 0]])
    with pytest.raises(TypeError, match="sphere: unknown argument 'colour'"):
        Spheres(center=[[0, 0, 0]], radius=1, colour=3)


def test_directions_are_made_unit():
    disc = Discs(center=[[0, 0, 0]], normal=[[0, 0, 5.0]], radius=1, meridian=[[3.0, 0, 4.0]])
    assert disc.normal.tolist() == [[0, 0, 1]] and np.allclose(np.linalg.norm(disc.meridian, axis=-1), 1.0)
    meridian = disc.records()[1]["meridian"]
    assert np.allclose(meridian, [[1, 0, 0]]), "made perpendicular to the normal"


@pytest.mark.parametrize("cls", [Cylinders, Cones])
def test_a_meridian_along_the_axis_is_replaced(cls):
    radius = {"radius" if cls is Cylinders else "base_radius": 1.0}
    made = cls(base=[[0, 0, 0]], apex=[[0, 0, 1]], meridian=[[0, 0, 1]], **radius)
    meridian = made.records()[1]["meridian"][0]
    assert abs(meridian[2]) < 1e-6 and np.linalg.norm(meridian) == pytest.approx(1.0)


@each
def test_take_and_concatenate(kind):
    made = ALL[kind](5)._with({"material": np.arange(5)})
    assert made.take(np.array([3, 1])).material.tolist() == [3, 1]
    both = type(made).concatenate([made, made.take(np.array([4]))])
    assert both.material.tolist() == [0, 1, 2, 3, 4, 4] and len(both) == 6


@each
def test_one_value_stays_one(kind):
    """No memory for what is the same in all rows, whatever is done with them."""
    made = ALL[kind](4)
    meridian = {"sphere": "pole", "triangle": "uv1"}.get(kind, "meridian")
    move = Similarity(np.eye(3), 2.0, np.ones(3))
    both = type(made).concatenate([made, made])
    for rows in (made, made.take(np.array([2, 1])), made.take(slice(1, 3)), both, both.transformed(move)):
        for name in (meridian, "material"):
            assert getattr(rows, name).strides[0] == 0 and len(getattr(rows, name)) == len(rows), name
    other = type(made).concatenate([made, made._with({"material": np.full(4, 3)})])
    assert other.material.tolist() == [0] * 4 + [3] * 4


@each
def test_attributes_go_along_with_their_rows(kind):
    made = ALL[kind](3)._with({"attributes": {}})
    places = made.attribute_places
    at_each = np.arange(3 * places * 4, dtype=np.float32).reshape(3, places, 4)
    made.attributes = {"each": at_each, "all": np.broadcast_to(np.float32([[[1, 2, 3, 4]]]), (3, 1, 4))}
    taken = made.take(np.array([2, 0])).transformed(Similarity(np.eye(3), 2.0, np.ones(3)))
    assert (taken.attributes["each"] == at_each[[2, 0]]).all() and (taken.attributes["all"] == [1, 2, 3, 4]).all()
    plain = ALL[kind](2)._with({"attributes": {"each": np.full((2, 1, 4), 9, np.float32)}})
    both = type(made).concatenate([plain, made])
    assert (both.attributes["each"][:2] == 9).all() and (both.attributes["each"][2:] == at_each).all()
    assert both.attributes["all"][:, 0, 0].tolist() == [0, 0, 1, 1, 1], "0 where a part has none"


@pytest.mark.parametrize(
    ("value", "shape"),
    [((1, 2, 3, 4), (2, 1, 4)), (np.ones((2, 4)), (2, 1, 4)), (np.ones((2, 3, 4)), (2, 3, 4))],
)
def test_shapes_of_attributes(value, shape):
    corners = {f"p{i}": np.eye(3)[[i, i]] for i in range(3)}
    made = Triangles(**corners, attributes={"color": value})
    assert made.attributes["color"].shape == shape and made.attributes["color"].dtype == np.float32
    assert Spheres(center=np.zeros((2, 3)), radius=1.0).attributes == {}


@pytest.mark.parametrize("value", [1.0, np.ones(3), np.ones((3, 4)), np.ones((2, 2, 4)), np.ones((2, 3, 3))])
def test_attributes_of_other_shapes_are_refused(value):
    message = f"sphere: attribute 'color' has shape {np.shape(value)}, expected (2, 1, 4)"
    with pytest.raises(SceneError, match=re.escape(message)):
        Spheres(center=np.zeros((2, 3)), radius=1.0, attributes={"color": value})


def test_the_uv_of_a_whole_sphere():
    """It stands where the rotation would, told apart by a length that no rotation has."""
    uv = [[0.25, 0.75], [np.nan, np.nan]]
    made = Spheres(center=np.zeros((2, 3)), radius=1.0, pole=[[1.0, 0, 0]], fixed_uv=uv)
    rotation = made.records()[1]["rotation"]
    assert rotation[0].tolist() == [0.25, 0.75, 4.0] and np.linalg.norm(rotation[1]) <= 1.0 + 1e-6
    assert (rotation[1] == made.take(np.array([1])).records()[1]["rotation"][0]).all()
    assert (made.take(np.array([0])).records()[1]["rotation"] == rotation[0]).all(), "one for all, too"
    found = made.reference_surface(np.float64([[0, 1, 0], [0, 1, 0]]))[1]
    assert found[0].tolist() == [0.25, 0.75] and np.isfinite(found[1]).all()


@each
def test_a_similarity_moves_the_shape_and_its_hits(kind):
    """What a moved ray hits of a moved shape is the old hit, moved: t scales, uv stays."""
    rng = np.random.default_rng(0)
    made = ALL[kind](1)
    rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    rotation *= np.sign(np.linalg.det(rotation))
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = 2.5 * rotation, [1.0, -2.0, 3.0]
    similarity = Similarity.of(matrix)
    assert similarity.scale == pytest.approx(2.5)
    target = np.array([0.3, 0.2, 0.0 if kind in ("disc", "triangle", "plane") else 1.0])
    origin = np.array([[3.0, 2.0, 4.0]])
    direction = (target - origin) / np.linalg.norm(target - origin)
    t = made.reference_hit(origin, direction)
    moved = made.transformed(similarity)
    moved_t = moved.reference_hit(similarity.points(origin), similarity.directions(direction))
    assert np.isfinite(t).all() and np.allclose(moved_t, 2.5 * t)
    normal, uv = made.reference_surface(origin + t[:, None] * direction)
    point = similarity.points(origin + t[:, None] * direction)
    moved_normal, moved_uv = moved.reference_surface(point)
    assert np.allclose(moved_uv, uv) and np.allclose(moved_normal, similarity.directions(normal))


def matrix_of(linear):
    matrix = np.eye(4)
    matrix[:3, :3] = linear
    return matrix


@pytest.mark.parametrize(
    "linear",
    [
        np.diag([1, 1, 1.001]),
        np.diag([-1.0, 1, 1]),
        np.zeros((3, 3)),
        np.diag([1.0, 1, 0]),
        [[1, 0.01, 0], [0, 1, 0], [0, 0, 1]],
    ],
)
def test_what_does_not_keep_shapes_is_no_similarity(linear):
    assert not keeps_shapes(matrix_of(linear)[None]).any()


def test_a_float32_rotation_is_a_similarity():
    angle = np.linspace(0, 7, 50)
    for a in angle:
        turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]], np.float32) * np.float32(
            0.3
        )
        assert keeps_shapes(matrix_of(turn)[None]).all()


def turned(seed):
    rotation, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return rotation


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("kind", ["cylinder", "cone", "disc"])
def test_round_bodies_may_be_stretched_along_their_axis(kind, seed):
    """What a ray meets, and its uv, are those of the ray in the space before the stretch."""
    generator, count = np.random.default_rng(seed), 400
    axis = generator.normal(size=3)
    axis /= np.linalg.norm(axis)
    frame = np.linalg.qr(np.stack([axis, *generator.normal(size=(2, 3))], axis=-1))[0][:, ::-1]  # axis last, or -axis
    frame *= np.sign(np.linalg.det(frame))
    middle, meridian = generator.normal(size=(count, 3)), np.tile(frame[:, 0], (count, 1))
    ends = {"base": middle, "apex": middle + axis * generator.uniform(0.3, 2.0, (count, 1)), "meridian": meridian}
    radius = generator.uniform(0.5, 1.0, count)
    body = {
        "cylinder": lambda: Cylinders(**ends, radius=radius),
        "cone": lambda: Cones(**ends, base_radius=radius, apex_radius=0.3 * radius),
        "disc": lambda: Discs(center=middle, normal=np.tile(axis, (count, 1)), radius=radius, meridian=meridian),
    }[kind]()
    matrices = np.tile(np.eye(4), (count, 1, 1))
    turns = np.linalg.qr(generator.normal(size=(count, 3, 3)))[0]
    turns *= np.sign(np.linalg.det(turns))[:, None, None]
    across, along = 10.0 ** generator.uniform(-2, 2, (2, count))
    matrices[:, :3, :3] = turns @ (frame * np.stack([across, across, along], axis=-1)[:, None]) @ frame.T
    matrices[:, :3, 3] = generator.normal(size=(count, 3))
    assert keeps_round(matrices, axis).all() and not keeps_shapes(matrices).any()
    moved = body.transformed(AxialStretch.of(matrices, axis))
    origin = middle + 3.0 * generator.normal(size=(count, 3))
    direction = middle + 0.3 * generator.normal(size=(count, 3)) - origin
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    t = body.reference_hit(origin, direction)
    there = np.einsum("nij,nj->ni", matrices[:, :3, :3], direction)
    stretch = np.linalg.norm(there, axis=1)
    moved_origin = np.einsum("nij,nj->ni", matrices[:, :3, :3], origin) + matrices[:, :3, 3]
    found = moved.reference_hit(moved_origin, there / stretch[:, None])
    assert 0.2 < np.isfinite(t).mean() < 1.0
    np.testing.assert_allclose(found, t * stretch, rtol=1e-6)
    hit = np.isfinite(t)
    point = (origin + np.where(hit, t, 0.0)[:, None] * direction)[hit]
    _, uv = body.take(hit).reference_surface(point)
    _, moved_uv = moved.take(hit).reference_surface((moved_origin + found[:, None] / stretch[:, None] * there)[hit])
    np.testing.assert_allclose(moved_uv, uv, atol=1e-6)


@pytest.mark.parametrize(
    "linear",
    [np.diag([1, 1.001, 2]), np.diag([1, 1, -2.0]), [[1, 0, 0.01], [0, 1, 0], [0, 0, 1]], np.diag([1.0, 1, 0])],
)
def test_what_does_not_keep_round_bodies(linear):
    assert not keeps_round(matrix_of(linear)[None], (0.0, 0.0, 1.0)).any()


@pytest.mark.parametrize("scales", [(1, 1, 0), (0, 2, 3), (5e-7, 0, 1e-6), (1e8, 0, 1e7), (1, 1, 1e-12)])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_what_is_flattened_gets_a_thickness(scales, seed):
    flat = matrix_of(turned(seed) @ np.diag(np.float64(scales)) @ turned(seed + 10))
    flat[:3, 3] = [1, 2, 3]
    assert not invertible(flat[None])[0]
    thick = thickened(flat[None])[0]
    assert invertible(thick[None])[0] and np.linalg.det(thick) > 0.0 and (thick[:, 3] == flat[:, 3]).all()
    largest = max(scales)
    got = np.linalg.svd(thick[:3, :3], compute_uv=False) / largest
    assert np.allclose(np.sort(got), np.sort([1e-4, *(s / largest for s in sorted(scales)[1:])]), rtol=1e-6)
    assert np.abs(thick - flat).max() <= 1.01e-4 * largest, "nothing else changes"


def test_what_is_a_line_or_a_point_or_a_body_stays_as_it_is():
    matrices = np.stack([matrix_of(np.diag(d)) for d in np.float64([[1, 0, 0], [0, 0, 0], [1, 2, 1e-9], [-1, 2, 3]])])
    matrices = np.concatenate([matrices, np.full((1, 4, 4), np.nan), matrix_of(np.diag([1, np.inf, 0]))[None]])
    assert np.array_equal(thickened(matrices), matrices, equal_nan=True)
    assert invertible(matrices).tolist() == [False, False, True, True, False, False]
    assert thickened(np.zeros((0, 4, 4))).shape == (0, 4, 4)


def test_bounds_are_tight():
    """Each box touches the shape's farthest points, by dense sampling of circles."""
    rng = np.random.default_rng(1)
    axis = rng.normal(size=(20, 3))
    axis /= np.linalg.norm(axis, axis=-1, keepdims=True)
    side = np.cross(axis, [0.3, 0.5, 0.7])
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    angle = np.linspace(0, 2 * np.pi, 2000)[:, None, None]
    circle = np.cos(angle) * side + np.sin(angle) * np.cross(axis, side)
    lower, upper = Discs(center=np.zeros((20, 3)), normal=axis, radius=2.0).bounds()
    assert np.allclose(lower, 2 * circle.min(axis=0), atol=1e-5) and np.allclose(
        upper, 2 * circle.max(axis=0), atol=1e-5
    )
    lower, upper = Cones(base=np.zeros((20, 3)), apex=3 * axis, base_radius=2.0, apex_radius=-0.0).bounds()
    points = np.concatenate([2 * circle, 3 * axis[None]])
    assert np.allclose(lower, points.min(axis=0), atol=1e-5) and np.allclose(upper, points.max(axis=0), atol=1e-5)
    lower, upper = Spheres(center=[[1, 2, 3]], radius=[-2.0]).bounds()
    assert lower.tolist() == [[-1, 0, 1]] and upper.tolist() == [[3, 4, 5]]


def test_the_labels_are_the_kinds():
    assert [cls.kind for cls in BY_KIND] == ["sphere", "cylinder", "cone", "disc", "triangle"]
