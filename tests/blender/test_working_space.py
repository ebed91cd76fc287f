"""Images and skies where Blender works in other colors than Rec. 709, against Cycles."""

import bpy
import pytest

from tests.blender.shading_table import cases
from tests.blender.shading_table.drawing import compare

_SHOWN = (
    "image by uv",
    "image straight with alpha",
    "image Display P3",
    "image OpenEXR",
    "image of data",
    "sky multiple scattering 0.4",
    "sky preetham 0.5",
)


@pytest.mark.skipif(bpy.app.version < (5, 0, 0), reason="the working space can be chosen since Blender 5.0")
@pytest.mark.parametrize("space", ("Linear Rec.2020", "ACEScg"))
def test_images_and_skies_in_another_working_space(space):
    bpy.ops.wm.set_working_color_space(working_space=space, convert_colors=False)
    assert bpy.data.colorspace.working_space == space
    for key, compared in compare({name: cases()[f"images/{name}"] for name in _SHOWN}).items():
        assert compared.median < 0.005 and not compared.warnings, key
