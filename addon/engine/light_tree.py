"""The light tree: of many lights, which ones a point may ask.

A node knows where its lights are, into which directions they shine, and what they give together (Conty Estevez and
Kulla 2018, Importance Sampling of Many Lights with Adaptive Tree Splitting). The tree is a forest: lights that differ
in more than place, direction and color have trees of their own, so that one light can stand for a node. Its order is
depth first, each node knows the next one that is not below it, and the shader needs no stack.
"""

from dataclasses import dataclass, fields

import numpy as np

from . import bvh, layout
from .primitives.base import perpendicular_part

#: `cos_axis` of what shines to all sides.
ALL_SIDES = -2.0
#: How much wider a cone is stored than it is: what the shader's arithmetic may be wrong by.
_SLACK = 1e-4


@dataclass
class LightBounds:
    """What a tree needs to know of n lights; all arrays float64 (n, ...) but `light` and `group`, int64.

    `center` (n, 3) and `radius` (n,) of the sphere that holds a light; of the cone of directions in which it shines
    straight ahead the middle `axis` (n, 3) and the cosine `cos_axis` (n,) of half its angle, ALL_SIDES for all, and of
    the largest angle off them under which it is seen the cosine `cos_reach` (n,); `color` (n, 3) as in `Light`;
    `falls_off` (n,) 1 or 0; `light` (n,) its number; `group` (n, k): what lights of one tree have in common.
    """

    center: np.ndarray
    radius: np.ndarray
    axis: np.ndarray
    cos_axis: np.ndarray
    cos_reach: np.ndarray
    color: np.ndarray
    falls_off: np.ndarray
    light: np.ndarray
    group: np.ndarray

    def __len__(self):
        return len(self.center)

    def take(self, rows):
        return LightBounds(*(getattr(self, field.name)[rows] for field in fields(self)))

    @classmethod
    def concatenate(cls, parts):
        return cls(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(cls)))


def build_light_tree(bounds):
    """Records of `layout.LIGHT_NODE`, (2n - trees,), of `LightBounds`: a tree after the other, by `group` in ascending
    order. Lights that give nothing are left out."""
    bounds = bounds.take(bounds.color.max(axis=1, initial=0.0) > 0.0)
    if not len(bounds):
        return layout.LIGHT_NODE.zeros(0)
    _, tree_of = np.unique(bounds.group, axis=0, return_inverse=True)
    order = np.argsort(tree_of.ravel(), kind="stable")
    starts = np.flatnonzero(np.diff(tree_of.ravel()[order], prepend=-1))
    trees, first = [], 0
    for rows in np.split(order, starts[1:]):
        trees.append(_tree(bounds.take(rows), first))
        first += len(trees[-1])
    return np.concatenate(trees)


def _tree(bounds, first):
    """Records of the tree over lights of one group, node 0 of which is number `first` of all."""
    children = _children(bounds)
    levels = _levels(children, len(bounds))
    nodes = _merged(bounds, children, levels)
    size = np.ones(len(nodes["brightness"]), np.int64)
    for inner, below in reversed(levels):
        size[inner] = 1 + size[below].sum(axis=1)
    place = np.zeros(len(size), np.int64)
    for inner, (left, right) in ((inner, below.T) for inner, below in levels):
        place[left] = place[inner] + 1
        place[right] = place[left] + size[left]
    records = layout.LIGHT_NODE.zeros(len(size))
    for name, values in nodes.items():
        records[name][place] = values
    records["next"][place] = first + place + size
    return records


def _children(bounds):
    """Children (n - 1, 2) int64 of the inner nodes n, n + 1, ..., the root first; below n they are lights."""
    count = len(bounds)
    if count == 1:
        return np.zeros((0, 2), np.int64)
    reach = bounds.radius[:, None]
    lower, upper = bvh.rounded_outward(bounds.center - reach, bounds.center + reach)
    tree = bvh.build(lower, upper, leaf_size=1)
    return np.where(tree.is_leaf, tree.order[np.where(tree.is_leaf, tree.child, 0)], count + tree.child)


def _levels(children, count):
    """The inner nodes of each level and their children, from the root down: [((k,), (k, 2)), ...]."""
    levels, level = [], np.arange(count, count + (len(children) > 0))
    while len(level):
        below = children[level - count]
        levels.append((level, below))
        level = below[below >= count]
    return levels


def _merged(bounds, children, levels):
    """Members of all nodes by name, those of the lights first."""
    nodes = {
        "center": bounds.center,
        "radius": bounds.radius,
        "axis": bounds.axis,
        "cos_axis": bounds.cos_axis,
        "color": bounds.color,
        "cos_reach": bounds.cos_reach,
        "falls_off": bounds.falls_off,
        "light": bounds.light,
    }
    nodes = {name: np.concatenate([v, np.zeros((len(children), *v.shape[1:]), v.dtype)]) for name, v in nodes.items()}
    nodes["brightness"] = nodes["color"].mean(axis=1)
    brightest = nodes["brightness"].copy()
    for inner, below in reversed(levels):
        nodes["color"][inner] = nodes["color"][below].sum(axis=1)
        weight = nodes["brightness"][below]
        nodes["brightness"][inner] = weight.sum(axis=1)
        weight = (weight / weight.sum(axis=1, keepdims=True))[..., None]
        center = (weight * nodes["center"][below]).sum(axis=1)
        offset = np.linalg.norm(nodes["center"][below] - center[:, None], axis=-1)
        nodes["center"][inner], nodes["radius"][inner] = center, (offset + nodes["radius"][below]).max(axis=1)
        axis, cos_axis = merged_cones(nodes["axis"][below], nodes["cos_axis"][below])
        nodes["axis"][inner], nodes["cos_axis"][inner] = axis, cos_axis
        nodes["cos_reach"][inner] = nodes["cos_reach"][below].min(axis=1)
        nodes["falls_off"][inner] = nodes["falls_off"][below[:, 0]]
        brighter = np.take_along_axis(below, np.argmax(brightest[below], axis=1)[:, None], axis=1)[:, 0]
        nodes["light"][inner], brightest[inner] = nodes["light"][brighter], brightest[brighter]
    nodes["radius"] *= 1.0 + _SLACK
    wide = np.cos(np.minimum(np.arccos(np.clip(nodes["cos_axis"], -1.0, 1.0)) + _SLACK, np.pi))
    nodes["cos_axis"] = np.where(nodes["cos_axis"] < -1.0, ALL_SIDES, wide)
    return nodes


def merged_cones(axis, cosine):
    """The axes (n, 3) and cosines (n,) of cones that hold two cones each: axes (n, 2, 3), cosines (n, 2)."""
    large = np.argmin(cosine, axis=1)[:, None]
    a, b = (np.take_along_axis(axis, rows[..., None], axis=1)[:, 0] for rows in (large, 1 - large))
    half = np.arccos(np.clip(cosine, -1.0, 1.0))
    wide, narrow = (np.take_along_axis(half, rows, axis=1)[:, 0] for rows in (large, 1 - large))
    between = 2.0 * np.arcsin(np.minimum(np.linalg.norm(a - b, axis=1) / 2.0, 1.0))
    angle = np.clip((wide + narrow + between) / 2.0, wide, np.pi)
    turn = np.where(between + narrow <= wide, 0.0, angle - wide)
    angle = np.where(between + narrow <= wide, wide, angle)
    across = perpendicular_part(b, a)  # of what lies straight opposite any direction will do
    turned = np.cos(turn)[:, None] * a + np.sin(turn)[:, None] * across
    return turned, np.where((cosine < -1.0).any(axis=1), ALL_SIDES, np.cos(angle))
