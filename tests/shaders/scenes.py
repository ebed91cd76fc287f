"""Random scenes and the float64 answer to every ray by brute force."""

import numpy as np

from addon.engine.primitives import Planes
from addon.engine.scene import Camera, Geometry, Instances, Material, Scene

from . import shapes

MAKERS = (
    shapes.spheres,
    shapes.cylinders,
    lambda rng, n: shapes.cones(rng, n, "truncated"),
    lambda rng, n: shapes.cones(rng, n, "tip"),
    shapes.discs,
    shapes.triangles,
)


def empty_scene():
    camera = Camera.look_at((0.0, -4.0, 0.0), (0.0, 0.0, 0.0))
    return Scene(camera=camera)


def parts(rng, count, spread=1.0):
    """Primitives of every kind, `count` in all, of sizes up to the spacing, in a cube of +-spread."""
    share = -(-count // len(MAKERS))
    scale = spread / max(count, 1) ** (1.0 / 3.0)
    made = []
    for make in MAKERS:
        part = make(rng, share)
        middle, extent = shapes.middle_and_extent(part)
        made.append(
            resized(
                part, middle, scale * rng.uniform(0.2, 1.0, share) / extent, rng.uniform(-spread, spread, (share, 3))
            )
        )
    return made


def resized(part, middle, factor, center):
    """Each row scaled about its middle by a factor and moved to a centre."""
    values = {}
    for column in part.columns:
        value = np.asarray(getattr(part, column.name))
        if column.name in ("center", "base", "apex", "p0", "p1", "p2"):
            value = shapes.single((value - middle) * factor[:, None] + center)
        elif "radius" in column.name:
            value = shapes.single(value * factor)
        values[column.name] = value
    return type(part)(**values)


def numbered(scene, part):
    """The part with a material of its own for each row, whose glow tells which primitive is hit."""
    first = new_materials(scene, len(part))
    return part._with({"material": np.arange(first, first + len(part), dtype=np.int32)})


def new_materials(scene, count):
    """Add materials that glow with their number; the first one's number."""
    first = len(scene.materials)
    scene.materials += [Material(glow=float(first + i)) for i in range(count)]
    return first


def slots(part, start):
    """The part with the material slots from `start` on, one a row."""
    return part._with({"material": np.arange(start, start + len(part), dtype=np.int32)})


class Oracle:
    """Everything in a scene as (material of each row, primitives, matrix or None), for brute force in float64."""

    def __init__(self):
        self.entries = []

    def add(self, first_material, part, matrix=None):
        self.entries.append((first_material, shapes.exactly(part), matrix))

    def __len__(self):
        return sum(len(part) for _, part, _ in self.entries)

    def nearest(self, origin, direction):
        """t (n,) and material (n,) of the nearest hits, inf and -1 for none, and the second nearest t (n,)."""
        n = len(origin)
        best, second, which = np.full(n, np.inf), np.full(n, np.inf), np.full(n, -1)
        for material, t in self._all(origin, direction):
            nearer = t < best
            second = np.where(nearer, best, np.minimum(second, t))
            best, which = np.where(nearer, t, best), np.where(nearer, material, which)
        return best, which, second

    def _all(self, origin, direction):
        """For each primitive its material and t (n,) of all rays."""
        n = len(origin)
        for first, part, matrix in self.entries:
            o, d, scale = origin, direction, np.ones(n)
            if matrix is not None:
                inverse = np.linalg.inv(matrix)
                o, d = o @ inverse[:3, :3].T + inverse[:3, 3], d @ inverse[:3, :3].T
                scale = np.linalg.norm(d, axis=-1)
                d = d / scale[:, None]
            rows = max(200_000 // n, 1)
            for start in range(0, len(part), rows):
                some = part.take(np.arange(start, min(start + rows, len(part))))
                k = len(some)
                t = some.take(np.repeat(np.arange(k), n)).reference_hit(np.tile(o, (k, 1)), np.tile(d, (k, 1)))
                for i, row in enumerate(t.reshape(k, n)):
                    yield first + start + i, row / scale


def random_affine(rng):
    """A random matrix (4, 4): rotation, stretch of 0.2 to 3 along axes, shear, half of them mirrored, and a place."""
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    shear = np.eye(3) + np.triu(rng.uniform(-0.3, 0.3, (3, 3)), 1)
    matrix = np.eye(4)
    matrix[:3, :3] = q @ np.diag(shapes.log_uniform(rng, 0.2, 3.0, 3)) @ shear
    matrix[:3, 3] = rng.uniform(-1.0, 1.0, 3)
    return matrix


def mixed(rng, count, instances=0):
    """A scene of `count` primitives in world space and a quarter of that in a geometry with instances; its oracle."""
    scene, oracle = empty_scene(), Oracle()
    for part in parts(rng, count) if count else ():
        part = numbered(scene, part)
        scene.add(part)
        oracle.add(int(part.material[0]), part)
    made, start = [], 0
    for part in parts(rng, max(count // 4, 1), 0.5) if instances else ():
        made.append(slots(part, start))
        start += len(part)
    geometry = Geometry(*made, name="instanced")
    for i in range(instances):
        first = new_materials(scene, start)
        matrix = random_affine(rng)
        scene.instances.append(Instances(geometry, matrix, tuple(range(first, first + start)), f"instance {i}"))
        for part in made:
            oracle.add(first + int(part.material[0]), part, matrix)
    return scene, oracle


def with_planes(rng, scene, oracle, count=2):
    for _ in range(count):
        plane = Planes(point=rng.uniform(-1, 1, (1, 3)), normal=shapes.unit_vectors(rng, 1))
        plane = numbered(scene, plane)
        scene.add(plane)
        oracle.add(int(plane.material[0]), plane)
