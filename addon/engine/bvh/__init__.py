"""Bounding volume hierarchies over boxes with labels: build, refit, measure. No primitive is known here."""

from .boxes import rounded_outward
from .build import build
from .cost import sah_cost, statistics
from .form import Form
from .quick import quick_build
from .refit import refit
from .sweep import sweep_build
from .tree import FAR, MAX_DEPTH, Bvh

__all__ = [
    "FAR",
    "MAX_DEPTH",
    "Bvh",
    "Form",
    "build",
    "quick_build",
    "refit",
    "rounded_outward",
    "sah_cost",
    "statistics",
    "sweep_build",
]
