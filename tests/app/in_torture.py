# SPDX-License-Identifier: GPL-3.0-or-later
"""Run in Blender's window by test_torture.py: edit at random for a while, and look that no picture is stale.

blender --factory-startup --python tests/app/in_torture.py -- FOLDER SEED SECONDS [STEPS]
blender --factory-startup --python tests/app/in_torture.py -- FOLDER show

Each step is a line of FOLDER/steps.jsonl, written before it is made and again when it is done: a crash is repeated by
its seed, with as many steps. At the end FOLDER/end.json says what is wrong, a list of texts, and end.blend and end.npy
are the scene and its picture; with `show`, fresh.npy is the picture of end.blend in an application that did nothing
else.
"""

import faulthandler
import json
import signal
import sys
import time
from inspect import isgenerator
from pathlib import Path

import bpy
import numpy as np
from mathutils import Quaternion

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
import addon
from addon.viewport import scenes
from tests.app.live_view import Screen, fill_window, point_at_view, run_in_window, view_parts
from tests.app.scene_edits import start_scene
from tests.app.torture_edits import Edits, operate, spaces
from tests.app.window_edits import FORGETTING

sys.dont_write_bytecode = True
FOLDER, WHAT, *REST_OF_ARGUMENTS = sys.argv[sys.argv.index("--") + 1 :]
FOLDER = Path(FOLDER)
TICK = 0.03  # seconds
REST = 0.7  # seconds without a redraw: the picture is done
MOST = 120.0  # seconds until it must be
BETWEEN_CHECKS = 25  # steps at most
WORTH_A_CHECK = 4  # steps, before something that makes the view begin anew anyway, so that nothing stale gets away
DIFFERENT = 12  # of 255: a pixel that differs by more is another one
LAST_SAMPLES = 16  # of the picture that another application shows too, with other noise
ALLOWED = 0.002  # part of the pixels: edges that tie

screen = Screen()
wrong = []
blank = []  # whether each check's picture was


def log(**line):
    with (FOLDER / "steps.jsonl").open("a") as file:
        file.write(json.dumps(line) + "\n")


def keep_settings():
    """What opening a file sets back: nothing over the pictures, no window for renders."""
    view = bpy.context.preferences.view
    view.render_display_type, view.show_splash, view.smooth_view = "NONE", False, 0
    for space in spaces():
        space.overlay.show_overlays = space.show_gizmo = False
        space.shading.type = "RENDERED"


def settled():
    """Whether rendered views have nothing to load and their pictures are whole. While another thread prepares
    something, or a sample takes long on a busy machine, nothing is drawn."""
    used = [scene for scene in scenes._scenes.values() if scene.sessions]
    return all(scene.settled and not any(session._tracing for session in scene.sessions) for scene in used)


def picture():
    """The largest viewport at rest."""
    yield from point_at_view()
    view_parts()["area"].tag_redraw()
    yield from screen.rest(REST, MOST, settled)
    return (yield from screen.picture())


def check(step):
    """The picture is the one that the same scene has when every viewport has begun anew."""
    bpy.context.scene.render.engine = "CONIC"
    keep_settings()
    if step % 2:  # all of the scene; else what the edits have led to
        look_from_afar()
    yield
    before = yield from picture()
    for space in spaces():
        space.shading.type = "SOLID"
    yield from screen.rest(REST, MOST)
    keep_settings()
    after = yield from picture()
    if before.shape != after.shape:
        wrong.append(f"step {step}: the viewport changed its size from {before.shape} to {after.shape}")
        return
    far = (np.abs(before.astype(int) - after).max(axis=-1) > DIFFERENT).mean()
    blank.append(bool(after.std() < 0.5))
    log(check=step, different=round(float(far), 5), blank=blank[-1])
    if far > ALLOWED:
        wrong.append(f"step {step}: {100.0 * far:.2f} % of the pixels are stale, see check-{step}.npz")
        np.savez_compressed(FOLDER / f"check-{step}.npz", before=before, after=after)


