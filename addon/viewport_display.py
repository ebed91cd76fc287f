# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts a picture into a viewport, scene-linear and premultiplied: Blender does the display transform."""

from functools import cache
from pathlib import Path

import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

_SHADERS = Path(__file__).parent / "shaders"
_VERTEX = "void main() { gl_Position = vec4(pos, 0.0, 1.0); }"


@cache  # for good: Blender may take a new shader for a dropped one that is still bound
def _shader():
    info = gpu.types.GPUShaderCreateInfo()
    info.vertex_in(0, "VEC2", "pos")
    info.sampler(0, "FLOAT_2D", "picture")
    info.push_constant("INT", "pixel_size")
    info.fragment_out(0, "VEC4", "out_color")
    info.vertex_source(_VERTEX)
    info.fragment_source((_SHADERS / "display_frag.glsl").read_text())
    return gpu.shader.create_from_info(info)


def draw_pixels(pixels, pixel_size=1):
    """Fill the bound frame buffer with `pixels` (h, w, 4), bottom row first, each a square of
    `pixel_size`."""
    height, width = pixels.shape[:2]
    flat = np.ascontiguousarray(pixels, np.float32).reshape(-1)
    data = gpu.types.Buffer("FLOAT", flat.size, flat)
    texture = gpu.types.GPUTexture((width, height), format="RGBA32F", data=data)
    shader = _shader()
    triangle = batch_for_shader(shader, "TRIS", {"pos": ((-1.0, -1.0), (3.0, -1.0), (-1.0, 3.0))})
    shader.bind()
    shader.uniform_sampler("picture", texture)
    shader.uniform_int("pixel_size", pixel_size)
    gpu.state.blend_set("ALPHA_PREMULT")
    triangle.draw(shader)
    gpu.state.blend_set("NONE")
