"""Nodes that compute values: numbers, vectors and colors of attributes."""

from math import tau

from mathutils import Vector

from .case import COLORS, NUMBERS, PLACE, A, B, C, K, L, M, N, Node, Swatch, choices, every

#: They give NaN in Cycles before 4.5 where the normal is 0.
_BENDING = ["REFLECT", "REFRACT"]
_VECTOR_OPERATIONS = [operation for operation in choices("VectorMath", "operation") if operation not in _BENDING]
_BLENDS = choices("Mix", "blend_type")
_RANGES = choices("MapRange", "interpolation_type")
_MAPPINGS = choices("Mapping", "vector_type")
_ROTATIONS = ["AXIS_ANGLE", "X_AXIS", "Y_AXIS", "Z_AXIS"]
_INTERPOLATIONS = ("LINEAR", "CONSTANT", "EASE", "CARDINAL", "B_SPLINE")
_HUES = ("NEAR", "FAR", "CW", "CCW")


def _ramp(interpolation, mode="RGB", hue="NEAR"):
    """Makes a color ramp of four stops, whose places are no 256ths."""

    def then(node):
        ramp = node.color_ramp
        ramp.color_mode, ramp.interpolation, ramp.hue_interpolation = mode, interpolation, hue
        for place in (0.37, 0.62):
            ramp.elements.new(place)
        colors = ((1.0, 0.1, 0.0, 0.2), (0.05, 0.8, 0.3, 1.0), (0.1, 0.2, 1.0, 0.6), (0.9, 0.9, 0.4, 0.8))
        for element, place, color in zip(ramp.elements, (0.11, 0.37, 0.62, 0.93), colors, strict=True):
            element.position, element.color = place, color

    then.__name__ = " ".join((mode, *([hue] if mode != "RGB" else [interpolation])))
    return then


def _curves(extend="EXTRAPOLATED", black=(0.0, 0.0, 0.0), white=(1.0, 1.0, 1.0)):
    """Bends all curves of a node, each in its own way; other levels where there are any."""

    def then(node):
        mapping = node.mapping
        mapping.extend = extend
        for i, curve in enumerate(mapping.curves):
            curve.points.new(0.3, 0.6 - 0.1 * i)
            curve.points[-1].location = Vector((1.0, 0.8 + 0.1 * i))
            curve.points[0].location = Vector((curve.points[0].location[0], 0.1))
        mapping.black_level, mapping.white_level = black, white
        mapping.update()

    then.__name__ = extend if black == (0.0, 0.0, 0.0) else "LEVELS"
    return then


def _set_output(value):
    """Sets the value of a node that has it in its output."""
    return lambda node: setattr(node.outputs[0], "default_value", value)


_CURVES = [_curves("EXTRAPOLATED"), _curves("HORIZONTAL")]
_LEVELS = _curves(black=(0.1, 0.0, 0.2), white=(0.9, 1.5, 0.8))
_KELVIN = Node("MapRange", feed=(K, -1.5, 2.5, 0.0, 14000.0))
_NANOMETERS = Node("MapRange", feed=(K, -1.5, 2.5, 300.0, 850.0))
_TURNED = {"of_object": {"rotation_euler": (0.0, 0.0, tau / 4.0), "scale": (1.0, 1.0, 0.5)}}
_CONSTANT = {"constant": True}
_SPACES = ["WORLD", "OBJECT", "CAMERA"]
_MODES = ["RGB", "HSV", "HSL"]
_BOTH = [True, False]