def make(edits, chosen, step):
    """One edit; yields while it waits."""
    log(step=step, edit=chosen.__name__)
    done = chosen(edits)
    if isgenerator(done):
        done = yield from done
    log(step=step, edit=chosen.__name__, done=str(done))
    if chosen.__name__ != "undo":
        operate(bpy.ops.ed.undo_push, message=chosen.__name__)
    if bpy.context.mode != "OBJECT":  # an undo may lead back into another mode
        operate(bpy.ops.object.mode_set, mode="OBJECT")


def torture(seed, seconds, steps):
    """All of it, for so many seconds or steps."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield
    start_scene()
    keep_settings()
    edits, start, step, checked = Edits(seed, FOLDER), time.monotonic(), 0, 0
    yield from check(0)
    while step < steps if steps else time.monotonic() - start < seconds:
        chosen = edits.choose()
        if step - checked >= (WORTH_A_CHECK if chosen in FORGETTING else BETWEEN_CHECKS):
            checked = step
            yield from check(step)
        step += 1
        yield from make(edits, chosen, step)
        keep_engine(edits)
        for _ in range(edits.random.choice([0, 0, 1, 3])):
            yield
    yield from check(step)
    yield from finish(step)


def keep_engine(edits):
    """Now and then all viewports come back to the rendered view: an undo or a file may have led elsewhere."""
    if edits.random.random() < 0.3:
        bpy.context.scene.render.engine = "CONIC"
        keep_settings()


def look_at_all():
    space = view_parts()["area"].spaces.active
    space.use_render_border = bpy.context.scene.render.use_border = False
    space.lens, space.clip_start, space.clip_end = 50.0, 0.01, 1000.0
    for name in dir(space):
        if name.startswith("show_object_viewport_"):
            setattr(space, name, True)
    look_from_afar()


def look_from_afar():
    view = view_parts()["area"].spaces.active.region_3d
    view.view_perspective, view.view_location, view.view_distance = "PERSP", (0.0, 0.0, 0.0), 12.0
    view.view_rotation = Quaternion((0.83, 0.43, 0.16, 0.32))


def finish(step):
    """The scene in a file, and its picture in a window with one viewport."""
    if view_parts()["area"].spaces.active.local_view:
        operate(bpy.ops.view3d.localview)
    if len(view_parts()["area"].spaces.active.region_quadviews):
        operate(bpy.ops.screen.region_quadview)
    yield from fill_window()
    look_at_all()
    scene = bpy.context.scene
    scene.conic.preview_samples = LAST_SAMPLES
    scene.frame_set(scene.frame_current)  # as opening the file does: what is animated and was moved goes back
    np.save(FOLDER / "end.npy", (yield from picture()))
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "end.blend"), copy=True)
    log(end=step)
    if sum(blank) > 0.5 * len(blank):
        wrong.append(f"{sum(blank)} of {len(blank)} checks compared blank pictures: they say nothing")
    tell()


def show():
    """The picture of what was saved at the end."""
    bpy.ops.wm.open_mainfile(filepath=str(FOLDER / "end.blend"), load_ui=False)
    yield
    yield from fill_window()
    keep_settings()
    look_at_all()
    np.save(FOLDER / "fresh.npy", (yield from picture()))
    tell()


def tell(failed=""):
    temporary = FOLDER / "end.part"
    temporary.write_text(json.dumps(wrong + [failed] * bool(failed)))
    temporary.rename(FOLDER / "end.json")


faulthandler.register(signal.SIGUSR1)  # test_torture.py sends it where nothing happens any more
addon.register()
if WHAT == "show":
    run_in_window(show(), TICK, tell)
else:
    seconds, *count = REST_OF_ARGUMENTS
    run_in_window(torture(int(WHAT), float(seconds), int(count[0]) if count else 0), TICK, tell)
