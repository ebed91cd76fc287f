# SPDX-License-Identifier: GPL-3.0-or-later
"""What a picture was made of and what it cost, as numbers that people can read.

A render and a viewport fill a `Statistics` each; the newer one is what the panel shows.
"""

import sys
import time
from dataclasses import dataclass, field

from .wording import counted, plural

#: What the stages of a picture are called, in their order.
STAGES = {
    "read": "read",
    "build": "tree",
    "upload": "upload",
    "compile": "compile",
    "trace": "trace",
    "first_picture": "first picture",
    "total": "total",
}


@dataclass
class Statistics:
    """Of one picture. `objects`: how many objects were taken as each kind; `primitives`: how many stand in the picture
    by kind, an instanced one each time; `geometries`: how many different ones the instances have; `grids`: how many
    geometries have a grid in place of a tree; `seconds` by stage, `first_picture` and `total` from the very start;
    `parts`: the seconds of a stage by its parts; `gpu_bytes` by what they hold; `peak_bytes`: most memory that
    Blender's process ever had, 0 where that is not known."""

    source: str  # what made it: Render, Viewport
    device: str = ""
    entry: str = ""  # of the path tracer: FRAGMENT, COMPUTE
    width: int = 0
    height: int = 0
    samples: int = 0
    objects: dict = field(default_factory=dict)
    primitives: dict = field(default_factory=dict)
    instances: int = 0
    geometries: int = 0
    grids: int = 0
    seconds: dict = field(default_factory=dict)
    parts: dict = field(default_factory=dict)
    gpu_bytes: dict = field(default_factory=dict)
    peak_bytes: int = 0
    _started: float = field(default_factory=time.perf_counter, repr=False)

    def reach(self, stage):
        """Note how long after the start a stage is reached; the first time counts."""
        self.seconds.setdefault(stage, time.perf_counter() - self._started)

    def add_reading(self, found):
        """Take over what the sync says of itself, a `SyncStatistics`."""
        self.objects, self.parts["read"] = found.objects, found.seconds

    def add_session(self, found):
        """Take over what an engine session says of itself, `Session.statistics()`."""
        for name in ("device", "entry", "primitives", "instances", "geometries"):
            setattr(self, name, found[name])
        self.gpu_bytes = found["textures"] | {"film": found["gpu_bytes"] - sum(found["textures"].values())}
        # Its first picture counts from loading; `reach` counts from reading.
        self.seconds |= {stage: spent for stage, spent in found["seconds"].items() if stage != "first_picture"}
        self.parts["build"], self.grids = found["build"], found["bvh"]["grids"]
        self.peak_bytes = peak_memory()

    @property
    def gpu_total(self):
        """Bytes on the GPU."""
        return sum(self.gpu_bytes.values())


def peak_memory():
    """Most bytes of memory that this process ever had; 0 where the system does not say (Windows)."""
    try:
        import resource
    except ImportError:
        return 0
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


# Numbers as text


def bytes_text(count):
    """`512 B`, `3.1 MiB`, `48 MiB`: two digits at least, three at most before the unit gets larger."""
    units = ("B", "KiB", "MiB", "GiB", "TiB")
    size, unit = float(count), 0
    while size >= 999.5 and unit < len(units) - 1:
        size, unit = size / 1024.0, unit + 1
    return f"{size:.1f} {units[unit]}" if unit and size < 9.95 else f"{size:.0f} {units[unit]}"


def seconds_text(seconds):
    """`0.004 s`, `0.4 s`, `12 s`, `3 min 05 s`, `2 h 03 min`."""
    if seconds < 0.0995:
        return f"{seconds:.3f} s"
    if seconds < 9.95:
        return f"{seconds:.1f} s"
    if seconds < 59.5:
        return f"{seconds:.0f} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {rest:02d} s"
    return f"{minutes // 60} h {minutes % 60:02d} min"


def primitives_text(primitives):
    """`2 cylinders, 7,381 spheres` from numbers by kind."""
    return ", ".join(counted(count, kind) for kind, count in sorted(primitives.items())) or "nothing to see"


def log_line(statistics):
    """All in one line, for the console."""
    shapes = primitives_text(statistics.primitives)
    if statistics.instances:
        shapes += f", {counted(statistics.instances, 'instance')}"
    parts = ["Conic", shapes, f"{bytes_text(statistics.gpu_total)} GPU"]
    if statistics.peak_bytes:
        parts.append(f"{bytes_text(statistics.peak_bytes)} peak")
    parts.append(", ".join(f"{name} {seconds_text(seconds)}" for _, name, seconds in _stages(statistics)))
    shader = [f"{statistics.entry.lower()} shader"] if statistics.entry else []
    return " | ".join([*parts, *shader, statistics.device])


def sections(statistics):
    """The panel's text: a list of (heading, rows), each row a label and a value."""
    objects = [(_taken_as(kind), f"{count:,}") for kind, count in _most_first(statistics.objects)]
    shapes = [(plural(kind).capitalize(), f"{count:,}") for kind, count in _most_first(statistics.primitives)]
    instancing = []
    if statistics.instances:
        instancing = [("Instances", f"{statistics.instances:,}"), ("Geometries", f"{statistics.geometries:,}")]
    if statistics.grids:
        shapes.append(("Grids in place of trees", f"{statistics.grids:,}"))
    memory = [("GPU", bytes_text(statistics.gpu_total))]
    memory += [(_part(name), bytes_text(count)) for name, count in _most_first(statistics.gpu_bytes)]
    if statistics.peak_bytes:
        memory.append(("Blender's peak", bytes_text(statistics.peak_bytes)))
    picture = [
        ("Size", f"{statistics.width:,} x {statistics.height:,}"),
        ("Samples", f"{statistics.samples:,}"),
        ("Device", statistics.device),
        ("Shader", statistics.entry.capitalize()),
    ]
    found = [
        (statistics.source, picture),
        ("Objects", objects),
        ("Primitives", shapes),
        ("Instancing", instancing),
        ("Time", _time_rows(statistics)),
        ("Memory", memory),
    ]
    return [(heading, rows) for heading, rows in found if rows]


def _time_rows(statistics):
    """A row for each stage and, below it, its parts."""
    rows = []
    for stage, name, seconds in _stages(statistics):
        rows.append((name.capitalize(), seconds_text(seconds)))
        parts = statistics.parts.get(stage, {}).items()
        rows += [(_part(part), seconds_text(spent)) for part, spent in parts]
    return rows


def _part(name):
    """The label of a part of what stands above it."""
    return f"    {name.replace('_', ' ')}"


def _taken_as(kind):
    """What objects of a kind are called in the panel. The copies that objects make are not objects of their own."""
    return "Instanced" if kind == "instances" else kind.replace("_", " ").capitalize()


def _most_first(counts):
    """Items of a dictionary of numbers, without zeros, the largest first."""
    return sorted(((name, count) for name, count in counts.items() if count), key=lambda item: (-item[1], item[0]))


def _stages(statistics):
    """(stage, name, seconds) of those of `STAGES` that there were."""
    return [(stage, name, statistics.seconds[stage]) for stage, name in STAGES.items() if stage in statistics.seconds]


# Where the panel finds them

#: Called, without arguments, in Blender's main thread after there are newer ones.
observers = []
_latest = None


def publish(statistics):
    """Make these the ones that are shown. Call it in Blender's main thread."""
    global _latest
    _latest = statistics
    for observer in observers:
        observer()


def latest():
    """The newest published Statistics; None before the first."""
    return _latest
