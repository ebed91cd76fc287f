"""A context without a window through moderngl: tests, command line and library use. The only file that imports
moderngl."""

import contextlib
import ctypes
import functools
import re

import numpy as np

from .. import data_texture
from ..errors import DeviceError
from .base import (
    FULL_SCREEN_TRIANGLE,
    GROUP_SIZE,
    PIXEL,
    PIXEL_OF_COMPUTE,
    describe_compile_error,
    loaded_as_images,
    row_pieces,
    texel_readers,
    tile_and_groups,
)

_VERTEX = """#version 330
in vec2 position;
void main() { gl_Position = vec4(position, 0.0, 1.0); }
"""

_NO_DRIVER = """no OpenGL driver for drawing without a window was found ({cause}).
Install one: on Debian and Ubuntu 'apt-get install libegl1 libgl1-mesa-dri' (Mesa, works without a GPU),
on Fedora 'dnf install mesa-libEGL mesa-dri-drivers', or the EGL libraries of your GPU's driver."""


_EGL_DRAW_AND_READ = 0x3059, 0x305A


@functools.cache
def _egl():
    """The library that knows which context is current, None on systems without EGL."""
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError:
        return None
    for function in (egl.eglGetCurrentDisplay, egl.eglGetCurrentSurface, egl.eglGetCurrentContext):
        function.restype = ctypes.c_void_p
    egl.eglMakeCurrent.argtypes = [ctypes.c_void_p] * 4
    return egl


@contextlib.contextmanager
def _current_context_kept():
    """Give the thread back the context that it had, Blender's say, which moderngl does not do. Without one Blender
    ends where it frees a program."""
    egl = _egl()
    context = egl and egl.eglGetCurrentContext()
    if not context:
        yield
        return
    display, surfaces = egl.eglGetCurrentDisplay(), [egl.eglGetCurrentSurface(which) for which in _EGL_DRAW_AND_READ]
    try:
        yield
    finally:
        egl.eglMakeCurrent(display, *surfaces, context)


def _context():
    try:
        import moderngl
    except ImportError as error:
        raise DeviceError("drawing without Blender needs the Python package moderngl: pip install moderngl") from error
    causes = []
    for options in ({"backend": "egl"}, {}):
        try:
            return moderngl.create_context(standalone=True, require=330, **options)
        except Exception as error:  # moderngl and glcontext raise bare Exception for a missing library or display
            causes.append(str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__)
    raise DeviceError(_NO_DRIVER.format(cause="; ".join(dict.fromkeys(causes))))


def _in_context(method):
    """Make the device's context current meanwhile: there may be others in the process, Blender's among them."""

    @functools.wraps(method)
    def inside(self, *arguments):
        with _current_context_kept(), self._context:
            return method(self, *arguments)

    return inside


