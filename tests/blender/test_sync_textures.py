"""Procedural textures: what of their nodes is a constant, which compiles nothing when it changes."""

import pytest

from addon.engine.packing import pack
from tests.blender.building import add_camera, material, node, quad, sync
from tests.blender.shading_table.case import choices


def programs():
    """The GLSL of all programs of the scene, and the texels of their constants."""
    synced = sync()
    assert not synced.messages
    packed = pack(synced.scene, 4096)
    return packed.programs, packed.textures["tables"].tobytes()


def textured(kind):
    """A node whose color is shown, on a quad before the camera."""
    add_camera()
    made, tree, output = material()
    emission = node(tree, "Emission", output.inputs["Surface"])
    shown = node(tree, kind)
    tree.links.new(shown.outputs["Color"], emission.inputs["Color"])
    quad().data.materials.append(made)
    return shown


SETTINGS = [
    ("TexNoise", {"noise_type": choices("TexNoise", "noise_type"), "normalize": [False]}),
    ("TexVoronoi", {"feature": ["F2", "SMOOTH_F1"], "distance": choices("TexVoronoi", "distance")}),
    ("TexBrick", {"offset": [0.1], "squash": [2.0], "offset_frequency": [5], "squash_frequency": [3]}),
    ("TexMagic", {"turbulence_depth": [0, 7]}),
]


@pytest.mark.parametrize("kind, settings", SETTINGS)
def test_settings_are_constants(kind, settings):
    shown = textured(kind)
    text, values = programs()
    assert "{" in text
    for name, choices_of_it in settings.items():
        for choice in choices_of_it:
            before = getattr(shown, name)
            setattr(shown, name, choice)
            changed, changed_values = programs()
            assert changed == text, (name, choice)
            assert (changed_values == values) == (choice == before), (name, choice)
            setattr(shown, name, before)


@pytest.mark.parametrize("kind", ["TexNoise", "TexVoronoi", "TexWave", "TexMagic", "TexBrick"])
def test_inputs_are_constants(kind):
    """From 0, where noise of a wave is left out, to something else."""
    shown = textured(kind)
    inputs = [socket for socket in shown.inputs if socket.enabled and socket.type == "VALUE"]
    for socket in inputs:
        socket.default_value = 0.0
    text, values = programs()
    for socket in inputs:
        socket.default_value = 0.3
        changed, changed_values = programs()
        assert changed == text and changed_values != values, socket.name
        values = changed_values
