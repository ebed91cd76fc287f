"""Image, environment and sky textures."""

from functools import cache, partial
from pathlib import Path
from tempfile import mkdtemp

import bpy
import numpy as np

from tests.blender.building import image, node

from .case import Node, Swatch

#: Coordinates of the plate: far beyond the picture, and around the origin.
PLACE = Node("Attribute", "Vector", attribute_name="place")
ROUND = Node("VectorMath", operation="SUBTRACT", feed=(PLACE, (0.1, 0.2, 0.4)))
SIDES = {"REPEAT": "repeat", "EXTEND": "extend", "CLIP": "clip", "MIRROR": "mirror"}


def pixels(alpha=True, size=(11, 7), seed=8):
    """Colors (h, w, 4) in 0..1, smooth enough that a pixel beside does not matter."""
    rng = np.random.default_rng(seed)
    made = rng.uniform(0.1, 0.95, (size[1], size[0], 4))
    made[..., 3] = np.rint(rng.uniform(0.2, 1.0, size[::-1]) * 255.0) / 255.0 if alpha else 1.0
    return made


def generated(alpha=True, *, mode="STRAIGHT", **settings):
    made = image(pixels(alpha), **settings)
    made.alpha_mode = mode
    return made


def opaque():
    return generated(alpha=False)


def faint(alpha_mode, *, packed=False):
    """Floats whose alpha is a tenth."""
    values = pixels(False)
    values[..., 3] = 0.1
    made = image(values, float_buffer=True)
    made.alpha_mode = alpha_mode
    if packed:
        made.pack()
    return made


def painted(name, file_format, mode):
    """A file that was painted: it is half as bright."""
    made = from_file(name, file_format, mode=mode)
    values = np.array(made.pixels)
    values.reshape(-1, 4)[:, :3] *= 0.5
    made.pixels.foreach_set(values.astype(np.float32))
    return made


def picture(make=opaque, output="Color", also=False, kind="TexImage", vector=PLACE, **settings):
    """A node with an image; `also`: its alpha is used too, and taken from the color."""

    def shown(tree, socket):
        made = Node(kind, output, then=lambda made: setattr(made, "image", make()), Vector=vector, **settings).build(
            tree
        )
        if also:
            difference = node(tree, "VectorMath", socket)
            difference.operation = "SUBTRACT"
            tree.links.new(made.node.outputs["Alpha"], difference.inputs[1])
            socket = difference.inputs[0]
        tree.links.new(made, socket)

    return shown


@cache
def folder():
    return Path(mkdtemp(prefix="images"))


def saved(name, file_format, values):
    """A file of pixels (h, w, 4) as they are."""
    path = folder() / name
    made = image(values, float_buffer=file_format in ("OPEN_EXR", "HDR"), is_data=True)
    made.filepath_raw, made.file_format = str(path), file_format
    made.save()
    bpy.data.images.remove(made)
    return str(path)


def from_file(name="picture.png", file_format="PNG", *, packed=False, space="", mode="", alpha=True):
    values = pixels(alpha)
    if mode == "PREMUL":
        values[..., :3] *= values[..., 3:]
    values[..., :3] *= 3.0 if file_format in ("OPEN_EXR", "HDR") else 1.0
    made = bpy.data.images.load(saved(name, file_format, values))
    made.colorspace_settings.name, made.alpha_mode = space or made.colorspace_settings.name, mode or made.alpha_mode
    if packed:
        made.pack()
    return made


def tiled(packed=False):
    """Four tiles of a UDIM image, one of them not there."""
    for i, number in enumerate((1001, 1002, 1012)):
        path = saved(f"tiles.{number}.png", "PNG", pixels(False, seed=i))
    made = bpy.data.images.load(path.replace("1012", "<UDIM>"))
    made.source = "TILED"
    for number in (1002, 1012):
        made.tiles.new(number)
    assert len(made.pixels), "Blender has looked at it, and knows its color space"
    if packed:
        made.pack()
    return made


def of_sequence(**settings):
    """What shows a frame of a sequence of three."""

    def shown(tree, socket):
        for frame in (1, 2, 3):
            path = saved(f"frame{frame:03d}.png", "PNG", pixels(False, seed=20 + frame))
        made = bpy.data.images.load(path.replace("003", "001"))
        made.source = "SEQUENCE"
        shown = Node("TexImage", "Color", Vector=PLACE).build(tree).node
        shown.image = made
        shown.image_user.frame_duration = 3
        for name, value in settings.items():
            setattr(shown.image_user, name, value)
        tree.links.new(shown.outputs["Color"], socket)

    return shown


