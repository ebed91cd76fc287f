"""What an edit renews of the Scene, and that all else is the same object as before."""

import random
from functools import partial

import bpy
import pytest

from tests.blender.building import link
from tests.blender.scene_reader.edits import EDITS, edit_mesh, move, objects, radius_of_dots, rename, toggle
from tests.blender.scene_reader.reading import things


def recolor(_random):
    objects()["ball"].color = (0.5, 0.5, 0.5, 1.0)  # which no material asks for


def tag_all(_random):
    for data in (*bpy.data.objects, *bpy.data.meshes, *bpy.data.materials, *bpy.data.images, *bpy.data.worlds):
        data.update_tag()


@pytest.mark.parametrize("edit", [*(EDITS[name] for name in ("nothing", "select", "panel", "frame")), recolor, tag_all])
def test_what_changes_nothing_renews_nothing(everything, reading, edit):
    assert reading.renewed(lambda: edit(random.Random(1))) == set()


def test_a_reader_that_forgets_finds_the_same_objects_again(everything, reading):
    assert reading.renewed(reading.reader.forget) == set()


#: An edit and what it renews, by its name; `material NAME` stands for its number.
RENEWED = {
    "move ball 2": (partial(move, "ball 2"), {"shapes", "material elsewhere"}),  # which has the coordinates of ball 2
    "move painted": (partial(move, "painted"), {"placed painted"}),
    "move parent": (EDITS["move parent"], {"placed painted"}),
    "move cloud": (partial(move, "cloud"), {"placed ball", "geometry ball"}),
    "move instancer": (EDITS["move instancer"], {"placed grouped"}),  # whose mesh it has
    "move camera": (EDITS["move camera"], set()),
    "rename glass": (partial(rename, "glass"), set()),
    "edit painted": (partial(edit_mesh, "painted"), {"placed painted", "geometry painted"}),
    "points": (EDITS["points"], {"placed dots", "geometry dots"}),
    "constant": (EDITS["constant"], {"material red"}),
    "group": (EDITS["group"], {"material grouped"}),
    "paint": (EDITS["paint"], {"image 0"}),
    "energy": (EDITS["energy"], set()),
    "world node": (EDITS["world node"], set()),
    "pass index": (EDITS["pass index"], {"placed indexed"}),
    "vertex colors": (EDITS["vertex colors"], {"placed vertex colors", "geometry vertex colors"}),
    "modifier off": (EDITS["modifier off"], {"placed bent", "geometry bent"}),
    "hide": (EDITS["hide"], {"-placed painted", "-geometry painted", "image 0"}),
    "rays": (lambda _random: toggle(objects()["painted"], "visible_camera"), {"placed painted"}),
    # An image that is not asked for needs no uv.
    "link": (EDITS["link"], {"material painted", "image 0", "placed painted", "geometry painted"}),
}


@pytest.mark.parametrize("name", RENEWED)
def test_an_edit_renews_what_it_changes_and_nothing_else(everything, reading, name):
    edit, renewed = RENEWED[name]
    reading.read()
    expected = reading.numbered(renewed)
    assert reading.renewed(lambda: edit(random.Random(3))) == expected


def test_what_has_as_many_primitives_replaces_what_was_there(everything, reading):
    before = reading.read()
    of = {placed.name: placed.geometry for placed in before.instances}
    shapes = before.shapes
    for name in ("painted", "ball 2"):
        move(name, random.Random(1))
    edit_mesh("painted", random.Random(1))
    radius_of_dots(random.Random(1))
    after = reading.read()
    found = {placed.name: placed.geometry for placed in after.instances}
    assert after.shapes is not shapes and after.shapes.replaces() is shapes
    for name in ("painted", "dots"):
        assert found[name] is not of[name] and found[name].replaces() is of[name]
    assert found["bent"] is of["bent"]
    link(bpy.data.meshes["ball"], "one more")
    assert reading.read().shapes.replaces is None


def test_what_is_still_there_is_not_replaced(everything, reading):
    twin = link(objects()["painted"].data, "twin")
    before = things(reading.read())
    twin.data = twin.data.copy()
    edit_mesh("twin", random.Random(1))
    after = things(reading.read())
    assert after["geometry painted"] is before["geometry painted"]
    assert after["geometry twin"].replaces is None


def test_after_undo_only_what_was_undone_is_renewed(everything, reading):
    reading.read()
    bpy.ops.ed.undo_push(message="before")
    move("painted", random.Random(1))
    bpy.ops.ed.undo_push(message="moved")
    reading.read()

    def undo():
        bpy.ops.ed.undo()
        reading.reader.forget()

    assert reading.renewed(undo) == {"placed painted"}
