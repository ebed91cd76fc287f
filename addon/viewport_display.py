# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts pictures into a viewport, scene-linear and premultiplied: Blender does the display transform."""

from functools import cache
from pathlib import Path

import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

_SHADERS = Path(__file__).parent / "shaders"
_VERTEX = "void main() { uv = 0.5 * pos + 0.5; gl_Position = vec4(pos, 0.0, 1.0); }"


@cache  # until Conic is unregistered: Blender may take a new shader for a dropped one that is still bound
def _shader():
    between = gpu.types.GPUStageInterfaceInfo("conic_display")
    between.smooth("VEC2", "uv")
    info = gpu.types.GPUShaderCreateInfo()
    info.vertex_in(0, "VEC2", "pos")
    info.vertex_out(between)
    info.sampler(0, "FLOAT_2D", "picture")
    info.fragment_out(0, "VEC4", "out_color")
    info.vertex_source(_VERTEX)
    info.fragment_source((_SHADERS / "display_frag.glsl").read_text())
    return gpu.shader.create_from_info(info)


def _texture(pixels):
    """A texture of pixels (h, w, 4) float32, bottom row first."""
    height, width = pixels.shape[:2]
    flat = np.ascontiguousarray(pixels, np.float32).reshape(-1)
    data = gpu.types.Buffer("FLOAT", flat.size, flat)
    return gpu.types.GPUTexture((width, height), format="RGBA32F", data=data)


class Display:
    """Fills the bound frame buffer with pictures of any size. One can be kept, to lie under those that follow."""

    def __init__(self):
        self._kept = None
        self._drawn = ()  # until the next draw: the GPU may not have read it yet

    def keep(self, pixels):
        """Keep a picture (h, w, 4) float32, bottom row first."""
        self._kept = _texture(pixels)

    def draw(self, pixels=None, over_kept=True):
        """Draw the kept picture if there is one and `over_kept`, and over it `pixels` (h, w, 4) float32 if given."""
        textures = [self._kept] if over_kept and self._kept else []
        if pixels is not None:
            textures.append(_texture(pixels))
        shader = _shader()
        triangle = batch_for_shader(shader, "TRIS", {"pos": ((-1.0, -1.0), (3.0, -1.0), (-1.0, 3.0))})
        gpu.state.blend_set("ALPHA_PREMULT")
        shader.bind()
        for texture in textures:
            shader.uniform_sampler("picture", texture)
            triangle.draw(shader)
        gpu.state.blend_set("NONE")
        gpu.shader.unbind()
        self._drawn = textures, triangle


def unregister():
    """Give the shader back while Blender can still take it: after its end, Python would free it into nothing."""
    _shader.cache_clear()
