# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact shapes among the islands of one mesh: realised instances, the tubes of `Curve to Mesh`, joined objects.

An island is a run of vertices that no face joins to others, as Blender writes what it realises or joins. Islands of
one topology are one shape under different transforms: the first of them is recognised, the others are fitted to it,
all at once.
"""

from dataclasses import dataclass

import numpy as np

from ..engine.primitives import Cones, Cylinders, Discs, Spheres
from .recognise import MeshArrays, Sphere, recognise
from .recognise.shapes import POSITION_TOLERANCE, ROUNDING

#: Topologies that are tried, the most frequent first: each costs a recognition.
_TOPOLOGIES = 64
#: Elements that are looked at together: bounds the memory for millions of islands.
_BLOCK = 1 << 22
#: Attribute values that differ by less, absolutely or relatively, are one value: what interpolation costs.
_SAME_VALUE = 1e-6, 1e-4


@dataclass(frozen=True)
class Islands:
    """Exact primitives in object space, whose material is the slot, and the faces that stay triangles: `rest` (f,)
    bool."""

    primitives: tuple
    rest: np.ndarray


def find_islands(mesh: MeshArrays, attributes=None, smooth_only=False):
    """The `Islands` of a mesh that is no exact shape as a whole; None where none of its islands is one.

    `attributes`: name -> (values (n, 4) float32, domain POINT, FACE or CORNER), as `read_attribute` gives them. An
    island along whose axis one changes becomes a primitive between every two rings; where it changes otherwise the
    island stays triangles. `smooth_only`: only islands that are shaded smooth. The mesh's uv is not looked at: ask
    only where no material takes it.
    """
    layout = _Layout.of(mesh)
    if layout is None:
        return None
    taken = np.zeros(len(layout.vertices), bool)
    primitives = []
    for members in layout.topologies(mesh):
        shape = _RingShape.of(layout.island(mesh, members[0]))
        if shape is not None:
            for block in np.array_split(members, -(-len(members) * shape.corners // _BLOCK)):
                primitives += _Block(mesh, layout, shape, block).take(attributes or {}, smooth_only, taken)
    return Islands(tuple(primitives), ~taken[layout.island_of_face]) if primitives else None


@dataclass(frozen=True)
class _Layout:
    """Where islands lie: `vertices`, `faces`, `corners` (i,) the first of each, `counts` (i, 3) how many, and
    `island_of_face` (f,)."""

    vertices: np.ndarray
    faces: np.ndarray
    corners: np.ndarray
    counts: np.ndarray
    island_of_face: np.ndarray

    @classmethod
    def of(cls, mesh):
        """None where the mesh is one island, or its faces do not lie island after island."""
        v, f, c = mesh.counts
        if not f or not mesh.face_size.all():
            return None
        first = mesh.face_offset[:-1]
        low = np.minimum.reduceat(mesh.corner_vertex, first)
        high = np.maximum.reduceat(mesh.corner_vertex, first)
        # How many faces reach over the gap before each vertex.
        across = np.cumsum(np.bincount(low + 1, minlength=v + 1)[:v] - np.bincount(high + 1, minlength=v + 1)[:v])
        label = np.cumsum(across == 0) - 1
        island_of_face = label[low]
        if (np.diff(island_of_face) < 0).any():
            return None
        starts = np.flatnonzero(np.diff(island_of_face, prepend=-1))
        if len(starts) < 2:
            return None
        labels = island_of_face[starts]  # loose vertices are islands without faces
        begin = np.flatnonzero(across == 0)
        vertices = begin[labels]
        corners = mesh.face_offset[starts]
        sizes = (np.append(begin, v)[labels + 1] - vertices, np.diff(starts, append=f), np.diff(corners, append=c))
        return cls(vertices, starts, corners, np.stack(sizes, -1), np.repeat(np.arange(len(starts)), sizes[1]))

    def topologies(self, mesh):
        """Yield the numbers (k,) of the islands that have their faces alike, the most frequent first."""
        _, of_island, count = np.unique(self.counts, axis=0, return_inverse=True, return_counts=True)
        of_island = of_island.reshape(-1)
        tried = 0
        for group in np.argsort(-count, kind="stable"):
            members = np.flatnonzero(of_island == group)
            while len(members):
                if tried == _TOPOLOGIES:
                    return
                tried += 1
                alike = self._alike(mesh, members)
                yield members[alike]
                members = members[~alike]

    def _alike(self, mesh, members):
        """Which of islands of the same counts have the faces of the first of them: (k,) bool."""
        _, faces, corners = self.counts[members[0]]
        alike = np.empty(len(members), bool)
        block = max(1, _BLOCK // corners)
        for start in range(0, len(members), block):
            rows = members[start : start + block]
            around = mesh.corner_vertex[_runs(self.corners[rows], corners)] - self.vertices[rows, None]
            sizes = mesh.face_size[_runs(self.faces[rows], faces)]
            if start == 0:
                template = around[0], sizes[0]
            alike[start : start + block] = (around == template[0]).all(axis=1) & (sizes == template[1]).all(axis=1)
        return alike

    def island(self, mesh, number):
        """One island as a mesh."""
        v, f, c = self.vertices[number], self.faces[number], self.corners[number]
        vertices, faces, corners = self.counts[number]
        return MeshArrays(
            mesh.positions[v : v + vertices],
            mesh.corner_vertex[c : c + corners] - v,
            mesh.face_offset[f : f + faces + 1] - c,
            mesh.smooth[f : f + faces],
            mesh.material[f : f + faces],
        )


def _runs(first, count):
    """Indices (n, count) of the elements that follow each of first (n,)."""
    return first[:, None] + np.arange(count)


@dataclass(frozen=True)
class _Piece:
    """A part of a recognised island: its faces (k,), and the corners (m,) where its attributes are taken, a set for
    each place: one, or the rings at base and apex."""

    faces: np.ndarray
    places: tuple


@dataclass(frozen=True)
class _RingShape:
    """A recognised island, the first of its topology: a sphere, or rings around an axis with or without caps.

    `points` (v, 3) float64 about their mean `center`; `side`: a piece between every two rings, of a sphere one;
    `heights` (rings,) in [0, 1]; `caps`: (Disc, `_Piece`) pairs.
    """

    body: object
    points: np.ndarray
    center: np.ndarray
    side: tuple
    heights: np.ndarray
    caps: tuple
    corners: int

    @classmethod
    def of(cls, mesh):
        """None where the island is no sphere, cylinder or cone."""
        recognition = recognise(mesh)
        if recognition.kind not in ("SPHERE", "CYLINDER", "CONE") or recognition.local is not None:
            return None
        body, *discs = recognition.parts
        points = mesh.positions.astype(np.float64)
        center = points.mean(axis=0)
        corners = mesh.counts[2]
        if isinstance(body, Sphere):
            whole = _Piece(np.arange(mesh.counts[1]), (np.arange(corners),))
            return cls(body, points - center, center, (whole,), np.empty(0), (), corners)
        ring, heights = _rings((points - body.base) @ body.axis / body.length)
        side, ends = _pieces(mesh, ring[mesh.corner_vertex], len(heights))
        caps = tuple((disc, ends[int((disc.normal @ body.axis) > 0.0)]) for disc in discs)
        return cls(body, points - center, center, side, heights, caps, corners)


def _rings(height):
    """The ring (v,) of each height, and the heights of the rings, ascending."""
    order = np.argsort(height)
    step = np.diff(height[order], prepend=height[order[0]]) > 1e-3
    ring = np.empty(len(height), int)
    ring[order] = np.cumsum(step)
    return ring, np.bincount(ring, height) / np.bincount(ring)


def _pieces(mesh, ring, rings):
    """The pieces of the side, and those of the two ends, from the ring (c,) of each corner."""
    first = mesh.face_offset[:-1]
    low, high = np.minimum.reduceat(ring, first), np.maximum.reduceat(ring, first)
    of_corner = mesh.corner_face
    side = []
    for k in range(rings - 1):
        inside = (low[of_corner] == k) & (high[of_corner] == k + 1)
        places = tuple(np.flatnonzero(inside & (ring == end)) for end in (k, k + 1))
        side.append(_Piece(np.flatnonzero((low == k) & (high == k + 1)), places))
    ends = []
    for k in (0, rings - 1):
        flat = (low == k) & (high == k)
        ends.append(_Piece(np.flatnonzero(flat), (np.flatnonzero(flat[of_corner]),)))
    return tuple(side), tuple(ends)


class _Block:
    """Islands of one topology, fitted to the `_RingShape` of the first: p = (q - center) @ linear + mean."""

    def __init__(self, mesh, layout, shape, members):
        self.mesh, self.layout, self.shape, self.members = mesh, layout, shape, members
        points = mesh.positions[_runs(layout.vertices[members], len(shape.points))].astype(np.float64)
        self.mean = points.mean(axis=1)
        largest = np.abs(points).max(axis=(1, 2))
        points -= self.mean[:, None]
        self.linear = np.einsum("av,nvb->nab", np.linalg.pinv(shape.points), points)
        self.off = np.abs(shape.points @ self.linear - points).max(axis=(1, 2))
        # The rounding of the first grows with the stretch.
        stretch = np.linalg.norm(self.linear, axis=(1, 2))
        self.rounding = ROUNDING * (largest + stretch * np.abs(shape.points + shape.center).max())

    def take(self, attributes, smooth_only, taken):
        """The primitives of the islands that are the shape; marks them in `taken` (islands,) bool."""
        shape, body = self.shape, self.shape.body
        pieces = [*shape.side, *(piece for _, piece in shape.caps)]
        sphere = isinstance(body, Sphere)
        scale, good = self._scale(None if sphere else body.axis, body)
        good &= self._faces_alike(self.mesh.material, pieces)
        if smooth_only:
            good &= self._faces_alike(self.mesh.smooth, shape.side) & self.mesh.smooth[self._first_face(shape.side[0])]
        values, alike = self._values(attributes, pieces)
        good &= alike
        taken[self.members[good]] = True
        if not good.any():
            return []
        if sphere:
            return [self._spheres(good, scale, values)]
        return [*self._sides(good, scale, values), *self._caps(good, scale, values)]

    def _scale(self, axis, body):
        """How much each island is larger than the first, across the axis where there is one: (n,), and whether it
        keeps the shape: (n,) bool."""
        across = np.eye(3) if axis is None else _across(axis)
        vectors = across @ self.linear
        gram = vectors @ vectors.transpose(0, 2, 1)
        scale = np.sqrt(np.trace(gram, axis1=1, axis2=2) / len(across))
        radius = scale * (max(body.radius_base, body.radius_apex) if hasattr(body, "radius_base") else body.radius)
        with np.errstate(divide="ignore", invalid="ignore"):
            tolerance = 2.0 * (POSITION_TOLERANCE + self.rounding / radius)
            gram = gram / (scale**2)[:, None, None]
            if axis is not None:
                along = axis @ self.linear
                along /= np.linalg.norm(along, axis=-1, keepdims=True)
                upright = np.abs(np.einsum("nai,ni->na", vectors, along)).max(axis=1) / scale
            else:
                upright = np.zeros(len(scale))
            good = (np.abs(gram - np.eye(len(across))).max(axis=(1, 2)) <= 2.0 * tolerance) & (upright <= tolerance)
            good &= (self.off <= tolerance * radius) & (np.linalg.det(self.linear) > 0.0)
        return scale, good

    def _points(self, point, rows):
        return (point - self.shape.center) @ self.linear[rows] + self.mean[rows]

    def _first_face(self, piece):
        return self.layout.faces[self.members] + piece.faces[0]

    def _faces_alike(self, values, pieces):
        """Where all faces of each piece have one value: (n,) bool."""
        alike = np.ones(len(self.members), bool)
        if (values == values[0]).all():
            return alike
        for piece in pieces:
            of_face = values[self.layout.faces[self.members][:, None] + piece.faces]
            alike &= (of_face == of_face[:, :1]).all(axis=1)
        return alike

    def _values(self, attributes, pieces):
        """Attribute values by name, (n, 4) for each place of each piece, and where each place has one: (n,) bool."""
        alike = np.ones(len(self.members), bool)
        found = {}
        for name, (values, domain) in attributes.items():
            found[name] = []
            for place in (place for piece in pieces for place in piece.places):
                corners = self.layout.corners[self.members][:, None] + place
                of_place = values[self._elements(corners, domain)]
                first = of_place[:, 0]
                alike &= _same(of_place, first[:, None]).all(axis=1)
                found[name].append(first)
        return found, alike

    def _elements(self, corners, domain):
        """The element of a domain at each of corners (n, m)."""
        if domain == "CORNER":
            return corners
        return self.mesh.corner_vertex[corners] if domain == "POINT" else self.mesh.corner_face[corners]

    def _spheres(self, rows, scale, values):
        return Spheres(
            center=self._points(self.shape.body.centre, rows),
            radius=scale[rows] * self.shape.body.radius,
            material=self.mesh.material[self._first_face(self.shape.side[0])[rows]],
            attributes={name: places[0][rows] for name, places in values.items()},
        )

    def _sides(self, rows, scale, values):
        """Each side as one primitive where no attribute changes along it, else as one between every two rings."""
        count, heights = len(self.shape.side), self.shape.heights
        changes = np.zeros(len(rows), bool)
        for places in values.values():
            for place in places[1 : 2 * count]:
                changes |= ~_same(place, places[0])
        strips = [(rows & ~changes, 0, heights[[0, -1]], (0, 0))]
        strips += [(rows & changes, k, heights[k : k + 2], (2 * k, 2 * k + 1)) for k in range(count)]
        return [self._strip(*strip, scale, values) for strip in strips if strip[0].any()]

    def _strip(self, rows, number, heights, ends, scale, values):
        body = self.shape.body
        base, apex = (self._points(body.base + body.axis * (body.length * h), rows) for h in heights)
        columns = {
            "base": base,
            "apex": apex,
            "material": self.mesh.material[self._first_face(self.shape.side[number])[rows]],
            "attributes": {n: np.stack([places[end][rows] for end in ends], 1) for n, places in values.items()},
        }
        if not hasattr(body, "radius_base"):
            return Cylinders(radius=scale[rows] * body.radius, **columns)
        radii = body.radius_base + (body.radius_apex - body.radius_base) * np.asarray(heights)
        return Cones(base_radius=scale[rows] * radii[0], apex_radius=scale[rows] * radii[1], **columns)

    def _caps(self, rows, scale, values):
        first = 2 * len(self.shape.side)
        for k, (disc, piece) in enumerate(self.shape.caps):
            yield Discs(
                center=self._points(disc.centre, rows),
                normal=disc.normal @ self.linear[rows],
                radius=scale[rows] * disc.radius,
                material=self.mesh.material[self._first_face(piece)[rows]],
                attributes={name: places[first + k][rows] for name, places in values.items()},
            )


def _same(a, b):
    """Whether colours (..., 4) are one: (...) bool."""
    absolute, relative = _SAME_VALUE
    return np.abs(a - b).max(axis=-1) <= absolute + relative * np.abs(b).max(axis=-1)


def _across(axis):
    """Two unit vectors (2, 3) perpendicular to the unit vector `axis` and to each other."""
    return np.linalg.svd(axis[None])[2][1:]
