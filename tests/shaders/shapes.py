"""Random primitives and rays over many scales, and how far float32 may be from the float64 reference.

Every generator takes a numpy Generator and a count. Sizes, distances from the world's origin and distances of the ray's
origin are log-uniform. What is made is rounded to float32 first, as the GPU sees it, and handed to the reference so.
"""

import numpy as np

from addon.engine.primitives import Cones, Cylinders, Discs, Planes, Spheres, Triangles

#: Unit roundoff of float32.
ROUNDOFF = 2.0**-24

#: GLSL's answer is the exact one for a ray and a primitive moved by at most this many roundings of the lengths that it
#: was computed from: about one for each operation between the inputs and the roots.
BACKWARD_ROUNDINGS = 16.0
#: Where a sliver is seen edge-on, its vertices' roundings turn its plane, and move the hit far along it.
SLIVER_ROUNDINGS = 64.0


def log_uniform(rng, low, high, size):
    return np.exp(rng.uniform(np.log(low), np.log(high), size))


def unit_vectors(rng, n):
    v = rng.normal(size=(n, 3))
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def single(array):
    """Rounded to float32, as float64."""
    return np.asarray(array, np.float32).astype(np.float64)


def placed(rng, n):
    """Sizes (n,) from 1e-4 to 1e5 and centres (n, 3) up to 1000 sizes from the origin, a fifth of them at it."""
    size = log_uniform(rng, 1e-4, 1e5, n)
    away = np.where(rng.random(n) < 0.2, 0.0, log_uniform(rng, 1e-2, 1e3, n))
    return size, unit_vectors(rng, n) * (size * away)[:, None]


def spheres(rng, n, sign=1.0):
    size, center = placed(rng, n)
    return Spheres(
        center=single(center),
        radius=single(size * sign),
        material=np.arange(n),
        pole=unit_vectors(rng, n),
        meridian=unit_vectors(rng, n),
    )


def cylinders(rng, n, sign=1.0):
    size, base = placed(rng, n)
    radius = single(size * log_uniform(rng, 1e-2, 1.0, n))
    base, axis = single(base), single(unit_vectors(rng, n) * (size * log_uniform(rng, 1e-2, 1.0, n))[:, None])
    return Cylinders(base=base, apex=base + axis, radius=radius * sign, material=np.arange(n), **side_columns(rng, n))


def side_columns(rng, n):
    return {"meridian": unit_vectors(rng, n), "uv_transform": single(rng.uniform(0.5, 2.0, (n, 4)))}


#: Radii of base and apex relative to the height, by the name of the shape.
CONE_FORMS = {
    "tip": lambda rng, n: (log_uniform(rng, 0.1, 10.0, n), np.zeros(n)),
    "wide": lambda rng, n: (np.zeros(n), log_uniform(rng, 0.1, 10.0, n)),
    "truncated": lambda rng, n: (log_uniform(rng, 0.1, 10.0, n), log_uniform(rng, 0.1, 10.0, n)),
    "needle": lambda rng, n: (log_uniform(rng, 1e-4, 1e-2, n), np.zeros(n)),
    "flat": lambda rng, n: (log_uniform(rng, 1e2, 1e4, n), np.zeros(n)),
    "nearly_cylindrical": lambda rng, n: (
        np.ones(n),
        1.0 + rng.uniform(-1.0, 1.0, n) * log_uniform(rng, 1e-7, 1e-2, n),
    ),
}


def cones(rng, n, form="truncated", sign=1.0):
    size, base = placed(rng, n)
    base_radius, apex_radius = CONE_FORMS[form](rng, n)
    height = size / np.maximum(np.maximum(base_radius, apex_radius), 1.0)
    base, axis = single(base), single(unit_vectors(rng, n) * height[:, None])
    return Cones(
        base=base,
        apex=base + axis,
        base_radius=single(sign * height * base_radius),
        apex_radius=single(sign * height * apex_radius),
        material=np.arange(n),
        planar=rng.integers(0, 2, n),
        **side_columns(rng, n),
    )


