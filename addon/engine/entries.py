"""Which entry of the path tracer runs: its pixels are fragments that are drawn, or invocations of a compute program.

Both are the same text otherwise and give the same picture. Which one is faster depends on the device: some GPUs run
fragments on a part of their units only. It is measured once a process, by a small probe of the same character.
"""

import time
from dataclasses import replace

import numpy as np

from . import shader_source

#: What can be asked for.
ENTRIES = ("AUTO", "FRAGMENT", "COMPUTE")
#: The file with main() of each.
FILES = {"FRAGMENT": "film_frag.glsl", "COMPUTE": "film_comp.glsl"}

#: Renderers without a GPU: compute is not faster there, as the benchmark `entries` has it, and takes longer to compile.
_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "SwiftShader", "Basic Render")
#: How much faster compute must be than fragments to be preferred.
_LEAST_GAIN = 1.05
_PROBES = {"FRAGMENT": "probe_frag.glsl", "COMPUTE": "probe_comp.glsl"}
_PROBE_LEAVES = 16**3
_PROBE_SIDE = 512  # pixels
_PROBE_SECONDS = 0.002  # that a draw should take at least, where the probe has so many pixels
_PROBE_RUNS = 5

_NO_UNIFORMS = np.zeros(4, np.float32)

_measured = {}  # what AUTO means, by the name of the device
_refused = set()  # devices whose driver did not take a compute program, by name


def known(device, wanted):
    """FRAGMENT or COMPUTE: what `wanted` means on a device, by what is known of it so far. It touches no GPU."""
    if wanted == "FRAGMENT" or not device.can_compute or device.name in _refused:
        return "FRAGMENT"
    return "COMPUTE" if wanted == "COMPUTE" else _measured.get(device.name, "FRAGMENT")


def is_settled(device, wanted):
    """Whether it is known what `wanted` means on a device."""
    return wanted != "AUTO" or not device.can_compute or device.name in _measured


def settle(device, wanted):
    """See to it that it is known what `wanted` means on a device: some milliseconds on its GPU, and what its driver
    takes to compile two small programs."""
    if not is_settled(device, wanted):
        is_software = any(name in device.name for name in _SOFTWARE)
        _measured[device.name] = "FRAGMENT" if is_software else measure(device)


def refuse(device):
    """Its driver did not take a compute program: it gets no other one."""
    _refused.add(device.name)


def measure(device):
    """The faster entry of a device: COMPUTE only where it draws the same picture, and in clearly less time."""
    try:
        seconds, pictures = probe(device)
    except Exception:  # whatever fails there, as drivers do in their own ways: fragments are drawn everywhere
        return "FRAGMENT"
    # Compilers round in their own ways, and each mirror makes more of it.
    same = np.mean(np.abs(pictures["FRAGMENT"] - pictures["COMPUTE"]) > 1e-2) < 0.05
    is_faster = seconds["FRAGMENT"] > _LEAST_GAIN * seconds["COMPUTE"]
    return "COMPUTE" if same and is_faster else "FRAGMENT"


def probe(device):
    """Least seconds of a draw of the probe, and its picture (height, width, 4), by entry."""
    texture, target = device.texture(_probe_tree()), device.target(_PROBE_SIDE, _PROBE_SIDE, 1)
    programs = {entry: device.program(_probe_source(file)) for entry, file in _PROBES.items()}

    def middle(rows):
        return (0, (_PROBE_SIDE - rows) // 2, _PROBE_SIDE, rows)

    def draw(entry, rows):
        started = time.perf_counter()
        device.draw(programs[entry], target, middle(rows), {"probe": texture}, _NO_UNIFORMS)
        device.read(target, 0, (0, 0, 1, 1))  # waits for the GPU
        return time.perf_counter() - started

    try:
        for entry in programs:
            draw(entry, 1)  # drivers leave much of their work to the first draw
        rows = 8
        while rows < _PROBE_SIDE and draw("FRAGMENT", rows) < _PROBE_SECONDS:
            rows *= 2
        seconds = {entry: np.inf for entry in programs}
        for _ in range(_PROBE_RUNS):
            for entry in programs:
                seconds[entry] = min(seconds[entry], draw(entry, rows))
        pictures = {}
        for entry in programs:
            device.clear(target, 0)
            draw(entry, rows)
            pictures[entry] = device.read(target, 0, middle(rows))
        return seconds, pictures
    finally:
        device.release(target)
        device.release(texture)


def _probe_source(file):
    source = shader_source.program(file, constants={"PROBE_LEAVES": _PROBE_LEAVES}, images=("probe",))
    return replace(source, uniform_struct="")


def _probe_tree():
    """Texels (2, n, 4) of the probe's tree: 16^3 spheres a unit apart, their places along a Z curve."""
    number = np.arange(_PROBE_LEAVES)
    bits = (number[:, None, None] >> (3 * np.arange(4) + np.arange(3)[:, None])) & 1
    places = (bits << np.arange(4)).sum(axis=-1)
    shift = np.random.default_rng(1).uniform(-0.3, 0.3, places.shape)
    level = np.column_stack([places + shift, np.full(len(places), 0.4)])
    levels = [level]
    while len(level) > 1:
        pairs = level.reshape(-1, 2, 4)
        center = pairs[..., :3].mean(axis=1)
        reach = np.linalg.norm(pairs[..., :3] - center[:, None], axis=-1) + pairs[..., 3]
        level = np.column_stack([center, reach.max(axis=1)])
        levels.append(level)
    unused = np.zeros((1, 4))
    return np.concatenate([unused, *levels[::-1]]).reshape(2, -1, 4).astype(np.float32)
