"""These run where the add-on Molecular Nodes is: `tools/setup molecules`, .venvs/molecules/bin/python -m pytest."""

import pytest


@pytest.fixture(autouse=True)
def _empty_blender(empty_blender):
    """Reset Blender before each test."""
