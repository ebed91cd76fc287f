# SPDX-License-Identifier: GPL-3.0-or-later
"""Recognised or chosen shapes as the engine's primitives, in object space."""

from dataclasses import dataclass

import numpy as np

from ..engine.scene import Cones, Cylinders, Discs, Planes, Spheres
from .recognise import Cone, Cylinder, Disc, Recognition, Sphere, UvMap

#: Relative extent below which a bounding box is flat.
_FLAT = 1e-6
#: How far the cosine of the angle between two axes may be from 1.
_PARALLEL = 1e-9


@dataclass(frozen=True, eq=False)
class Shape:
    """Primitives that make up one exact shape, their material being the slot, in a space that `local` (4, 4) takes to
    the object's."""

    primitives: tuple
    local: np.ndarray

    @property
    def axis(self):
        """The unit vector (3,) around which all its primitives, cylinders, cones and discs, are round; None where there
        is no such one."""
        directions = [_directions(part) for part in self.primitives]
        if any(of_part is None for of_part in directions):
            return None
        directions = np.concatenate(directions).astype(np.float64)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        parallel = np.abs(directions @ directions[0]) >= 1.0 - _PARALLEL
        return directions[0] if parallel.all() else None


def _directions(part):
    """The axis (n, 3) of each row of cylinders, cones or discs; None for other kinds."""
    if isinstance(part, Discs):
        return part.normal
    return part.apex - part.base if isinstance(part, Cylinders | Cones) else None


def shape_of(recognition):
    """The `Shape` of a Recognition that is not MESH."""
    local = np.eye(4)
    if recognition.local is not None:
        local[:3] = recognition.local
    return Shape(tuple(_MAKE[part.kind](part) for part in recognition.parts), local)


def is_closed_shape(shape):
    """Whether a `Shape` is the whole border of a body: a disc alone is not, nor a cylinder or cone without its ends.

    The infinite plane is: what lies below it, as water.
    """
    discs = ends = 0
    for part in shape.primitives:
        if isinstance(part, Discs):
            discs += len(part)
        elif isinstance(part, Cylinders):
            ends += 2 * len(part)
        elif isinstance(part, Cones):
            ends += np.count_nonzero(part.base_radius > 0.0) + np.count_nonzero(part.apex_radius > 0.0)
    return discs == ends


def plane_shape():
    """The infinite plane through the object's origin where its X and Y axes lie."""
    return Shape((Planes(point=(0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0)),), np.eye(4))


def fitted(kind, positions):
    """The shape inscribed in the bounding box of positions (n, 3) as a Recognition of `kind`, or None where the box
    is flat in a direction that the shape needs. Its axis is Z, a cone's tip is up."""
    low, high = positions.min(axis=0).astype(np.float64), positions.max(axis=0).astype(np.float64)
    half = (high - low) / 2.0
    needed = 2 if kind == "DISC" else 3
    if not np.isfinite(half).all() or not (half[:needed] > _FLAT * half.max()).all():
        return None
    if kind == "DISC":
        half[2] = half[:2].max()  # any: a disc has no height
    local = np.column_stack([np.diag(half), (low + high) / 2.0])
    return Recognition(
        kind, f"{kind.lower()}: chosen in the object's settings, fits its bounding box", _unit(kind), local, True
    )


def _unit(kind):
    """Parts of the unit shape: radius 1, axis Z from -1 to 1."""
    up, x, bottom = np.array((0.0, 0.0, 1.0)), np.array((1.0, 0.0, 0.0)), np.array((0.0, 0.0, -1.0))
    uv = UvMap()
    if kind == "SPHERE":
        return (Sphere(0, uv, np.zeros(3), 1.0, np.eye(3)),)
    if kind == "DISC":
        return (Disc(0, uv, np.zeros(3), up, 1.0, x),)
    base = Disc(0, uv, bottom, -up, 1.0, x)
    if kind == "CYLINDER":
        return Cylinder(0, uv, bottom, up, 2.0, 1.0, x), base, Disc(0, uv, up, up, 1.0, x)
    return Cone(0, uv, bottom, up, 2.0, 1.0, 0.0, x), base


def _sphere(part):
    return Spheres(
        center=part.centre,
        radius=part.radius,
        material=part.material,
        pole=part.frame[:, 2],
        meridian=part.frame[:, 0],
    )


def _cylinder(part):
    return Cylinders(
        base=part.base,
        apex=part.base + part.axis * part.length,
        radius=part.radius,
        material=part.material,
        meridian=part.e0,
        uv_transform=part.uv.transform,
    )


def _cone(part):
    return Cones(
        base=part.base,
        apex=part.base + part.axis * part.length,
        base_radius=part.radius_base,
        apex_radius=part.radius_apex,
        material=part.material,
        meridian=part.e0,
        uv_transform=part.uv.transform,
        planar=int(part.uv.planar),
    )


def _disc(part):
    return Discs(
        center=part.centre,
        normal=part.normal,
        radius=part.radius,
        material=part.material,
        meridian=part.e0,
        uv_transform=part.uv.transform,
    )


_MAKE = {"SPHERE": _sphere, "CYLINDER": _cylinder, "CONE": _cone, "DISC": _disc}
