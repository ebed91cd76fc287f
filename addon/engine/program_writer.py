"""Many programs as one GLSL function `programs_run`, of which each hit runs one.

Drivers inline every call: calls of heavy functions are what costs time to compile. The programs run side by side, and
where several want the same heavy function next they *meet* at one call of it, each with inputs of its own. What a
program computes before a meeting, no sooner than it is needed, is a block `if (program == 7)`; programs whose blocks
are equal share one. Values live within their block where they can. Those that later blocks need are kept in variables
that all programs share: each costs the driver something at every block.

What a program makes of *settled* values is a block of its own, the last, if another program makes the same of its own:
all mixtures of plastic and matte do the same with color, roughness and factor, wherever these come from.
"""

import re
from collections import Counter, defaultdict
from dataclasses import dataclass, field

from .glsl_functions import function
from .operators import OPERATORS

_INCLUDES = ("<material>", '"point_lib.glsl"', '"operator_lib.glsl"')
_VALUE = re.compile(r"\$(\d+)_(\d+)")


@dataclass
class Step:
    """A call: `arguments` GLSL of its inputs, where `$3_0` stands for result 0 of step 3; `used` tells which of its
    results are, of the GLSL `types`; `needs` numbers of the steps that its arguments name."""

    name: str
    beside: int
    arguments: tuple
    used: list
    types: tuple
    needs: frozenset
    heavy: bool


@dataclass
class Structure:
    """A program without its constants. `outputs`: (member of the material, GLSL with {0} for the value, the value);
    `texels` that its constants fill, which the steps know as `c0.xyz` and so on."""

    steps: list = field(default_factory=list)
    outputs: list = field(default_factory=list)
    texels: int = 0

    @property
    def key(self):
        return repr((self.outputs, [(s.name, s.beside, s.arguments, s.used) for s in self.steps], self.texels))


def programs_text(structures):
    """The GLSL function `programs_run` of structures by number from 1 on, with what it includes."""
    meetings = _meetings(structures)
    runs = _runs(structures, meetings)
    lines = []
    for number, meeting in enumerate(meetings):
        lines += [f"  {line}" for line in meeting.declarations()]
        lines += _blocks(runs, number)
        lines.append(f"  {meeting.statement()}")
    lines += [*_blocks(runs, len(meetings)), *_blocks(runs, len(meetings) + 1)]
    kept = sorted({variable for run in runs for variable in run.variables})
    steps = [step for structure in structures for step in structure.steps]
    axes = sorted({step.beside for step in steps} - {0})
    libraries = sorted({f'"{function(step.name).library}"' for step in steps if step.name not in OPERATORS})
    libraries += [f'"{function("point_beside").library}"'] if axes else []
    head = [f"#include {name}" for name in (*_INCLUDES, *libraries)]
    head += ["", "void programs_run(int program, int constants, Point point, inout Material material)", "{"]
    texels = max((structure.texels for structure in structures), default=0)
    head += [f"  vec4 c{k} = fetch_tables(constants + {k});" for k in range(texels)]
    head += [f"  Point point_{axis} = point_beside(point, {axis - 1});" for axis in axes]
    head += [f"  {kind} {name} = {kind}(0);" for name, kind in kept]
    return "\n".join([*head, *lines, "}"]) + "\n"


def _meetings(structures):
    """The calls of heavy functions in order."""
    waiting = [{number: step for number, step in enumerate(s.steps) if step.heavy} for s in structures]
    needs = [_heavy_needs(structure.steps) for structure in structures]
    done = [0] * len(structures)  # a bit for each step
    meetings = []
    while True:
        ready = defaultdict(dict)
        for program, steps in enumerate(waiting):
            for number, step in steps.items():
                if not needs[program][number] & ~done[program]:
                    ready[step.name, step.beside].setdefault(program, number)
        if not ready:
            return meetings
        name, beside = max(sorted(ready), key=lambda key: len(ready[key]))
        takers = {program: (number, waiting[program][number]) for program, number in ready[name, beside].items()}
        meetings.append(_Meeting(len(meetings), name, beside, takers))
        for program, number in ready[name, beside].items():
            done[program] |= 1 << number
            del waiting[program][number]


