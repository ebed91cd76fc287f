"""The programs that are measured beside Conic, a file each. All have the methods of `base.Peer`."""

from .conic import Conic
from .povray import PovRay
from .tachyon import Tachyon

WHITTED = (Conic, PovRay, Tachyon)
