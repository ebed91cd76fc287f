"""These run where the add-on Molecular Nodes is installed: `tools/setup molecules`, .venvs/molecules/bin/python."""

import pytest

pytest.importorskip("molecularnodes", reason="Molecular Nodes is not installed", exc_type=ImportError)


@pytest.fixture(autouse=True)
def _empty_blender(empty_blender):
    """Reset Blender before each test."""