def sky(kind, elevation=0.4, **settings):
    """A sky of a type of this Blender, without its sun, which is too bright to compare."""
    given = {"sky_type": kind}
    if kind in ("PREETHAM", "HOSEK_WILKIE"):
        given |= {"sun_direction": (0.5, 0.3, elevation), "turbidity": 3.0}
    else:
        given |= {"sun_disc": False, "sun_elevation": elevation, "sun_rotation": 1.0}
    return Node("TexSky", **(given | settings), Vector=Node("VectorMath", operation="NORMALIZE", feed=(ROUND,)))


#: Single scattering as Blender calls it, by version.
SINGLE = (("NISHITA", {"until": (5, 0)}), ("SINGLE_SCATTERING", {"since": (5, 0)}))

MULTIPLE, MULTIPLE_ONLY = "MULTIPLE_SCATTERING", {"scale": 0.02, "since": (5, 0)}
HEIGHTS = ((0.4, {}), (1.4, {}), (0.03, {}), (-0.05, {}))

CASES = [
    *(
        Swatch(f"image {interpolation} {side}", shown=picture(interpolation=interpolation, extension=extension))
        for interpolation in ("Linear", "Closest", "Cubic", "Smart")
        for extension, side in SIDES.items()
    ),
    Swatch("image by uv", shown=picture(vector=None)),
    Swatch("image alpha", shown=picture(generated, "Alpha")),
    *(
        Swatch(
            f"image {mode.lower()} {'with' if also else 'without'} alpha",
            shown=picture(partial(from_file, f"{mode}.png", mode=mode), also=also),
            since=(5, 2) if mode == "PREMUL" else (),  # before, Cycles multiplies by alpha twice
        )
        for mode in ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE")
        for also in (False, True)
    ),
    Swatch("image generated with alpha", shown=picture(generated, also=True)),
    Swatch("image generated without alpha", shown=picture(generated)),
    Swatch("image of data", shown=picture(partial(generated, is_data=True))),
    Swatch("image of data with alpha", shown=picture(partial(generated, is_data=True), also=True)),
    Swatch("image of floats", shown=picture(partial(generated, False, float_buffer=True))),
    Swatch("image of floats, cubic", shown=picture(partial(from_file, "c.exr", "OPEN_EXR"), interpolation="Cubic")),
    Swatch(
        "image OpenEXR straight",
        shown=picture(partial(from_file, "e.exr", "OPEN_EXR", mode="STRAIGHT")),
        since=(5, 0),  # before, Cycles does not multiply by alpha, and Blender does
    ),
    Swatch("image OpenEXR packed", shown=picture(partial(from_file, "f.exr", "OPEN_EXR", packed=True))),
    Swatch("image OpenEXR channels", shown=picture(partial(from_file, "g.exr", "OPEN_EXR", mode="CHANNEL_PACKED"))),
    Swatch("image OpenEXR none", shown=picture(partial(from_file, "h.exr", "OPEN_EXR", mode="NONE"))),
    Swatch(
        "image OpenEXR packed straight",
        shown=picture(partial(from_file, "i.exr", "OPEN_EXR", packed=True, mode="STRAIGHT")),
    ),
    Swatch("image OpenEXR", shown=picture(partial(from_file, "a.exr", "OPEN_EXR"))),
    Swatch("image OpenEXR with alpha", shown=picture(partial(from_file, "b.exr", "OPEN_EXR"), also=True)),
    Swatch("image Radiance HDR", shown=picture(partial(from_file, "a.hdr", "HDR"))),
    Swatch("image JPEG", shown=picture(partial(from_file, "a.jpg", "JPEG"))),
    Swatch("image packed", shown=picture(partial(from_file, "packed.png", packed=True))),
    *(
        Swatch(f"image {name}", shown=picture(partial(from_file, "spaces.png", space=name, alpha=False)))
        for name in ("Linear Rec.709", "Display P3", "ACEScg", "Rec.1886", "Filmic Log", "AgX Base sRGB")
    ),
    Swatch("image Display P3 with alpha", shown=picture(partial(from_file, "p3.png", space="Display P3"), also=True)),
    Swatch("image EXR of ACEScg", shown=picture(partial(from_file, "d.exr", "OPEN_EXR", space="ACEScg"))),
    Swatch("image of tiles", shown=picture(tiled)),
    Swatch("image of packed tiles", shown=picture(partial(tiled, packed=True))),
    Swatch("image sequence", shown=of_sequence(frame_start=0)),
    Swatch("image sequence with offset", shown=of_sequence(frame_start=1, frame_offset=2)),
    Swatch("image sequence, cyclic", shown=of_sequence(frame_start=-4, use_cyclic=True)),
    Swatch("image missing", shown=picture(lambda: None), told="no image", constant=True),
    *(
        Swatch(f"image {projection.lower()}", shown=picture(projection=projection, vector=ROUND))
        for projection in ("SPHERE", "TUBE")
    ),
    *(
        Swatch(
            f"image box {blend} on a {shape}",
            shown=picture(projection="BOX", projection_blend=blend, vector=Node("TexCoord", "Object")),
            on=shape,
        )
        for blend, shape in ((0.0, "cube"), (0.0, "sphere"), (0.3, "sphere"), (1.0, "sphere"), (0.5, "cylinder"))
    ),
    Swatch("environment", shown=picture(kind="TexEnvironment", vector=ROUND)),
    *(
        Swatch(
            f"{name} of faint floats {mode.lower()}{' packed' * packed}{' with alpha' * also}",
            shown=picture(partial(faint, mode, packed=packed), kind=kind, vector=ROUND, also=also),
        )
        for name, kind in (("image", "TexImage"), ("environment", "TexEnvironment"))
        for mode in ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE")
        for packed in (False, True)
        for also in ((False, True) if kind == "TexImage" else (False,))
    ),
    *(
        Swatch(
            f"image {kind} painted {mode.lower()}",
            shown=picture(partial(painted, f"k.{kind}", file_format, mode)),
            since=(5, 2),  # before, Cycles reads the file
        )
        for kind, file_format in (("exr", "OPEN_EXR"), ("png", "PNG"))
        for mode in ("STRAIGHT", "CHANNEL_PACKED", "NONE")  # of PREMUL, Cycles multiplies bytes twice
    ),
    *(
        Swatch(
            f"environment OpenEXR {mode.lower()}",
            shown=picture(partial(from_file, "j.exr", "OPEN_EXR", mode=mode), kind="TexEnvironment", vector=ROUND),
            since=(5, 0) if mode == "STRAIGHT" else (),  # before, Cycles does not multiply by alpha, and Blender does
        )
        for mode in ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE")
    ),
    *(
        Swatch(
            f"environment PNG {mode.lower()}",
            shown=picture(partial(from_file, f"{mode}.png", mode=mode), kind="TexEnvironment", vector=ROUND),
            since=(5, 2) if mode == "PREMUL" else (),  # before, Cycles multiplies by alpha twice
        )
        for mode in ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE")
    ),
    Swatch("environment cubic", shown=picture(kind="TexEnvironment", vector=ROUND, interpolation="Cubic")),
    Swatch("environment by position", shown=picture(kind="TexEnvironment", vector=None), on="sphere"),
    Swatch("environment mirror ball", shown=picture(kind="TexEnvironment", vector=ROUND, projection="MIRROR_BALL")),
    *(
        Swatch(f"sky single scattering {elevation}", shown=sky(kind, elevation, **settings), scale=0.02, **version)
        for kind, version in SINGLE
        for elevation, settings in (*HEIGHTS, (0.3, {"altitude": 8e3, "air_density": 2.0, "ozone_density": 5.0}))
    ),
    *(
        Swatch(f"sky multiple scattering {elevation}", shown=sky(MULTIPLE, elevation, **settings), **MULTIPLE_ONLY)
        for elevation, settings in (*HEIGHTS, (0.3, {"altitude": 8e3, "air_density": 2.0, "aerosol_density": 3.0}))
    ),
    *(
        Swatch(f"sky preetham {elevation}", shown=sky("PREETHAM", elevation), scale=0.2)
        for elevation in (0.1, 0.5, 3.0)
    ),
    Swatch(
        "sky hosek wilkie",
        shown=sky("HOSEK_WILKIE", 0.5),
        told="Preetham, darkened, is used instead",
        tolerance=0.6,
        few=1.0,
        reason="its data are not at hand: Preetham's sky is used",
    ),
]
