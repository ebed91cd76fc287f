"""The functions of the shader folder that expressions may call: their signatures are read from the GLSL itself.

A function of a file `*_texture_lib.glsl` is heavy: calls of it are merged (see `node_programs`). One that stands within
`#ifdef FEATURE` needs that feature.
"""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

SHADER_FOLDER = Path(__file__).resolve().parents[1] / "shaders"
_SIGNATURE = re.compile(r"^(float|vec2|vec3|vec4|void|Point) (\w+)\(([^)]*)\)\s*\{", re.MULTILINE)
_CONDITION = re.compile(r"^\s*#(ifdef|ifndef|else|endif)\s*(\w*)", re.MULTILINE)


@dataclass(frozen=True)
class GlslFunction:
    """`library`: its file. `inputs`: types of its parameters but those named `out` and a first one of type Point, which
    `takes_point` tells. `results`: type that it returns, then of each `out` parameter; `returns`: whether it
    returns."""

    name: str
    library: str
    inputs: tuple
    results: tuple
    returns: bool
    takes_point: bool
    features: tuple
    is_heavy: bool


def function(name):
    """The `GlslFunction` of a name. Raises KeyError where no library has it."""
    found = _functions().get(name)
    if found is None:
        raise KeyError(f"no shader library has a function {name}")
    return found


@cache
def _functions():
    found = {}
    for path in sorted(SHADER_FOLDER.glob("*_lib.glsl")):
        text = path.read_text(encoding="utf-8")
        conditions = list(_CONDITION.finditer(text))
        for match in _SIGNATURE.finditer(text):
            read = _read(path.name, match, _features_at(match.start(), conditions))
            if read is not None:
                found.setdefault(read.name, read)
    return found


def _read(library, match, features):
    """The function of a signature; None where it has parameters that no expression can be."""
    returned, name, text = match.groups()
    inputs, outs, takes_point = [], [], False
    for number, parameter in enumerate(filter(None, (" ".join(p.split()) for p in text.split(",")))):
        *qualifiers, kind, _ = parameter.split(" ")
        if kind == "Point" and number == 0:
            takes_point = True
        elif kind not in ("float", "int", "bool", "vec2", "vec3", "vec4") or "inout" in qualifiers:
            return None
        else:
            (outs if "out" in qualifiers else inputs).append(kind)
    results = (*(() if returned == "void" else (returned,)), *outs)
    is_heavy = library.endswith("_texture_lib.glsl")
    return GlslFunction(name, library, tuple(inputs), results, returned != "void", takes_point, features, is_heavy)


def _features_at(position, conditions):
    """The features that hold at a position of a text."""
    stack = []
    for condition in conditions:
        if condition.start() > position:
            break
        word, name = condition.groups()
        if word in ("ifdef", "ifndef"):
            stack.append(name if word == "ifdef" else None)
        elif word == "else":
            stack[-1] = None
        else:
            stack.pop()
    return tuple(name for name in stack if name)
