"""The point that positions are taken relative to, near the camera: float32 keeps its digits where people look."""

import numpy as np

#: How much farther off an origin may be, relative to the width of the grid that a new one would lie on, and stay.
_STAYS = 2.0


def find_origin(scene, plan, before=None):
    """The origin (3,): the camera's place, rounded to a grid much coarser than the distances to what is near it. It is
    exactly 0 for scenes around 0, stays put while the camera moves, and does not mind single things that lie far off.

    `before`: one that records are relative to already; it stays as long as it is nearly as good.
    """
    eye = np.asarray(scene.camera.matrix, np.float64)[:3, 3]
    places = _sampled_places(plan)
    if not len(places):
        return np.zeros(3) if before is None else before
    distance = float(np.quantile(np.linalg.norm(places - eye, axis=1), 0.25, method="lower"))
    grid = 2.0 ** (np.ceil(np.log2(max(distance, 1e-30))) + 2.0)
    if before is not None and np.abs(before - eye).max() <= _STAYS * grid:
        return before
    return np.round(eye / grid) * grid


def _sampled_places(plan, most=1000):
    """Where things are, (n, 3): the middle of about `most` primitives of a kind in world space, the origin of as many
    instances of other geometries."""
    places = [np.zeros((0, 3))]
    in_world = np.flatnonzero(plan.in_world)
    for number in in_world:
        for _, part in plan.geometries[number].parts:
            lower, upper = part.take(_spread(len(part), -(-most // len(in_world)))).bounds()
            places.append((lower + upper) / 2.0)
    stands = [
        p.matrices[:, :3, 3] for p, n in zip(plan.placed, plan.placed_numbers, strict=True) if not plan.in_world[n]
    ]
    if stands:
        stands = np.concatenate(stands)
        places.append(stands[_spread(len(stands), most)])
    return np.concatenate(places)


def _spread(count, most):
    """At most `most` indices below `count`, evenly spread."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.int64))
