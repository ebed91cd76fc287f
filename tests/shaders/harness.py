"""Run the product's GLSL functions over many inputs at once: one input a pixel, read back as rows.

A test program is a fragment file in `glsl/` that includes the product's libraries. Its inputs lie in a data texture of
their own, described by a `Record` as all GPU data is, so that it is read by `read_<record>(i)`.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from addon.engine import data_texture, layout, shader_source
from addon.engine.record import Field, Record
from addon.engine.scene import Visibility

FOLDERS = (Path(__file__).resolve().parent / "glsl", shader_source.SHADER_FOLDER)

#: Pixels in a row of a test's target.
ROW = 256

#: A ray and, for surfaces, the direction in which the next ray leaves.
TEST_RAY = Record(
    "test_ray",
    "test_rays",
    (
        Field("origin", "vec3", ""),
        Field("t_max", "float", ""),
        Field("direction", "vec3", "unit"),
        Field("kind", "int", "one of the bits of Visibility"),
        Field("next", "vec3", "unit"),
        Field("unused", "float", ""),
    ),
)
#: Whatever a function takes, as eight numbers.
TEST_VALUE = Record("test_value", "test_values", (Field("a", "vec4", ""), Field("b", "vec4", "")))


def texels(*arrays):
    """Structured arrays one after the other as a data texture (height, data_texture.WIDTH, 4) float32."""
    rows = np.concatenate([np.ascontiguousarray(a).view(np.float32).reshape(-1, 4) for a in arrays])
    height = max(-(-len(rows) // data_texture.WIDTH), 1)
    padded = np.zeros((height * data_texture.WIDTH, 4), np.float32)
    padded[: len(rows)] = rows
    return padded.reshape(height, data_texture.WIDTH, 4)


def frame_record(**values):
    """The uniform block (n,) float32, zero but for `values`."""
    frame = layout.FRAME.zeros(1)
    for name, value in values.items():
        frame[name] = value
    return frame.view(np.float32)


def run(
    device, entry, count, textures, *, features=(), constants=None, outputs=("out_color",), frame=None, generated=()
):
    """Draw `count` pixels of the fragment file `entry`; a list of (count, 4) float32, one for each output.

    `textures`: texels (height, width, 4) by name. `generated`: (name, text) of files. The pixel's number is
    `TEST_INDEX` in GLSL.
    """
    index = f"(int(gl_FragCoord.y) * {ROW} + int(gl_FragCoord.x))"
    source = shader_source.program(
        entry,
        features,
        {"TEST_INDEX": index, **(constants or {})},
        outputs,
        FOLDERS,
        (*layout.RECORDS, TEST_RAY, TEST_VALUE),
        generated,
    )
    program = device.program(source)
    height = -(-count // ROW)
    target = device.target(ROW, height, len(outputs))
    uploaded = {name: device.texture(textures[name]) for name in source.textures}
    try:
        rectangle = (0, 0, ROW, height)
        device.draw(program, target, rectangle, uploaded, frame_record() if frame is None else frame)
        return [device.read(target, i, rectangle).reshape(-1, 4)[:count].copy() for i in range(len(outputs))]
    finally:
        device.release(target)
        for texture in uploaded.values():
            device.release(texture)


def run_values(device, entry, *columns, **options):
    """`run` over up to eight columns (n,) that become `read_test_value(TEST_INDEX)`."""
    values = TEST_VALUE.zeros(len(columns[0]))
    flat = values.view(np.float32).reshape(len(values), 8)
    for i, column in enumerate(columns):
        flat[:, i] = column
    textures = {"test_values": texels(values)} | options.pop("textures", {})
    return run(device, entry, len(values), textures, **options)


@dataclass(frozen=True)
class Hits:
    """What the GLSL of a kind says of n pairs of ray and primitive; rows of misses mean nothing but in `t`."""

    t: np.ndarray  # (n,) float32, inf for a miss
    position: np.ndarray  # (n, 3)
    normal: np.ndarray  # (n, 3) geometric
    shading_normal: np.ndarray  # (n, 3)
    uv: np.ndarray  # (n, 2)
    error: np.ndarray  # (n,)
    material: np.ndarray  # (n,)
    spawned: np.ndarray  # (n, 3) origin of the ray that leaves towards `next`
    t_next: np.ndarray  # (n,) that ray's t on the same primitive, inf for a miss


def ray_records(origin, direction, t_max=1e30, following=None, kind=Visibility.CAMERA):
    """TEST_RAY records (n,) of rays, and of the directions that the next rays leave in."""
    rays = TEST_RAY.zeros(len(origin))
    rays["kind"] = int(kind)
    rays["origin"], rays["direction"], rays["t_max"] = origin, direction, t_max
    rays["next"] = direction if following is None else following
    return rays


def hits(device, primitives, origin, direction, *, t_max=1e30, following=None):
    """`Hits` of ray i with primitive i; `following` (n, 3): directions in which rays leave the surface."""
    kind = primitives.kind
    hit, surface = primitives.records()
    names = primitives.record.texture, primitives.surface_record.texture
    frame = None
    if names[0] == names[1]:
        textures = {names[0]: texels(hit, surface)}
        frame = frame_record(**{f"{kind}_surface_first": hit.nbytes // 16})
    else:
        textures = {names[0]: texels(hit), names[1]: texels(surface)}
    t, position, normal, shading, spawned = run(
        device,
        "pairs_frag.glsl",
        len(origin),
        textures | {"test_rays": texels(ray_records(origin, direction, t_max, following))},
        features={f"HAS_{kind.upper()}"},
        constants={
            "TEST_HIT": f"{kind}_hit",
            "TEST_SURFACE": f"{kind}_surface",
            "TEST_READ": f"read_{kind}",
            "TEST_READ_SURFACE": f"read_{kind}_surface",
        },
        outputs=("out_hit", "out_position", "out_normal", "out_shading", "out_spawned"),
        frame=frame,
    )
    misses = t[:, 0] >= np.broadcast_to(np.float32(t_max), len(t))
    return Hits(
        np.where(misses, np.inf, t[:, 0]),
        position[:, :3],
        normal[:, :3],
        shading[:, :3],
        np.stack([position[:, 3], normal[:, 3]], axis=-1),
        t[:, 1],
        t[:, 2],
        spawned[:, :3],
        np.where(spawned[:, 3] >= np.float32(1e30), np.inf, spawned[:, 3]),
    )