class HeadlessDevice:
    """`Device` on an OpenGL context of its own, 3.3 at least. Raises DeviceError when there is no driver."""

    def __init__(self):
        self._programs = {}
        self._uniforms = None
        with _current_context_kept():
            self._context = _context()
            self._triangle = self._context.buffer(np.array(FULL_SCREEN_TRIANGLE, np.float32).tobytes())
            info = self._context.info
        self.name = f"{info['GL_RENDERER']} (OpenGL {info['GL_VERSION']})"
        self.max_texture_size = int(info["GL_MAX_TEXTURE_SIZE"])
        self.can_compute = self._context.version_code >= 430

    def close(self):
        """Give back the context and everything that was made in it; the device cannot be used any more."""
        self._programs = {}
        with _current_context_kept():
            self._context.release()

    @_in_context
    def texture(self, texels):
        height, width, _ = texels.shape
        try:
            texture = self._context.texture((width, height), 4, np.ascontiguousarray(texels, np.float32), dtype="f4")
        except Exception as error:
            raise DeviceError(f"no memory for a texture of {width} x {height}: {error}") from error
        texture.filter = (self._context.NEAREST, self._context.NEAREST)
        return texture

    @_in_context
    def grown(self, texture, texels):
        width = min(texels, data_texture.WIDTH)
        height = -(-texels // width)
        new = self._empty_texture(width, height)
        if texture is not None:
            frames = [self._context.framebuffer([t]) for t in (new, texture)]
            self._context.copy_framebuffer(*frames)
            for frame in frames:
                frame.release()
        return new

    @_in_context
    def update(self, texture, first, texels):
        for start, rows in row_pieces(first, len(texels), texture.width):
            x, y = start % texture.width, start // texture.width
            width = min(texture.width, rows.stop - rows.start)
            piece = np.ascontiguousarray(texels[rows], np.float32)
            texture.write(piece, viewport=(x, y, width, len(piece) // width))

    def _empty_texture(self, width, height):
        try:
            texture = self._context.texture((width, height), 4, dtype="f4")
        except Exception as error:
            raise DeviceError(f"no memory for a texture of {width} x {height}: {error}") from error
        texture.filter = (self._context.NEAREST, self._context.NEAREST)
        return texture

    @_in_context
    def target(self, width, height, attachments):
        try:
            colors = [self._context.texture((width, height), 4, dtype="f4") for _ in range(attachments)]
            target = self._context.framebuffer(colors)
        except Exception as error:
            raise DeviceError(f"no memory for a picture of {width} x {height}: {error}") from error
        target.clear()
        return target

    @_in_context
    def program(self, source):
        if source not in self._programs:
            text = self._declarations(source) + source.text
            try:
                if source.is_compute:
                    program = self._context.compute_shader(text)
                else:
                    program = self._context.program(vertex_shader=_VERTEX, fragment_shader=text)
            except Exception as error:  # moderngl.Error, whose text holds the driver's log
                number = re.search(r"\b0[:(](\d+)", str(error))
                line = int(number.group(1)) if number else 0
                raise DeviceError(describe_compile_error(source, str(error), line)) from error
            images = self._images_of(source)
            for unit, name in enumerate(source.textures):
                if f"{name}_data" in program and name not in images:
                    program[f"{name}_data"] = unit
            if not source.is_compute:
                program = self._context.vertex_array(program, [(self._triangle, "2f", "position")])
            self._programs[source] = (source, program)
        return self._programs[source]

    def _images_of(self, source):
        return loaded_as_images(source, self.name) if self._context.version_code >= 420 else ()

    def _declarations(self, source):
        images, written = self._images_of(source), source.outputs if source.is_compute else ()
        textures = "".join(f"#define {name} {value}\n" for name, value in texel_readers(source, images))
        for name in source.textures:
            if name in images:
                unit = len(written) + images.index(name)
                textures += f"layout(rgba32f, binding = {unit}) readonly uniform image2D {name}_data;\n"
            else:
                textures += f"uniform sampler2D {name}_data;\n"
        block = f"{source.uniform_struct}layout(std140) uniform frame_block {{ Frame frame; }};\n"
        head = f"{block if source.uniform_struct else ''}{textures}"
        if source.is_compute:
            head += f"layout(local_size_x = {GROUP_SIZE}) in;\nuniform ivec4 tile;\n"
            for unit, name in enumerate(written):
                head += f"layout(rgba32f, binding = {unit}) uniform image2D {name}_image;\n"
            return f"#version 430\n#define PIXEL {PIXEL_OF_COMPUTE}\n{head}#line 1\n"
        outputs = "".join(f"layout(location = {i}) out vec4 {name};\n" for i, name in enumerate(source.outputs))
        return f"#version {420 if images else 330}\n#define PIXEL {PIXEL}\n{head}{outputs}#line 1\n"

    @_in_context
    def draw(self, program, target, rectangle, textures, uniforms):
        source, runner = program
        uniforms = np.ascontiguousarray(uniforms, np.float32)
        if self._uniforms is None or self._uniforms.size != uniforms.nbytes:
            self._uniforms = self._context.buffer(reserve=uniforms.nbytes)
        self._uniforms.write(uniforms.tobytes())
        self._uniforms.bind_to_uniform_block(0)
        images, written = self._images_of(source), len(source.outputs) if source.is_compute else 0
        for unit, name in enumerate(source.textures):
            if name in images:
                textures[name].bind_to_image(written + images.index(name), read=True, write=False)
            else:
                textures[name].use(unit)
        (self._dispatch if source.is_compute else self._draw)(runner, target, rectangle)

    def _draw(self, vertices, target, rectangle):
        gl = self._context
        target.use()
        target.scissor = rectangle
        gl.enable_only(gl.BLEND)
        gl.blend_func = gl.ONE, gl.ONE
        vertices.render(gl.TRIANGLES)
        target.scissor = None

    def _dispatch(self, program, target, rectangle):
        for unit, texture in enumerate(target.color_attachments):
            texture.bind_to_image(unit, read=True, write=True)
        program["tile"], groups = tile_and_groups(rectangle)
        program.run(*groups, 1)
        self._context.memory_barrier()

    def attachment(self, target, attachment):
        return target.color_attachments[attachment]

    @_in_context
    def clear(self, target, attachment):
        only = self._context.framebuffer([target.color_attachments[attachment]])
        only.clear()
        only.release()

    @_in_context
    def read(self, target, attachment, rectangle):
        x, y, width, height = rectangle
        data = target.read((x, y, width, height), 4, attachment=attachment, dtype="f4", alignment=1)
        return np.frombuffer(data, np.float32).reshape(height, width, 4)

    @_in_context
    def release(self, thing):
        for attachment in getattr(thing, "color_attachments", ()):
            attachment.release()
        thing.release()
