"""A 3D viewport without a window: what a viewport session asks of Blender, and a frame buffer that it draws into."""

import time
from types import SimpleNamespace

import bpy
import gpu
import numpy as np

from addon.viewport import history, scenes
from addon.viewport.session import ViewportSession

WIDTH, HEIGHT = 80, 60


class Engine:
    """What a viewport session asks of a RenderEngine."""

    def __init__(self):
        self.redraws, self.text, self.pixel_size = 0, "", 1

    def tag_redraw(self):
        self.redraws += 1

    def update_stats(self, _stats, info):
        self.text = info

    def get_preview_pixel_size(self, _scene):
        return self.pixel_size


class StandIn:
    """A viewport that looks down on the origin from 10 above, 6 wide. It is also the context of its redraws."""

    def __init__(self, size=(WIDTH, HEIGHT)):
        gpu.init()
        self.engine = Engine()
        self.session = ViewportSession(self.engine)
        self.space_data = None
        self.region_data = SimpleNamespace(is_perspective=False, view_perspective="ORTHO")
        self.resize(*size)
        self.look_from(0.0)

    def resize(self, width, height):
        self.region = SimpleNamespace(width=width, height=height)
        self.texture = gpu.types.GPUTexture((width, height), format="RGBA32F")
        self.framebuffer = gpu.types.GPUFrameBuffer(color_slots=[self.texture])

    def look_from(self, x, width=6.0):
        """Look down from (x, 0, 10) on what is `width` wide."""
        height = width * self.region.height / self.region.width
        self.region_data.view_matrix = np.eye(4)
        self.region_data.view_matrix[:3, 3] = (-x, 0.0, -10.0)
        self.region_data.window_matrix = np.diag([2.0 / width, 2.0 / height, -2.0 / 100.0, 1.0])

    def redraw(self):
        """One redraw; whether another one was asked for."""
        depsgraph = bpy.context.evaluated_depsgraph_get()
        before = self.engine.redraws
        with self.framebuffer.bind():
            self.framebuffer.clear(color=(0.0, 0.0, 0.0, 0.0))
            self.session.draw(self, depsgraph)
        return self.engine.redraws > before

    def settle(self):
        """Redraw until nothing more is asked for; the pixels (h, w, 4)."""
        end = time.monotonic() + 120.0
        while self.redraw() or self.session.waiting:
            if time.monotonic() > end:
                raise AssertionError("it never ends")
            if self.session.waiting:
                time.sleep(0.001)
        return self.pixels()

    def pixels(self):
        """What the frame buffer holds, (h, w, 4)."""
        width, height = self.region.width, self.region.height
        pixels = np.empty(width * height * 4, np.float32)
        buffer = gpu.types.Buffer("FLOAT", pixels.size, pixels)
        with self.framebuffer.bind():
            self.framebuffer.read_color(0, 0, width, height, 4, 0, "FLOAT", data=buffer)
        return pixels.reshape(height, width, 4)

    def close(self):
        """As if Blender closed it."""
        vars(self).clear()


def mark(_scene, depsgraph):
    """As a `view_update` that Blender calls."""
    scenes.mark(depsgraph)


def records(kind):
    """The records of a kind in the log, the newest last."""
    return [record for record in history.records if isinstance(record, kind)]


def loads():
    """Records of what was found to differ and was loaded."""
    return [load for load in records(history.Load) if load.change]


def draws():
    return records(history.Draw)


def sphere_at(pixels):
    """Mean column and area of what is darker than the sky, in pixels."""
    dark = pixels[..., 0] < 0.5
    return np.nonzero(dark)[1].mean() + 0.5, dark.sum()


def add_lamp():
    """A point lamp at the origin."""
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "POINT"))
    bpy.context.collection.objects.link(lamp)
    return lamp
