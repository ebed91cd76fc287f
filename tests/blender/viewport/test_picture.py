"""The picture of a view as it forms: coarse at first, then finer, then with more samples."""

import bpy
import numpy as np
import pytest

from addon.viewport.picture import STEPS
from tests.blender.viewport.stand_in import HEIGHT, WIDTH, draws, sphere_at


def test_a_first_picture_of_few_pixels_is_whole_and_finer_ones_follow(view):
    view.settle()
    bpy.context.scene.conic.preview_frame_seconds = 0.001
    bpy.context.scene.conic.preview_samples = 3
    view.settle()
    for x in (0.5, 1.0):  # what the first takes decides on the second
        view.look_from(x)
        view.redraw()
        first = draws()[-1]
        assert first.began and (view.pixels()[..., 3] == 1.0).all(), "all of it is there"
    count = len(draws()) - 1
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 - WIDTH / 6, abs=0.5)
    steps, samples = ([getattr(draw, name) for draw in draws()[count:]] for name in ("step", "sample"))
    assert steps == sorted(steps, reverse=True) and steps[-1] == 1 and set(steps) <= set(STEPS)
    assert samples == sorted(samples) and samples[-1] == 3
    assert sum(draw.began for draw in draws()[count:]) == 1


def test_more_samples_go_on_and_fewer_stop(view):
    view.settle()
    count = len(draws())
    bpy.context.scene.conic.preview_samples = 5
    more = view.settle()
    assert view.engine.text.startswith("Sample 5/5") and draws()[-1].sample == 5
    bpy.context.scene.conic.preview_samples = 3
    view.settle()
    assert view.engine.text.startswith("Sample 3/3") and draws()[-1].sample == 5, "what is drawn stays"
    bpy.context.scene.conic.preview_samples = 5
    assert np.array_equal(view.settle(), more)
    assert not any(draw.began for draw in draws()[count:])
    view.look_from(0.0, width=7.0)
    view.settle()
    view.look_from(0.0)
    assert np.allclose(view.settle(), more, atol=1e-6), "as if it had had as many from the first"


def test_the_first_picture_has_as_many_pixels_as_the_frame_allows(view):
    view.settle()
    picture, pixels = view.session.picture, WIDTH * HEIGHT
    for spent, before, step in (
        (0.1, 16, 1),
        (0.5, 4, 1),
        (0.9, 4, 4),  # it would fit, but only just: the next might not
        (0.9, 1, 1),
        (2.0, 1, 4),
        (10.0, 4, 4),
        (20.0, 4, 8),
        (1e6, 1, STEPS[-1]),
    ):
        picture.session.pace._costs[:], picture._first_step = spent / pixels, before
        assert picture._choose_step(1.0) == step, (spent, before)


@pytest.mark.parametrize("outlines", [False, True])
def test_the_display_divides_what_the_film_sums_up(view, outlines):
    """At any moment it shows what reading the film back gives."""
    settings = bpy.context.scene.conic
    settings.preview_samples, settings.use_outlines = 4, outlines
    view.settle()
    settings.preview_frame_seconds = 0.001
    view.look_from(0.3)
    seen = set()
    while view.redraw():
        picture = view.session.picture
        if picture.sample > 0:
            assert np.abs(view.pixels() - picture.session.pixels()).max() < 1e-5
            seen.add(picture.session.film.reached)
    assert np.abs(view.pixels() - picture.session.pixels()).max() < 1e-5
    assert len(seen) > 1


def test_what_forms_has_no_dark_rim(view):
    """A coarse film is smooth where it is, whatever is to come beside it."""
    view.settle()
    bpy.context.object.hide_viewport = True  # all is the bright sky
    bpy.context.scene.conic.preview_frame_seconds = 0.001
    view.settle()
    view.look_from(0.5)
    view.redraw()
    picture = view.session.picture
    picture._start(4)
    picture.session._film.pace._costs[:] = 1.0
    for _ in range(3):
        picture.session.step(1e-9, tile_seconds=1e-9)
    assert picture.session.film.reached[3] > 0, "it stops within a row"
    layer = picture._layer()
    with view.framebuffer.bind():
        view.framebuffer.clear(color=(0.0, 0.0, 0.0, 0.0))
        view.session.display.draw([layer], picture.view)
    pixels = view.pixels()
    drawn = pixels[..., 3] > 0.0
    assert 0 < drawn.sum() < drawn.size and pixels[drawn].min() > 0.99


def test_what_is_coarse_is_seen_until_all_that_is_finer_is_there(view):
    view.settle()
    bpy.context.scene.conic.preview_frame_seconds = 0.001
    view.session.picture.session.pace._costs[:] = 1.0
    view.settle()
    view.look_from(0.5)
    parts = set()
    while view.redraw():
        assert (view.pixels()[..., 3] == 1.0).all(), parts
        session = view.session.picture.session
        session._film.pace._costs[:] = 1.0  # it stops within the film
        if view.session.picture.sample == 0 and not session.film.finished:
            parts.add((view.session.picture.step, session.film.reached))
            steps = [round(layer.pixel / (6.0 / WIDTH)) for layer in view.session.picture.layers]
            assert view.session.picture.step in steps, "what there is of the finer one is shown"
    assert len(parts) > 5


def test_large_pixels(view):
    view.engine.pixel_size = 4
    pixels = view.settle()
    blocks = pixels.reshape(HEIGHT // 4, 4, WIDTH // 4, 4, 4)
    assert (blocks == blocks[:, :1, :, :1]).all()
    assert sphere_at(pixels)[1] == pytest.approx(np.pi * (WIDTH / 6) ** 2, rel=0.15)


@pytest.mark.parametrize("change", ["pan", "zoom out", "resize"])
def test_what_was_seen_before_is_shown_where_it_is_still_right(view, change):
    """With a first picture of few pixels, the old one is as sharp as before, in its new place."""
    view.settle()
    bpy.context.scene.conic.preview_frame_seconds = 0.001
    view.session.picture.session.pace._costs[:] = 1.0
    view.settle()
    if change == "pan":
        view.look_from(1.0)
    elif change == "zoom out":
        view.look_from(0.0, width=9.0)
    else:
        view.resize(100, 60)
        view.look_from(0.0, width=7.5)
    view.redraw()
    assert draws()[-1].began and draws()[-1].kept and draws()[-1].step > 1
    early = view.pixels()[..., 0]
    late = view.settle()[..., 0]
    assert np.abs(early - late).mean() < (0.01 if change != "zoom out" else 0.03)
    assert not draws()[-1].kept


def test_turning_keeps_nothing(view):
    view.settle()
    view.region_data.view_matrix = view.region_data.view_matrix.copy()
    view.region_data.view_matrix[:3, :3] = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    view.redraw()
    assert draws()[-1].began and not draws()[-1].kept
