"""The viewport's session, drawn into a frame buffer: Blender gives a GPU context outside of a render from 5.2 on."""

import gc
import threading
import time
import weakref

import bpy
import gpu
import numpy as np
import pytest

from addon import viewport_kept, viewport_log, viewport_scenes, viewport_session
from addon.engine import DeviceError, LoadedScene, SceneError, bvh, loaded_scene
from addon.engine.changes import Change
from addon.engine.devices.blender_gpu import BlenderDevice
from addon.engine.packing import pack
from addon.engine.tree_packing import QUICK_FROM
from addon.operators.nff_shapes import new_point_cloud
from addon.sync.scene_reader import SceneReader
from addon.viewport_pace import MOST_BEFORE_FIRST
from addon.viewport_picture import STEPS, ViewportPicture
from addon.viewport_renewal import Renewal
from tests.blender.viewport_stand_in import HEIGHT, WIDTH, StandIn, draws, loads, mark, records

pytestmark = pytest.mark.skipif(not hasattr(gpu, "init"), reason="no GPU context in the background before Blender 5.2")


@pytest.fixture
def view():
    """A view of a black sphere of radius 1 before a bright sky."""
    bpy.ops.conic.sphere_add()
    world = bpy.data.worlds.new("World")
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    bpy.context.scene.world = world
    bpy.context.scene.conic.preview_samples = 2
    bpy.context.scene.conic.preview_frame_seconds = 0.2
    world.cycles_visibility.diffuse = False  # it lights nothing
    viewport_log.records.clear()
    bpy.app.handlers.depsgraph_update_post.append(mark)
    view = StandIn()
    yield view
    view.close()  # what the GPU holds goes before Blender does
    bpy.app.handlers.depsgraph_update_post.remove(mark)


@pytest.fixture
def second(view):
    """A second view of the same scene."""
    second = StandIn()
    yield second
    second.close()


@pytest.fixture
def uploads(monkeypatch):
    """A list with an entry for each texture of a scene that the device is given."""
    seen = []
    for name in ("texture", "update", "grown"):
        if hasattr(BlenderDevice, name):
            monkeypatch.setattr(BlenderDevice, name, counted(getattr(BlenderDevice, name), seen))
    return seen


def counted(function, seen):
    def call(*arguments, **options):
        seen.append(function.__name__)
        return function(*arguments, **options)

    return call


def add_lamp():
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "POINT"))
    bpy.context.collection.objects.link(lamp)
    return lamp


def sphere_at(pixels):
    """Mean column and area of what is darker than the sky, in pixels."""
    dark = pixels[..., 0] < 0.5
    return np.nonzero(dark)[1].mean() + 0.5, dark.sum()


def test_it_shows_the_scene_and_comes_to_rest(view):
    column, area = sphere_at(view.settle())
    assert column == pytest.approx(WIDTH / 2, abs=0.25)
    assert area == pytest.approx(np.pi * (WIDTH / 6) ** 2, rel=0.03)
    assert view.engine.text.startswith("Sample 2/2 | 1 sphere | ")
    assert not view.redraw(), "at rest it stays"


def test_turning_the_view_draws_anew_and_uploads_nothing(view, uploads):
    view.settle()
    assert uploads
    uploads.clear()
    view.look_from(1.0)
    assert view.redraw()
    assert draws()[-1].began
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 - WIDTH / 6, abs=0.5)
    assert not uploads and len(loads()) == 1


def test_a_change_is_shown_and_selecting_is_none(view):
    view.settle()
    count = len(draws())
    bpy.context.object.select_set(False)
    view.settle()
    assert len(loads()) == 1 and not any(draw.began for draw in draws()[count:])
    bpy.context.object.location.x = 1.0
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 + WIDTH / 6, abs=0.5)
    assert len(loads()) == 2


# Pictures as they form


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


# Settings of the viewport


