"""Procedural textures."""

from itertools import chain

from .case import PLACE, A, B, Node, Swatch, choices, every

_DIMENSIONS = choices("TexNoise", "noise_dimensions")
#: A number that varies over the plate.
_W = Node("VectorMath", "Value", operation="DOT_PRODUCT", feed=(PLACE, (0.4, -0.7, 0.2)))
#: A number of each face.
_W_OF_FACES = Node("SeparateXYZ", "X", feed=(B,))
#: Whole octaves and a part of one.
_FRACTAL = {"Scale": 1.3, "Detail": 2.4, "Roughness": 0.6, "Lacunarity": 2.2}
#: Inputs that only some variants of a node have.
_OF_SOME = {"Offset": 0.4, "Gain": 1.3, "Smoothness": 0.6, "Exponent": 0.7}
_BRICKS = {"Color1": (0.8, 0.2, 0.1, 1.0), "Color2": (0.1, 0.3, 0.9, 1.0), "Mortar": (0.5, 0.9, 0.4, 1.0)}
_WALL = _BRICKS | {
    "Mortar_Size": 0.05,
    "Mortar_Smooth": 0.6,
    "Bias": 0.2,
    "Brick_Width": 0.6,
    "Row_Height": 0.3,
    "offset": 0.3,
    "offset_frequency": 3,
    "squash": 1.7,
    "squash_frequency": 2,
}


def _with_inputs_of_some(node):
    for socket in node.inputs:
        if socket.name in _OF_SOME:
            socket.default_value = _OF_SOME[socket.name]


def _in_all(setting, name, kind, output=0, *, dimensions=_DIMENSIONS, vector=PLACE, w=_W, **values):
    """Swatches of a node in each number of dimensions, which `setting` tells."""
    for number in dimensions:
        place = {} if number == "1D" else {"Vector": vector}
        place |= {"W": w} if number in ("1D", "4D") else {}
        node = {setting: number, "then": _with_inputs_of_some} | place | values
        yield from every(f"{name} {number}", kind, output, **node)


def _noise(name, output="Fac", **values):
    return _in_all("noise_dimensions", name, "TexNoise", output, **values)


def _voronoi(name, output="Distance", **values):
    return _in_all("voronoi_dimensions", name, "TexVoronoi", output, **{"Scale": 1.3, "Randomness": 0.9} | values)


def _by_output(name, kind, outputs, **values):
    """Swatches of the same node by each of its outputs."""
    return chain(*(every(f"{name} {output}", kind, output, **values) for output in outputs))


CASES = [
    *_noise("noise", noise_type=choices("TexNoise", "noise_type"), **_FRACTAL),
    *_noise("noise distorted", "Color", Distortion=0.7, **_FRACTAL),
    *_noise("noise not normalized", normalize=False, Detail=0.0, Scale=2.0),
    *every("noise of much detail", "TexNoise", "Fac", Vector=PLACE, Detail=15.0, Scale=2.0),
    *_noise("noise far away", vector=A, w=_W_OF_FACES, Detail=0.0, Scale=1e6),
    Swatch("noise of generated coordinates", Node("TexNoise", "Color"), on="sphere"),
    *_voronoi("voronoi", feature=["F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE"]),
    *_voronoi("voronoi radius", "Radius", feature="N_SPHERE_RADIUS"),
    *_voronoi("voronoi color", "Color", feature=["F1", "F2", "SMOOTH_F1"]),
    *_voronoi("voronoi position", "Position", feature=["F1", "SMOOTH_F1"], dimensions=["2D", "3D", "4D"]),
    *_voronoi("voronoi w", "W", feature=["F1", "F2"], dimensions=["1D", "4D"]),
    *_voronoi(
        "voronoi by",
        distance=["MANHATTAN", "CHEBYCHEV", "MINKOWSKI"],
        feature=["F1", "SMOOTH_F1"],
        dimensions=["2D", "3D"],
    ),
    *_voronoi("voronoi of octaves", feature=["F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE"], normalize=True, **_FRACTAL),
    *_voronoi("voronoi of octaves by", distance="MINKOWSKI", normalize=True, dimensions=["3D"], **_FRACTAL),
    *_voronoi("voronoi color of octaves", "Color", normalize=[False, True], dimensions=["3D"], **_FRACTAL),
    *_voronoi("voronoi position of octaves", "Position", dimensions=["3D"], **_FRACTAL),
    Swatch("voronoi of generated coordinates", Node("TexVoronoi", "Distance"), on="sphere"),
    *(
        Swatch(f"{kind} of generated coordinates", Node(f"Tex{kind}", "Color"), on="sphere")
        for kind in ("Wave", "Magic", "Gradient", "Checker")
    ),
    # Few bricks: Cycles' sphere has flat sides, so that what lies at a joint differs.
    Swatch("bricks of generated coordinates", Node("TexBrick", "Color", Scale=2.0), on="sphere"),
    *_in_all("noise_dimensions", "white noise", "TexWhiteNoise", "Color", vector=A, w=_W_OF_FACES),
    *_in_all("noise_dimensions", "white noise value", "TexWhiteNoise", "Value", vector=A, w=_W_OF_FACES),
    *every("white noise of no place", "TexWhiteNoise", "Color", case={"constant": True}),
    *every("gradient", "TexGradient", "Fac", Vector=PLACE, gradient_type=choices("TexGradient", "gradient_type")),
    *_by_output("checker", "TexChecker", ["Color", "Fac"], Vector=PLACE, Color1=(0.8, 0.2, 0.1, 1.0)),
    *every("magic", "TexMagic", "Color", turbulence_depth=list(range(11)), Vector=PLACE, Scale=1.3, Distortion=1.2),
    *every("magic without distortion", "TexMagic", "Fac", Vector=PLACE, turbulence_depth=0, Distortion=0.0),
    *every("bands", "TexWave", "Fac", Vector=PLACE, Scale=0.4, bands_direction=choices("TexWave", "bands_direction")),
    *every(
        "rings",
        "TexWave",
        "Color",
        wave_type="RINGS",
        rings_direction=choices("TexWave", "rings_direction"),
        Vector=PLACE,
        Scale=0.4,
        Phase_Offset=0.4,
    ),
    *every(
        "waves distorted",
        "TexWave",
        "Fac",
        wave_profile=choices("TexWave", "wave_profile"),
        Vector=PLACE,
        Scale=0.3,
        Distortion=3.0,
        Detail=2.5,
        Detail_Scale=1.7,
        Detail_Roughness=0.6,
    ),
    *_by_output("bricks", "TexBrick", ["Color", "Fac"], Vector=PLACE, Scale=2.0, **_BRICKS),
    *_by_output("bricks of a wall", "TexBrick", ["Color", "Fac"], Vector=PLACE, Scale=1.5, **_WALL),
    *_by_output(
        "gabor",
        "TexGabor",
        ["Value", "Phase", "Intensity"],
        gabor_type=["2D", "3D"],
        case={"since": (4, 3)},
        Vector=PLACE,
        Anisotropy=0.7,
    ),
]
