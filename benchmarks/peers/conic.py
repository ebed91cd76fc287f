"""Conic itself: the engine on a headless context."""

import numpy as np

from addon.engine import Session, Settings
from addon.engine.devices.headless import HeadlessDevice

from .base import Peer


class Conic(Peer):
    """One context for all scenes of a process, as in a session of Blender."""

    name = "Conic"
    _device = None

    @classmethod
    def device(cls):
        if Conic._device is None:
            Conic._device = HeadlessDevice()
        return Conic._device

    @classmethod
    def version(cls):
        return cls.device().name

    def __init__(self, scene, size, depth, folder=None, **settings):
        self.scene, self.size = scene, size
        self.settings = {"max_depth": depth, "weight_cutoff": 0.0, "shadows": _shadows(scene)} | settings
        self.session = Session(self.device())
        self.session.load(scene, Settings(**self.settings))

    def trace(self):
        return _trace(self.session, self.size)

    def picture(self):
        return np.clip(self.session.pixels()[..., :3], 0.0, 1.0)

    def rays(self):
        """Rays by kind, counted in a picture of its own."""
        session = Session(self.device())
        session.load(self.scene, Settings(**self.settings | {"count_rays": True}))
        _trace(session, self.size)
        rays = session.statistics()["rays"]
        session.free()
        return rays

    def statistics(self):
        return self.session.statistics()

    def close(self):
        self.session.free()


def _shadows(scene):
    """Clear bodies tint shadows, as in the other programs; without them the plain program does."""
    return "TINTED" if any(any(material.transmit) for material in scene.materials) else "OPAQUE"


def _trace(session, size):
    """Seconds of tracing one picture."""
    session.start(size, size)
    before = session.statistics()["seconds"]["trace"]
    while session.step(60.0):
        pass
    return session.statistics()["seconds"]["trace"] - before