def test_pause_keeps_the_picture_and_turning_shows_a_coarse_one(view):
    view.settle()
    settings = bpy.context.scene.conic
    settings.preview_pause = True
    bpy.context.object.location.x = 1.0
    assert not view.redraw() and "Paused" in view.engine.text
    assert sphere_at(view.pixels())[0] == pytest.approx(WIDTH / 2, abs=0.25)
    view.look_from(-1.0)
    assert not view.redraw() and draws()[-1].began
    assert sphere_at(view.pixels())[0] == pytest.approx(WIDTH / 2 + WIDTH / 6, abs=3.0)
    settings.preview_pause = False
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 + WIDTH / 3, abs=0.5)
    assert draws()[-1].finished and "Paused" not in view.engine.text


@pytest.mark.parametrize("name, value", [("preview_samples", 1), ("max_depth", 2), ("shadows", "OPAQUE")])
def test_a_setting_of_the_picture_is_a_change(view, name, value):
    view.settle()
    setattr(bpy.context.scene.conic, name, value)
    view.settle()
    assert len(loads()) == 2


def test_a_setting_of_the_viewport_is_none(view):
    view.settle()
    bpy.context.scene.conic.preview_frame_seconds = 0.1
    view.settle()
    assert len(loads()) == 1


@pytest.fixture
def space():
    """The 3D viewport of the factory window, and what an operator in it needs."""
    screen = bpy.context.window_manager.windows[0].screen
    area = next(area for area in screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=region):
        yield area.spaces.active


def test_types_that_a_viewport_hides_are_not_drawn_without_an_update(view, space):
    view.space_data = space
    assert sphere_at(view.settle())[1] > 0
    space.show_object_viewport_mesh = False
    view.redraw()
    assert not (view.settle()[..., 0] < 0.5).any()
    space.show_object_viewport_mesh = True
    assert sphere_at(view.settle())[1] > 0
    assert len(loads()) == 3


def test_local_view_shows_its_objects_without_an_update(view, space):
    view.space_data = space
    add_lamp()
    bpy.ops.conic.sphere_add(location=(2.0, 0.0, 0.0), radius=0.5)
    both = sphere_at(view.settle())[1]
    bpy.ops.view3d.localview()
    column, area = sphere_at(view.settle())
    assert "warning" not in view.engine.text, "the scene's lamp lights the local view too"
    assert area < 0.5 * both and column == pytest.approx(WIDTH / 2 + WIDTH / 3, abs=0.5)
    bpy.ops.view3d.localview()
    assert sphere_at(view.settle())[1] == both


def test_only_the_border_is_drawn(view, space):
    view.space_data = space
    whole = view.settle()
    space.use_render_border = True
    space.render_border_min_x, space.render_border_max_x = 0.25, 0.75
    space.render_border_min_y, space.render_border_max_y = 0.5, 0.75
    part = view.settle()
    x, y, right, top = WIDTH // 4, HEIGHT // 2, 3 * WIDTH // 4, 3 * HEIGHT // 4
    assert np.array_equal(part[y:top, x:right], whole[y:top, x:right])
    part[y:top, x:right] = 0.0
    assert not part.any()
    space.use_render_border = False


# Several viewports


def test_viewports_of_one_scene_share_it(view, second, uploads):
    view.settle()
    count = len(uploads)
    second.look_from(1.0)
    shown = sphere_at(second.settle())[0], sphere_at(view.settle())[0]
    assert shown == (pytest.approx(WIDTH / 2 - WIDTH / 6, abs=0.5), pytest.approx(WIDTH / 2, abs=0.25))
    assert len(uploads) == count and len(loads()) == 1
    bpy.context.object.location.x = 1.0
    shown = sphere_at(second.settle())[0], sphere_at(view.settle())[0]
    assert shown == (pytest.approx(WIDTH / 2, abs=0.5), pytest.approx(WIDTH / 2 + WIDTH / 6, abs=0.5))
    assert len(loads()) == 2


def test_a_scene_is_freed_with_its_last_viewport(view, second):
    view.settle()
    second.settle()
    loaded = weakref.ref(view.session.scene.loaded)
    gc.disable()
    try:
        view.close()
        assert loaded() is not None and sphere_at(second.settle())[1] > 0
        second.close()
        assert loaded() is None and not viewport_scenes._scenes, "at once, without a search for garbage"
    finally:
        gc.enable()


