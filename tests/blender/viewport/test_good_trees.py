"""Trees of large scenes are built quickly first; good ones follow once a picture is there."""

import time

import bpy
import numpy as np
import pytest

from addon.engine import LoadedScene, SceneError, bvh
from addon.engine.changes import Change
from addon.engine.tree_packing import QUICK_FROM
from addon.operators.nff_shapes import new_point_cloud
from addon.viewport import history, scene, waiting
from addon.viewport.pace import MOST_BEFORE_FIRST
from addon.viewport.picture import ViewportPicture
from addon.viewport.renewal import Renewal
from tests.blender.viewport.gate import Gate
from tests.blender.viewport.stand_in import draws, loads, records


@pytest.fixture
def crowd(view):
    """Very many small spheres beside the one of the view; their number."""
    count = QUICK_FROM + 1000
    centers = np.random.default_rng(0).uniform(-3.0, 3.0, (count, 3)).astype(np.float32)
    cloud = new_point_cloud("Crowd", centers, np.full(count, 0.02, np.float32), None)
    bpy.context.scene.collection.objects.link(cloud)
    return count


@pytest.fixture
def gate(view, crowd, monkeypatch):
    """The `Gate` that holds back the good trees of the crowd; the picture with quick ones is finished."""
    gate = Gate(monkeypatch, bvh, "build", holds=lambda lower, *_arguments, **_options: len(lower) >= QUICK_FROM)
    redraw_until(view, picture_is_finished)
    assert gate.reached.wait(60.0)
    return gate


def redraw_until(view, reached):
    """Redraw until something is `reached()` and nothing more is asked for."""
    while view.redraw() or not reached():
        pass


def picture_is_finished():
    return draws() and draws()[-1].finished


def edit_is_loaded():
    return len(loads()) >= 2


def test_good_trees_follow_quick_ones_and_the_picture_goes_on(view, crowd):
    view.settle()
    first, better = loads()
    assert first.change & Change.GEOMETRY and better.change == Change.TREES
    assert sum(draw.began for draw in draws()) == 1 and draws()[-1].sample == 2
    assert not view.session.scene.loaded.can_improve and not view.redraw()


@pytest.mark.parametrize(("seconds_left", "begun_at"), [(1.0, 2), (100.0, 1)])
def test_good_trees_wait_for_a_picture_that_is_nearly_finished(view, crowd, monkeypatch, seconds_left, begun_at):
    """Both need the processor where there is no GPU; but not for one that takes longer than the trees."""
    seconds = property(lambda picture: 0.0 if picture.finished else seconds_left)
    monkeypatch.setattr(ViewportPicture, "seconds_left", seconds)
    samples = []

    def begun(loaded, prepare, *statistics):
        if prepare == loaded.prepare_better:
            samples.append(view.session.picture.sample)
        return Renewal(loaded, prepare, *statistics)

    monkeypatch.setattr(scene, "Renewal", begun)
    view.settle()
    assert samples == [begun_at]


def test_nothing_is_shown_before_the_first_picture_and_its_textures_come_whole(view, crowd, uploads, monkeypatch):
    """A redraw waits for the scene at first, there is nothing to turn meanwhile; later it goes on after a moment."""
    waits, wait = [], Renewal.wait
    monkeypatch.setattr(Renewal, "wait", lambda renewal, seconds: (waits.append(seconds), wait(renewal, seconds))[1])
    view.settle()
    assert max(waits) == MOST_BEFORE_FIRST and "update" not in uploads[: uploads.index("texture") + 3]
    waits.clear()
    bpy.context.object.location.x = 1.0
    view.settle()
    assert 0.0 < max(waits) < MOST_BEFORE_FIRST and "update" in uploads


def test_an_edit_goes_before_good_trees(view, crowd, monkeypatch):
    gate = Gate(monkeypatch, LoadedScene, "prepare_better")
    redraw_until(view, picture_is_finished)
    assert view.session.waiting and "Loading" not in view.engine.text
    bpy.context.object.location.x = 1.0
    redraw_until(view, edit_is_loaded)
    assert loads()[-1].change & Change.FILM and "Loading" not in view.engine.text
    gate.opened.set()
    view.settle()
    assert loads()[-1].change == Change.TREES and not view.session.scene.loaded.can_improve


def test_good_trees_are_not_given_up_for_an_edit_that_changes_nothing(view, gate):
    bpy.context.scene.conic.preview_samples = 5  # no other picture
    bpy.context.object.update_tag()
    redraw_until(view, lambda: len(records(history.Load)) >= 2)
    assert draws()[-1].sample == 5 and draws()[-1].finished
    gate.opened.set()
    view.settle()
    assert gate.held == 1 and loads()[-1].change == Change.TREES
    assert draws()[-1].sample == 5, "the good trees do not bring the old settings back"
    assert view.session.scene.loaded.drawn.settings.samples == 5


def test_the_work_on_good_trees_outlives_an_edit(view, gate):
    bpy.context.object.location.x = 1.0
    redraw_until(view, edit_is_loaded)
    assert loads()[-1].change & Change.FILM
    gate.opened.set()
    view.settle()
    assert gate.held == 1 and [load.change for load in loads()][2:] == [Change.TREES]
    assert not view.session.scene.loaded.can_improve
    scene = view.session.scene.reader.read(
        bpy.context.evaluated_depsgraph_get(), 8, 8, camera=view.session.picture.view.camera
    )
    assert not any(geometry.tree for geometry in (scene.shapes, *(placed.geometry for placed in scene.instances)))


def test_who_edits_meanwhile_hears_of_good_trees(view, gate):
    """The edit is what they wait for no longer: the trees are."""
    bpy.context.object.location.x = 1.0
    bpy.context.view_layer.update()
    waiting._look()  # tells of the edit
    redraw_until(view, edit_is_loaded)
    gate.opened.set()
    while not view.session.scene.prepared:
        time.sleep(0.001)
    before = view.engine.redraws
    waiting._look()
    assert view.engine.redraws == before + 1


def test_good_trees_that_cannot_be_built_are_reported_and_not_tried_again(view, crowd, monkeypatch):
    def fail(_loaded, _stopped):
        raise SceneError("no memory")

    monkeypatch.setattr(LoadedScene, "prepare_better", fail)
    view.settle()
    assert "no memory" in view.session.error and draws()[-1].finished and not view.redraw()