def discs(rng, n):
    size, center = placed(rng, n)
    normal = single(unit_vectors(rng, n))
    return Discs(
        center=single(center), normal=normal, radius=single(size), material=np.arange(n), **side_columns(rng, n)
    )


def planes(rng, n):
    """Planes whose equation is exact in float32: the reference takes W from the point."""
    size, point = placed(rng, n)
    normal = unit_vectors(rng, n)
    return Planes(point=point, normal=normal, meridian=unit_vectors(rng, n), tile=size * log_uniform(rng, 0.1, 10.0, n))


def triangles(rng, n, sliver=1.0, one_sided=0):
    """Triangles; `sliver` < 1 puts the third vertex that near to the line through the other two."""
    size, center = placed(rng, n)
    p0, p1, p2 = (unit_vectors(rng, n) * size[:, None] for _ in range(3))
    if sliver < 1.0:
        along = rng.uniform(-0.5, 1.5, n)[:, None]
        p2 = p0 + along * (p1 - p0) + unit_vectors(rng, n) * (size * log_uniform(rng, sliver, 1.0, n))[:, None]
    flip = np.sign(np.sum(np.cross(p1 - p0, p2 - p0) * unit_vectors(rng, n), axis=-1, keepdims=True))
    normals = [single(flip * unit_vectors(rng, n)) for _ in range(3)]
    return Triangles(
        **{name: single(center + p) for name, p in (("p0", p0), ("p1", p1), ("p2", p2))},
        **dict(zip(("n0", "n1", "n2"), normals, strict=True)),
        **{name: single(rng.random((n, 2))) for name in ("uv0", "uv1", "uv2")},
        material=np.arange(n),
        one_sided=np.full(n, one_sided),
    )


def exactly(primitives):
    """The primitives that the GPU sees: made again from their float32 records, so that the reference has no other."""
    hit, surface = primitives.records()
    hit = {name: hit[name].astype(np.float64) for name in hit.dtype.names}
    values = {column.name: getattr(primitives, column.name) for column in primitives.columns}
    for name in ("meridian", "n0", "n1", "n2", "uv1", "uv2", "uv_transform"):
        if name in surface.dtype.names:
            values[name] = surface[name].astype(np.float64)
    for name in hit:
        if name in values:
            values[name] = hit[name]
    if primitives.kind in ("cylinder", "cone"):
        values["apex"] = hit["base"] + hit["axis"]
    if primitives.kind == "plane":
        length = np.linalg.norm(hit["normal"], axis=-1)
        values["point"] = hit["normal"] * (-hit["offset"] / length**2)[:, None]
        values["meridian"], values["tile"] = surface["meridian"].astype(np.float64), primitives.tile
    return type(primitives)(**values)


def middle_and_extent(primitives):
    """A point (n, 3) inside each primitive and the distance (n,) of its farthest point from there."""
    if primitives.kind == "plane":
        return np.asarray(primitives.point), np.asarray(primitives.tile)
    lower, upper = (np.asarray(corner, np.float64) for corner in primitives.bounds())
    return (lower + upper) / 2.0, np.linalg.norm(upper - lower, axis=-1) / 2.0


def rays(rng, primitives, near=1e-2, far=1e3):
    """Rays towards random points around the middles, from `near` to `far` extents away: origin, direction, (n, 3)."""
    middle, extent = middle_and_extent(primitives)
    n = len(primitives)
    origin = single(middle + unit_vectors(rng, n) * (extent * log_uniform(rng, near, far, n))[:, None])
    target = middle + unit_vectors(rng, n) * (extent * rng.random(n) ** 0.5)[:, None]
    direction = target - origin
    return origin, single(direction / np.linalg.norm(direction, axis=-1, keepdims=True))


