"""Expressions: what is folded, what is left out, and that no value of a parameter decides anything."""

import numpy as np
import pytest

from addon.engine.expression import (
    AttributeNumber,
    Call,
    Literal,
    Parameter,
    Table,
    attribute_keys,
    beside,
    call,
    calls,
    clamped,
    combine,
    component,
    in_order,
    is_zero,
    less,
    literal,
    luminance,
    mix,
    select,
    settled,
    sqrt,
)
from addon.engine.glsl_functions import function
from addon.engine.node_programs import NodePrograms, constant_texels

UV = call("point_uv")
COLOR = call("attribute_value", AttributeNumber("a"))


def test_literals_leave_out_what_is_superfluous():
    assert COLOR * 1.0 is COLOR and COLOR + 0.0 is COLOR and COLOR - 0.0 is COLOR and COLOR / 1.0 is COLOR
    assert is_zero(COLOR * 0.0) and is_zero(literal(2.0) * 0.0)
    assert mix(COLOR, UV, 0.0) is COLOR and mix(UV, COLOR, 1.0) is COLOR
    assert select(less(1.0, 2.0), UV, UV) is UV


@pytest.mark.parametrize("value", [0.0, 1.0, 0.3])
def test_parameters_leave_out_nothing(value):
    p = Parameter(value)
    for made in (COLOR * p, COLOR + p, mix(COLOR, UV, p), select(p, COLOR, UV)):
        assert isinstance(made, Call)
    assert not is_zero(p)


def test_what_parameters_make_is_a_parameter():
    made = clamped(Parameter(3.0) * 2.0 - 1.0) + sqrt(Parameter((4.0, 9.0, -1.0)))
    assert isinstance(made, Parameter) and made.value == (3.0, 4.0, 1.0)
    assert isinstance(literal(2.0) * 3.0, Literal)
    assert luminance(Parameter((1.0, 0.0, 0.0))).value == pytest.approx((0.2126,))
    assert combine(1.0, Parameter(2.0), 3.0).value == (1.0, 2.0, 3.0) and component(Parameter((5.0, 6.0)), 1).value == (
        6.0,
    )
    assert (Parameter(1.0) / Parameter(0.0)).value == (0.0,)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e39])
def test_no_parameter_is_beyond_float32(value):
    assert Parameter((value, 1.0)).value == (0.0, 1.0)


def test_signatures_are_read_from_the_shaders():
    assert function("attribute_value").takes_point and function("attribute_value").inputs == ("int",)
    assert function("image_sample").is_heavy and not function("point_uv").is_heavy
    assert function("optics_fresnel").results == ("float", "float")
    with pytest.raises(KeyError, match="no shader library has a function nothing"):
        call("nothing")
    with pytest.raises(TypeError, match="takes 2 inputs, not 1"):
        calls("optics_fresnel", 1.0)


def program(expression, member="diffuse"):
    programs = NodePrograms()
    return programs, programs.add({member: (expression, "({0})")})


def textured(number, factor):
    return call("image_sample", Parameter(number, "int"), UV) * Parameter(factor)


def test_materials_that_differ_in_constants_share_a_program():
    programs = NodePrograms()
    first = programs.add({"diffuse": (textured(0, 0.0), "{0}")})
    text = programs.text()
    second = programs.add({"diffuse": (textured(7, (1.0, 2.0, 3.0, 4.0)[0]), "{0}")})
    assert (first.number, second.number, len(programs)) == (1, 1, 1) and programs.text() == text
    assert programs.add({"glow": (textured(0, 0.5), "{0}")}).number == 2
    np.testing.assert_array_equal(constant_texels(second, 10, None), [[7.0, 1.0, 0.0, 0.0]])


def test_heavy_calls_of_all_programs_meet():
    programs = NodePrograms()
    programs.add({"diffuse": (textured(0, 1.0), "{0}")})
    programs.add({"diffuse": (textured(0, 1.0) + textured(1, 1.0), "{0}"), "glow": (UV * textured(2, 0.5), "{0}")})
    programs.add({"glow": (call("image_sample", Parameter(1, "int"), textured(0, 2.0)), "{0}")})
    assert programs.text().count("image_sample(") == 3


def test_the_same_call_is_made_once():
    a = call("image_sample", number := Parameter(0, "int"), UV)
    b = call("image_sample", number, call("point_uv"))
    programs, _ = program(a + b)
    assert programs.text().count("image_sample(") == 1


def test_constants_fill_texels():
    table = Table(np.arange(8.0).reshape(2, 4))
    sampled = call("image_sample", Parameter(3, "int"), UV) * Parameter((1.0, 2.0, 3.0, 4.0))
    value = sampled * Parameter(5.0) + Parameter((6.0, 7.0, 8.0)) * Parameter(9.0)
    _, made = program(value)
    assert constant_texels(made, 0, None).shape == (3, 4)
    assert constant_texels(made, 0, None)[0].tolist() == [1.0, 2.0, 3.0, 4.0]
    made = program(call("attribute_value", AttributeNumber("x")) + call("attribute_value", table))[1]
    texels = constant_texels(made, 100, {"x": 4}.get)
    assert texels[0, :2].tolist() == [4.0, 101.0] and texels[1:].ravel().tolist() == list(range(8))
    assert attribute_keys([COLOR]) == {"a"}


def test_long_chains_are_no_recursion():
    value = COLOR
    for _ in range(20_000):
        value = value * Parameter(0.5) + UV
    assert len(in_order((value,))) > 40_000


def test_beside_moves_every_point():
    moved = beside(UV * textured(0, 1.0), 2)
    assert {node.beside for node in in_order((moved,)) if isinstance(node, Call) and node.name == "point_uv"} == {2}


def test_blocks_that_are_equal_stand_once():
    """What is made of settled values does not tell where these come from; without them nothing is shared."""
    factors = component(UV, 0), component(UV, 1), component(COLOR, 0) * Parameter(2.0)
    for mark, blocks in ((settled, 1), (lambda x: x, 3)):
        programs = NodePrograms()
        for factor in factors:
            programs.add(
                {"diffuse": (mix(Parameter((1.0, 0.0, 0.0)), Parameter((0.0, 1.0, 0.0)), mark(factor)), "({0})")}
            )
        assert len(programs) == 3 and programs.text().count("mix(") == blocks
    assert settled(Parameter(1.0)).type == "float" and not isinstance(settled(Parameter(1.0)), Call)


def test_who_does_not_take_part_in_a_heavy_call_gives_zero():
    """A number of turns written into the node would be run by everything else too."""
    numbers = [Parameter(1.0)] * 7
    programs, _ = program(call("noise_texture_3d", call("point_position"), *numbers, 0, True, 3))
    text = programs.text()
    assert "int h0_10 = int(0);" in text and "h0_10 = 3;" in text and "h0_8" not in text


def test_values_that_outlive_a_meeting_share_variables():
    programs = NodePrograms()
    for factor in (0.5, (0.5, 0.2, 0.1)):
        early = call("point_position") * Parameter(factor)
        late = call("image_sample", Parameter(0, "int"), early)
        programs.add({"diffuse": (early * late, "({0})"), "glow": (early + UV, "({0})")})
    assert len(programs) == 2
    assert programs.text().count("vec3 kept_vec3_0 = vec3(0);") == 1 and "kept_vec3_1" not in programs.text()
