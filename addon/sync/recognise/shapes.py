"""What recognition takes and gives: plain data in object space.

Conventions of the parts' own uv (with theta, phi counted from ``e0`` towards ``axis x e0``, in [0, 2 pi)):

- sphere: u = phi / 2 pi, v = 1 - theta / pi, theta from the pole (the third column of ``frame``);
- side of a cylinder or cone: u = theta / 2 pi, v = height over the base / length;
- disc: u = d.e0 / 2R + 1/2, v = d.(normal x e0) / 2R + 1/2, with d from the centre.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

POSITION_TOLERANCE = 1e-4  # of the shape's size: far below a pixel, far above what applying a transform costs
ROUNDING = 8 * float(np.finfo(np.float32).eps)  # of the coordinates: float32 meshes far from their origin


class StaysMesh(Exception):  # noqa: N818 - an answer, not an error
    """The mesh is not the shape that was tried; the message says why, in words for the object's panel."""


@dataclass(frozen=True)
class MeshArrays:
    """A mesh in object space, as numpy arrays; every vertex index and offset is valid.

    positions (v, 3) float32; corner_vertex (c,) int32, the vertex of each face corner; face_offset (f + 1,)
    int32, the first corner of each face and c at the end; smooth (f,) bool, shaded smooth; material (f,)
    int32, the slot; uv (c, 2) float32, the active render uv map, or None.
    """

    positions: np.ndarray
    corner_vertex: np.ndarray
    face_offset: np.ndarray
    smooth: np.ndarray
    material: np.ndarray
    uv: np.ndarray | None = None

    @property
    def counts(self) -> tuple[int, int, int]:
        """The numbers of vertices, faces and corners."""
        return len(self.positions), len(self.face_offset) - 1, len(self.corner_vertex)

    @cached_property
    def face_size(self) -> np.ndarray:
        """(f,) int: corners of each face."""
        return np.diff(self.face_offset)

    @cached_property
    def corner_face(self) -> np.ndarray:
        """(c,) int: the face of each corner."""
        return np.repeat(np.arange(len(self.face_size)), self.face_size)

    @cached_property
    def edge_end(self) -> np.ndarray:
        """(c,) int: the vertex of the corner that follows each corner in its face."""
        following = np.arange(1, len(self.corner_vertex) + 1)
        following[self.face_offset[1:] - 1] = self.face_offset[:-1]
        return self.corner_vertex[following]

    def directed_edges(self, reverse: bool = False) -> np.ndarray:
        """(c,) int64, sorted: one key for each directed edge of each face (or for each edge reversed)."""
        start, end = self.corner_vertex.astype(np.int64), self.edge_end.astype(np.int64)
        if reverse:
            start, end = end, start
        return np.sort(start * len(self.positions) + end)

    def uniform_material(self, faces: np.ndarray, name: str) -> int:
        """The one material slot of the faces (f,) bool; StaysMesh where they have several."""
        slots = self.material[faces]
        if (slots != slots[0]).any():
            raise StaysMesh(f"the {name} has faces of more than one material")
        return int(slots[0])


@dataclass(frozen=True)
class UvMap:
    """How a mesh's uv map relates to a part's own uv: mesh_uv = (su * u + ou, sv * v + ov).

    transform is (su, sv, ou, ov). ``matches`` is False where no such transform gives the mesh's map; then
    transform is the identity. A mesh without a uv map contradicts nothing and matches. ``planar`` (cones
    only): the transform applies to p = d.e0 / (2 max(r0, r1)) + 1/2 and q = d.(axis x e0) / (2 max(r0, r1)) +
    1/2, d from the base centre.
    """

    transform: tuple[float, float, float, float] = (1.0, 1.0, 0.0, 0.0)
    matches: bool = True
    planar: bool = False


@dataclass(frozen=True)
class Part:
    """One exact surface, its material slot and its uv map. Vectors are (3,) float64."""

    kind: ClassVar[str]
    material: int
    uv: UvMap


@dataclass(frozen=True)
class Sphere(Part):
    """A sphere; frame (3, 3) is a rotation with columns e0, e1, e2: zero meridian, e2 x e0, pole."""

    kind = "SPHERE"
    centre: np.ndarray
    radius: float
    frame: np.ndarray


@dataclass(frozen=True)
class Cylinder(Part):
    """The side of a cylinder over the base's centre."""

    kind = "CYLINDER"
    base: np.ndarray
    axis: np.ndarray
    length: float
    radius: float
    e0: np.ndarray


@dataclass(frozen=True)
class Cone(Part):
    """The side of a cone, from radius_base to radius_apex (0 for a tip); either may be the larger."""

    kind = "CONE"
    base: np.ndarray
    axis: np.ndarray
    length: float
    radius_base: float
    radius_apex: float
    e0: np.ndarray


@dataclass(frozen=True)
class Disc(Part):
    """A disc; the normal points out of the body."""

    kind = "DISC"
    centre: np.ndarray
    normal: np.ndarray
    radius: float
    e0: np.ndarray


@dataclass(frozen=True)
class Recognition:
    """What a mesh was taken as.

    kind is MESH, SPHERE, CYLINDER, CONE or DISC; reason a sentence for the object's panel. ``parts`` make up
    the shape (a cylinder is its side and its caps), empty for MESH. ``local`` is None, or the (3, 4) float64
    affine that takes the parts to object space (a stretched mesh: the parts are then in a space of their
    own). ``all_smooth``: every face of the curved surface is shaded smooth (of a disc: every face).
    """

    kind: str
    reason: str
    parts: tuple[Part, ...] = ()
    local: np.ndarray | None = None
    all_smooth: bool = False

    @property
    def uv_matches(self) -> bool:
        """Whether the mesh's uv map is the exact shape's, up to each part's transform."""
        return all(part.uv.matches for part in self.parts)
