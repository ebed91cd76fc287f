"""From expressions to programs: one for all materials of the same structure, whose constants lie in a texture.
`program_writer` says what they are in GLSL."""

from dataclasses import dataclass

import numpy as np

from .expression import (
    AttributeNumber,
    Call,
    Literal,
    Parameter,
    Table,
    in_order,
)
from .glsl_functions import function
from .operators import OPERATORS
from .program_writer import Step, Structure, programs_text

_CONSTANTS = (Parameter, Table, AttributeNumber)
_SIZES = {"float": 1, "vec2": 2, "vec3": 3, "vec4": 4, "int": 1}


@dataclass(frozen=True)
class Program:
    """What one material runs: `number` of its structure from 1 on, and what its constants are, in order of their
    texels: `constants`, tuples of up to four (Parameter | Table | AttributeNumber, component) a texel."""

    number: int
    constants: tuple


class NodePrograms:
    """Collects the programs of a scene."""

    def __init__(self):
        self._numbers, self._structures = {}, []

    def add(self, members):
        """The `Program` that gives members of a material their values: Expressions by name, with GLSL `{0}` around
        each: name to (expression, text)."""
        structure, constants = _Builder(members).build()
        number = self._numbers.setdefault(structure.key, len(self._numbers) + 1)
        if number > len(self._structures):
            self._structures.append(structure)
        return Program(number, constants)

    def __len__(self):
        return len(self._structures)

    def features(self):
        """Features of the shader that the functions need."""
        return {f for s in self._structures for step in s.steps for f in _features(step.name)}

    def text(self):
        """The GLSL function `programs_run`, with what it includes."""
        return programs_text(self._structures)


def _features(name):
    return () if name in OPERATORS else function(name).features


def constant_texels(program, first, attribute_number):
    """The texels (n, 4) float32 of a program's constants, its tables behind them, if they lie from texel `first` on."""
    rows, tables = np.zeros((len(program.constants), 4), np.float32), []
    end = first + len(rows)
    for row, entries in zip(rows, program.constants, strict=True):
        for place, (constant, part) in enumerate(entries):
            if isinstance(constant, Table):
                row[place] = end
                tables.append(np.asarray(constant.values, np.float32))
                end += len(constant.values)
            elif isinstance(constant, AttributeNumber):
                row[place] = attribute_number(constant.key)
            else:
                row[place] = constant.value[part]
    return np.concatenate([rows, *tables])


class _Builder:
    """Numbers the values of one material's expressions and finds places for its constants."""

    def __init__(self, members):
        self.members = members
        self.structure = Structure()
        self.names = {}  # id of an expression to its GLSL
        self.makers = {}  # id of an expression to the step that makes it
        self.known = {}  # what a call is to its step

    def build(self):
        roots = [expression for expression, _ in self.members.values()]
        nodes = in_order(roots)
        constants = [n for n in in_order(roots, "settled") if isinstance(n, _CONSTANTS)]
        known = set(map(id, constants))
        texels = self._place(constants, [])  # where they are does not depend on what is settled before
        self._place([n for n in nodes if isinstance(n, _CONSTANTS) and id(n) not in known], texels)
        self.constants = tuple(map(tuple, texels))
        self.structure.texels = len(texels)
        for node in nodes:
            if isinstance(node, Literal):
                self.names[id(node)] = _literal_text(node)
            elif isinstance(node, Call):
                self._step(node)
        for name, (expression, text) in self.members.items():
            self.structure.outputs.append((name, text, self.names[id(expression)]))
        return self.structure, self.constants

    def _place(self, nodes, texels):
        """Pack constants into `texels`, lists of (constant, component), and further ones: wide ones first, numbers into
        the gaps."""
        for node in sorted(nodes, key=lambda n: -_SIZES[n.type]):
            size = _SIZES[node.type]
            home = next((t for t in texels if len(t) + size <= 4), None)
            if home is None:
                home = []
                texels.append(home)
            swizzle = "xyzw"[len(home) : len(home) + size]
            text = f"c{texels.index(home)}.{swizzle}"
            if isinstance(node, Table):
                text = f"(int(frame_constant_first) + int({text}))"
            elif node.type == "int":
                text = f"int({text})"
            self.names[id(node)] = text
            home += [(node, part) for part in range(size)]
        return texels

    def _step(self, call):
        arguments = tuple(self.names[id(x)] for x in call.inputs)
        key = call.name, call.beside, arguments
        if key not in self.known:
            self.known[key] = len(self.structure.steps)
            self.structure.steps.append(self._made(call, arguments))
        number = self.known[key]
        step = self.structure.steps[number]
        step.used[call.output] = True
        self.names[id(call)] = f"${number}_{call.output}"
        self.makers[id(call)] = number

    def _made(self, call, arguments):
        needs = frozenset(self.makers[id(x)] for x in call.inputs if id(x) in self.makers)
        if call.name in OPERATORS:
            return Step(call.name, 0, arguments, [False], (call.type,), needs, False)
        known = function(call.name)
        beside = call.beside if known.takes_point else 0
        return Step(call.name, beside, arguments, [False] * len(known.results), known.results, needs, known.is_heavy)


def _literal_text(node):
    if node.type == "int":
        return str(node.value[0])
    numbers = [_number_text(x) for x in node.value]
    return numbers[0] if len(numbers) == 1 else f"{node.type}({', '.join(numbers)})"


def _number_text(x):
    text = repr(float(np.float32(x)))
    return f"({text})" if x < 0.0 else text