# Loading


class Gate:
    """Holds back whatever is prepared until it is opened."""

    def __init__(self, monkeypatch):
        self.opened = threading.Event()
        prepare = LoadedScene.prepare

        def wait(*arguments):
            assert self.opened.wait(60.0)
            return prepare(*arguments)

        monkeypatch.setattr(LoadedScene, "prepare", wait)


def test_the_old_scene_can_be_turned_while_the_new_one_is_prepared(view, monkeypatch):
    view.settle()
    gate = Gate(monkeypatch)
    bpy.context.object.location.x = 1.0
    view.redraw()
    assert view.session.waiting and "Loading" in view.engine.text
    assert sphere_at(view.pixels())[0] == pytest.approx(WIDTH / 2, abs=0.25)
    view.look_from(-1.0)
    while view.redraw():
        pass
    assert view.session.waiting and sphere_at(view.pixels())[0] == pytest.approx(WIDTH / 2 + WIDTH / 6, abs=0.5)
    bpy.context.object.location.x = 0.5  # and again
    view.redraw()
    gate.opened.set()
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 + 1.5 * WIDTH / 6, abs=0.5)
    assert "Loading" not in view.engine.text


def test_a_viewport_may_close_while_its_scene_is_prepared(view, monkeypatch):
    view.settle()
    gate = Gate(monkeypatch)
    bpy.context.object.location.x = 1.0
    view.redraw()
    assert view.session.waiting
    view.close()
    gate.opened.set()
    assert not viewport_scenes._scenes


def test_a_viewport_that_pauses_hears_once_of_what_has_been_prepared(view, monkeypatch):
    view.settle()
    gate = Gate(monkeypatch)
    bpy.context.object.location.x = 1.0
    view.redraw()
    bpy.context.scene.conic.preview_pause = True
    assert viewport_scenes._look() is not None
    gate.opened.set()
    while not view.session.scene.prepared:
        time.sleep(0.001)
    before = view.engine.redraws
    assert viewport_scenes._look() is None and view.engine.redraws == before + 1
    bpy.context.scene.conic.preview_pause = False
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 + WIDTH / 6, abs=0.5)


def test_what_an_undo_has_replaced_is_not_prepared_to_the_end(view, monkeypatch):
    view.settle()
    asked, gate = [], threading.Event()

    def wait(*arguments, stopped, **settings):
        assert gate.wait(60.0)
        asked.append(stopped())
        return pack(*arguments, stopped=stopped, **settings)

    monkeypatch.setattr(loaded_scene, "pack", wait)
    bpy.context.object.location.x = 1.0
    view.redraw()
    viewport_scenes._begin_replacing()
    viewport_scenes._end_replacing()
    bpy.context.object.location.x = -1.0
    gate.set()
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 - WIDTH / 6, abs=0.5)
    assert asked == [True, False] and not any(load.error for load in loads())


def test_a_viewport_without_a_gpu_says_so(view, monkeypatch):
    def scene_of(*_arguments):
        raise DeviceError("Blender has no GPU context here")

    monkeypatch.setattr(viewport_session, "scene_of", scene_of)
    assert not view.redraw()
    assert view.engine.text == "Blender has no GPU context here"


def test_what_is_prepared_for_nobody_keeps_nothing_on_the_gpu(view, monkeypatch):
    """Its thread must not be the one that frees textures."""
    view.settle()
    began, gate = threading.Event(), threading.Event()

    def wait(*arguments, **settings):
        began.set()
        assert gate.wait(60.0)
        return pack(*arguments, **settings)

    monkeypatch.setattr(loaded_scene, "pack", wait)
    bpy.context.object.location.x = 1.0
    view.redraw()
    assert began.wait(60.0)
    drawn = view.session.scene.loaded.drawn
    assert drawn.textures
    view.close()
    assert not drawn.textures
    gate.set()