CASES = [
    Swatch("value", Node("Value", then=_set_output(0.7)), constant=True),
    Swatch("rgb", Node("RGB", then=_set_output((0.2, 0.5, 0.9, 1.0))), constant=True),
    *every("math", "Math", operation=choices("Math", "operation"), feed=NUMBERS),
    Swatch("math of colors, clamped", Node("Math", operation="ADD", use_clamp=True, feed=COLORS)),
    *every("vector math", "VectorMath", operation=_VECTOR_OPERATIONS, feed=(A, B, C, K)),
    *every("vector math", "VectorMath", operation=_BENDING, feed=(A, B, C, K), case={"since": (4, 5)}),
    *every("mix", "Mix", data_type="RGBA", blend_type=_BLENDS, feed=(K, B, C)),
    *every("mix wildly", "Mix", data_type="RGBA", blend_type=_BLENDS, clamp_factor=False, feed=(K, B, C)),
    *every("mix, clamped", "Mix", data_type="RGBA", blend_type=["ADD"], clamp_result=True, feed=(K, B, C)),
    *every("legacy mix", "MixRGB", blend_type=["ADD", "DIVIDE", "OVERLAY"], use_clamp=_BOTH, feed=(K, B, C)),
    *every("mix numbers", "Mix", data_type="FLOAT", clamp_factor=_BOTH, feed=NUMBERS),
    *every("mix vectors", "Mix", data_type="VECTOR", clamp_factor=_BOTH, feed=(K, B, C)),
    *every("mix by each", "Mix", data_type="VECTOR", factor_mode="NON_UNIFORM", clamp_factor=_BOTH, feed=COLORS),
    *every("clamp", "Clamp", clamp_type=["MINMAX", "RANGE"], feed=NUMBERS),
    *every("map range", "MapRange", interpolation_type=_RANGES, clamp=_BOTH, feed=(K, L, M, 0.2, 0.9, 4.0)),
    *every(
        "map vectors", "MapRange", data_type="FLOAT_VECTOR", interpolation_type=_RANGES, clamp=_BOTH, feed=COLORS * 2
    ),
    *every("ramp", "ValToRGB", ["Color", "Alpha"], Fac=K, then=[_ramp(i) for i in _INTERPOLATIONS]),
    *every("ramp", "ValToRGB", Fac=K, then=[_ramp("LINEAR", m, h) for m in ("HSV", "HSL") for h in _HUES]),
    *every("rgb curves", "RGBCurve", feed=(L, A), then=[*_CURVES, _LEVELS]),
    *every("vector curves", "VectorCurve", feed=(L, A), then=_CURVES),
    *every("float curve", "FloatCurve", feed=(L, K), then=_CURVES),
    *every("separate", "SeparateColor", [0, 1, 2], mode=_MODES, feed=(A,)),
    *every("combine", "CombineColor", mode=_MODES, feed=NUMBERS),
    *every("separate xyz", "SeparateXYZ", [0, 1, 2], feed=(A,)),
    Swatch("combine xyz", Node("CombineXYZ", feed=NUMBERS)),
    *every("legacy separate rgb", "SeparateRGB", [0, 1, 2], feed=(A,), case={"until": (5, 0)}),
    *every("legacy separate hsv", "SeparateHSV", [0, 1, 2], feed=(A,), case={"until": (5, 0)}),
    Swatch("legacy combine rgb", Node("CombineRGB", feed=NUMBERS), until=(5, 0)),
    Swatch("legacy combine hsv", Node("CombineHSV", feed=NUMBERS), until=(5, 0)),
    Swatch("hue, saturation, value", Node("HueSaturation", Hue=K, Saturation=L, Value=M, Factor=N, Color=B)),
    Swatch("bright, contrast", Node("BrightContrast", feed=(A, K, L))),
    Swatch("gamma", Node("Gamma", feed=(A, K))),
    Swatch("invert", Node("Invert", feed=(K, A))),
    Swatch("rgb to bw", Node("RGBToBW", feed=(A,))),
    Swatch("number as color", Node("Gamma", feed=(K, 1.0))),
    Swatch("color as number", Node("Math", operation="MULTIPLY", feed=(Node("Gamma", feed=(A, 1.0)), 0.7))),
    Swatch("blackbody", Node("Blackbody", Temperature=_KELVIN)),
    *every("constant blackbody", "Blackbody", Temperature=[700.0, 4500.0, 20000.0], case=_CONSTANT),
    Swatch("wavelength", Node("Wavelength", Wavelength=_NANOMETERS)),
    *every("constant wavelength", "Wavelength", Wavelength=[460.0, 612.0], case=_CONSTANT),
    *every("rotate", "VectorRotate", rotation_type=_ROTATIONS, invert=_BOTH, feed=(A, B, C, L)),
    *every("rotate by angles", "VectorRotate", rotation_type="EULER_XYZ", invert=_BOTH, feed=(A, B, C)),
    *every(
        "mapping", "Mapping", vector_type=_MAPPINGS, feed=(PLACE, (0.3, -0.2, 0.5), (0.4, 0.7, -1.1), (2, 0.5, -1.5))
    ),
    *every("mapping, linked", "Mapping", vector_type=_MAPPINGS, feed=COLORS),
    Swatch("normal", Node("Normal", "Normal", then=_set_output((0.48, 0.6, 0.64))), constant=True),
    Swatch("normal's dot", Node("Normal", "Dot", Normal=A, then=_set_output((0.48, 0.6, 0.64)))),
    *every(
        "between",
        "VectorTransform",
        vector_type=["POINT", "VECTOR", "NORMAL"],
        convert_from=_SPACES,
        convert_to=_SPACES,
        feed=(A,),
        case=_TURNED,
    ),
    Swatch("bool", Node("FunctionNodeInputBool", boolean=True), constant=True, since=(5, 2)),
    Swatch("integer", Node("FunctionNodeInputInt", integer=3), constant=True, since=(5, 2)),
    Swatch("vector", Node("FunctionNodeInputVector", vector=(0.2, -0.4, 0.7)), constant=True, since=(5, 2)),
    *every("menu switch", "GeometryNodeMenuSwitch", data_type="RGBA", feed=("B", B, C), case={"since": (5, 0)}),
]
