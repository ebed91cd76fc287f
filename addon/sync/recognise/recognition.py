"""The one entry: what a mesh is, and why."""

import numpy as np

from . import icosphere, revolution
from .profile import shape_of
from .shapes import POSITION_TOLERANCE, MeshArrays, Recognition, StaysMesh

OTHER = "its faces are not those of a sphere, cylinder, cone or disc"
SAMPLE = 64


def recognise(mesh: MeshArrays) -> Recognition:
    """What the mesh is: an exact shape, or MESH; the reason says why in a sentence for the object's panel.

    Costs a look at the counts for nearly every other mesh, whatever its size.
    """
    if mesh.counts[1] == 0:
        return Recognition("MESH", "mesh: it has no faces")
    if not np.isfinite(mesh.positions.sum(dtype=np.float64)):
        return Recognition("MESH", "mesh: it has NaN or infinite vertices")
    reasons = []
    for attempt in _attempts(mesh):
        try:
            return attempt()
        except StaysMesh as reason:
            reasons.append(str(reason))
    return Recognition("MESH", "mesh: " + (reasons or [_other(mesh)])[0])


def _attempts(mesh: MeshArrays):
    """Functions that return a Recognition or raise StaysMesh: the shapes whose counts are the mesh's."""
    if m := icosphere.divisions(mesh):
        yield lambda: icosphere.recognise_icosphere(mesh, m)
    for counts in revolution.candidates(mesh):
        yield lambda counts=counts: shape_of(mesh, revolution.fit(mesh, counts))


def _other(mesh: MeshArrays) -> str:
    """Why a mesh with other counts stays one: a damaged sphere is named."""
    step = max(1, len(mesh.positions) // SAMPLE)
    if len(mesh.positions) < 42 or not _on_sphere(mesh.positions[::step]) or not _on_sphere(mesh.positions):
        return OTHER
    edges = mesh.positions[mesh.corner_vertex[::step]] - mesh.positions[mesh.edge_end[::step]]
    size = np.ptp(mesh.positions, axis=0).max()
    if np.linalg.norm(edges, axis=1).max() > 0.4 * size:
        return OTHER
    return "its vertices lie on a sphere, but faces of a UV or ico sphere are missing, added or divided"


def _on_sphere(points: np.ndarray) -> bool:
    """Whether the points (k, 3) lie on a sphere: |p|^2 = 2 c.p + const, by least squares."""
    p = points.astype(np.float64)
    p -= p.mean(0)
    square = (p * p).sum(1)
    system = np.column_stack([2 * p, np.ones(len(p))])
    solution = np.linalg.lstsq(system, square, rcond=None)[0]
    return bool(np.abs(system @ solution - square).max() <= 4 * POSITION_TOLERANCE * square.max())