def test_undo_and_new_files_read_anew(view, monkeypatch):
    forgotten = []
    view.settle()
    monkeypatch.setattr(SceneReader, "forget", lambda self: forgotten.append(self))
    for name in ("undo_post", "redo_post", "load_post"):
        for handler in getattr(bpy.app.handlers, name):
            if handler.__module__ == viewport_scenes.__name__:
                handler(bpy.context.scene, None)
    assert len(forgotten) == 3 and not view.session.scene.settled
    view.settle()
    assert len(loads()) == 1, "it was the same"


def test_an_add_on_that_was_disabled_by_a_file_hears_of_changes_when_it_is_enabled(view):
    """As by Load Factory Settings, which takes its handlers away in between."""
    view.settle()
    for handler in list(bpy.app.handlers.load_pre):
        if handler.__module__ == viewport_scenes.__name__:
            handler("", None)
    viewport_scenes.unregister()
    viewport_scenes.register()
    bpy.context.object.location.x = 1.0
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 + WIDTH / 6, abs=0.5)


def test_statistics_are_published_once_for_what_is_loaded(view, monkeypatch):
    published = []
    monkeypatch.setattr(viewport_session, "publish", published.append)
    view.settle()
    view.look_from(1.0)
    view.settle()
    (found,) = published
    assert (found.source, found.width, found.height, found.samples) == ("Viewport", WIDTH, HEIGHT, 2)
    assert found.primitives == {"sphere": 1} and found.objects == {"sphere": 1}
    assert found.seconds["read"] < found.seconds["first_picture"]
    bpy.context.object.location.x = 1.0
    view.settle()
    assert len(published) == 2


# What goes wrong


def test_an_error_is_shown_and_the_next_change_tries_again(view, monkeypatch):
    def refuse(*_arguments, **_settings):
        raise SceneError("this cannot be")

    for loaded in (False, True):
        with monkeypatch.context() as patched:
            patched.setattr(SceneReader, "read", refuse)
            bpy.context.object.location.x = 1.0
            view.settle()
            assert view.engine.text == "this cannot be"
            assert not view.redraw(), "it does not try again and again"
            assert (view.pixels()[..., 3] > 0.0).all() == loaded, "what was there is shown"
        bpy.context.object.location.x = 0.0
        assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2, abs=0.25)


@pytest.mark.parametrize(
    "error, words",
    [(ValueError("shapes do not fit"), "ValueError: shapes do not fit"), (MemoryError(), "not enough memory")],
)
@pytest.mark.parametrize(
    "owner, name",
    [(SceneReader, "read"), (LoadedScene, "prepare"), (LoadedScene, "apply"), (viewport_session, "view_of")],
)
def test_a_defect_is_shown_and_its_traceback_logged_once(view, monkeypatch, caplog, owner, name, error, words):
    def fail(*_arguments, **_settings):
        raise type(error)(*error.args)

    with monkeypatch.context() as patched:
        patched.setattr(owner, name, fail)
        for x in (1.0, 2.0, 3.0):
            bpy.context.object.location.x = x
            view.settle()
            assert words in view.engine.text
    traces = [record for record in caplog.records if "Traceback" in record.getMessage()]
    assert len(traces) == (0 if isinstance(error, MemoryError) else 1)
    bpy.context.object.location.x = 0.0
    assert sphere_at(view.settle())[1] > 0


def test_a_picture_that_there_is_no_memory_for_is_tried_again(view, monkeypatch):
    def refuse(*_arguments):
        raise DeviceError("no memory for a picture")

    view.settle()
    with monkeypatch.context() as patched:
        patched.setattr(BlenderDevice, "target", refuse)
        view.look_from(1.0)
        for _ in range(2):
            assert not view.redraw() and view.engine.text == "no memory for a picture"
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 - WIDTH / 6, abs=0.5)


def test_the_count_of_warnings_is_that_of_the_scene_as_it_is(view, caplog):
    """A broken lamp, and so no light; mended; broken again, which is told again."""
    lamp = add_lamp()
    for energy, count in ((float("nan"), 2), (10.0, 0), (float("nan"), 2)):
        caplog.clear()
        lamp.data.energy = energy
        view.settle()
        assert (f"{count} warnings" in view.engine.text) == (count > 0)
        assert ("warning" in view.engine.text) == (count > 0)
        assert len(caplog.records) == count
        bpy.context.object.update_tag()  # read once more: nothing is said twice
        view.settle()
        assert len(caplog.records) == count


