"""What a rendered viewport has on the GPU is freed and made anew, many times. With hundreds of redraws a test it has a
window of its own, see `conftest.window`."""

import shutil

import numpy as np
import pytest

pytestmark = pytest.mark.skipif(
    not (shutil.which("Xvfb") and shutil.which("xdotool")), reason="Xvfb or xdotool is not installed"
)


@pytest.fixture
def alone(rested):
    """The window with the viewport alone: the rest of it is 100 draws each time."""
    turn_over = """
        with bpy.context.temp_override(**view_parts()):
            bpy.ops.screen.screen_full_area(use_hide_panels=True)
    """
    rested.run(turn_over)
    rested.rest()
    yield rested
    rested.run(turn_over)
    rested.rest()


@pytest.mark.parametrize("entry", ["FRAGMENT", "COMPUTE"])
def test_pictures_are_of_what_was_loaded_last(alone, entry):
    """A viewport draws in a GPU context of its own, and goes on in its window's. What each has bound of a scene that is
    freed meanwhile must not come back when the next one's textures get its numbers."""
    alone.run("bpy.context.scene.conic.entry = entry", entry=entry)
    alone.rest()
    alone.run("""
        import random

        numbers, found = random.Random(2), []
        background = bpy.context.scene.world.node_tree.nodes["Background"]
        before = tuple(background.inputs["Color"].default_value), background.inputs["Strength"].default_value
        background.inputs["Strength"].default_value = 1.0
        bpy.data.objects["Plane"].hide_viewport = True
        shown = next(iter(scenes._scenes.values()))

        def edit():
            "Another world, seen at once: nothing is drawn between redraws meanwhile."
            version, color = shown.loaded.version, [numbers.random() for _ in range(3)]
            background.inputs["Color"].default_value = (*color, 1.0)
            while shown.loaded.version == version or not shown.settled:
                with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
                    bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
            return color
    """)
    for number in range(20):
        color = alone.run("result = [edit() for _ in range(edits)][-1]", edits=1 + number % 4)
        alone.wait_until(lambda: alone.run("result = all(s.picture.finished for s in shown.sessions)"))
        sky = alone.run("result = [s.picture.session.pixels()[-3, 3, :3].tolist() for s in shown.sessions]")
        np.testing.assert_allclose(sky, [color], rtol=0.01, err_msg=f"round {number}")
    alone.run("""
        background.inputs["Color"].default_value, background.inputs["Strength"].default_value = before
        bpy.data.objects["Plane"].hide_viewport = False
        bpy.context.scene.conic.entry = "AUTO"
        del shown
    """)
    alone.rest()
