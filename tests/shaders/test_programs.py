"""Whatever a scene uses: the program for it is valid GLSL."""

import re

import pytest

from addon.engine import shader_source
from addon.engine.node_programs import NodePrograms
from addon.engine.shader_source import NEEDS

CONSTANTS = {"BVH_STACK_SIZE": 8, "PATH_STACK_SIZE": 4, "SHADOW_SURFACES": 4, "UNENDED_ALPHA": -1.0}
ALL = shader_source.FEATURES
NO_PROGRAMS = (("programs_lib.glsl", NodePrograms().text()),)
COMBINATIONS = (
    {"nothing": frozenset(), "everything": ALL}
    | {f"{name} alone": {name} | NEEDS.get(name, set()) for name in sorted(ALL)}
    | {f"all but {name}": ALL - {name} - {n for n, needs in NEEDS.items() if name in needs} for name in sorted(ALL)}
)


@pytest.mark.parametrize("features", COMBINATIONS.values(), ids=COMBINATIONS)
def test_every_feature_alone_and_left_out(device, features):
    """`device.program` raises where a driver refuses the text."""
    outputs = ("out_color", *(("out_rays", "out_dropped") if "COUNT_RAYS" in features else ()))
    outputs += ("out_guide",) if "HAS_OUTLINES" in features else ()
    source = shader_source.program("film_frag.glsl", features, CONSTANTS, outputs, generated=NO_PROGRAMS)
    assert device.program(source) is not None


@pytest.mark.parametrize("name", ["nothing", "everything"])
def test_the_compute_entry(device, name):
    """What both entries include is tested above."""
    if not device.can_compute:
        pytest.skip("this driver has no compute programs")
    features = COMBINATIONS[name]
    outputs = ("out_color", "out_rays", "out_dropped", "out_guide") if features else ("out_color",)
    source = shader_source.program("film_comp.glsl", features, CONSTANTS, outputs, generated=NO_PROGRAMS)
    assert source.is_compute and device.program(source) is not None


def test_nothing_that_traces_knows_its_entry():
    """The pixel is `PIXEL`, which devices define."""
    for path in shader_source.SHADER_FOLDER.glob("*_lib.glsl"):
        assert not re.search(r"\bgl_(FragCoord|GlobalInvocationID|LocalInvocation\w+|WorkGroupID)\b", path.read_text())
