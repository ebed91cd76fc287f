"""The world as a light: a map of what comes from all directions, drawn once, and what shaders make of it.

The map is a square of cells of equal solid angle, see `octahedron_lib.glsl`. Of it are made the light on surfaces where
nothing is in the way, for pictures without noise, and a tree by which sampled shadow rays choose bright directions.
"""

import hashlib
from dataclasses import dataclass

import numpy as np

from . import data_texture, layout, shader_source
from .expression import constant_of
from .material_packing import image_numbers
from .node_programs import constant_texels
from .operators import LUMINANCE

#: Cells along a side of the map of a world that is smooth, and the most: a quarter of the sun's disc fills one.
_SIDE, _LARGEST_SIDE = 128, 1024
#: Texels around the horizon for each cell along a side where both are as fine.
_AROUND = np.sqrt(np.pi)
#: Samples of a cell along a side, at least and at most.
_SAMPLES = 2, 16
#: Shares of directions chosen by the cosine among which is chosen; the first finds what the map has missed.
_COSINE_SHARES = (0.1, 0.25, 0.5, 0.75, 1.0)
#: How bright a cell is to be at least beside a bright one.
_RIM = 0.1


@dataclass(frozen=True)
class WorldLight:
    """`frame`: fields of the `Frame` record. `texels`: the data texture of `layout.WORLD_LIGHT_CELL`. Both are of a map
    (n, n, 3), n = 2^levels; `is_black` where nothing comes from anywhere."""

    frame: dict
    texels: np.ndarray
    is_black: bool

    @classmethod
    def of_map(cls, radiance):
        radiance = np.fmax(radiance, np.float32(0.0))  # 0 where it is NaN
        radiance[np.isinf(radiance)] = 0.0
        brightness = radiance @ LUMINANCE.astype(radiance.dtype)
        is_black = not brightness.any()
        brightness = _with_rims(brightness)
        brightness = (brightness / max(brightness.mean(dtype=np.float64), 1e-300)).astype(np.float32)
        tree = _tree(brightness)
        texture = data_texture.zeros(len(tree))
        texture.reshape(-1, 4)[: len(tree)] = tree
        frame = irradiance(_reduced(radiance)) | {
            "world_light_levels": len(radiance).bit_length() - 1,
            "world_cosine_share": _cosine_share(_reduced(brightness[..., None])),
        }
        return cls(frame, texture, is_black=is_black)


def world_digest(packed):
    """Bytes that are equal for `PackedScene`s whose worlds are the same light; none where it lights nothing."""
    if not packed.world.lights:
        return b""
    programs, program = packed.world_programs
    constant = constant_of(packed.world.radiance)
    digest = hashlib.blake2b(digest_size=16)
    digest.update(repr((packed.world.detail, constant, programs.text())).encode())
    if program:
        digest.update(constant_texels(program, 0, lambda key: -1))
        images = [packed.residency.images[number].serial for number in image_numbers((packed.world.radiance,))]
        digest.update(repr(images).encode())
    return digest.digest()


def light_of_world(device, packed, textures):
    """The `WorldLight` of a `PackedScene` whose `textures` are on the device; None of a black world. A generator that
    returns it, and yields between draws."""
    constant = constant_of(packed.world.radiance)
    if constant is None:
        light = WorldLight.of_map((yield from _draw_map(device, packed, textures)))
    else:
        light = WorldLight.of_map(np.broadcast_to(constant, (_SIDE, _SIDE, 3)))
        light.frame["world_radiance"] = np.clip(constant, 0.0, np.finfo(np.float32).max)
    return None if light.is_black else light


