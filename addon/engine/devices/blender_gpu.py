"""Blender's own GPU context, OpenGL, Vulkan or Metal. The only file that imports gpu."""

import contextlib
import os
import re
import sys
import tempfile
from collections import OrderedDict
from functools import cache

import numpy as np

from .. import data_texture
from ..errors import DeviceError
from ..glsl_functions import SHADER_FOLDER
from .base import (
    FULL_SCREEN_TRIANGLE,
    GROUP_SIZE,
    PIXEL,
    PIXEL_OF_COMPUTE,
    describe_compile_error,
    loaded_as_images,
    texel_readers,
    tile_and_groups,
)

_VERTEX = "void main() { gl_Position = vec4(position, 0.0, 1.0); }"

_COPY = "copy_texels_frag.glsl"

#: Programs by source, the one that was asked for last at the end: undo, other scenes and previews of materials come
#: back to them. None is left bound after a draw: Blender tells programs apart by their address, and would take a new
#: one for one that was freed while bound.
_PROGRAMS = OrderedDict()
_MOST_PROGRAMS = 64  # each edit of a node tree may make one


def _program(source, compiled):
    """The program of a source; `compiled` makes it where it is not there."""
    if source not in _PROGRAMS:
        _PROGRAMS[source] = compiled()
        while len(_PROGRAMS) > _MOST_PROGRAMS:  # whoever draws with it keeps it until then
            _PROGRAMS.popitem(last=False)
    _PROGRAMS.move_to_end(source)
    return _PROGRAMS[source]


@cache
def blank_texture():
    """A texture that lasts, to be bound in the place of those that do not, after each draw.

    A texture that is freed in one of Blender's GPU contexts, of which a viewport has one and its window another, stays
    bound in the others. The next one that is made may get its number, and where that is bound, Mesa's drivers find the
    number there already and go on with the old one.
    """
    import gpu

    return gpu.types.GPUTexture((1, 1), format="RGBA32F")


def free_programs():
    """Give all that is shared back to Blender while it can still take it: before its end."""
    _PROGRAMS.clear()
    blank_texture.cache_clear()


