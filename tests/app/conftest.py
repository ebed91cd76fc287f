"""Every test here begins in an empty Blender application, with Conic registered."""

import pytest


@pytest.fixture(autouse=True)
def _empty_blender(empty_blender):
    """Reset Blender before each test."""
