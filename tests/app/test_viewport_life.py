"""What else happens to a rendered viewport in Blender's window: other viewports, renders, engines and files. Its
pictures stay in build/app-viewport."""

import shutil
import time

import numpy as np
import pytest

from tests.app.viewport_scene import BLUE, RED, assert_only_turned, ball, changes, far, log, middle, region, scenes

pytestmark = pytest.mark.skipif(
    not (shutil.which("Xvfb") and shutil.which("xdotool")), reason="Xvfb or xdotool is not installed"
)


# Other viewports


def test_quad_view(rested):
    rested.key("ctrl+alt+q")
    rested.rest()
    rested.picture("quad view")
    found = log(rested)
    assert_only_turned(found)
    assert found["began"] >= 4
    assert rested.run("result = len(scenes._scenes)") == 1
    rested.key("ctrl+alt+q")
    rested.rest()


def test_a_second_viewport(rested):
    rested.run("""
        with bpy.context.temp_override(**view_parts()):
            bpy.ops.screen.area_split(direction="VERTICAL", factor=0.5)
        view(1).shading.type = "RENDERED"
    """)
    rested.rest()
    rested.picture("two viewports")
    assert_only_turned(log(rested))
    counts = "result = [len(scenes._scenes)] + [len(s.sessions) for s in scenes._scenes.values()]"
    assert rested.run(counts) == [1, 2]
    rested.run("bpy.data.objects['red'].location.z = 1.0")
    rested.rest()
    assert len(changes(log(rested))) == 1, "it is loaded once"
    rested.picture("two viewports, moved")
    rested.run("""
        bpy.data.objects["red"].location.z = 0.0
        last = view_parts(1)
        with bpy.context.temp_override(**last):
            bpy.ops.screen.area_close()
    """)
    rested.rest()
    assert rested.run(counts) == [1, 1]


def test_solid_and_back(rested):
    before = rested.picture()
    rested.run("view().shading.type = 'SOLID'")
    rested.rest(0.5)
    assert rested.run("result = [len(s.sessions) for s in scenes._scenes.values()]") == [0]
    rested.run("records.clear(); view().shading.type = 'RENDERED'")
    rested.rest()
    found = log(rested)
    assert found["began"] and not changes(found), "nothing is loaded again"
    x, y, width, height = region(rested)
    assert np.abs(before - rested.picture("back"))[y : y + height, x : x + width].mean() < 0.002
    rested.run("view().shading.type = 'SOLID'")
    rested.rest(0.5)
    rested.run("bpy.data.objects['blue'].location.z = 2.0")
    rested.rest(0.5)
    rested.run("view().shading.type = 'RENDERED'")
    rested.rest()
    assert far(ball(before, BLUE), ball(rested.picture("back, moved"), BLUE)) > 10
    rested.run("bpy.data.objects['blue'].location.z = 0.0")
    rested.rest()


# Renders, engines, files


def test_f12_beside_the_viewport(rested, tmp_path):
    """While it renders, the view can be turned."""
    rested.run(
        """
        done = []
        bpy.app.handlers.render_complete.append(lambda *_: done.append(True))
        scene = bpy.context.scene
        scene.render.filepath, scene.conic.samples = path, 64
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            bpy.ops.render.render("INVOKE_DEFAULT", write_still=True)
        """,
        path=str(tmp_path / "f12.png"),
    )
    x, y = middle(rested)
    rested.drag(2, (x, y), *[(x + 6 * k, y) for k in range(20)], after=lambda: rested.picture("turned while rendering"))
    found = log(rested)
    print("render done:", rested.run("result = len(done)"))
    assert found["began"] >= 2
    rested.wait_until(lambda: rested.run("result = len(done)"))
    rested.rest()
    rested.picture("after the render")
    assert (tmp_path / "f12.png").exists()
    rested.run("bpy.app.handlers.render_complete.clear()")


