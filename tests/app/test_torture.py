# SPDX-License-Identifier: GPL-3.0-or-later
"""Random edits in the application's window, with the rendered view open: no error, no crash, no stale picture.

`make torture` runs it for five minutes; it is no part of the other tests, since how far it comes is another matter each
time. Otherwise:

    CONIC_TORTURE_SECONDS=30 CONIC_TORTURE_SEED=7 tools/run_app_tests opengl -- tests/app/test_torture.py -q

On Vulkan with Mesa's software driver some two minutes are what Blender stands, see `window` in conftest.py.

A failure names the folder with the log of the steps; CONIC_TORTURE_STEPS=<number> with the same seed repeats it so far.
"""

import json
import os
import re
import shutil
import signal
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from tests.app.screen import blender_window, virtual_screen

ROOT = Path(__file__).resolve().parents[2]
SIZE = 960, 640
SECONDS = os.environ.get("CONIC_TORTURE_SECONDS", "0")
SEED = os.environ.get("CONIC_TORTURE_SEED", "1")
STEPS = os.environ.get("CONIC_TORTURE_STEPS", "0")
SILENCE = 240.0  # seconds without a step: it hangs; another engine may compile shaders for minutes
BLOCK = 16  # pixels: another order of the lights is another noise
DIFFERENT, ALLOWED = 20, 0.01  # of 255, for the means of blocks; part of the blocks
#: Lines of the log that say that something went wrong.
COMPLAINT = re.compile(r"Traceback|\bError\b|ERROR|GPUShader:|[Aa]ssert|Invalid|corrupt|not freed", re.MULTILINE)
FINE = re.compile(r"Unable to bake|Modifier cannot|Info:|Warning:|libdecor|Undo.*not available|\bcycles +\|")

pytestmark = [
    pytest.mark.skipif(not shutil.which("Xvfb"), reason="Xvfb, a virtual screen, is not installed"),
    pytest.mark.skipif(not (float(SECONDS) or int(STEPS)), reason="`make torture` runs it"),
]


@pytest.fixture(scope="module")
def folder():
    """What the run leaves, of this GPU back end and seed."""
    folder = ROOT / "build" / "torture" / f"{sys.argv[sys.argv.index('--gpu-backend') + 1]}-{SEED}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def run_in_window(folder, name, *arguments):
    """Have in_torture.py run; what it found wrong, and what Blender said that is wrong."""
    script, log, steps, end = Path(__file__).with_name("in_torture.py"), folder / f"{name}.log", *paths(folder)
    end.unlink(missing_ok=True)
    with (
        virtual_screen(folder, *SIZE) as (environment, _),
        blender_window(environment, SIZE, log, "--python", script, "--", folder, *arguments) as process,
    ):
        grew, length = time.monotonic(), 0
        while not end.exists():
            size = steps.stat().st_size if steps.exists() else 0
            if size != length:
                grew, length = time.monotonic(), size
            if process.poll() is not None or time.monotonic() - grew > SILENCE:
                how = f"ended with code {process.poll()}"
                if process.poll() is None:
                    how = "hangs"
                    process.send_signal(signal.SIGUSR1)  # it says where its threads are
                    time.sleep(2.0)
                pytest.fail(f"Blender {how} at {last_steps(steps)} of {folder}; it said:\n{log.read_text()[-6000:]}")
            time.sleep(0.2)
    return json.loads(end.read_text()) + complaints(log)


def paths(folder):
    return folder / "steps.jsonl", folder / "end.json"


def last_steps(steps):
    return steps.read_text().splitlines()[-3:] if steps.exists() else "the start"


def steps_made(folder):
    steps = paths(folder)[0]
    return sum('"done"' in line for line in steps.open()) if steps.exists() else 0


def complaints(log):
    """The lines in which Blender complains, with what follows them."""
    lines = log.read_text(errors="replace").splitlines()
    wrong = [i for i, line in enumerate(lines) if COMPLAINT.search(line) and not FINE.search(line)]
    return ["\n".join(lines[i : i + 25]) for i in wrong[:3]]


def block_means(picture):
    """Of a picture (h, w, 3)."""
    height, width = (length // BLOCK for length in picture.shape[:2])
    whole = picture[: height * BLOCK, : width * BLOCK]
    return whole.reshape(height, BLOCK, width, BLOCK, 3).mean(axis=(1, 3))


def test_random_edits_leave_the_viewport_as_a_fresh_one(registered, folder):
    wrong = run_in_window(folder, "torture", SEED, SECONDS, STEPS)
    steps = steps_made(folder)
    print(f"{steps} steps, seed {SEED}")
    assert not wrong, f"seed {SEED}, {steps} steps, see {folder}:\n" + "\n".join(wrong)


def test_the_saved_scene_looks_the_same_in_another_application(registered, folder):
    if not (folder / "end.npy").exists():
        pytest.skip("the run did not come to its end")
    wrong = run_in_window(folder, "fresh", "show")
    assert not wrong, "\n".join(wrong)
    end, fresh = (block_means(np.load(folder / name)) for name in ("end.npy", "fresh.npy"))
    assert (np.abs(end - fresh).max(axis=-1) > DIFFERENT).mean() < ALLOWED