def _heavy_needs(steps):
    """The heavy steps that each step waits for, directly or not, as bits of a number."""
    needs = []
    for step in steps:
        bits = 0
        for number in step.needs:
            bits |= needs[number] | (steps[number].heavy << number)
        needs.append(bits)
    return needs


class _Meeting:
    """Heavy call number `number`, of a function at the point or `beside` it, and what the programs that take part hand
    it: `takers`, (number of the step, step) by program."""

    def __init__(self, number, name, beside, takers):
        self.number, self.name, self.beside, self.takers = number, name, beside, takers
        self.function = function(name)
        self.shared = {}  # place to the GLSL of inputs that are the same for all
        for place, kind in enumerate(self.function.inputs):
            texts = {step.arguments[place] for _, step in takers.values()}
            if len(texts) == 1 and _may_share(next(iter(texts)), kind):
                self.shared[place] = _passed(texts.pop(), kind)

    def declarations(self):
        for place, kind in enumerate(self.function.inputs):
            if place not in self.shared:
                yield f"{kind} h{self.number}_{place} = {kind}(0);"
        for result, kind in enumerate(self.function.results):
            if result > 0 or not self.function.returns:
                yield f"{kind} r{self.number}_{result};"

    def inputs(self, program):
        """The variables that a program sets, each with the GLSL of its value."""
        if program not in self.takers:
            return []
        _, step = self.takers[program]
        kinds = enumerate(zip(self.function.inputs, step.arguments, strict=True))
        return [(f"h{self.number}_{k}", _passed(text, kind)) for k, (kind, text) in kinds if k not in self.shared]

    def statement(self):
        inputs = [self.shared.get(place, f"h{self.number}_{place}") for place in range(len(self.function.inputs))]
        if self.function.takes_point:
            inputs.insert(0, _point(self.beside))
        results = [f"r{self.number}_{result}" for result in range(len(self.function.results))]
        value = f"{self.function.results[0]} {results.pop(0)} = " if self.function.returns else ""
        return f"{value}{self.name}({', '.join([*inputs, *results])});"


def _may_share(text, kind):
    """Whether an input that is the same for all who take part may be handed on as it is. Programs that do not take part
    call with 0: numbers of turns, which are ints, must be 0 for them."""
    return _is_number(text) and (kind != "int" or int(text) == 0)


def _runs(structures, meetings):
    """A `_Run` of each structure, cut at its settled values where another makes the same of its own."""
    runs = [_Run(structure, program, meetings, True) for program, structure in enumerate(structures)]
    users = Counter(run.lines[-1] for run in runs)
    return [
        run if users[run.lines[-1]] > 1 else _Run(run.structure, program, meetings, False)
        for program, run in enumerate(runs)
    ]


