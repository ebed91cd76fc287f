"""The viewport's session, drawn into a frame buffer: Blender gives a GPU context outside of a render from 5.2 on."""

import gc
import weakref
from types import SimpleNamespace

import bpy
import gpu
import numpy as np
import pytest

from addon import viewport_session
from addon.viewport_session import ViewportSession

pytestmark = pytest.mark.skipif(not hasattr(gpu, "init"), reason="no GPU context in the background before Blender 5.2")
WIDTH, HEIGHT = 80, 60


class Engine:
    """What a viewport session asks of a RenderEngine."""

    def __init__(self):
        self.redraws, self.text, self.pixel_size = 0, "", 1

    def tag_redraw(self):
        self.redraws += 1

    def update_stats(self, _stats, info):
        self.text = info

    def get_preview_pixel_size(self, _scene):
        return self.pixel_size


class View:
    """A viewport that looks down on the origin from 10 above, 6 wide, and a frame buffer for it."""

    def __init__(self):
        gpu.init()
        self.engine = Engine()
        self.session = ViewportSession(self.engine)
        self.space_data = None
        self.region = SimpleNamespace(width=WIDTH, height=HEIGHT)
        self.region_data = SimpleNamespace(view_matrix=np.eye(4), window_matrix=np.eye(4), is_perspective=False)
        self.look_from(0.0)
        self.texture = gpu.types.GPUTexture((WIDTH, HEIGHT), format="RGBA32F")
        self.framebuffer = gpu.types.GPUFrameBuffer(color_slots=[self.texture])

    def look_from(self, x):
        self.region_data.view_matrix = np.eye(4)
        self.region_data.view_matrix[:3, 3] = (-x, 0.0, -10.0)
        self.region_data.window_matrix = np.diag([2.0 / 6.0, 2.0 / 4.5, -2.0 / 100.0, 1.0])

    def redraw(self):
        """One redraw; whether another one was asked for."""
        before = self.engine.redraws
        with self.framebuffer.bind():
            self.framebuffer.clear(color=(0.0, 0.0, 0.0, 0.0))
            self.session.draw(self, bpy.context.evaluated_depsgraph_get())
        return self.engine.redraws > before

    def settle(self):
        """Redraw until nothing more is asked for; the pixels (h, w, 4)."""
        for _ in range(200):
            if not self.redraw():
                break
        else:
            raise AssertionError("it never ends")
        pixels = np.empty(WIDTH * HEIGHT * 4, np.float32)
        buffer = gpu.types.Buffer("FLOAT", pixels.size, pixels)
        with self.framebuffer.bind():
            self.framebuffer.read_color(0, 0, WIDTH, HEIGHT, 4, 0, "FLOAT", data=buffer)
        return pixels.reshape(HEIGHT, WIDTH, 4)


@pytest.fixture
def view():
    """A view of a black sphere of radius 1 before a bright sky."""
    bpy.ops.conic.sphere_add()
    world = bpy.data.worlds.new("World")
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    bpy.context.scene.world = world
    bpy.context.scene.conic.preview_samples = 2
    world.cycles_visibility.diffuse = False  # it lights nothing
    view = View()
    yield view
    vars(view).clear()  # what the GPU holds goes before Blender does


@pytest.fixture
def loads(monkeypatch):
    """A list with an entry for each load of a scene."""
    seen = []
    build = viewport_session.Session.build

    def counted(self, *arguments):
        seen.append(True)
        build(self, *arguments)

    monkeypatch.setattr(viewport_session.Session, "build", counted)
    return seen


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
    assert view.engine.text.startswith("Sample 2/2")
    assert not view.redraw(), "at rest it stays"


def test_turning_the_view_draws_anew_without_loading(view, loads):
    view.settle()
    view.look_from(1.0)
    assert view.redraw()
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 - WIDTH / 6, abs=0.5)
    assert len(loads) == 1


def test_a_change_is_shown_and_selecting_is_none(view, loads):
    view.settle()
    bpy.context.object.select_set(False)
    view.session.mark()
    assert not view.redraw() and len(loads) == 1
    bpy.context.object.location.x = 1.0
    view.session.mark()
    assert view.redraw()
    assert sphere_at(view.settle())[0] == pytest.approx(WIDTH / 2 + WIDTH / 6, abs=0.5)
    assert len(loads) == 2


