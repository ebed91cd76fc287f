"""All that stands in the world as rows of an array: the upper tree and the two records of each instance."""

from dataclasses import dataclass

import numpy as np

from . import bvh, layout, reference
from .errors import SceneError
from .residency import KeptTree
from .scene import Instances
from .threads import pieces
from .tree_packing import QUICK_FROM, WORN


@dataclass
class PlacedInstances:
    """A row for each leaf of the upper tree, in the order of the scene: `matrices` (n, 4, 4) float64 relative to the
    origin, `geometry` and `first_material` (n,) int64, `visibility` (n,) int32."""

    matrices: np.ndarray
    geometry: np.ndarray
    first_material: np.ndarray
    visibility: np.ndarray


def blocks(scene, plan):
    """The `Instances` of a plan, the world's shapes first where they are among what is placed."""
    return [*([Instances(scene.shapes, np.eye(4), None)] if plan.shapes else []), *plan.placed]


def place(placed, plan, materials, origin):
    """`PlacedInstances` of the `blocks`; `materials` is the `MaterialTable`."""
    numbers, firsts = plan.placed_numbers, materials.firsts
    if plan.shapes:
        numbers, firsts = [0, *numbers], [0, *firsts]
    counts = [len(p) for p in placed]
    matrices = np.empty((sum(counts), 4, 4))
    start = 0
    for p, number in zip(placed, numbers, strict=True):
        block = matrices[start : start + len(p)]
        block[:] = p.matrices
        if plan.in_world[number]:  # its primitives are relative to the origin themselves
            block[:, :3, 3] += block[:, :3, :3] @ origin
        block[:, :3, 3] -= origin
        start += len(p)
    return PlacedInstances(
        matrices,
        np.repeat(numbers, counts),
        np.repeat(firsts, counts),
        np.repeat(np.array([int(p.visibility) for p in placed], np.int32), counts),
    )


def upper_tree(instances, bounds, kept=None, *, quick=False):
    """The tree over the instances' boxes, and what of it may be kept; `bounds` (G, 2, 3): of the geometries by number.

    `kept`: the `KeptTree` of as many instances, most of which are the same. It serves again unless it is worn. `quick`:
    whether a large tree is built quickly.
    """
    count = len(instances.matrices)
    lower, upper = np.empty((count, 3), np.float32), np.empty((count, 3), np.float32)
    for rows in pieces(count):
        low, high = moved_boxes(bounds[instances.geometry[rows]], instances.matrices[rows])
        lower[rows], upper[rows] = bvh.rounded_outward(low, high)
    if kept is not None:
        order = kept.form.bvh.order
        tree = kept.form.around(np.concatenate([-lower[order].T, upper[order].T]))
        if np.isfinite(tree.boxes).all() and bvh.sah_cost(tree) <= WORN * kept.sah_cost:
            return tree, kept
    try:
        build = bvh.quick_build if quick and count >= QUICK_FROM else bvh.build
        tree = build(lower, upper, leaf_size=1)
    except ValueError as error:
        raise SceneError(f"instances: {error}") from error
    return tree, KeptTree(bvh.Form(tree), float(bvh.sah_cost(tree)))


def write_records(hits, surfaces, instances, order, roots):
    """Write the records (n,) of `layout.INSTANCE` and `layout.INSTANCE_SURFACE` of the instances in `order`.

    `roots` (G,) int64: references to the geometries' trees.
    """
    low, high = reference.split_index(roots)
    for rows in pieces(len(order)):
        picked = order[rows]
        matrices, geometry = instances.matrices[picked], instances.geometry[picked]
        to_object = affine_inverse(matrices)
        for row, axis in enumerate("xyz"):
            hits[f"to_object_{axis}"][rows] = to_object[:, row]
            surfaces[f"to_world_{axis}"][rows] = matrices[:, row]
        hits["root"][rows], hits["root_high"][rows] = low[geometry], high[geometry]
        hits["first_material"][rows] = instances.first_material[picked]
        hits["geometry"][rows], hits["visibility"][rows] = geometry, instances.visibility[picked]


def write_attributes(writer, placed, order):
    """Write the instances' attributes by an `AttributeWriter`; 0 where one lacks it."""
    leaf = np.empty(len(order), np.int64)
    leaf[order] = np.arange(len(order))
    for key in writer.first:
        if layout.KINDS[key[2]] != "instance":
            continue
        texels, start = writer.texels(key), 0
        for p in placed:
            if key[0] in p.attributes:
                texels[leaf[start : start + len(p)]] = p.attributes[key[0]]
            start += len(p)


def affine_inverse(matrices):
    """Inverses (n, 4, 4) of affine matrices (n, 4, 4), float64, by cofactors."""
    x, y, z, place = (matrices[:, :3, column] for column in range(4))
    linear = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=1)
    linear /= np.einsum("ni,ni->n", x, linear[:, 0])[:, None, None]
    inverse = np.zeros_like(matrices)
    inverse[:, :3, :3] = linear
    inverse[:, :3, 3] = -np.einsum("nij,nj->ni", linear, place)
    inverse[:, 3, 3] = 1.0
    return inverse


def moved_boxes(bounds, matrices):
    """Boxes (n, 2, 3) under affine matrices (n, 4, 4): lower and upper corners (n, 3). (Arvo 1990, Graphics Gems.)"""
    center = bounds.mean(axis=1)
    half = (bounds[:, 1] - bounds[:, 0]) / 2.0
    moved = np.einsum("nij,nj->ni", matrices[:, :3, :3], center) + matrices[:, :3, 3]
    reach = np.einsum("nij,nj->ni", np.abs(matrices[:, :3, :3]), half)
    return moved - reach, moved + reach
