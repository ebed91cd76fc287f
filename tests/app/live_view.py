# SPDX-License-Identifier: GPL-3.0-or-later
"""The 3D viewport of Blender's window, for scripts that run in it: fill it, see the screen, wait, tell the test."""

import json
import time
import traceback

import bpy
import gpu
import numpy as np

LOST = 4.0  # seconds without a picture: opening a file with its window has taken the cursor's drawing away
IDLE_TURNS = 6  # of the main loop without a redraw: one that shows a picture may take longer than any time of rest
UNSEEN = 60.0  # seconds without a picture: none will come


class Screen:
    """What the window shows of its 3D viewport, the same way for every render engine and GPU back end.

    Blender draws cursors last, onto the whole window: what is read there is what the user sees. It does so only for
    the region below the mouse, which `fill_window` puts there.
    """

    def __init__(self):
        self.drawn = time.monotonic()  # when the window was last drawn
        self.pictures = None  # list of (seconds of the monotonic clock, pixels (h, w, 3) uint8) while it records
        self._attach()

    def _attach(self):
        bpy.types.WindowManager.draw_cursor_add(self._see, (), "VIEW_3D", "WINDOW")

    def _see(self, *_):
        pixels = None if self.pictures is None else _read(view_parts()["region"])  # waits for the GPU
        self.drawn = time.monotonic()
        if pixels is not None:
            self.pictures.append((self.drawn, pixels))

    def rest(self, seconds, most, until=lambda: True):
        """Wait until nothing was drawn for `seconds` and `until()` holds, for `most` seconds; yields while it waits."""
        start, drawn, turns = time.monotonic(), None, 0
        while turns < IDLE_TURNS or time.monotonic() - max(self.drawn, start) < seconds or not until():
            turns, drawn = (turns + 1 if drawn == self.drawn else 0), self.drawn
            if time.monotonic() - start > most:
                raise TimeoutError(f"the viewport did not come to rest in {most:g} s")
            yield

    def picture(self):
        """What is shown now, (h, w, 3) uint8, bottom row first; yields until it is seen."""
        self.pictures, before, start = [], self.pictures, time.monotonic()
        lost = start + LOST
        while not self.pictures:
            if time.monotonic() - start > UNSEEN:
                raise TimeoutError("the window is not drawn, or the mouse is not in the 3D viewport")
            if time.monotonic() > lost:
                lost = time.monotonic() + LOST
                self._attach()
                yield from point_at_view()
            view_parts()["area"].tag_redraw()
            yield
        (_, pixels), *_ = reversed(self.pictures)
        self.pictures = before
        return pixels


def _read(region):
    """The pixels (h, w, 3) uint8 of a region of the window that is being drawn."""
    x, y, width, height = region.x, region.y, region.width, region.height
    pixels = np.empty(height * width * 4, np.float32)
    buffer = gpu.types.Buffer("FLOAT", pixels.size, pixels)
    gpu.state.active_framebuffer_get().read_color(x, y, width, height, 4, 0, "FLOAT", data=buffer)
    return (pixels.reshape(height, width, 4)[..., :3] * 255.0 + 0.5).astype(np.uint8)


def view_parts():
    """Window, area and region of the largest 3D viewport, for an override of the context."""
    window = bpy.context.window_manager.windows[0]
    areas = (area for area in window.screen.areas if area.type == "VIEW_3D")
    area = max(areas, key=lambda area: area.width * area.height)
    region = next(region for region in area.regions if region.type == "WINDOW")
    return {"window": window, "area": area, "region": region}


def fill_window():
    """The 3D viewport alone in the window, the mouse in it, nothing drawn over the picture; yields while it waits."""
    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.view.smooth_view = 0
    with bpy.context.temp_override(**view_parts()):
        bpy.ops.screen.screen_full_area(use_hide_panels=True)
    yield
    space = view_parts()["area"].spaces.active
    space.overlay.show_overlays = space.show_gizmo = space.show_region_header = False
    yield
    yield from point_at_view()


def point_at_view():
    """Move the mouse into the 3D viewport; twice, for Blender only notices a motion."""
    for part in (3, 4):
        region = view_parts()["region"]
        x, y = region.x + region.width // part, region.y + region.height // part
        bpy.context.window_manager.windows[0].cursor_warp(x, y)
        yield


def run_in_window(steps, tick, failed):
    """Take the generator's steps, `tick` seconds apart, in Blender's main loop; `failed(text)` when it raises."""

    def step():
        try:
            next(steps)
        except StopIteration:
            return None
        except BaseException:
            failed(traceback.format_exc())
            return None
        return tick

    bpy.app.timers.register(step, first_interval=1.0, persistent=True)


def tell(path, **state):
    """Write a state to a JSON file in one go: whoever waits for the file may look at any time."""
    temporary = path.with_suffix(".part")
    temporary.write_text(json.dumps(state))
    temporary.rename(path)
