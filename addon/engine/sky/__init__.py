"""Skies as tables by direction, scene-linear Rec. 709, and the radiance of the sun's disc.

Three models, with the constants of those that Blender offers, so that numbers agree. A table (ROWS, COLUMNS, 3) float32
is kept for a while: the same sky is asked for again at each change of anything else.
"""

from functools import lru_cache

from . import multiple, preetham, single
from .table import COLUMNS as COLUMNS
from .table import ROWS as ROWS

single_scattering = lru_cache(8)(single.table)
single_scattering_sun = single.sun
multiple_scattering = lru_cache(8)(multiple.table)
multiple_scattering_sun = multiple.sun
horizon = multiple.horizon
preetham_table = lru_cache(8)(preetham.table)
