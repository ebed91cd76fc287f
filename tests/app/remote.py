"""Blender's window in another process, for tests: scripts to run in it, mouse and keyboard, and what is shown."""

import json
import os
import subprocess
import sys
import textwrap
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.app.screen import blender_window, save_picture, virtual_screen

ROOT = Path(__file__).resolve().parents[2]
WAIT = 300.0  # seconds at most, on a software rasteriser


class Window:
    """A window of `size` (width, height). Places in it are pixels from the lower left."""

    def __init__(self, folder, size, environment, pixels, process, log, pictures):
        self.folder, self.size, self.log = folder, size, log
        self._environment, self._pixels, self._process, self._pictures = environment, pixels, process, pictures

    def run(self, script, **values):
        """Run a script in Blender, with `values` as variables; what it leaves in `result`."""
        reply = self.folder / "reply.json"
        names = "".join(f"{name} = {value!r}\n" for name, value in values.items())
        temporary = self.folder / "request.part"
        temporary.write_text(names + textwrap.dedent(script))
        temporary.rename(self.folder / "request.py")
        self.wait_until(reply.exists)
        answer = json.loads(reply.read_text())
        reply.unlink()
        assert "error" not in answer, answer["error"]
        return answer["result"]

    def wait_until(self, condition, seconds=WAIT):
        """Wait until `condition()` is true."""
        end = time.monotonic() + seconds
        while not (found := condition()):
            if self._process.poll() is not None:
                pytest.fail(f"Blender has ended; it said:\n{self.said()}")
            if time.monotonic() > end:
                pytest.fail(f"nothing came in {seconds:g} s; Blender said:\n{self.said()}")
            time.sleep(0.01)
        return found

    def rest(self, seconds=1.5):
        """Wait until nothing was drawn for so long, from now on."""
        time.sleep(seconds)
        self.wait_until(lambda: self.run("result = rested()") > seconds)

    def said(self):
        """What Blender has printed."""
        return self.log.read_text(errors="replace")

    def picture(self, name=None):
        """What is shown, (h, w, 3) float32, bottom row first; kept in the folder of pictures where it has a name."""
        pixels = self._pixels()
        if name:
            save_picture(pixels, self._pictures / f"{name}.png")
        return pixels

    # Mouse and keyboard, as from outside

    def move(self, x, y):
        self._xdotool("mousemove", x, self.size[1] - 1 - y)

    def drag(self, button, *places, pause=0.03, after=None):
        """Press a mouse button at the first place, go to the others one after the other, and let it go."""
        self.move(*places[0])
        time.sleep(0.3)
        self._xdotool("mousedown", button)
        for place in places[1:]:
            self.move(*place)
            time.sleep(pause)
        if after:
            after()
        self._xdotool("mouseup", button)

    def key(self, name, down=None):
        """Strike a key, or press it and let it go: `down` True and False."""
        self._xdotool({None: "key", True: "keydown", False: "keyup"}[down], name)

    def wheel(self, steps):
        """Turn the wheel, up where `steps` is positive."""
        for _ in range(abs(steps)):
            self._xdotool("click", 4 if steps > 0 else 5)
            time.sleep(0.05)

    def _xdotool(self, *arguments):
        command = ["xdotool", *(str(int(a)) if isinstance(a, float) else str(a) for a in arguments)]
        subprocess.run(command, env=os.environ | self._environment, check=True)


@contextmanager
def open_window(folder, size, pictures, *files):
    """Blender's window on a screen of its own; yields the `Window`."""
    log = folder / "blender.log"
    script = Path(__file__).with_name("in_remote.py")
    backend = sys.argv[sys.argv.index("--gpu-backend") + 1]
    pictures = ROOT / "build" / pictures / backend
    pictures.mkdir(parents=True, exist_ok=True)
    with (
        virtual_screen(folder, *size) as (environment, pixels),
        blender_window(environment, size, log, *files, "--python", script, "--", folder) as process,
    ):
        yield Window(folder, size, environment, pixels, process, log, pictures)
