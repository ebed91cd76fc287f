"""What all tests share: hypothesis' profile, and Blender with Conic registered from this checkout."""

import pytest
from hypothesis import settings

# A software rasteriser compiles a shader in the first example and then draws fast.
settings.register_profile("conic", deadline=None, print_blob=True)
settings.load_profile("conic")


@pytest.fixture(scope="session")
def registered():
    """The add-on, registered; unregistered before Python ends, where Blender 4.2 would crash and 4.5 hang."""
    import addon

    addon.register()
    yield addon
    addon.unregister()


@pytest.fixture
def empty_blender(registered):
    """Blender's factory state with nothing in the scene, Conic registered."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
