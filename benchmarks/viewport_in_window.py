# SPDX-License-Identifier: GPL-3.0-or-later
"""Run in Blender's window by benchmarks.viewport: open, show, turn and change one scene in each engine in turn.

blender --factory-startup --python benchmarks/viewport_in_window.py -- FOLDER SCENE ROUNDS ENGINE...

FOLDER has SCENE-ENGINE.blend and empty-ENGINE.blend. Each measurement is a line of FOLDER/SCENE.jsonl; the file
FOLDER/SCENE.end says that all is done, with the traceback in it where it failed.
"""

import json
import math
import os
import sys
import time
from pathlib import Path

import bpy
from mathutils import Quaternion

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import addon
from benchmarks.viewport_milestones import has_changed, milestones
from tests.app.live_view import Screen, fill_window, run_in_window, view_parts
from tests.app.torture_edits import operate

sys.dont_write_bytecode = True
FOLDER, SCENE, ROUNDS, *ENGINES = sys.argv[sys.argv.index("--") + 1 :]
FOLDER, ROUNDS = Path(FOLDER), int(ROUNDS)
TICK = 0.02  # seconds between looks whether the viewport has come to rest
REST = 2.0  # seconds without a redraw: it has
MOST = 120.0  # seconds for one action
REPEATS = 3  # orbit steps and moves a round

screen = Screen()


def space():
    return view_parts()["area"].spaces.active


def look_from(angle):
    """Look at the origin from 20 degrees above, turned by `angle` degrees."""
    view = space().region_3d
    view.view_perspective = "PERSP"
    view.view_location, view.view_distance = (0.0, 0.0, 0.1), 3.2
    view.view_rotation = Quaternion((0, 0, 1), math.radians(angle)) @ Quaternion((1, 0, 0), math.radians(70.0))
    view.update()


def show(kind):
    space().shading.type = kind


def move(turn):
    """Shift the ball to the side, to and fro."""
    bpy.data.objects["Ball"].location.z = 0.9 if turn % 2 else 1.25


def move_undoably():
    """Shift the ball far from where it is, so that undo has a step to take back."""
    operate(bpy.ops.ed.undo_push, message="Before")
    ball = bpy.data.objects["Ball"]
    ball.location.z = 1.25 if ball.location.z < 1.0 else 0.9
    operate(bpy.ops.ed.undo_push, message="Move")


def open_file(name, engine):
    """Open a file as File > Open does, in the window as it is."""
    bpy.ops.wm.open_mainfile(filepath=str(FOLDER / f"{name}-{engine}.blend"), load_ui=False)


def measured(action):
    """Do it; the milestones of what the window then shows, and how many pictures there were. Raises TimeoutError."""
    before = yield from screen.picture()
    screen.pictures = []
    start = time.monotonic()
    action()
    returned = time.monotonic() - start
    view_parts()["area"].tag_redraw()
    changed = lambda: bool(screen.pictures) and has_changed(before, screen.pictures[-1][1])  # noqa: E731
    try:
        yield from screen.rest(REST, MOST, changed)
    finally:
        shown, screen.pictures = [(at - start, picture) for at, picture in screen.pictures], None
        if os.environ.get("CONIC_BENCHMARK_PICTURES"):
            keep(before, shown)
    return milestones(before, shown) | {"redraws": len(shown), "returned": returned}


def keep(before, shown):
    """All pictures in one file, for a look."""
    import numpy as np

    path = FOLDER / f"{SCENE}-{time.monotonic():.3f}.npz"
    np.savez_compressed(path, before=before, at=[at for at, _ in shown], shown=[picture for _, picture in shown])


def settled(action):
    """Do it and wait for rest."""
    action()
    view_parts()["area"].tag_redraw()
    yield from screen.rest(REST, MOST)


def round_of(engine, number):
    """All actions with one engine; yields while it waits. Raises TimeoutError where one takes too long."""

    def tell(action, **found):
        line = {"scene": SCENE, "engine": engine, "round": number, "action": action, **found}
        with (FOLDER / f"{SCENE}.jsonl").open("a") as file:
            file.write(json.dumps(line) + "\n")

    open_file("empty", engine)
    yield
    look_from(0.0)
    yield from settled(lambda: show("RENDERED"))
    tell("open", **(yield from measured(lambda: open_file(SCENE, engine))))
    yield from settled(lambda: show("SOLID"))
    tell("switch", **(yield from measured(lambda: show("RENDERED"))))
    for turn in range(REPEATS):
        tell("orbit", **(yield from measured(lambda turn=turn: look_from(15.0 * (turn + 1)))))
    for turn in range(REPEATS):
        tell("move", **(yield from measured(lambda turn=turn: move(turn + 1))))
    for _ in range(REPEATS):
        yield from settled(move_undoably)
        tell("undo", **(yield from measured(lambda: operate(bpy.ops.ed.undo))))


def steps():
    """The whole way."""
    yield from fill_window()
    engines = list(ENGINES)
    for number in range(ROUNDS):
        for engine in list(engines):
            try:
                yield from round_of(engine, number)
            except TimeoutError:
                engines.remove(engine)
                show("SOLID")
    end("")


def end(text):
    (FOLDER / f"{SCENE}.end").write_text(text)


addon.register()
run_in_window(steps(), TICK, end)