# Large scenes


@pytest.fixture
def crowd(view):
    """Very many small spheres beside the one of the view; their number."""
    count = QUICK_FROM + 1000
    centers = np.random.default_rng(0).uniform(-3.0, 3.0, (count, 3)).astype(np.float32)
    cloud = new_point_cloud("Crowd", centers, np.full(count, 0.02, np.float32), None)
    bpy.context.scene.collection.objects.link(cloud)
    return count


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

    monkeypatch.setattr(viewport_scenes, "Renewal", begun)
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
    gate, prepare_better = threading.Event(), LoadedScene.prepare_better

    def wait(loaded, stopped):
        assert gate.wait(60.0)
        return prepare_better(loaded, stopped)

    monkeypatch.setattr(LoadedScene, "prepare_better", wait)
    while view.redraw() or not draws()[-1].finished:
        pass
    assert view.session.waiting and "Loading" not in view.engine.text
    bpy.context.object.location.x = 1.0
    while len(loads()) < 2 or view.redraw():
        view.redraw()
    assert loads()[-1].change & Change.FILM and "Loading" not in view.engine.text
    gate.set()
    view.settle()
    assert loads()[-1].change == Change.TREES and not view.session.scene.loaded.can_improve


def test_good_trees_are_not_given_up_for_an_edit_that_changes_nothing(view, crowd, monkeypatch):
    gate, begun, built, build = threading.Event(), threading.Event(), [], bvh.build

    def wait(lower, *arguments, **options):
        if len(lower) >= QUICK_FROM:
            built.append(len(lower))
            begun.set()
            assert gate.wait(60.0)
        return build(lower, *arguments, **options)

    monkeypatch.setattr(bvh, "build", wait)
    while view.redraw() or not draws()[-1].finished:
        pass
    assert begun.wait(60.0)
    bpy.context.scene.conic.preview_samples = 5  # no other picture
    bpy.context.object.update_tag()
    while len(records(viewport_log.Load)) < 2 or view.redraw():
        view.redraw()
    assert draws()[-1].sample == 5 and draws()[-1].finished
    gate.set()
    view.settle()
    assert len(built) == 1 and loads()[-1].change == Change.TREES
    assert draws()[-1].sample == 5, "the good trees do not bring the old settings back"
    assert view.session.scene.loaded.drawn.settings.samples == 5


def test_the_work_on_good_trees_outlives_an_edit(view, crowd, monkeypatch):
    gate, begun, built, build = threading.Event(), threading.Event(), [], bvh.build

    def wait(lower, *arguments, **options):
        if len(lower) >= QUICK_FROM:
            built.append(len(lower))
            begun.set()
            assert gate.wait(60.0)
        return build(lower, *arguments, **options)

    monkeypatch.setattr(bvh, "build", wait)
    while view.redraw() or not draws()[-1].finished:
        pass
    assert begun.wait(60.0)
    bpy.context.object.location.x = 1.0
    while len(loads()) < 2 or view.redraw():
        view.redraw()
    assert loads()[-1].change & Change.FILM
    gate.set()
    view.settle()
    assert len(built) == 1 and [load.change for load in loads()][2:] == [Change.TREES]
    assert not view.session.scene.loaded.can_improve
    scene = view.session.scene.reader.read(
        bpy.context.evaluated_depsgraph_get(), 8, 8, camera=view.session.picture.view.camera
    )
    assert not any(geometry.tree for geometry in (scene.shapes, *(placed.geometry for placed in scene.instances)))


def test_good_trees_that_cannot_be_built_are_reported_and_not_tried_again(view, crowd, monkeypatch):
    def fail(_loaded, _stopped):
        raise SceneError("no memory")

    monkeypatch.setattr(LoadedScene, "prepare_better", fail)
    view.settle()
    assert "no memory" in view.session.error and draws()[-1].finished and not view.redraw()


