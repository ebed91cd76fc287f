"""A screen that is a file: an X server without hardware (Xvfb), and Blender's window on it."""

import json
import os
import subprocess
import sys
import time
from contextlib import contextmanager

import bpy
import numpy as np

WAIT = 420.0  # seconds at most, on a software rasteriser


@contextmanager
def virtual_screen(folder, width, height):
    """An X server with one screen of width x height; yields the variables of the environment that lead to it, and a
    function that returns its pixels (h, w, 3) float32, bottom row first."""
    read, write = os.pipe()
    command = ["Xvfb", "-displayfd", str(write), "-nocursor", "-fbdir", str(folder)]
    command += ["-screen", "0", f"{width}x{height}x24"]
    with subprocess.Popen(command, pass_fds=[write], stderr=subprocess.DEVNULL) as server:
        os.close(write)
        try:
            with os.fdopen(read) as number:
                display = number.readline().strip()
            assert display, "Xvfb did not start"
            yield {"DISPLAY": f":{display}"}, lambda: _pixels(folder / "Xvfb_screen0")
        finally:
            server.terminate()


def _pixels(path):
    """The pixels of an X window dump (XWDFile.h) of 32 bits a pixel, blue first."""
    data = path.read_bytes()
    header = np.frombuffer(data[:100], ">u4")
    size, width, height, bits, line, colors = (int(header[i]) for i in (0, 4, 5, 11, 12, 19))
    assert bits == 32
    start = size + 12 * colors
    rows = np.frombuffer(data, np.uint8, line * height, start).reshape(height, line)[::-1, : 4 * width]
    return rows.reshape(height, width, 4)[..., 2::-1].astype(np.float32) / 255.0


@contextmanager
def blender_window(environment, size, log, *arguments):
    """This application in a window of `size` (width, height) at the screen's corner, with the GPU back end that runs
    the tests; yields its process, and ends it. What it says goes to the file `log`."""
    backend = sys.argv[sys.argv.index("--gpu-backend") :][:2]
    command = [bpy.app.binary_path, *backend, "--factory-startup", "--window-geometry", 0, 0, *size, *arguments]
    command = [str(part) for part in command]
    with (
        open(log, "w") as file,
        subprocess.Popen(command, env=os.environ | environment, stdout=file, stderr=subprocess.STDOUT) as process,
    ):
        try:
            yield process
        finally:
            process.kill()


def wait_for(path, process, log):
    """The state that the script in the window writes to `path`."""
    end = time.monotonic() + WAIT
    while not path.exists():
        if process.poll() is not None or time.monotonic() > end:
            raise AssertionError(f"the window showed no picture; Blender said:\n{log.read_text()}")
        time.sleep(0.2)
    state = json.loads(path.read_text())
    assert "error" not in state, state["error"]
    return state


def save_picture(pixels, path):
    """Write pixels (h, w, 3), as they are shown, to a PNG file."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new("shown", width, height)
    image.pixels.foreach_set(np.concatenate([pixels, np.ones_like(pixels[..., :1])], axis=-1).ravel())
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
