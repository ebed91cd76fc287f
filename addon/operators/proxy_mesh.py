# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that stand for exact shapes in Blender's own drawing: overlays, outlines, picking (no bpy here).

Their vertices lie on the shape, and their uv map is the one that Conic gives the exact shape, so that other
engines and Blender's own drawing put an image at the same place.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

SEGMENTS = 32
RINGS = 16


@dataclass(frozen=True)
class ProxyMesh:
    """vertices (v, 3) float64; faces, f lists of vertex indices; uv (c, 2), a row for each corner of each
    face in turn; smooth (f,) bool."""

    vertices: np.ndarray
    faces: list
    uv: np.ndarray
    smooth: np.ndarray

    def inverted(self):
        """The same with faces that look the other way."""
        corners = np.split(np.arange(len(self.uv)), np.cumsum([len(face) for face in self.faces])[:-1])
        order = np.concatenate([corner[::-1] for corner in corners])
        return ProxyMesh(self.vertices, [face[::-1] for face in self.faces], self.uv[order], self.smooth)

    @classmethod
    def join(cls, *parts):
        """Vertices are shared between parts, which number them alike: those of the first part hold."""
        return cls(
            parts[0].vertices,
            [face for part in parts for face in part.faces],
            np.concatenate([part.uv for part in parts]),
            np.concatenate([part.smooth for part in parts]),
        )


@dataclass(frozen=True)
class Tip:
    """A ring that is one vertex: a pole, or the tip of a cone."""

    vertex: int


def _circle(radius, height):
    """(SEGMENTS, 3): the circle about the Z axis, counted from X towards Y."""
    angle = 2.0 * np.pi * np.arange(SEGMENTS) / SEGMENTS
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(SEGMENTS, height)], axis=-1)


def _band(vertices, lower, upper, v_lower, v_upper):
    """The smooth faces between two rings, each given by the index of its first vertex or as a `Tip`.

    u is the angle in turns; the tip's corner has the u of its triangle's middle.
    """
    faces, uv = [], []
    for i in range(SEGMENTS):
        j = (i + 1) % SEGMENTS
        u0, u1, middle = i / SEGMENTS, (i + 1) / SEGMENTS, (i + 0.5) / SEGMENTS
        if isinstance(upper, Tip):
            faces.append([lower + i, lower + j, upper.vertex])
            uv += [(u0, v_lower), (u1, v_lower), (middle, v_upper)]
        elif isinstance(lower, Tip):
            faces.append([lower.vertex, upper + j, upper + i])
            uv += [(middle, v_lower), (u1, v_upper), (u0, v_upper)]
        else:
            faces.append([lower + i, lower + j, upper + j, upper + i])
            uv += [(u0, v_lower), (u1, v_lower), (u1, v_upper), (u0, v_upper)]
    return ProxyMesh(vertices, faces, np.array(uv), np.ones(SEGMENTS, bool))


def _cap(vertices, first, radius, upwards):
    """The flat face over a ring; uv = 1/2 + d / 2R along X and, seen from outside, a quarter turn to its
    left."""
    ring = np.arange(first, first + SEGMENTS)
    face = ring if upwards else ring[::-1]
    left = 1.0 if upwards else -1.0
    uv = 0.5 + vertices[face, :2] * (1.0, left) / (2.0 * radius)
    return ProxyMesh(vertices, [face.tolist()], uv, np.zeros(1, bool))


def sphere(radius):
    """A sphere about the origin with its poles on the Z axis: u = phi / 2 pi, v = 1 - theta / pi."""
    theta = np.pi * np.arange(RINGS - 1, 0, -1) / RINGS  # from the south to the north
    rings = [_circle(radius * np.sin(t), radius * np.cos(t)) for t in theta]
    vertices = np.concatenate([*rings, [(0.0, 0.0, -radius), (0.0, 0.0, radius)]])
    starts = [Tip(len(vertices) - 2), *range(0, SEGMENTS * (RINGS - 1), SEGMENTS), Tip(len(vertices) - 1)]
    bands = [
        _band(vertices, lower, upper, k / RINGS, (k + 1) / RINGS) for k, (lower, upper) in enumerate(pairwise(starts))
    ]
    return ProxyMesh.join(*bands)


def cone(radius1, radius2, depth, *, caps=True):
    """A cone about the Z axis, `radius1` at -depth / 2, `radius2` at depth / 2; one of them may be 0. With `caps` it
    is solid.

    Its side has u = theta / 2 pi and v = height / depth, its caps the uv of discs.
    """
    ends = [(radius, height) for radius, height in ((radius1, -depth / 2.0), (radius2, depth / 2.0))]
    vertices, starts, count = [], [], 0
    for radius, height in ends:
        ring = _circle(radius, height) if radius > 0.0 else np.array([(0.0, 0.0, height)])
        starts.append(count if radius > 0.0 else Tip(count))
        vertices.append(ring)
        count += len(ring)
    vertices = np.concatenate(vertices)
    parts = [_band(vertices, *starts, 0.0, 1.0)]
    for start, (radius, _), upwards in zip(starts, ends, (False, True), strict=True):
        if caps and radius > 0.0:
            parts.append(_cap(vertices, start, radius, upwards))
    return ProxyMesh.join(*parts)


def cylinder(radius, depth):
    """A solid cylinder about the Z axis from -depth / 2 to depth / 2."""
    return cone(radius, radius, depth)


def disc(radius):
    """A disc about the origin that faces up the Z axis: uv = 1/2 + d / 2R."""
    return _cap(_circle(radius, 0.0), 0, radius, upwards=True)


def plane(size):
    """A square of `size` about the origin that faces up the Z axis: uv = (x, y), as the plane without end
    goes on beyond it: an image repeats every unit."""
    half = size / 2.0
    vertices = np.array([(-half, -half, 0.0), (half, -half, 0.0), (half, half, 0.0), (-half, half, 0.0)])
    return ProxyMesh(vertices, [[0, 1, 2, 3]], vertices[:, :2], np.zeros(1, bool))
