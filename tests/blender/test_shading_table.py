"""Every case of the table of comparisons with Cycles; see `shading_table`."""

import bpy
import pytest

from tests.blender.shading_table import cases, keys_to_test
from tests.blender.shading_table.drawing import compare, faults, pictures


@pytest.fixture(scope="session")
def drawn():
    """`Compared` by key of what was drawn so far, or what kept a picture from being drawn."""
    return {}


def _draw_with(key, drawn, items):
    """Draw the picture that a case is on, with those of its cases only that are tested in this session."""
    chosen = {i.callspec.params["key"] for i in items if i.originalname == test_case.__name__}
    known = {k: case for k, case in cases().items() if k in chosen}
    keys = next(keys for keys in pictures(known) if key in keys)
    try:
        drawn.update(compare({k: known[k] for k in keys}))
    except Exception as error:
        drawn.update(dict.fromkeys(keys, error))


@pytest.mark.parametrize("key", keys_to_test())
def test_case(key, drawn, request, record_property):
    case = cases()[key]
    if key not in drawn:
        _draw_with(key, drawn, request.session.items)
    compared = drawn[key]
    if isinstance(compared, Exception):
        raise compared
    record_property("median relative error", compared.median)
    assert not faults(case, compared)


def test_names_of_cases_fit_those_of_materials():
    names = [key.split("/")[1][:60] for key in cases()]
    assert len(bpy.app.version) == 3 and max(map(len, names)) <= 60
