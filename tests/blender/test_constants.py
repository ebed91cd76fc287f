"""Changing a constant of a material compiles nothing: of all node types the shader's text stays what it was."""

import bpy
import numpy as np
import pytest

from addon.engine.packing import pack
from addon.sync.closures import CLOSURES
from addon.sync.shader_nodes.registry import ENTRIES
from tests.blender.building import add_camera, image, material, quad, sync
from tests.blender.shading_table import WHOLE, cases
from tests.blender.shading_table.case import Swatch

#: Values for all sockets of a kind, one after the other: they meet 0, 1, what is between, more and less.
_NUMBERS = (0.0, 1.0, 0.3, 0.0, 2.5, -0.7, 0.75)
_COLORS = (
    (0, 0, 0, 1),
    (1, 1, 1, 1),
    (0.2, 0.5, 0.8, 1),
    (0, 0, 0, 0),
    (0, 1, 0, 1),
    (2, 3, 0.5, 1),
    (0.5, 0.4, 0.3, 1),
)
_VECTORS = ((0, 0, 0), (1, 1, 1), (0.2, 0.5, 0.8), (0, 0, 1), (0, 0, 0), (-2, 3, -0.5), (0.5, 0.4, 0.3))
_INTEGERS = (0, 1, 3, 0, 2, -1, 7)


@pytest.fixture
def shown():
    """A material on a quad that lights nothing, since what glows or not is a change of the lights: (its tree, output
    node)."""
    add_camera()
    made, tree, output = material("changed")
    made.cycles.emission_sampling = "NONE"
    quad().data.materials.append(made)
    return tree, output


def compiled():
    """What the shader is made of, and the values of its constants."""
    packed = pack(sync().scene, 4096)
    sizes = tuple(sorted(packed.constants.items()))
    return (packed.programs, packed.features, sizes, packed.world_programs[0].text()), packed.textures[
        "tables"
    ].tobytes()


def sockets(tree):
    """All sockets that hold a value which counts."""
    for each in tree.nodes:
        given = each.outputs if each.type in ("VALUE", "RGB", "NORMAL") else ()
        for socket in (*(s for s in each.inputs if not s.is_linked and s.enabled), *given):
            if each.type == "BUMP" and socket.name == "Filter Width":
                continue  # of which heights a bump is made: see `test_what_does_compile_anew`
            yield socket


def change(socket, round_):
    """Give a socket another value: the one of a round."""
    of_kind = {"VALUE": _NUMBERS, "RGBA": _COLORS, "VECTOR": _VECTORS, "INT": _INTEGERS, "BOOLEAN": _INTEGERS}
    values = of_kind.get(socket.type)
    if values is None or not hasattr(socket, "default_value"):
        return
    value = values[round_ % len(values)]
    if socket.type == "VECTOR":
        value = np.resize(value, len(socket.default_value))
    socket.default_value = bool(value) if socket.type == "BOOLEAN" else value


def change_settings(tree, round_):
    """Move and color stops of ramps, bend curves, exchange pictures; one of tiles is looked up by another function."""
    for each in tree.nodes:
        if each.type == "VALTORGB":
            for i, element in enumerate(each.color_ramp.elements):
                element.color = _COLORS[(round_ + i) % len(_COLORS)]
                element.position = min((i + 1) * 0.1 * (round_ + 1), 1.0)
        elif hasattr(each, "mapping") and hasattr(each.mapping, "curves"):
            for curve in each.mapping.curves:
                curve.points[0].location[1], curve.points[-1].location[1] = 0.1 * round_, 1.0 - 0.15 * round_
            each.mapping.update()
        elif getattr(each, "image", None) is not None and each.image.source != "TILED":
            each.image = image(np.full((round_ + 1, 3, 4), 0.1 * round_), float_buffer=round_ % 2 > 0)


def assert_same_shader(tree):
    """Change all constants of a tree; how often its values have changed."""
    text, values = compiled()
    changes = 0
    for round_ in range(len(_NUMBERS)):
        for socket in sockets(tree):
            change(socket, round_)
        change_settings(tree, round_)
        changed, changed_values = compiled()
        assert changed == text, f"round {round_}"
        changes += changed_values != values
    return changes


def _types():
    """Names of the classes of nodes that are read, by the type that entries are known by."""
    names = {}
    scratch = bpy.data.node_groups.new("scratch", "ShaderNodeTree")
    for name in sorted(dir(bpy.types)):
        if name.startswith("ShaderNode"):
            try:
                names[name] = scratch.nodes.new(name).type
            except RuntimeError:
                continue
    bpy.data.node_groups.remove(scratch)
    return [name for name, kind in names.items() if kind in ENTRIES or kind in CLOSURES]


