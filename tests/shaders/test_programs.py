"""Whatever a scene uses: the program for it is valid GLSL."""

import pytest

from addon.engine import shader_source

CONSTANTS = {"BVH_STACK_SIZE": 8, "PATH_STACK_SIZE": 4, "TINTED_SHADOW_SURFACES": 4, "UNENDED_ALPHA": -1.0}
ALL = shader_source.FEATURES
COMBINATIONS = (
    {"nothing": frozenset(), "everything": ALL}
    | {f"{name} alone": frozenset([name]) for name in sorted(ALL)}
    | {f"all but {name}": ALL - {name} for name in sorted(ALL)}
)


@pytest.mark.parametrize("features", COMBINATIONS.values(), ids=COMBINATIONS)
def test_every_feature_alone_and_left_out(device, features):
    """`device.program` raises where a driver refuses the text."""
    outputs = ("out_color", "out_rays", "out_dropped") if "COUNT_RAYS" in features else ("out_color",)
    source = shader_source.program("trace_frag.glsl", features, CONSTANTS, outputs)
    assert device.program(source) is not None
