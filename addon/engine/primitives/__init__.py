"""The kinds of primitives, a file each. `BY_KIND` is in the order of the leaf labels (`layout.KINDS`)."""

from ..layout import KINDS
from .base import Primitives
from .cone import Cones
from .cylinder import Cylinders
from .disc import Discs
from .plane import Planes
from .sphere import Spheres
from .transforms import AxialStretch, Similarity, invertible, keeps_round, keeps_shapes, thickened
from .triangle import Triangles

_CLASSES = {cls.kind: cls for cls in (Spheres, Cylinders, Cones, Discs, Triangles)}

#: Classes of what stands in a tree, by leaf label.
BY_KIND = tuple(_CLASSES[kind] for kind in KINDS if kind in _CLASSES)

__all__ = [
    "BY_KIND",
    "AxialStretch",
    "Cones",
    "Cylinders",
    "Discs",
    "Planes",
    "Primitives",
    "Similarity",
    "Spheres",
    "Triangles",
    "invertible",
    "keeps_round",
    "keeps_shapes",
    "thickened",
]
