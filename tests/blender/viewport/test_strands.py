"""Strands are cut as finely as the nearest of the views needs."""

import time

import bpy
import pytest

from addon.viewport import history
from tests.blender.viewport.stand_in import StandIn, loads


def test_strands_are_cut_finer_where_the_view_comes_near(view):
    def pieces():
        return view.session.scene.loaded.drawn.packed.statistics["primitives"]["cylinder"]

    bpy.ops.curve.primitive_bezier_circle_add(radius=2.0)
    bpy.context.object.conic.strand_radius = 0.01
    view.settle()
    few, count = pieces(), len(loads())
    view.look_from(0.0, width=4.0)
    view.settle()
    assert len(loads()) == count, "they are fine enough"
    view.look_from(0.0, width=0.3)
    view.settle()
    assert len(loads()) == count + 1 and pieces() > 2 * few
    view.look_from(0.0)
    view.settle()
    assert len(loads()) == count + 1, "finer ones do no harm"
    assert not view.redraw()


@pytest.mark.parametrize("first", ["near", "far"])
def test_strands_are_cut_for_the_nearest_of_all_views(gpu_context, first):
    """They come to rest, whoever is redrawn first."""
    bpy.ops.curve.primitive_bezier_circle_add(radius=2.0)
    bpy.context.object.conic.strand_radius = 0.01
    bpy.context.scene.conic.preview_samples = 2
    history.records.clear()
    far, near = views = StandIn(), StandIn()
    far.look_from(0.0)
    near.look_from(0.0, width=0.3)
    try:
        for _ in range(200):
            asked = [view.redraw() for view in (views if first == "far" else reversed(views))]
            if not any(asked) and not far.session.scene.preparing:
                break
            time.sleep(0.01)
        assert not any(asked), "redrawn without end"
        reader = far.session.scene.reader
        assert not any(
            reader.is_too_coarse(view.session.picture.view.camera, view.session.picture.view.size[1]) for view in views
        )
        assert len(loads()) <= 3
    finally:
        near.close()
        far.close()