@pytest.mark.parametrize("engine", ["BLENDER_EEVEE", "BLENDER_WORKBENCH"])
def test_another_engine_and_back(rested, engine):
    rested.run("view().overlay.show_overlays = False")
    rested.rest()
    before = rested.picture()
    rested.run("bpy.context.scene.render.engine = engine", engine=engine)
    rested.rest()
    rested.picture(engine.lower())
    rested.rest(1.5)
    assert rested.run("result = len(scenes._scenes)") == 0
    rested.run("bpy.context.scene.render.engine = 'CONIC'")
    rested.rest()
    x, y, width, height = region(rested)
    difference = np.abs(before - rested.picture("back"))[y : y + height, x : x + width]
    assert difference.mean() < 0.002, "the same picture"
    rested.run("view().overlay.show_overlays = True")


def test_material_preview_shows_the_stand_ins(rested):
    rested.run("view().shading.type = 'MATERIAL'")
    rested.rest()
    shown = rested.picture("material preview")
    assert ball(shown, BLUE) and ball(shown, RED)


def test_disabling_the_add_on_and_enabling_it(rested):
    rested.run("addon.unregister()")
    rested.rest(0.5)
    rested.picture("without Conic")
    rested.run("addon.register(); bpy.context.scene.render.engine = 'CONIC'")
    rested.rest()
    assert ball(rested.picture("with Conic again"), BLUE)


def test_opening_a_file(rested, tmp_path):
    rested.run("bpy.ops.wm.save_as_mainfile(filepath=path)", path=str(tmp_path / "scene.blend"))
    rested.run("bpy.data.objects['blue'].location.z = 2.0")
    rested.rest()
    moved = ball(rested.picture(), BLUE)
    rested.run("bpy.ops.wm.open_mainfile(filepath=path)", path=str(tmp_path / "scene.blend"))
    rested.rest()
    assert scenes(rested) == 0, "Blender opens files in the solid view"
    rested.run("view().shading.type = 'RENDERED'")
    rested.rest()
    assert far(moved, ball(rested.picture("opened"), BLUE)) > 10
    assert rested.run("result = len(scenes._scenes)") == 1


def test_a_second_window_opens_and_closes(rested):
    rested.run("""
        with bpy.context.temp_override(**view_parts()):
            bpy.ops.wm.window_new()
        opened = bpy.context.window_manager.windows[-1]
        area = opened.screen.areas[0]
        area.type = "VIEW_3D"
        area.spaces.active.shading.type = "RENDERED"
    """)
    rested.rest()
    rested.picture("two windows")
    found = log(rested)
    assert_only_turned(found)
    assert found["began"]
    rested.run("""
        with bpy.context.temp_override(window=opened):
            bpy.ops.wm.window_close()
    """)
    rested.rest()
    assert rested.run("result = [len(s.sessions) for s in scenes._scenes.values()]") == [1]


def test_a_window_closes_while_the_view_traces(rested):
    """No GPU context is active then until another window is drawn: tracing in a timer has to wait for that."""
    before = ball(rested.picture(), RED)
    session = "next(iter(next(iter(scenes._scenes.values())).sessions))"
    samples = rested.run("""
        result = bpy.context.scene.conic.preview_samples
        bpy.context.scene.conic.preview_samples = 4096
    """)
    for _ in range(4):
        rested.run("""
            with bpy.context.temp_override(**view_parts()):
                bpy.ops.screen.userpref_show()
        """)
        time.sleep(0.3)
        drawn = rested.run(f"result = {session}.picture.sample")
        rested.run("""
            with bpy.context.temp_override(window=bpy.context.window_manager.windows[-1]):
                bpy.ops.wm.window_close()
        """)
        rested.wait_until(lambda drawn=drawn: rested.run(f"result = {session}.picture.sample") > drawn)  # it goes on
    assert rested.run(f"result = {session}.error") == ""
    rested.run(f"bpy.context.scene.conic.preview_samples = {samples}")
    rested.rest()
    assert far(before, ball(rested.picture("windows closed"), RED)) < 0.5
