"""From shader files to the text of one program.

A shader file may hold, each on a line of its own,

    #include "name_lib.glsl"    another file of the shader folder, once per program
    #include <record>           the struct and reader of a record of `layout`, once per program
    #ifdef NAME / #ifndef NAME / #else / #endif

Conditions are decided here, so that a program carries, compiles and asks samplers for what it uses only; every name
they test must be known (`FEATURES`), a misspelt one is an error. Uniforms, samplers and outputs are not declared in
the files: devices declare them from `ProgramSource`, each in its own way. `origin` finds file and line of a line that
a driver complains about.
"""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from . import layout, record_glsl
from .glsl_functions import SHADER_FOLDER

_PLACES = {
    f"HAS_{kind.upper()}_{place}": {f"HAS_{kind.upper()}"}
    for kind in layout.TREE_KINDS
    for place in ("LEAVES", "OUTSIDE")
}
#: Features of shapes of which a scene may have none: a program with them can draw it all the same.
SPARE = frozenset(
    [f"HAS_{kind.upper()}" for kind in layout.KINDS if kind != "instance"]
    + [*_PLACES, "HAS_QUADRIC_LEAVES", "HAS_SPHERE_RUNS", "HAS_GRID", "HAS_GRID_CYLINDERS", "HAS_INSTANCES"]
)
#: Names that shader files may test.
FEATURES = SPARE.union(
    [
        "HAS_GRID_ALONE",
        "HAS_PROGRAMS",
        "VORONOI_LOOKUP3",
        "HAS_GRADIENTS",
        "HAS_LIGHT_PATH",
        "HAS_COAT",
        "HAS_TRANSLUCENT",
        "HAS_DIFFUSE_ROUGHNESS",
        "HAS_NORMALS",
        "HAS_HOLDOUT_SHARE",
        "HAS_ABSORPTION",
        "HAS_TRANSMISSION",
        "HAS_ATTRIBUTES",
        "HAS_VISIBILITY",
        "HAS_HOLDOUT",
        "HAS_SHADOW_CATCHER",
        "HAS_CULLING",
        "HAS_LIGHT_SHAPES",
        "HAS_SEEN_LAMPS",
        "HAS_LIGHT_TREE",
        "HAS_LIGHT_VISIBILITY",
        "HAS_LIGHT_LINKING",
        "HAS_EMITTERS",
        "HAS_VARYING_EMITTERS",
        "HAS_WORLD_LIGHT",
        "HAS_PLAIN_WORLD",
        "HAS_WORLD_GLOSS",
        "HAS_HEMISPHERE_LIGHT",
        "HAS_AMBIENT_OCCLUSION",
        "HAS_ROUGHNESS",
        "HAS_GLASS_ENERGY",
        "HAS_METALS",
        "TINTED_SHADOWS",
        "TRANSPARENT_SHADOWS",
        "CULLED_SHADOWS",
        "COUNT_RAYS",
        "FLAT_COLORS",
        "HAS_GUIDE",
        "HAS_DEPTH_CUE",
        "HAS_OUTLINES",
        "OUTLINE_SHAPES",
        "OUTLINE_ATTRIBUTES",
    ]
)

#: Features that others need.
NEEDS = _PLACES | {
    "HAS_GLASS_ENERGY": {"HAS_TRANSMISSION", "HAS_ROUGHNESS"},
    "HAS_GRID": {"HAS_SPHERE"},
    "HAS_GRID_ALONE": {"HAS_GRID", "HAS_SPHERE"},
    "HAS_GRID_CYLINDERS": {"HAS_GRID", "HAS_CYLINDER"},
    "HAS_AMBIENT_OCCLUSION": {"HAS_HEMISPHERE_LIGHT"},
    "HAS_DEPTH_CUE": {"HAS_GUIDE"},
    "HAS_EMITTERS": {"HAS_LIGHT_SHAPES"},
    "HAS_SEEN_LAMPS": {"HAS_LIGHT_SHAPES"},
    "HAS_LIGHT_TREE": {"HAS_LIGHT_SHAPES"},
    "HAS_OUTLINES": {"HAS_GUIDE"},
    "HAS_PLAIN_WORLD": {"HAS_WORLD_LIGHT"},
    "HAS_WORLD_GLOSS": {"HAS_WORLD_LIGHT", "HAS_ROUGHNESS"},
    "OUTLINE_ATTRIBUTES": {"HAS_ATTRIBUTES", "HAS_OUTLINES", "HAS_GUIDE"},
    "OUTLINE_SHAPES": {"HAS_OUTLINES", "HAS_GUIDE"},
}

_DIRECTIVE = re.compile(r"\s*#\s*(include|ifdef|ifndef|else|endif)\b\s*(.*?)\s*(?:/\*.*)?$")


class ShaderSourceError(Exception):
    """A shader file that includes or tests what does not exist: a defect of the shaders, with file and line."""