class _Run:
    """One program between the meetings: the `lines` of its blocks, one before each meeting, one after the last, and one
    for what it makes of settled values if it `is_cut` there."""

    def __init__(self, structure, program, meetings, is_cut):
        self.structure, self.is_cut, self.end = structure, is_cut, len(meetings) + 1
        self.met = {m.takers[program][0]: m.number for m in meetings if program in m.takers}
        self.names = {}  # (step, result) to GLSL
        self.variables = set()  # (name, type) of those that keep values between blocks
        self.free, self.taken = defaultdict(list), []  # of them: names by type; (last block, type, name)
        self.count = Counter()
        self._schedule()
        inputs = [meeting.inputs(program) for meeting in meetings] + [[], []]
        self.lines = [self._block(number, of_meeting) for number, of_meeting in enumerate(inputs)]

    def _schedule(self):
        """`starts`: block in which each step stands, the first that needs it; `ends`: last block that needs each value;
        `blocks`: numbers of the light steps of each block."""
        steps = self.structure.steps
        self.starts, self.ends = [self.end] * len(steps), {}
        for _, _, value in self.structure.outputs:
            self._use(value, self.end)
        for number in range(len(steps) - 1, -1, -1):
            step = steps[number]
            if step.heavy:
                self.starts[number] = self.met[number]
                for result in range(len(step.types)):
                    self.names[number, result] = f"r{self.met[number]}_{result}"
            elif self._hands_over(number):
                self.starts[number] = self.end - 1
            elif step.name == "settled":
                self._use(step.arguments[0], self.ends[number, 0])
            for argument in step.arguments:
                self._use(argument, self.starts[number])
        self.blocks = defaultdict(list)
        for number, step in enumerate(steps):
            if not step.heavy:
                self.blocks[self.starts[number]].append(number)

    def _hands_over(self, number):
        """Whether a step gives a settled value to the last block, and to none before."""
        is_last = self.starts[number] >= self.end - 1
        return self.is_cut and self.structure.steps[number].name == "settled" and is_last

    def _use(self, text, block):
        for number, result in _values(text):
            self.starts[number] = min(self.starts[number], block)
            self.ends[number, result] = max(self.ends.get((number, result), 0), block)

    def _block(self, number, inputs):
        """Lines of the block before meeting `number`, at its end those that set the `inputs` of that."""
        self._give_back(number)
        self.local = 0
        lines = [line for step in self.blocks[number] for line in self._statement(step, number)]
        lines += [f"{variable} = {self._glsl(text)};" for variable, text in inputs]
        if number == self.end:
            outputs = self.structure.outputs
            lines += [f"material.{name} = {text.format(self._glsl(value))};" for name, text, value in outputs]
        return tuple(lines)

    def _statement(self, number, block):
        step = self.structure.steps[number]
        arguments = list(map(self._glsl, step.arguments))
        if step.name == "settled" and not self._hands_over(number):
            self.names[number, 0] = arguments[0]
            return
        if step.name in OPERATORS:
            yield f"{self._target(number, 0, block)} = {OPERATORS[step.name].text.format(*arguments)};"
            return
        known = function(step.name)
        arguments = list(map(_passed, arguments, known.inputs))
        if known.takes_point:
            arguments.insert(0, _point(step.beside))
        returned = f"{self._target(number, 0, block)} = " if known.returns and step.used[0] else ""
        for result in range(known.returns, len(step.types)):
            target = self._target(number, result, block)
            if " " in target:
                yield f"{target};"
            arguments.append(target.split(" ")[-1])
        yield f"{returned}{step.name}({', '.join(arguments)});"

    def _target(self, number, result, block):
        """Where a value goes: a variable that is kept, or a new one of the block with its type."""
        kind, last = self.structure.steps[number].types[result], self.ends.get((number, result), block)
        if self._hands_over(number):
            self.names[number, result] = name = self._new_variable(kind, "settled")
            return name
        if last > block:
            name = self.free[kind].pop() if self.free[kind] else self._new_variable(kind)
            self.taken.append((last, kind, name))
            self.names[number, result] = name
            return name
        name = f"v{self.local}"
        self.local += 1
        self.names[number, result] = name
        return f"{kind} {name}"

    def _new_variable(self, kind, use="kept"):
        name = f"{use}_{kind}_{self.count[use, kind]}"
        self.count[use, kind] += 1
        self.variables.add((name, kind))
        return name

    def _give_back(self, block):
        """Variables whose values no block from this one on needs."""
        for last, kind, name in self.taken:
            if last < block:
                self.free[kind].append(name)
        self.taken = [entry for entry in self.taken if entry[0] >= block]

    def _glsl(self, text):
        return _VALUE.sub(lambda match: self.names[int(match[1]), int(match[2])], text)


def _blocks(runs, number):
    """Lines of the blocks before meeting `number`, equal ones once."""
    programs = defaultdict(list)
    for program, run in enumerate(runs):
        if run.lines[number]:
            programs[run.lines[number]].append(program + 1)
    for lines, users in programs.items():
        yield f"  if ({_is_any(users)}) {{"
        yield from (f"    {line}" for line in lines)
        yield "  }"


def _is_any(numbers):
    """GLSL that tells whether `program` is one of numbers, which ascend."""
    ranges = []
    for number in numbers:
        if ranges and ranges[-1][1] == number - 1:
            ranges[-1][1] = number
        else:
            ranges.append([number, number])
    tests = [f"program == {a}" if a == b else f"(program >= {a} && program <= {b})" for a, b in ranges]
    return " || ".join(tests)


def _values(text):
    """(step, result) of each value that a text names."""
    return [(int(number), int(result)) for number, result in _VALUE.findall(text)]


def _passed(text, kind):
    """An argument of a parameter of a GLSL type."""
    return f"bool({text})" if kind == "bool" else text


def _point(axis):
    return f"point_{axis}" if axis else "point"


def _is_number(text):
    return text.lstrip("(-").replace(".", "").replace("e", "").rstrip(")").isdigit()
