"""Which parts of the shaders a scene asks for, told from what was packed of it."""

import numpy as np

from .leaves import QUADRICS, ROUND
from .primitives import BY_KIND
from .scene import Visibility


def features_of_packed(plan, in_grids, planes, materials, lights):
    """The features, a frozenset. `in_grids` (G,) bool: geometries that have a grid in place of a tree; `planes`: their
    records; `materials`: the `MaterialTable`; `lights`: as `light_packing` has packed them."""
    found = _kinds(plan, planes) | _leaves(plan, in_grids) | _visibility(plan, planes)
    if plan.attributes.names:
        found.add("HAS_ATTRIBUTES")
    return frozenset(found | materials.features() | lights.features)


def _kinds(plan, planes):
    totals = plan.counts.sum(axis=0)
    found = {f"HAS_{cls.kind.upper()}" for cls, count in zip(BY_KIND, totals, strict=True) if count}
    if len(planes):
        found.add("HAS_PLANE")
    if plan.placed:
        found.add("HAS_INSTANCES")
    return found


def _leaves(plan, in_grids):
    """Which kinds are tested where."""
    counts = np.where(in_grids[:, None], 0, plan.counts_in_trees)
    found = {f"HAS_{BY_KIND[label].kind.upper()}_LEAVES" for label in np.flatnonzero(counts.any(axis=0))}
    found |= {f"HAS_{BY_KIND[label].kind.upper()}_OUTSIDE" for label in np.flatnonzero(plan.outside)}
    if in_grids.any():
        found.add("HAS_GRID")
        if plan.counts_in_trees[in_grids][:, QUADRICS].any():
            found.add("HAS_GRID_CYLINDERS")
        if not (plan.placed or counts.any()):
            found.add("HAS_GRID_ALONE")
    quadrics, spheres = counts[:, QUADRICS].any(axis=1), counts[:, ROUND & ~QUADRICS].any(axis=1)
    if quadrics.any():
        found.add("HAS_QUADRIC_LEAVES")
        if (spheres & ~quadrics).any():
            found.add("HAS_SPHERE_RUNS")
    return found


def _visibility(plan, planes):
    seen = {int(p.visibility) for p in plan.placed} | set(np.unique(planes["visibility"]).astype(int).tolist())
    asks = {
        "HAS_VISIBILITY": any(~bits & Visibility.ALL for bits in seen),
        "HAS_HOLDOUT": any(bits & Visibility.HOLDOUT for bits in seen),
        "HAS_SHADOW_CATCHER": any(bits & Visibility.SHADOW_CATCHER for bits in seen),
    }
    return {name for name, asked in asks.items() if asked}