class BlenderDevice:
    """`Device` on the GPU context that is active: in `RenderEngine.render` and `view_draw`.

    Raises DeviceError when Blender has none.
    """

    def __init__(self):
        try:
            import gpu
            from gpu_extras.batch import batch_for_shader

            self._gpu = gpu
            self.max_texture_size = int(gpu.capabilities.max_texture_size_get())
            self.name = f"{gpu.platform.renderer_get()} ({gpu.platform.backend_type_get()})"
        except (ImportError, SystemError, RuntimeError) as error:
            raise DeviceError(
                f"Blender has no GPU context here ({error}). Conic draws with OpenGL, Vulkan or Metal; on a "
                "machine without a GPU install Mesa's software drivers (Debian, Ubuntu: libegl1 and libgl1-mesa-dri)"
            ) from error
        self.can_compute = hasattr(gpu, "compute")
        self._batch_for_shader = batch_for_shader

    def _buffer(self, array):
        # One-dimensional and float32: others are read wrongly by one version of Blender or another.
        flat = np.ascontiguousarray(array, np.float32).reshape(-1)
        return self._gpu.types.Buffer("FLOAT", flat.size, flat)

    def texture(self, texels):
        height, width, _ = texels.shape
        try:
            return self._gpu.types.GPUTexture((width, height), format="RGBA32F", data=self._buffer(texels))
        except (RuntimeError, ValueError, MemoryError) as error:
            raise DeviceError(f"no memory for a texture of {width} x {height}: {error}") from error

    def grown(self, texture, texels):
        width = min(texels, data_texture.WIDTH)
        height = -(-texels // width)
        try:
            new = self._gpu.types.GPUTexture((width, height), format="RGBA32F")
        except (RuntimeError, ValueError, MemoryError) as error:
            raise DeviceError(f"no memory for a texture of {width} x {height}: {error}") from error
        if texture is not None:
            self._copy(texture, new, 0, texture.width * texture.height)
        return new

    def update(self, texture, first, texels):
        # There is no other way to change a part of a texture than to draw it.
        padded = data_texture.zeros(len(texels))
        padded.reshape(-1, 4)[: len(texels)] = texels
        self._copy(self.texture(padded), texture, first, len(texels))

    def _copy(self, source, texture, first, count):
        """Copy the first `count` texels of `source` to number `first` and on of `texture`."""
        shader, batch = _program(_COPY, self._compiled_copy)
        width, last = texture.width, first + count - 1
        state = self._gpu.state
        with self._gpu.types.GPUFrameBuffer(color_slots=[texture]).bind():
            state.scissor_test_set(True)
            state.scissor_set(0, first // width, width, last // width - first // width + 1)
            state.blend_set("NONE")
            try:
                shader.bind()
                shader.uniform_sampler("texels_data", source)
                for name, value in (("into_first", first), ("into_width", width), ("count", count)):
                    shader.uniform_int(name, value)
                batch.draw(shader)
            finally:
                shader.uniform_sampler("texels_data", blank_texture())
                self._gpu.shader.unbind()
                state.scissor_test_set(False)
        self._copied = source  # until the next copy: the GPU may not have read it yet

    def _compiled_copy(self):
        info = self._gpu.types.GPUShaderCreateInfo()
        info.vertex_in(0, "VEC2", "position")
        info.sampler(0, "FLOAT_2D", "texels_data")
        for name in ("into_first", "into_width", "count"):
            info.push_constant("INT", name)
        info.fragment_out(0, "VEC4", "out_texel")
        info.vertex_source(_VERTEX)
        info.fragment_source((SHADER_FOLDER / _COPY).read_text(encoding="utf-8"))
        shader = self._gpu.shader.create_from_info(info)
        return shader, self._batch_for_shader(shader, "TRIS", {"position": FULL_SCREEN_TRIANGLE})

    def target(self, width, height, attachments):
        try:
            colors = [self._gpu.types.GPUTexture((width, height), format="RGBA32F") for _ in range(attachments)]
        except (RuntimeError, ValueError, MemoryError) as error:
            raise DeviceError(f"no memory for a picture of {width} x {height}: {error}") from error
        target = _Target(self._gpu.types.GPUFrameBuffer(color_slots=colors), colors)
        for attachment in range(attachments):
            self.clear(target, attachment)
        return target

    def program(self, source):
        return _program(source, lambda: self._compiled(source))

    def _compiled(self, source):
        info = self._create_info(source)
        try:
            with _captured_output() as captured:
                shader = self._gpu.shader.create_from_info(info)
        except Exception as error:  # gpu raises a bare Exception; the driver's log goes to the console
            log = captured.text or str(error)
            number = re.search(r":(\d+):\d+", log)
            line = int(number.group(1)) if number else 0
            raise DeviceError(describe_compile_error(source, log, line)) from error
        if source.is_compute:
            return source, shader, None
        return source, shader, self._batch_for_shader(shader, "TRIS", {"position": FULL_SCREEN_TRIANGLE})

    def _create_info(self, source):
        info = self._gpu.types.GPUShaderCreateInfo()
        if source.uniform_struct:
            info.typedef_source(source.uniform_struct)
            info.uniform_buf(0, "Frame", "frame")
        images, written = loaded_as_images(source, self.name), len(source.outputs) if source.is_compute else 0
        for unit, name in enumerate(source.textures):
            if name in images:
                info.image(written + images.index(name), "RGBA32F", "FLOAT_2D", f"{name}_data", qualifiers={"READ"})
            else:
                info.sampler(unit, "FLOAT_2D", f"{name}_data")
        for name, value in texel_readers(source, images):
            info.define(name, value)
        (self._add_compute_stage if source.is_compute else self._add_stages)(info, source)
        return info

    def _add_stages(self, info, source):
        info.define("PIXEL", PIXEL)
        info.vertex_in(0, "VEC2", "position")
        for location, name in enumerate(source.outputs):
            info.fragment_out(location, "VEC4", name)
        info.vertex_source(_VERTEX)
        info.fragment_source(source.text)

    def _add_compute_stage(self, info, source):
        info.define("PIXEL", PIXEL_OF_COMPUTE)
        info.local_group_size(GROUP_SIZE, 1, 1)
        info.push_constant("IVEC4", "tile")
        for unit, name in enumerate(source.outputs):
            info.image(unit, "RGBA32F", "FLOAT_2D", f"{name}_image", qualifiers={"READ", "WRITE"})
        info.compute_source(source.text)

    def draw(self, program, target, rectangle, textures, uniforms):
        source, shader, batch = program
        if source in _PROGRAMS:
            _PROGRAMS.move_to_end(source)
        block = self._gpu.types.GPUUniformBuf(self._buffer(uniforms))
        if source.is_compute:
            self._dispatch(source, shader, target, rectangle, textures, block)
        else:
            self._draw(source, shader, batch, target, rectangle, textures, block)
        target.keep = block, textures  # until the next draw has replaced them: the GPU may not have read them yet

    def _draw(self, source, shader, batch, target, rectangle, textures, block):
        state = self._gpu.state
        with target.framebuffer.bind():
            state.scissor_test_set(True)
            state.scissor_set(*rectangle)
            state.blend_set("ADDITIVE_PREMULT")
            try:
                self._bind(source, shader, textures, block)
                batch.draw(shader)
            finally:
                self._bind_textures(source, shader, dict.fromkeys(source.textures, blank_texture()))
                self._gpu.shader.unbind()
                state.blend_set("NONE")
                state.scissor_test_set(False)

    def _dispatch(self, source, shader, target, rectangle, textures, block):
        tile, groups = tile_and_groups(rectangle)
        try:
            self._bind(source, shader, textures, block)
            self._bind_outputs(source, shader, target.colors)
            shader.uniform_int("tile", tile)
            # Blender puts a barrier after it, for textures and images. None can be had for frame buffers, from which
            # `read` reads; drivers keep this order nevertheless.
            self._gpu.compute.dispatch(shader, *groups, 1)
        finally:
            self._bind_textures(source, shader, dict.fromkeys(source.textures, blank_texture()))
            self._bind_outputs(source, shader, [blank_texture()] * len(source.outputs))
            self._gpu.shader.unbind()

    def _bind(self, source, shader, textures, block):
        """Make a program the current one, with what it reads."""
        shader.bind()
        if source.uniform_struct:
            shader.uniform_block("frame", block)
        self._bind_textures(source, shader, textures)

    def _bind_textures(self, source, shader, textures):
        """Have the data textures of a program read from `textures` by name."""
        images = loaded_as_images(source, self.name)
        for name in source.textures:
            bind = shader.image if name in images else shader.uniform_sampler
            bind(f"{name}_data", textures[name])

    @staticmethod
    def _bind_outputs(source, shader, colors):
        """Have what a compute program puts out written to `colors`, a texture each."""
        for name, texture in zip(source.outputs, colors, strict=True):
            shader.image(f"{name}_image", texture)

    def attachment(self, target, attachment):
        return target.colors[attachment]

    def clear(self, target, attachment):
        target.colors[attachment].clear(format="FLOAT", value=(0.0, 0.0, 0.0, 0.0))

    def read(self, target, attachment, rectangle):
        x, y, width, height = rectangle
        pixels = np.empty(width * height * 4, np.float32)
        buffer = self._gpu.types.Buffer("FLOAT", pixels.size, pixels)
        with target.framebuffer.bind():
            target.framebuffer.read_color(x, y, width, height, 4, attachment, "FLOAT", data=buffer)
        return pixels.reshape(height, width, 4)

    def release(self, thing):
        """Textures are Blender's: freed when the last reference goes."""


class _Target:
    """A frame buffer, its attachments, and what the last draw still reads."""

    def __init__(self, framebuffer, colors):
        self.framebuffer, self.colors, self.keep = framebuffer, colors, ()


class _Captured:
    text = ""


@contextlib.contextmanager
def _captured_output():
    """Catch what C code prints meanwhile: the only way to a driver's log."""
    captured = _Captured()
    sys.stdout.flush()
    sys.stderr.flush()
    saved = [(fd, os.dup(fd)) for fd in (1, 2)]
    with tempfile.TemporaryFile() as file:
        for fd, _ in saved:
            os.dup2(file.fileno(), fd)
        try:
            yield captured
        finally:
            for fd, copy in saved:
                os.dup2(copy, fd)
                os.close(copy)
            file.seek(0)
            captured.text = file.read().decode(errors="replace")