def normalized(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def reach(primitives, origin):
    """The size (n,) of the lengths that an intersection is computed from."""
    middle, extent = middle_and_extent(primitives)
    # A plane's equation subtracts numbers of the size of the coordinates, everything else the ray's origin first.
    base = np.asarray(primitives.p0) if primitives.kind == "triangle" else middle
    away = np.linalg.norm(base - origin, axis=-1) + extent
    if primitives.kind == "plane":
        away += np.linalg.norm(origin, axis=-1) + np.linalg.norm(middle, axis=-1)
    return away


def perturbed(primitives, origin, direction, roundings=BACKWARD_ROUNDINGS):
    """The reference's t for the pair as it is (n,), and for pairs moved by the backward error (k, n): the origin along
    three axes, the direction across itself, the primitive's sizes."""
    direction = normalized(direction)
    amount = roundings * ROUNDOFF
    moved = (amount * reach(primitives, origin))[:, None]
    across = normalized(np.cross(direction, np.eye(3)[np.argmin(np.abs(direction), axis=-1)]))
    turns = [sign * amount * side for side in (across, np.cross(direction, across)) for sign in (1, -1)]
    others = [primitives.reference_hit(origin + moved * step, direction) for step in (*np.eye(3), *-np.eye(3))]
    others += [primitives.reference_hit(origin, normalized(direction + turn)) for turn in turns]
    others += [resized.reference_hit(origin, direction) for resized in resizings(primitives, amount, moved)]
    return primitives.reference_hit(origin, direction), np.stack(others)


def resizings(primitives, amount, moved):
    """The primitives with radii, and with the middle or the vertices' relative places, a little changed."""
    names = [c.name for c in primitives.columns if "radius" in c.name]
    for factor in (1.0 + amount, 1.0 - amount) if names else ():
        values = {name: getattr(primitives, name) * factor for name in names}
        if primitives.kind in ("cylinder", "cone"):
            middle = (primitives.base + primitives.apex) / 2.0
            values |= {name: middle + (getattr(primitives, name) - middle) * factor for name in ("base", "apex")}
        yield primitives._with(values)
    if primitives.kind == "cone":  # where the side ends is told by the height: far out, where the cone is flat
        yield from longer_and_shorter(primitives, moved)
    if primitives.kind == "triangle":  # each vertex has roundings of its own, which turn a sliver's plane
        p0, p1, p2 = primitives.p0, primitives.p1, primitives.p2
        normal = normalized(np.cross(p1 - p0, p2 - p0))
        inwards = [normalized((p0 + p1 + p2) / 3.0 - p) for p in (p0, p1, p2)]
        for name, inward in zip(("p0", "p1", "p2"), inwards, strict=True):
            for way in (normal, -normal, inward, -inward):
                yield primitives._with({name: getattr(primitives, name) + moved * way})


def longer_and_shorter(cones, moved):
    """The same sides, ending a little higher or lower."""
    axis = cones.apex - cones.base
    shares = moved[:, 0] / np.linalg.norm(axis, axis=-1)
    for share in (shares, -shares):
        change = share * (cones.apex_radius - cones.base_radius)
        sign = np.sign(cones.base_radius + cones.apex_radius)
        base_radius, apex_radius = cones.base_radius - change, cones.apex_radius + change
        yield cones._with(
            {
                "base": cones.base - share[:, None] * axis,
                "apex": cones.apex + share[:, None] * axis,
                "base_radius": np.where(base_radius * sign > 0.0, base_radius, 0.0),
                "apex_radius": np.where(apex_radius * sign > 0.0, apex_radius, 0.0),
            }
        )


def assert_same_hits(t, primitives, origin, direction, roundings=BACKWARD_ROUNDINGS):
    """t (n,) of GLSL, inf for a miss, is the reference's up to the backward error. Returns which rows are hits in both
    that the error cannot flip: the caller says how many there must be for the test to mean something.

    A ray that runs along the surface within the error may hit it anywhere there, or where exactly it just misses.
    """
    exact, others = perturbed(primitives, origin, direction, roundings)
    assert not np.isnan(t).any()
    hit = np.isfinite(exact)
    same = (np.isfinite(others) == hit).all(axis=0)
    touches = np.isfinite(t) & touching(primitives, origin, direction, t, exact, roundings)
    wrong = same & (np.isfinite(t) != hit) & ~touches
    assert not wrong.any(), describe(wrong, primitives, origin, direction, t, exact)
    both = same & hit & np.isfinite(t)
    with np.errstate(invalid="ignore"):
        spread = np.where(np.isfinite(others), np.abs(others - exact), 0.0).sum(axis=0)
        bound = spread + roundings * ROUNDOFF * np.where(hit, exact, 0.0)
        off = both & (np.abs(t - exact) > bound) & ~touches
    assert not off.any(), describe(off, primitives, origin, direction, t, exact)
    return both


def touching(primitives, origin, direction, t, exact, roundings):
    """Whether the points (n,) at t lie on round shapes within the backward error, and so all the way to the exact t."""
    if primitives.kind not in ("sphere", "cylinder", "cone"):
        return np.zeros(len(t), bool)
    tolerance = roundings * ROUNDOFF * reach(primitives, origin)
    t = np.where(np.isfinite(t), t, 0.0).astype(np.float64)
    between = (t + np.where(np.isfinite(exact), exact, t)) / 2.0
    on = np.ones(len(t), bool)
    for where in (t, between):
        point = origin + where[:, None] * normalized(direction)
        on &= np.abs(signed_distance(primitives, point)) <= tolerance
        if primitives.kind != "sphere":
            height, _, length = axis_coordinates(primitives, point)
            on &= (height >= -tolerance) & (height <= length + tolerance)
    return on


def describe(rows, primitives, origin, direction, t, exact):
    """The first of the failing rows, in full."""
    i = int(np.argmax(rows))
    columns = {c.name: np.asarray(getattr(primitives, c.name)[i]).tolist() for c in primitives.columns}
    ray = f"origin {origin[i].tolist()} direction {direction[i].tolist()}"
    return f"{int(rows.sum())} of {len(rows)}; number {i}: t {t[i]!r}, float64 {exact[i]!r}; {ray}; {columns}"


def signed_distance(primitives, point):
    """Distance (n,) of points from the surfaces without their edges; negative inside or below the normal."""
    p = {c.name: np.asarray(getattr(primitives, c.name), np.float64) for c in primitives.columns}
    if primitives.kind == "sphere":
        return np.linalg.norm(point - p["center"], axis=-1) - np.abs(p["radius"])
    if primitives.kind in ("disc", "plane"):
        return np.sum((point - p["center" if primitives.kind == "disc" else "point"]) * p["normal"], axis=-1)
    if primitives.kind == "triangle":
        normal = normalized(np.cross(p["p1"] - p["p0"], p["p2"] - p["p0"]))
        return np.sum((point - p["p0"]) * normal, axis=-1)
    base_radius = np.abs(p.get("base_radius", p.get("radius")))
    apex_radius = np.abs(p.get("apex_radius", p.get("radius")))
    height, distance_to_axis, length = axis_coordinates(primitives, point)
    slope = (apex_radius - base_radius) / length
    return (distance_to_axis - base_radius - slope * height) / np.sqrt(1.0 + slope**2)


def axis_coordinates(primitives, point):
    """Height over the base, distance from the axis, and the whole height, of points about cylinders or cones."""
    axis = primitives.apex - primitives.base
    length = np.linalg.norm(axis, axis=-1)
    height = np.sum((point - primitives.base) * axis, axis=-1) / length
    across = point - primitives.base - (height / length)[:, None] * axis
    return height, np.linalg.norm(across, axis=-1), length


def sharpest_radius(primitives, point):
    """The length (n,) over which normal and uv turn around or run once through the texture at a point."""
    if primitives.kind == "sphere":  # the smaller of the globe's radius and that of the circle of latitude
        across = np.cross(point - primitives.center, primitives.pole)
        return np.maximum(np.linalg.norm(across, axis=-1), 1e-300)
    if primitives.kind == "disc":
        return primitives.radius
    if primitives.kind == "plane":
        return primitives.tile
    if primitives.kind == "triangle":
        edges = (primitives.p1 - primitives.p0, primitives.p2 - primitives.p1, primitives.p0 - primitives.p2)
        area = np.linalg.norm(np.cross(edges[0], edges[1]), axis=-1)
        return area / np.max([np.linalg.norm(e, axis=-1) for e in edges], axis=0)
    _, distance_to_axis, length = axis_coordinates(primitives, point)
    return np.minimum(np.maximum(distance_to_axis, 1e-300), length)
