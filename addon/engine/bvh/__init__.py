"""Bounding volume hierarchies over boxes with labels: build, refit, measure. No primitive is known here."""

from .boxes import rounded_outward
from .build import build, build_forest
from .cost import sah_cost, sah_costs, statistics
from .form import Form
from .quick import QuickTree, quick_build
from .refit import refit
from .sweep import sweep_build
from .tree import FAR, MAX_DEPTH, Bvh, Forest

__all__ = [
    "FAR",
    "MAX_DEPTH",
    "Bvh",
    "Forest",
    "Form",
    "QuickTree",
    "build",
    "build_forest",
    "quick_build",
    "refit",
    "rounded_outward",
    "sah_cost",
    "sah_costs",
    "statistics",
    "sweep_build",
]
