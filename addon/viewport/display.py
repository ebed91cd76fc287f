# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws films into a viewport as they are on the GPU, scene-linear and premultiplied: Blender does the display
transform, and nothing is read back."""

from dataclasses import dataclass, replace
from functools import cache

import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ..engine.devices.blender_gpu import blank_texture
from ..engine.film import UNENDED_ALPHA
from ..engine.glsl_functions import SHADER_FOLDER
from ..engine.outlines import DISPLAY_GAMMA

_VERTEX = "void main() { uv = corner; gl_Position = vec4(place.xy + corner * place.zw, 0.0, 1.0); }"
_CORNERS = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0))


@dataclass(frozen=True)
class Layer:
    """A film as it was at one moment.

    `color`, `lines`: textures of summed samples, `lines` None where there are none; `line_samples`: how many those are.
    `reached`: as `Film.reached` has it. `edges` (left, right, bottom, top): where it lies on the
    camera's window; `pixel`: how wide its pixels are there. `smooth`: whether to interpolate between them.
    """

    color: object
    reached: tuple
    edges: tuple
    pixel: float
    lines: object = None
    line_samples: int = 0
    smooth: bool = False

    def moved(self, shift):
        """The same film elsewhere on the camera's window."""
        left, right, bottom, top = self.edges
        across, up = float(shift[0]), float(shift[1])
        return replace(self, edges=(left + across, right + across, bottom + up, top + up), smooth=True)


@cache  # until Conic is unregistered: Blender may take a new shader for a dropped one that is still bound
def _shader():
    """The shader, and the rectangle that it draws."""
    between = gpu.types.GPUStageInterfaceInfo("conic_display")
    between.smooth("VEC2", "uv")
    info = gpu.types.GPUShaderCreateInfo()
    info.vertex_in(0, "VEC2", "corner")
    info.vertex_out(between)
    info.sampler(0, "FLOAT_2D", "color_sums")
    info.sampler(1, "FLOAT_2D", "line_sums")
    info.push_constant("VEC4", "place")
    info.push_constant("VEC4", "reached")
    info.push_constant("FLOAT", "lines")
    info.push_constant("FLOAT", "smoothed")
    info.define("UNENDED_ALPHA", f"{UNENDED_ALPHA:e}")
    info.define("DISPLAY_GAMMA", str(DISPLAY_GAMMA))
    info.fragment_out(0, "VEC4", "out_color")
    info.vertex_source(_VERTEX)
    info.fragment_source((SHADER_FOLDER / "display_frag.glsl").read_text())
    shader = gpu.shader.create_from_info(info)
    return shader, batch_for_shader(shader, "TRI_STRIP", {"corner": _CORNERS})


class Display:
    """Fills the bound frame buffer, which is a region's."""

    def __init__(self):
        self._drawn = ()  # until the next draw: the GPU may not have read it yet

    def draw(self, layers, view):
        """Draw `Layer`s, each over those before it, within the border of a `View`."""
        gpu.state.scissor_test_set(True)
        gpu.state.scissor_set(*view.border)
        gpu.state.blend_set("ALPHA_PREMULT")
        try:
            for layer in layers:
                self._draw(layer, view.camera.window)
                gpu.state.blend_set("NONE")  # what is transparent does not show the layers below
        finally:
            gpu.state.blend_set("NONE")
            gpu.state.scissor_test_set(False)
            gpu.shader.unbind()
        self._drawn = tuple(layers)

    def _draw(self, layer, window):
        shader, rectangle = _shader()
        shader.bind()
        shader.uniform_sampler("color_sums", layer.color)
        shader.uniform_sampler("line_sums", layer.lines or layer.color)
        shader.uniform_float("place", _place(layer.edges, window))
        shader.uniform_float("reached", [float(number) for number in layer.reached])
        shader.uniform_float("lines", float(layer.line_samples if layer.lines else 0))
        shader.uniform_float("smoothed", float(layer.smooth))
        rectangle.draw(shader)
        for name in ("color_sums", "line_sums"):
            shader.uniform_sampler(name, blank_texture())


def _place(edges, window):
    """Corner and size (4,) in [-1, 1] of `edges` (left, right, bottom, top) within `window`, which fills the region."""
    low, high = np.array(window[::2]), np.array(window[1::2])
    corner = (np.array(edges[::2]) - low) / (high - low)
    opposite = (np.array(edges[1::2]) - low) / (high - low)
    return (*(2.0 * corner - 1.0).tolist(), *(2.0 * (opposite - corner)).tolist())


def unregister():
    """Give the shader back while Blender can still take it: after its end, Python would free it into nothing."""
    _shader.cache_clear()
