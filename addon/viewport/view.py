# SPDX-License-Identifier: GPL-3.0-or-later
"""What a region of a 3D viewport shows: through which camera, in how many pixels, and which part of it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..engine.scene import Camera
from ..sync.camera import camera_of_view, frame_in_view

_SAME = 1e-6  # how far axes may be off, and eyes in parts of their distance from the origin, to be the same


@dataclass(frozen=True, eq=False)
class View:
    """`size` (width, height) of the region in pixels; `border` (x, y, width, height) the part of it that is rendered,
    from the lower left; `pixel_size`: how many pixels of the screen one of the finished picture is wide."""

    camera: Camera
    size: tuple
    border: tuple
    pixel_size: int = 1

    @cached_property
    def key(self):
        """Equal for two views of the same picture."""
        camera = self.camera
        matrix = np.ascontiguousarray(camera.matrix, np.float64).tobytes()
        return matrix, camera.window, camera.orthographic, camera.clip, self.size, self.border, self.pixel_size

    @property
    def is_empty(self):
        """Whether nothing of the region is rendered: the camera's border lies outside of it."""
        return min(*self.size, *self.border[2:]) < 1

    def raster(self, step):
        """Of a picture whose pixels are `step` of the finished one wide: (size, border), both in its own pixels."""
        wide = step * self.pixel_size
        size = tuple(max(1, round(length / wide)) for length in self.size)
        scale = np.array(size) / self.size
        low = np.floor(np.array(self.border[:2]) * scale).astype(int)
        high = np.ceil(np.add(self.border[:2], self.border[2:]) * scale).astype(int)
        low = np.minimum(low, np.array(size) - 1)
        high = np.clip(high, low + 1, size)
        return size, (*low.tolist(), *(high - low).tolist())

    def part(self, size, border):
        """Edges (left, right, bottom, top) on the camera's window of the part `border` of a raster of `size`."""
        left, right, bottom, top = self.camera.window
        across, up = (right - left) / size[0], (top - bottom) / size[1]
        x, y, width, height = border
        return left + x * across, left + (x + width) * across, bottom + y * up, bottom + (y + height) * up

    def shift_from(self, other):
        """(2,) what to add to a point of the other view's camera window for the point of this one's that shows the
        same; None where that depends on the distance of what is seen, or the views show different things."""
        mine, its = np.asarray(self.camera.matrix, np.float64), np.asarray(other.camera.matrix, np.float64)
        if self.camera.orthographic != other.camera.orthographic:
            return None
        if np.abs(mine[:3, :3] - its[:3, :3]).max() > _SAME:
            return None
        moved = its[:3, 3] - mine[:3, 3]
        if self.camera.orthographic:
            return mine[:3, :2].T @ moved
        return np.zeros(2) if np.linalg.norm(moved) <= _SAME * (1.0 + np.linalg.norm(mine[:3, 3])) else None


def view_of(context, depsgraph, pixel_size):
    """The `View` of the region that `context` is of."""
    region, region_data, space = context.region, context.region_data, context.space_data
    size = region.width, region.height
    border = border_in_region(size, region_data, space, depsgraph)
    return View(camera_of_view(region, region_data), size, border, max(1, pixel_size))


def border_in_region(size, region_data, space, depsgraph):
    """The part (x, y, width, height) of a region that is rendered, in pixels from its lower left: of Ctrl+B's border,
    which is the scene's in a camera view, and a viewport's own otherwise."""
    low, high = np.zeros(2), np.array(size, float)
    if space is not None:
        if region_data.view_perspective == "CAMERA":
            low, high = _camera_border(size, region_data, space, depsgraph)
        elif space.use_render_border:
            low, high = _within((low, high), space)
    low = np.clip(low.astype(int), 0, size)
    high = np.clip(high.astype(int), low, size)
    return (*low.tolist(), *(high - low).tolist())


def _camera_border(size, region_data, space, depsgraph):
    render = depsgraph.scene_eval.render
    camera = space.camera if space.use_local_camera else depsgraph.scene.camera
    if not render.use_border or camera is None or camera.type != "CAMERA":
        return np.zeros(2), np.array(size, float)
    left, right, bottom, top = frame_in_view(camera.evaluated_get(depsgraph), depsgraph.scene_eval, region_data)
    frame = np.array([left, bottom]) * size, np.array([right, top]) * size
    return _within(frame, render, "")


def _within(corners, owner, prefix="render_"):
    """Lower left and upper right corner of the border that `owner` has within `corners`."""
    low, high = corners
    least, most = (
        np.array([getattr(owner, f"{prefix}border_{end}_{axis}") for axis in "xy"]) for end in ("min", "max")
    )
    return low + least * (high - low), low + most * (high - low)
