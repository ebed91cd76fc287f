"""The programs that are measured beside Conic, a file each. All have the methods of `base.Peer`."""

from .conic import Conic
from .conic_casting import ConicCasting
from .embree import Embree
from .mitsuba import Mitsuba
from .povray import PovRay
from .remote import Remote
from .tachyon import Tachyon

WHITTED = (Conic, PovRay, Tachyon)
TRAVERSAL = (Mitsuba, Embree)

__all__ = ["TRAVERSAL", "WHITTED", "Conic", "ConicCasting", "Embree", "Mitsuba", "PovRay", "Remote", "Tachyon"]