# Scenes that nobody shows


@pytest.fixture
def kept(view, monkeypatch):
    """viewport_kept as in a window, but that nobody looks."""
    monkeypatch.setattr(viewport_kept, "keep", lambda scene: viewport_kept._kept.update({scene: time.monotonic()}))
    yield viewport_kept
    viewport_kept._kept.clear()


def test_who_comes_back_finds_the_scene_and_what_has_changed(kept, view):
    before = view.settle()
    loaded = view.session.scene.loaded
    view.close()
    again = StandIn()
    count = len(loads())
    assert np.array_equal(again.settle(), before) and again.session.scene.loaded is loaded
    assert len(loads()) == count, "nothing was loaded again"
    again.close()
    bpy.app.handlers.depsgraph_update_post.remove(mark)  # no viewport, no `view_update`
    bpy.context.object.location.x = 1.0
    bpy.context.view_layer.update()
    bpy.app.handlers.depsgraph_update_post.append(mark)
    again = StandIn()
    assert not np.array_equal(again.settle(), before) and again.session.scene.loaded is loaded
    again.close()


def test_scenes_are_kept_for_a_while(kept, view, monkeypatch):
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    bpy.context.scene.render.engine = "CONIC"
    view.redraw()
    now[0] += 100.0
    scene = weakref.ref(view.session.scene)
    assert kept._look() and len(kept._kept) == 1, "it is shown"
    view.close()
    now[0] += 0.9 * kept.SECONDS
    assert kept._look() and scene()
    now[0] += 0.2 * kept.SECONDS
    assert kept._look() is None and not scene()


@pytest.mark.parametrize("end", ["render", "load", "another engine"])
def test_scenes_are_not_kept(kept, view, end):
    bpy.context.scene.render.engine = "CONIC"
    view.redraw()
    scene = weakref.ref(view.session.scene)
    view.close()
    if end == "render":
        kept._before_render()
    elif end == "load":
        viewport_scenes._begin_loading()
        viewport_scenes._end_replacing()
    else:
        bpy.context.scene.render.engine = "BLENDER_WORKBENCH"
    assert kept._look() is None and not scene()


# Tracing between redraws


def test_a_picture_that_fails_between_redraws_is_reported_once(view, monkeypatch):
    def fail(*_arguments):
        raise DeviceError("lost")

    view.settle()
    view.look_from(1.0)
    view.redraw()
    with monkeypatch.context() as patch:
        patch.setattr(ViewportPicture, "advance", fail)
        before = view.engine.redraws
        assert not view.session.trace() and view.engine.redraws == before + 1
        assert not view.session.trace(), "nothing is left of it"
    assert not view.redraw() and "lost" in view.engine.text
    view.settle()
    assert draws()[-1].finished and "lost" not in view.engine.text


def test_a_redraw_is_asked_for_when_there_is_something_to_see(view, monkeypatch):
    """The whole picture first, and the last sample; slices that give neither ask for none until it is time."""
    bpy.context.scene.conic.preview_samples = 3
    view.settle()
    view.look_from(1.0)
    with monkeypatch.context() as patch:
        patch.setattr(ViewportPicture, "_choose_step", lambda picture, seconds: STEPS[-1])
        view.redraw()
    assert draws()[-1].step > 1
    shown = []
    while not view.session.picture.finished:
        before = view.engine.redraws
        while view.session.trace():
            assert view.engine.redraws == before
        assert view.engine.redraws == before + 1
        shown.append((view.session.picture.step, view.session.picture.sample))
        view.session.pace.begin()  # the redraw
    assert shown[-1] == (1, 3) and (1, 1) in shown


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
def test_strands_are_cut_for_the_nearest_of_all_views(first):
    """They come to rest, whoever is redrawn first."""
    bpy.ops.curve.primitive_bezier_circle_add(radius=2.0)
    bpy.context.object.conic.strand_radius = 0.01
    bpy.context.scene.conic.preview_samples = 2
    viewport_log.records.clear()
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
