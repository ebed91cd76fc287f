"""Outlines over the samples of a picture: two passes over what the eye rays met first, summed up as samples are.

The film's jitter is the same for all pixels of a sample, so that each sample is a sharp picture of its own: its lines
are found and drawn a pixel exactly, and their mean over the samples is antialiased.
"""

import math

import numpy as np

from . import shader_source

_LEAST_STEP = 3.0  # pixels
DISPLAY_GAMMA = 2.2


class OutlinePass:
    """Draws the lines of each sample; `settings` is a `Settings` with outlines."""

    def __init__(self, device, settings):
        self._device = device
        self._marks = self._program("outline_marks_frag.glsl", settings, "guide", "out_mark")
        self._lines = self._program("outline_lines_frag.glsl", settings, "marks", "out_line")
        self._size, self._targets, self._samples = (0, 0), (), 0

    def _program(self, entry, settings, image, output):
        source = shader_source.program(entry, settings.film_features, outputs=(output,), images=(image,))
        return self._device.program(source)

    @property
    def bytes(self):
        """What the targets take."""
        return 2 * self._size[0] * self._size[1] * 16 if self._targets else 0

    def start(self, width, height):
        """Begin a picture of this many pixels."""
        self.release()
        self._targets = tuple(self._device.target(width, height, 1) for _ in range(2))
        self._size, self._samples = (width, height), 0

    def add_sample(self, guide, uniforms):
        """Add the lines of a sample: `guide` is the texture of what its eye rays met, `uniforms` its record `Frame`."""
        marks, lines = self._targets
        rectangle = (0, 0, *self._size)
        self._device.clear(marks, 0)
        self._device.draw(self._marks, marks, rectangle, {"guide": guide}, uniforms)
        marks_read = {"marks": self._device.attachment(marks, 0)}
        self._device.draw(self._lines, lines, rectangle, marks_read, uniforms)
        self._samples += 1

    @property
    def total(self):
        """(texture, samples): the sum of the lines of so many samples, premultiplied."""
        return self._device.attachment(self._targets[1], 0), self._samples

    def pixels(self):
        """Mean lines of the samples so far, (height, width, 4) float32, premultiplied."""
        total = self._device.read(self._targets[1], 0, (0, 0, *self._size))
        return total / np.float32(max(self._samples, 1))

    def release(self):
        """Free the targets."""
        for target in self._targets:
            self._device.release(target)
        self._targets = ()


def frame_values(outlines, window, frame_height, pixel_size=1.0):
    """Members of the record `Frame` for `Outlines`, in a picture of `frame_height` pixels of the camera's window (left,
    right, bottom, top), each of which is `pixel_size` pixels of the screen wide."""
    height = abs(window[3] - window[2])
    return {
        "outline_color": outlines.color,
        "outline_width": outlines.width / pixel_size,
        "outline_inner_width": outlines.inner_width / pixel_size,
        "outline_crease": math.cos(outlines.crease_angle),
        # Smaller steps than a few pixels cannot be told from a surface that turns away.
        "outline_step": max(outlines.depth_step, _LEAST_STEP / frame_height) * height,
    }


def over(lines, pixels):
    """`lines` over `pixels`, both (h, w, 4) premultiplied. A pixel that is half black looks half as bright as white: it
    gives off less than half the light, as displays have it. Otherwise dark lines would look like strings of beads."""
    brightness = lines[..., :3].sum(axis=-1, keepdims=True) / np.maximum(3.0 * lines[..., 3:], 1e-6)
    exponent = DISPLAY_GAMMA + (1.0 - DISPLAY_GAMMA) * np.clip(brightness, 0.0, 1.0)
    alpha = 1.0 - (1.0 - np.clip(lines[..., 3:], 0.0, 1.0)) ** exponent
    return lines * (alpha / np.maximum(lines[..., 3:], 1e-6)) + (1.0 - alpha) * pixels
