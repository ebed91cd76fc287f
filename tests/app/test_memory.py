# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered view in the application's window takes no more memory after many edits and frames than after some.

Some here; CONIC_MEMORY_EDITS=1000 CONIC_MEMORY_FRAMES=200 in the environment makes more. The first quarter warms up.
The same edits in Solid view show what Blender itself does.
"""

import json
import os
import shutil
import statistics
import time
from pathlib import Path

import pytest

from tests.app.screen import blender_window, virtual_screen

SIZE = 640, 480
COUNTS = {
    "edits": int(os.environ.get("CONIC_MEMORY_EDITS", "120")),
    "frames": int(os.environ.get("CONIC_MEMORY_FRAMES", "40")),
}
#: KiB each, more than in Solid view. What Conic has of the cloud, of a mesh or of a film is a MiB or more.
MOST = {"edits": 20.0, "frames": 50.0}
WAIT = 3600.0  # seconds

pytestmark = pytest.mark.skipif(
    not (shutil.which("Xvfb") and Path("/proc/self/status").exists()), reason="needs Linux and Xvfb, a virtual screen"
)


@pytest.fixture(scope="module")
def memory(registered, tmp_path_factory):
    """KiB after each edit and frame, in Solid and rendered view."""
    folder = tmp_path_factory.mktemp("memory")
    script, log, end = Path(__file__).with_name("in_memory.py"), folder / "blender.log", folder / "memory.json"
    with (
        virtual_screen(folder, *SIZE) as (environment, _),
        blender_window(environment, SIZE, log, "--python", script, "--", folder, *COUNTS.values()) as process,
    ):
        limit = time.monotonic() + WAIT
        while not end.exists():
            if process.poll() is not None or time.monotonic() > limit:
                pytest.fail(f"the window ended or hangs; Blender said:\n{log.read_text()}")
            time.sleep(0.2)
    found = json.loads(end.read_text())
    assert "error" not in found, found["error"]
    assert "Traceback" not in log.read_text(), log.read_text()
    return found


def growth(kilobytes):
    """KiB for each of the entries: the median of what many stretches of an eighth of them add.

    What leaks does so in each stretch; the one buffer of the window's size that the allocator keeps or gives back now
    and then is in few of them.
    """
    quarter, stretch = len(kilobytes) // 4, len(kilobytes) // 8
    return statistics.median(
        (end - start) / stretch
        for start, end in zip(kilobytes[quarter:-stretch], kilobytes[quarter + stretch :], strict=True)
    )


def test_the_view_took_part(memory):
    assert memory["loads"] > 0.6 * sum(COUNTS.values()), "what is edited is loaded, most of it by itself"


@pytest.mark.parametrize("what", COUNTS)
def test_memory_is_flat(memory, what):
    solid, rendered = (growth(memory[what][kind]) for kind in ("SOLID", "RENDERED"))
    first, *_, last = memory[what]["RENDERED"]
    print(
        f"\n{COUNTS[what]} {what}: {solid:.1f} KiB each in Solid view, {rendered:.1f} rendered; {first} to {last} KiB"
    )
    assert rendered - max(solid, 0.0) < MOST[what]
