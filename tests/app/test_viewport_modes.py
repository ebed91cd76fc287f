"""The rendered viewport in Blender's window shows what is edited, in whichever mode, and of whatever kind: what is seen
in the mode is what is seen when it is left. Its pictures stay in build/app-viewport.

All cases take ten minutes: a few run with the other tests, all with CONIC_ALL_MODES=1, as `make torture` does."""

import os
import shutil
import textwrap

import numpy as np
import pytest

from tests.app.mode_cases import CASES, LEAVE, STROKE, TOOLS
from tests.app.viewport_scene import middle, region

DIFFERENT = 12 / 255  # a pixel that differs by more is another one
SAME, OTHER = 0.001, 0.002  # part of the pixels: edges that tie; what an edit changes

USUAL = ("mesh", "exact sphere", "objects that share a mesh", "what hair grows on", "sculpted")
CHOSEN = tuple(CASES) if os.environ.get("CONIC_ALL_MODES") else USUAL

pytestmark = pytest.mark.skipif(
    not (shutil.which("Xvfb") and shutil.which("xdotool")), reason="Xvfb or xdotool is not installed"
)


@pytest.fixture
def empty_middle(rested):
    """The window with nothing between the outer balls, and nothing over the picture."""
    rested.run(TOOLS)
    rested.rest(0.5)
    yield rested
    rested.run(LEAVE)


def seen(window, name):
    """The viewport at rest, without the text at its top, a shelf of brushes at its bottom, and a brush."""
    x, y, width, height = region(window)
    window.move(x + width - 20, y + height - 10)
    window.rest()
    return window.picture(name)[y + 90 : y + height - 70, x : x + width]


def different(before, after):
    """Part of the pixels."""
    return (np.abs(before - after).max(axis=-1) > DIFFERENT).mean()


def stroke(window):
    """Draw with the mouse across the middle."""
    x, y = middle(window)
    window.drag(1, (x - 60, y - 10), *[(x - 60 + 8 * k, y - 10 + 2 * k) for k in range(16)])


@pytest.mark.parametrize("name", CHOSEN)
def test_what_is_edited_is_seen(empty_middle, name):
    window, case = empty_middle, CASES[name]
    window.run(textwrap.dedent(case.build))
    before = seen(window, f"{name}, 1 before")
    window.run("call(bpy.ops.object.mode_set, mode=mode)", mode=case.mode)
    within = seen(window, f"{name}, 2 in the mode")
    script, _, _ = case.edit.partition(STROKE)
    window.run(script)
    if STROKE in case.edit:
        stroke(window)
    edited = seen(window, f"{name}, 3 edited")
    window.run("call(bpy.ops.object.mode_set, mode='OBJECT')")
    after = seen(window, f"{name}, 4 after")
    assert "Traceback" not in window.said(), window.said()
    found = [different(*pair) for pair in ((before, within), (within, edited), (edited, after))]
    print(f"{name}: {[round(float(each), 4) for each in found]}")
    assert different(before, after) > OTHER, "it was edited"
    if not case.hides:
        assert found[0] < SAME, "the mode alone changes nothing"
        assert found[1] > OTHER, "the edit is seen"
        assert found[2] < SAME, "what was seen is what it is"
