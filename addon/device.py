# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine's device in Blender."""

import os

import bpy
import gpu

from .engine.devices.blender_gpu import BlenderDevice


class WindowDevice(BlenderDevice):
    """Blender's GPU in the main thread, whose context is now that of one window, now of another.

    A frame buffer belongs to a context (its textures do not): each draw and each reading makes a new one.
    """

    def draw(self, program, target, *arguments):
        self._renew(target)
        super().draw(program, target, *arguments)

    def read(self, target, *arguments):
        self._renew(target)
        return super().read(target, *arguments)

    def _renew(self, target):
        target.framebuffer = gpu.types.GPUFrameBuffer(color_slots=target.colors)


def new_device():
    """A device on Blender's GPU context, which must be active.

    The environment variable CONIC_DEVICE=headless takes a context of its own instead, which needs moderngl; it is
    there to compare the two. Raises DeviceError where there is no such device.
    """
    if os.environ.get("CONIC_DEVICE") == "headless":
        from .engine.devices.headless import HeadlessDevice

        return HeadlessDevice()
    return blender_device()


def blender_device():
    """A device on Blender's GPU context, whose textures Blender can draw."""
    return BlenderDevice() if bpy.app.background else WindowDevice()
