"""The application that runs these tests is the one that was asked for."""

import sys

import bpy
import gpu
import pytest


def test_it_is_the_application_not_the_module():
    assert bpy.app.binary_path
    assert bpy.app.version >= (4, 2, 0)


def test_gpu_backend_is_the_asked_one():
    if not hasattr(gpu, "init"):
        pytest.skip("before 5.2 Blender has no GPU context in the background outside of render()")
    asked = sys.argv[sys.argv.index("--gpu-backend") + 1]
    assert gpu.platform.backend_type_get() == asked.upper()


def test_conic_is_a_render_engine():
    bpy.context.scene.render.engine = "CONIC"
    assert bpy.context.engine == "CONIC"
