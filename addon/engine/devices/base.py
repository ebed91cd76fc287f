"""What a device does: textures, programs, drawing into float targets, reading back. It never knows what a sphere is."""

from typing import Protocol

#: Every program fills its rectangle with one triangle.
FULL_SCREEN_TRIANGLE = ((-1.0, -1.0), (3.0, -1.0), (-1.0, 3.0))


class Device(Protocol):
    """An adapter of a GPU context. All arrays are float32; rows of pictures run from the bottom up.

    Textures, targets and programs are opaque to the caller; they live until `release` (programs: as long as the
    device). Methods raise DeviceError with the cause.
    """

    name: str  #: renderer and driver, for people
    max_texture_size: int  #: texels along one side
    can_compute: bool  #: whether it takes programs whose source `is_compute`

    def texture(self, texels):
        """An RGBA32F data texture from texels (height, width, 4)."""

    def grown(self, texture, texels):
        """A data texture with room for at least so many texels, row by row, that begins as `texture` does (None: no
        matter how)."""

    def update(self, texture, first, texels):
        """Write texels (n, 4) into a data texture from texel number `first` on, row by row."""

    def target(self, width, height, attachments):
        """A frame buffer of RGBA32F attachments, cleared to zero."""

    def program(self, source):
        """A program from a `ProgramSource`; the same source gives the same program."""

    def draw(self, program, target, rectangle, textures, uniforms):
        """Add the program's outputs to the target within rectangle (x, y, width, height).

        `textures`: data texture by name, at least those of the program. `uniforms`: (n,) float32, the record `Frame`.
        """

    def attachment(self, target, attachment):
        """An attachment of a target as a texture that other draws can read; it lives as long as the target."""

    def clear(self, target, attachment):
        """Set an attachment of a target to zero."""

    def read(self, target, attachment, rectangle):
        """Pixels (height, width, 4) of an attachment; waits until all drawing is done."""

    def release(self, thing):
        """Free a texture or target."""


#: Pixels along a side of a work group of a compute program, which is a square; and invocations in it.
_GROUP_SIDE = 8
GROUP_SIZE = _GROUP_SIDE * _GROUP_SIDE

#: How programs name the pixel that they work on: its centre, from the lower left corner of the target.
PIXEL = "gl_FragCoord.xy"
#: Invocations run along a Z curve, so that those that a processor takes at a time are neighbours: 4 x 2 pixels of 8,
#: 8 x 4 of 32. That is worth 5% of the time to a software rasteriser.
PIXEL_OF_COMPUTE = (
    f"(vec2(tile.xy + ivec2(gl_WorkGroupID.xy) * {_GROUP_SIDE} + ivec2("
    "(INVOCATION & 1) | ((INVOCATION >> 1) & 2) | ((INVOCATION >> 2) & 4), "
    "((INVOCATION >> 1) & 1) | ((INVOCATION >> 2) & 2) | ((INVOCATION >> 3) & 4))) + 0.5)"
).replace("INVOCATION", "int(gl_LocalInvocationIndex)")


def tile_and_groups(rectangle):
    """Of a rectangle (x, y, width, height): the uniform `tile` of compute programs, which is first pixel and end, and
    the numbers of work groups that cover it."""
    x, y, width, height = rectangle
    return (x, y, x + width, y + height), (-(-width // _GROUP_SIDE), -(-height // _GROUP_SIDE))


#: Data textures by how often rays read them, and how many images a program may have in every driver.
_READ_MOST = ("nodes", "spheres", "cylinders", "cones", "discs", "triangles", "instances", "tables")
_MAX_IMAGES = 8


def loaded_as_images(source, renderer):
    """Which data textures of a program are best declared as images on this renderer, () for none.

    A GPU has caches for textures. Mesa's software rasteriser calls a function for each texelFetch, which finds the mip
    level lane by lane and saves all registers; an image load, in line, takes a third of the time.
    """
    if "llvmpipe" not in renderer:
        return ()
    most = _MAX_IMAGES - (len(source.outputs) if source.is_compute else 0)
    return tuple(name for name in _READ_MOST if name in source.textures)[:most]


def texel_readers(source, images):
    """The macros (signature, expression) by which a program reads its data textures, see `record_glsl.fetch`."""
    for name in source.textures:
        read = f"imageLoad({name}_data, place)" if name in images else f"texelFetch({name}_data, place, 0)"
        yield f"texel_{name}(place)", read


def row_pieces(first, count, width):
    """Cut texels from number `first` on into rectangles of a texture `width` wide: yields the first texel's number and
    which of the `count` it holds; at most a part of a row, whole rows, a part of a row."""
    start = 0
    while start < count:
        into_row, left = (first + start) % width, count - start
        length = min(width - into_row, left) if into_row or left < width else left // width * width
        yield first + start, slice(start, start + length)
        start += length


def describe_compile_error(source, log, line):
    """The text of an error for a shader that a driver refuses: its log, and the lines concerned where one is known."""
    text = f"shader {source.name} does not compile: {log.strip()}"
    return f"{text}\n{source.listing(line)}" if line else text
