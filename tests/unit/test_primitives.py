"""The columns of primitives: what is checked, what the messages say, how shapes move."""

import re

import numpy as np
import pytest

from addon.engine.errors import SceneError
from addon.engine.primitives import (
    BY_KIND,
    Cones,
    Cylinders,
    Discs,
    Planes,
    Similarity,
    Spheres,
    Triangles,
    keeps_shapes,
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