@pytest.mark.parametrize("kind", _types())
@pytest.mark.parametrize("fed", [False, True] if WHOLE else [True], ids=["constants", "fed"] if WHOLE else ["fed"])
def test_node(kind, fed, shown):
    """With constants at all inputs, and with what varies at the first one that is no shader."""
    tree, output = shown
    made = tree.nodes.new(kind)
    if hasattr(made, "image"):
        made.image = image(np.ones((2, 2, 4)))
    inputs = [s for s in made.inputs if s.enabled and s.type != "SHADER"]
    if fed:
        if not inputs:
            pytest.skip("it has no inputs")
        tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs[1], inputs[0])
    for shader in (s for s in made.inputs if s.type == "SHADER"):
        tree.links.new(tree.nodes.new("ShaderNodeBsdfPrincipled").outputs[0], shader)
    first = next(s for s in made.outputs if s.enabled)
    if first.type == "SHADER":
        tree.links.new(first, output.inputs["Volume" if "Volume" in kind else "Surface"])
    else:
        total = tree.nodes.new("ShaderNodeBsdfPrincipled")
        for socket, to in zip([s for s in made.outputs if s.enabled], total.inputs, strict=False):
            tree.links.new(socket, to)
        tree.links.new(total.outputs[0], output.inputs["Surface"])
    assert_same_shader(tree)


def test_each_input_of_principled(shown):
    """Alone, while all others are 0 and while all are 1."""
    tree, output = shown
    made = tree.nodes.new("ShaderNodeBsdfPrincipled")
    tree.links.new(made.outputs[0], output.inputs["Surface"])
    text = compiled()[0]
    for others in (0, 1):
        for socket in sockets(tree):
            change(socket, others)
        for socket in sockets(tree):
            change(socket, 2)
            assert compiled()[0] == text, (socket.name, others)
            change(socket, others)


def test_bump_on_principled(shown):
    """Bumps, mapped, of a ramp of an image."""
    tree, output = shown
    principled, bump, ramp, picture, mapping = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfPrincipled", "Bump", "ValToRGB", "TexImage", "Mapping")
    )
    picture.image = image(np.ones((2, 2, 4)))
    for a, b in (
        (tree.nodes.new("ShaderNodeTexCoord").outputs["UV"], mapping.inputs["Vector"]),
        (mapping.outputs[0], picture.inputs["Vector"]),
        (picture.outputs[0], ramp.inputs[0]),
        (ramp.outputs[0], bump.inputs["Height"]),
        (bump.outputs[0], principled.inputs["Normal"]),
        (principled.outputs[0], output.inputs["Surface"]),
    ):
        tree.links.new(a, b)
    assert assert_same_shader(tree) > 3


def test_what_does_compile_anew(shown):
    """What begins to glow is a light more; heights a whole pixel away are other functions than those of a tenth."""
    tree, output = shown
    made, bump = tree.nodes.new("ShaderNodeBsdfPrincipled"), tree.nodes.new("ShaderNodeBump")
    for a, b in (
        (tree.nodes.new("ShaderNodeTexNoise").outputs[0], bump.inputs["Height"]),
        (bump.outputs[0], made.inputs["Normal"]),
        (made.outputs[0], output.inputs["Surface"]),
    ):
        tree.links.new(a, b)
    bpy.data.materials["changed"].cycles.emission_sampling = "AUTO"
    text = compiled()[0]
    made.inputs["Emission Strength"].default_value = 1.0
    glowing = compiled()[0]
    assert glowing != text
    if "Filter Width" in bump.inputs:
        bump.inputs["Filter Width"].default_value = 1.0 if bump.inputs["Filter Width"].default_value < 0.4 else 0.1
        assert compiled()[0] != glowing


@pytest.mark.parametrize("subject", ["values", "trees", "textures", "images", "coordinates"][: None if WHOLE else 1])
def test_cases_of_the_table(subject):
    """Every node setting: each swatch of the table, all its constants changed at once."""
    add_camera()
    square = quad()
    square.data.materials.append(None)
    wrong = []
    for key, case in cases().items():
        if not key.startswith(f"{subject}/") or not isinstance(case, Swatch):
            continue
        made, tree, output = material("changed")
        made.cycles.emission_sampling = "NONE"
        emission = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(emission.outputs[0], output.inputs["Surface"])
        if callable(case.shown):
            case.shown(tree, emission.inputs["Color"])
        else:
            tree.links.new(case.shown.build(tree), emission.inputs["Color"])
        square.data.materials[0] = made
        text = compiled()[0]
        for round_ in (0, 5):
            for socket in sockets(tree):
                change(socket, round_)
            change_settings(tree, round_)
            if compiled()[0] != text:
                wrong.append((key, round_))
                break
        bpy.data.materials.remove(made)
    assert not wrong
