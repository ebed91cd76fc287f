"""The shapes that every test of intersections and surfaces runs over, by name, with a seed each."""

import numpy as np
import pytest

from . import shapes

#: Pairs of ray and primitive in one draw.
COUNT = 20_000

SHAPES = {
    "sphere": shapes.spheres,
    "cylinder": shapes.cylinders,
    **{f"cone_{form}": lambda rng, n, form=form: shapes.cones(rng, n, form) for form in shapes.CONE_FORMS},
    "disc": shapes.discs,
    "plane": shapes.planes,
    "triangle": shapes.triangles,
    "triangle_sliver": lambda rng, n: shapes.triangles(rng, n, 1e-4),
}
INSIDE_ONLY = {
    "sphere": lambda rng, n: shapes.spheres(rng, n, -1.0),
    "cylinder": lambda rng, n: shapes.cylinders(rng, n, -1.0),
    "cone": lambda rng, n: shapes.cones(rng, n, "truncated", -1.0),
    "cone_tip": lambda rng, n: shapes.cones(rng, n, "tip", -1.0),
}
CONVEX = [name for name in SHAPES if name not in ("disc", "plane") and not name.startswith("triangle")]
FLAT = [name for name in SHAPES if name not in CONVEX]

each_shape = pytest.mark.parametrize("shape", SHAPES)
each_seed = pytest.mark.parametrize("seed", range(2))


def roundings(shape):
    return shapes.SLIVER_ROUNDINGS if "sliver" in shape else shapes.BACKWARD_ROUNDINGS


def make(shape, seed, table=SHAPES, count=COUNT):
    """(primitives as the GPU sees them, random generator) of a named shape and seed."""
    rng = np.random.default_rng([seed, *shape.encode()])
    return shapes.exactly(table[shape](rng, count)), rng