@dataclass(frozen=True)
class ProgramSource:
    """All that a device needs to build a program that fills a rectangle of a target.

    `text`: GLSL without declarations of uniforms, samplers or outputs. `textures`: names of the data textures, the
    sampler of `name` is `<name>_data`. `uniform_struct`: GLSL struct `Frame` of the uniform block `frame` ("" for
    none). `outputs`: names of the vec4 outputs, in the order of the target's attachments. The pixel is `PIXEL`.

    The file that main() is in says how pixels are run. Of `<name>_frag.glsl` they are fragments, and what it sets the
    outputs to is added to the target. Of `<name>_comp.glsl` they are invocations, which do that themselves: there
    `<output>_image` is the attachment, and the ivec4 `tile` (first pixel, end) the rectangle; some lie beyond its end.
    """

    name: str
    text: str
    textures: tuple[str, ...]
    uniform_struct: str
    outputs: tuple[str, ...]
    lines: tuple[tuple[str, int], ...]

    @property
    def is_compute(self):
        return self.name.endswith("_comp.glsl")

    def origin(self, line):
        """(file, line) that line number `line` of `text` (from 1) comes from."""
        return self.lines[min(max(line, 1), len(self.lines)) - 1]

    def listing(self, around, radius=3):
        """Numbered lines of `text` around a line, each with the file it comes from, for error messages."""
        text = self.text.splitlines()
        first, last = max(around - radius, 1), min(around + radius, len(text))
        rows = []
        for number in range(first, last + 1):
            file, line = self.origin(number)
            rows.append(f"{'>' if number == around else ' '} {file}:{line}: {text[number - 1]}")
        return "\n".join(rows)


def program(
    entry,
    features=(),
    constants=None,
    outputs=("out_color",),
    folders=(SHADER_FOLDER,),
    records=layout.RECORDS,
    generated=(),
    images=(),
):
    """Assemble the program whose main() is in the file `entry`.

    `features`: names out of FEATURES that hold. `constants`: name to number, defined at the top. `folders`: where files
    are looked for, in this order. `records`: what can be included by name. `generated`: (name, text) of files that are
    in no folder. `images`: textures that are read by pixel, from the sampler `<image>_data`. Raises ShaderSourceError.
    """
    constants, folders = tuple(sorted((constants or {}).items())), tuple(map(Path, folders))
    return _program(
        entry, frozenset(features), constants, tuple(outputs), folders, tuple(records), tuple(generated), tuple(images)
    )


@cache
def _program(entry, features, constants, outputs, folders, records, generated, images):
    unknown = features - FEATURES
    if unknown:
        raise ShaderSourceError(f"unknown feature {sorted(unknown)[0]}")
    composer = _Composer(folders, features, records, dict(generated))
    for name, value in constants:
        composer.emit(f"#define {name} {value}", "<constants>", 1)
    for number, line in enumerate((record_glsl.constants() + record_glsl.uniforms()).splitlines(), 1):
        composer.emit(line, "<layout>", number)
    composer.file(entry)
    return ProgramSource(
        name=entry,
        text="\n".join(composer.text) + "\n",
        textures=(*images, *composer.textures),
        uniform_struct=record_glsl.uniform_struct(),
        outputs=outputs,
        lines=tuple(composer.lines),
    )


class _Composer:
    """Text, origin of each line and textures of a program while its files are read."""

    def __init__(self, folders, features, records, generated):
        self.folders, self.features, self.generated = folders, features, generated
        self.records = {record.name: record for record in records}
        self.text, self.lines, self.textures = [], [], []
        self._included = set()

    def emit(self, line, file, number):
        self.text.append(line)
        self.lines.append((file, number))

    def file(self, name, included_from=""):
        """Emit a file of the shader folders, unless the program has it already."""
        if name in self._included:
            return
        self._included.add(name)
        active = [True]
        for number, line in enumerate(self._text(name, included_from).splitlines(), 1):
            self._line(line, name, number, active)
        if len(active) != 1:
            raise ShaderSourceError(f"{name}: an #ifdef is not closed")

    def _text(self, name, included_from):
        if name in self.generated:
            return self.generated[name]
        path = next((folder / name for folder in self.folders if (folder / name).is_file()), None)
        if path is None:
            raise ShaderSourceError(f"{included_from}no shader file {name}")
        return path.read_text(encoding="utf-8")

    def _line(self, line, file, number, active):
        match = _DIRECTIVE.match(line)
        if not match:
            if active[-1]:
                self.emit(line, file, number)
            return
        directive, argument = match.groups()
        where = f"{file}:{number}: "
        if directive in ("ifdef", "ifndef"):
            if argument not in FEATURES:
                raise ShaderSourceError(f"{where}{argument} is not a known feature")
            active.append(active[-1] and (argument in self.features) == (directive == "ifdef"))
        elif len(active) == 1 and directive != "include":
            raise ShaderSourceError(f"{where}#{directive} without #ifdef")
        elif directive == "else":
            outer = active[-2]
            active[-1] = outer and not active[-1]
        elif directive == "endif":
            active.pop()
        elif active[-1]:
            self._include(argument, where)

    def _include(self, argument, where):
        name = argument[1:-1]
        if argument == f'"{name}"':
            self.file(name, where)
        elif argument == f"<{name}>" and name in self.records:
            self._record(self.records[name])
        else:
            raise ShaderSourceError(f"{where}#include {argument} names no file and no record")

    def _record(self, record):
        key = f"<{record.name}>"
        if key in self._included:
            return
        self._included.add(key)
        text = record_glsl.reader(record)
        if record.texture not in self.textures:
            self.textures.append(record.texture)
            text = record_glsl.fetch(record.texture) + text
        if record.points_into:
            self.textures.append(record.points_into)
            text = record_glsl.fetch(record.points_into) + text
        for number, line in enumerate(text.splitlines(), 1):
            self.emit(line, key, number)
