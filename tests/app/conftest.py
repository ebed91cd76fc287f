"""Every test here begins in an empty Blender application, with Conic registered."""

import pytest

from tests.app.viewport_scene import middle, reset, scene_in_window


@pytest.fixture(autouse=True)
def _empty_blender(empty_blender):
    """Reset Blender before each test."""


@pytest.fixture(scope="module")
def window(registered, tmp_path_factory):
    """Blender's window with the viewports' scene, one for each file of tests: on Vulkan with Mesa's software driver
    Blender ends where all its draws, of any engine, are 65,530 (Linux' vm.max_map_count): the memory of each one's
    descriptor set is mapped until Blender's pool of them is full, and that driver never says so."""
    with scene_in_window(tmp_path_factory.mktemp("viewport")) as window:
        yield window


@pytest.fixture
def rested(window):
    """The window at rest, its log empty."""
    reset(window)
    window.move(*middle(window))
    return window
