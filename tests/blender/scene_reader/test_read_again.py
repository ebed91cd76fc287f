"""A reader that reads again: nothing that it gives is ever stale, and numbers of materials and images last."""

import random

import bpy
import numpy as np
import pytest

from tests.blender.building import quad
from tests.blender.scene_reader.edits import EDITS, move, objects
from tests.blender.scene_reader.everything import MANY, given, plainly
from tests.blender.scene_reader.reading import things


@pytest.mark.parametrize("name", EDITS)
def test_after_an_edit_and_a_second_one_all_is_as_read_anew(everything, reading, name):
    chance = random.Random(name)
    reading.read()
    for _ in range(3):
        EDITS[name](chance)
        reading.read()


@pytest.mark.parametrize("seed", range(6))
def test_after_any_edits_all_is_as_read_anew(everything, reading, seed):
    chance = random.Random(seed)
    reading.read()
    for _ in range(40):
        name = chance.choice(list(EDITS))
        EDITS[name](chance)
        if chance.random() < 0.7:
            reading.read()
    reading.read()


def test_materials_and_images_keep_their_numbers(everything, reading):
    before = reading.read()
    objects()["ball"].hide_viewport = objects()["painted"].hide_viewport = True
    reading.read()
    objects()["ball"].hide_viewport = objects()["painted"].hide_viewport = False
    given(quad("late"), plainly("late"))
    after = reading.read()
    assert len(after.materials) == len(before.materials) + 1
    assert all(a is b for a, b in zip(before.materials, after.materials, strict=False))
    assert len(after.images) == len(before.images)


def test_many_copies_stand_in_a_geometry_of_their_own(everything, reading):
    scene = reading.read()
    (cloud,) = (placed for placed in scene.instances if placed.materials is None)
    assert cloud.name == "ball" and np.array_equal(cloud.matrices, np.eye(4)[None])
    assert sum(cloud.geometry.counts().values()) == MANY


def test_warnings_are_said_again(everything, reading):
    reading.read()
    messages = list(reading.messages)
    reading.read()
    assert messages and reading.messages == messages


def test_nothing_of_a_failed_read_is_lost(everything, reading):
    reading.read()
    camera = bpy.context.scene.camera
    bpy.context.scene.camera = None
    move("painted", random.Random(1))
    with pytest.raises(Exception, match="camera"):
        reading.read()
    bpy.context.scene.camera = camera
    reading.read()


def test_hair_that_changes_is_read_anew(everything, reading):
    hairy = quad("hairy")
    settings = hairy.modifiers.new("hair", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.count, settings.render_type = "HAIR", 5, "PATH"
    reading.read()
    for name, value in (("root_radius", 0.5), ("count", 7), ("hair_length", 2.0)):
        setattr(settings, name, value)
        reading.read()
    assert "geometry hairy" in things(reading.scene)