@pytest.fixture
def space():
    """The 3D viewport of the factory window, and what an operator in it needs."""
    screen = bpy.context.window_manager.windows[0].screen
    area = next(area for area in screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=region):
        yield area.spaces.active


def test_types_that_a_viewport_hides_are_not_drawn_without_an_update(view, loads, space):
    view.space_data = space
    assert sphere_at(view.settle())[1] > 0
    space.show_object_viewport_mesh = False
    assert view.redraw(), "though nothing marks the session"
    assert not (view.settle()[..., 0] < 0.5).any()
    space.show_object_viewport_mesh = True
    assert sphere_at(view.settle())[1] > 0
    assert len(loads) == 3


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
    view.session.mark()
    view.settle()
    assert len(published) == 2


def test_nothing_of_the_scene_is_kept_once_it_is_loaded(view, monkeypatch):
    scenes = []

    def watched(*arguments, **settings):
        scene = sync_scene(*arguments, **settings)
        scenes.extend(weakref.ref(kept) for kept in (scene, scene.shapes))
        return scene

    sync_scene = viewport_session.sync_scene
    monkeypatch.setattr(viewport_session, "sync_scene", watched)
    view.settle()
    gc.collect()
    assert scenes and not any(scene() for scene in scenes)


@pytest.mark.parametrize("name, value", [("preview_samples", 3), ("max_depth", 2), ("shadows", "OPAQUE")])
def test_a_setting_is_a_change(view, loads, name, value):
    view.settle()
    setattr(bpy.context.scene.conic, name, value)
    view.session.mark()
    view.settle()
    assert len(loads) == 2


def test_large_pixels(view):
    view.engine.pixel_size = 4
    pixels = view.settle()
    blocks = pixels.reshape(HEIGHT // 4, 4, WIDTH // 4, 4, 4)
    assert (blocks == blocks[:, :1, :, :1]).all()
    assert sphere_at(pixels)[1] == pytest.approx(np.pi * (WIDTH / 6) ** 2, rel=0.15)


def test_an_error_is_shown_and_the_next_change_tries_again(view, monkeypatch):
    from addon.engine import SceneError

    def refuse(*_arguments, **_settings):
        raise SceneError("this cannot be")

    with monkeypatch.context() as patched:
        patched.setattr(viewport_session, "sync_scene", refuse)
        assert not view.redraw()
        assert view.engine.text == "this cannot be"
        assert not view.redraw(), "it does not try again and again"
    view.session.mark()
    assert sphere_at(view.settle())[1] > 0


@pytest.mark.parametrize(
    "error, words",
    [(ValueError("shapes do not fit"), "ValueError: shapes do not fit"), (MemoryError(), "not enough memory")],
)
@pytest.mark.parametrize("place", ["sync_scene", "camera_of_view"])
def test_a_defect_is_shown_and_its_traceback_logged_once(view, monkeypatch, caplog, place, error, words):
    def fail(*_arguments, **_settings):
        raise type(error)(*error.args)

    with monkeypatch.context() as patched:
        patched.setattr(viewport_session, place, fail)
        for _ in range(3):
            view.session.mark()
            assert not view.redraw() and words in view.engine.text
    traces = [record for record in caplog.records if "Traceback" in record.getMessage()]
    assert len(traces) == (0 if isinstance(error, MemoryError) else 1)
    view.session.mark()
    assert sphere_at(view.settle())[1] > 0


def test_the_count_of_warnings_is_that_of_the_scene_as_it_is(view, caplog):
    """A broken lamp, and so no light; mended; broken again, which is told again."""
    lamp = add_lamp()
    for energy, count in ((float("nan"), 2), (10.0, 0), (float("nan"), 2)):
        caplog.clear()
        lamp.data.energy = energy
        view.session.mark()
        view.settle()
        assert (f"{count} warnings" in view.engine.text) == (count > 0)
        assert ("warning" in view.engine.text) == (count > 0)
        assert len(caplog.records) == count
        view.session.mark()  # read once more: nothing is said twice
        view.settle()
        assert len(caplog.records) == count
