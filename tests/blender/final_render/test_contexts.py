"""Blender's GPU context and a headless one give the same picture."""

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

from addon.engine.devices.headless import HeadlessDevice
from tests.blender.pictures import picture

ROOT = Path(__file__).resolve().parents[3]
# Renders the startup scene with a glass sphere and every kind of shape; sys.argv ends with the picture to write.
BOTH_WAYS = """
import sys, bpy, addon, atexit
addon.register()
atexit.register(addon.unregister)
scene = bpy.context.scene
bpy.ops.mesh.primitive_uv_sphere_add(location=(2.0, -1.0, 0.5))
bpy.ops.object.shade_smooth()
glass = bpy.data.materials.new("glass")
if bpy.app.version < (5, 0, 0):
    glass.use_nodes = True
bsdf = glass.node_tree.nodes["Principled BSDF"]
bsdf.inputs["Transmission Weight"].default_value, bsdf.inputs["Roughness"].default_value = 1.0, 0.0
bpy.context.object.data.materials.append(glass)
bpy.ops.conic.plane_add(location=(0.0, 0.0, -1.0))
bpy.ops.conic.cone_add(location=(-2.0, -1.0, 0.0), radius2=0.3)
bpy.ops.conic.cylinder_add(location=(-1.0, 3.0, 0.0))
bpy.ops.conic.disc_add(location=(0.0, 0.0, 2.0), rotation=(0.3, 0.2, 0.0))
render = scene.render
render.engine = "CONIC"
render.resolution_x, render.resolution_y, render.resolution_percentage = 96, 72, 100
render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
render.filepath = sys.argv[-1]
bpy.ops.render.render(write_still=True)
"""


@pytest.mark.skipif(bool(bpy.app.binary_path), reason="the application does not have moderngl; bpy compares the two")
def test_blenders_gpu_and_a_headless_context_give_the_same_picture(tmp_path):
    pictures = {}
    for device in ("blender", "headless"):
        path = tmp_path / f"{device}.exr"
        environment = {**os.environ, "CONIC_DEVICE": device, "PYTHONPATH": str(ROOT)}
        subprocess.run(
            [sys.executable, "-c", BOTH_WAYS, path], env=environment, capture_output=True, text=True, timeout=240
        )
        pictures[device] = picture(path)
    ours, other = pictures["blender"], pictures["headless"]
    assert ours[..., :3].std() > 0.02, "there is something to see"
    different = np.abs(ours - other).max(axis=-1) > 1e-4 * np.maximum(1.0, np.abs(other).max(axis=-1))
    assert different.mean() < 0.002


@pytest.mark.skipif(sys.platform != "linux", reason="the library is called so there")
def test_a_headless_device_gives_back_the_context(scene, tmp_path):
    """Blender's context is current after it as before: else its programs could not be freed, and Blender would end."""
    pytest.importorskip("moderngl")  # not in the application
    egl = ctypes.CDLL("libEGL.so.1")
    egl.eglGetCurrentContext.restype = ctypes.c_void_p
    scene.render.filepath = str(tmp_path / "picture.exr")
    bpy.ops.render.render(write_still=True)
    before = egl.eglGetCurrentContext()
    HeadlessDevice().close()
    assert egl.eglGetCurrentContext() == before