def _draw_map(device, packed, textures):
    """The map (n, n, 3) of a world that is not the same everywhere, as `light_of_world`."""
    programs, _ = packed.world_programs
    features = programs.features() | {"HAS_PROGRAMS"}
    generated = (("programs_lib.glsl", programs.text()),)
    program = device.program(shader_source.program("world_map_frag.glsl", features, generated=generated))
    frame = layout.FRAME.zeros(1)
    for name, value in packed.frame.items():
        frame[name] = value
    needed = packed.world.detail / _AROUND
    side = _SIDE
    while side < min(needed, _LARGEST_SIDE):
        side *= 2
    samples = int(np.clip(np.ceil(needed / side), *_SAMPLES))
    target = device.target(side, side, 1)
    whole = (0, 0, side, side)
    try:
        for k in range(samples**2):  # a draw each: none takes long
            yield
            offset = (np.array([k % samples, k // samples]) + 0.5) / samples - 0.5
            frame["raster"] = (1.0 / side, 1.0 / side, *(offset / side))
            device.draw(program, target, whole, textures, frame.view(np.float32))
        return device.read(target, 0, whole)[..., :3] / np.float32(samples**2)
    finally:
        device.release(target)


def directions(side):
    """The unit direction (side, side, 3) of the middle of each cell, row by row from the bottom."""
    place = (np.arange(side) + 0.5) * 2.0 / side - 1.0
    x, y = np.meshgrid(place, place)
    inside = 1.0 - np.abs(x) - np.abs(y)
    radius = 1.0 - np.abs(inside)
    with np.errstate(invalid="ignore"):
        turn = np.where(radius > 0.0, 1.0 + (np.abs(y) - np.abs(x)) / radius, 1.0)
    across, angle = radius * np.sqrt(2.0 - radius**2), np.pi / 4.0 * turn
    height = np.copysign(1.0 - radius**2, inside)
    return np.stack([np.copysign(across * np.cos(angle), x), np.copysign(across * np.sin(angle), y), height], axis=-1)


def irradiance(radiance):
    """Of a map (n, n, 3) the coefficients (3,) by name of the irradiance over pi as a polynomial of the normal.

    Spherical harmonics up to order 2, written with Legendre's polynomials of n . d: the clamped cosine is
    1/4 + P1 / 2 + 5 P2 / 16 of its pi (Ramamoorthi and Hanrahan 2001). |n| = 1 lets the constant join the squares.
    """
    towards, count = directions(len(radiance)).reshape(-1, 3), radiance[..., 0].size
    light = radiance.reshape(-1, 3)
    mean, linear = light.mean(axis=0), 2.0 * towards.T @ light / count
    square = 15.0 / 8.0 * np.einsum("ki,kj,kc->ijc", towards, towards, light, optimize=True) / count
    square += 3.0 / 8.0 * mean * np.eye(3)[:, :, None]
    axes = "xyz"
    coefficients = {f"world_{axes[i]}": linear[i] for i in range(3)}
    coefficients |= {f"world_{axes[i]}{axes[i]}": square[i, i] for i in range(3)}
    return coefficients | {f"world_{axes[i]}{axes[(i + 1) % 3]}": 2.0 * square[i, (i + 1) % 3] for i in range(3)}


def _reduced(cells):
    """A map (m, m, k) float64 of at most _SIDE cells a side, by means over those of (n, n, k)."""
    step = max(len(cells) // _SIDE, 1)
    side, kinds = len(cells) // step, cells.shape[-1]
    rows = cells.reshape(side, step, -1).sum(axis=1, dtype=np.float64)  # one after the other: several times faster
    return rows.reshape(side, side, step, kinds).sum(axis=2) / step**2


def _with_rims(brightness):
    """The brightness (n, n), in no cell less than a part of its brightest neighbour's: its samples may have missed the
    rim of a sun that reaches into it. Across an edge of the square lies the same edge turned about."""
    padded = np.pad(brightness, 1, "edge")
    padded[1:-1, [0, -1]], padded[[0, -1], 1:-1] = brightness[::-1, [0, -1]], brightness[[0, -1], ::-1]
    for _ in range(2):
        padded = np.maximum(np.maximum(padded[:-2], padded[1:-1]), padded[2:]).T
    return np.maximum(brightness, _RIM * padded)


def _tree(brightness):
    """Entries (m, 4) from the coarsest level on: the brightness of the quarters of each cell, below left first."""
    levels = []
    while len(brightness) > 1:
        half = len(brightness) // 2
        quarters = brightness.reshape(half, 2, half, 2).transpose(0, 2, 1, 3).reshape(half, half, 4)
        levels.append(quarters.reshape(-1, 4))
        brightness = quarters.mean(axis=-1)
    return np.concatenate(levels[::-1]).astype(np.float32)


def _cosine_share(brightness):
    """The part of directions to choose by the cosine, for the least variance on surfaces that face along the axes."""
    normals = np.concatenate([np.eye(3), -np.eye(3)])
    cosine = np.maximum(directions(len(brightness)).reshape(-1, 3) @ normals.T, 0.0).astype(np.float32)
    bright = brightness.reshape(-1, 1).astype(np.float32)
    squares = (bright * cosine) ** 2
    moments = [
        float(np.sum(squares / np.maximum(4.0 * share * cosine + (1.0 - share) * bright, 1e-30), dtype=np.float64))
        for share in _COSINE_SHARES
    ]
    return _COSINE_SHARES[int(np.argmin(moments))]
