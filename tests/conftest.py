"""What all tests share: hypothesis' profile, Blender with Conic registered from this checkout, and how Python ends."""

import atexit
import gc
import os
import sys

import pytest
from hypothesis import settings

# A software rasteriser compiles a shader in the first example and then draws fast.
settings.register_profile("conic", deadline=None, print_blob=True)
settings.load_profile("conic")


@pytest.fixture(scope="session")
def registered():
    """The add-on, registered in Blender's factory state; unregistered before Python ends, where Blender 4.2 would crash
    and 4.5 hang."""
    import bpy

    import addon

    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register()
    yield addon
    addon.unregister()


@pytest.fixture
def empty_blender(registered):
    """A new file of Blender's with nothing in the scene, Conic registered. Preferences stay as they are: to read them
    takes much longer than most tests do."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def pytest_collection_finish(session):
    """Whoever collects garbage need not look through the tests themselves, which are thousands of objects."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    """End Python at once where Blender before 5.0 is a module. It ends when nothing refers to bpy any more; pytest
    keeps functions and failed tests' tracebacks that do, so that it would end after Python, and crash."""
    session = config.pluginmanager.get_plugin("session")
    bpy = sys.modules.get("bpy")
    if session and bpy and not bpy.app.binary_path and bpy.app.version < (5, 0, 0):
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(session.exitstatus)
