"""Conic beside Cycles, both in Blender: how long each takes to a picture of direct light and mirrors without noise.

The scene is imported from NFF. Conic's one sample of points of light and mirrors has no noise. Cycles' noise is the
root mean square of its picture less its own of very many samples, values clipped to 0..1, measured at 1, 4, 16 ...
samples; the seconds until it is as small as `error` are interpolated or extrapolated along error ~ samples^-1/2.
Seconds are those of the whole render operator, in turn, each program having rendered once before. It needs bpy.
"""

import importlib.util
import math
import os
import tempfile
import time
from pathlib import Path

import numpy as np

from addon.engine.nff_writer import write_nff
from examples import standard_scenes

from . import results
from .measuring import Spread, geometric_mean
from .tables import Table, digits

SCENES = ("balls", "lattice", "tree")
DEPTH = 5
NOTES = (
    "Both render the same Blender file on the processor, in float32; Cycles' eye rays go through the pixels' middles "
    "too (filter of 0.01 pixels), bounces are specular alone (no diffuse ones), no denoiser, no adaptive sampling.",
    "about: extrapolated from the most samples that were measured. apart: root mean square of Conic's picture less "
    "that of Cycles, which has other highlights and reflects them.",
)


def add_arguments(parser):
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--error", type=float, default=0.01, help="the noise that is taken for none")
    parser.add_argument("--truth", type=int, default=1024, help="samples of the picture that is taken as true")
    parser.add_argument("--limit", type=int, default=256, help="the most samples of Cycles that are measured")
    parser.add_argument("--scenes", nargs="+", choices=standard_scenes.FAMILIES, default=list(SCENES))


def run(arguments):
    if importlib.util.find_spec("bpy") is None:
        print("Cycles is not there: this Python has no bpy")
        return None
    rows = {name: measure(name, arguments) for name in arguments.scenes}
    import bpy

    values = {"size": arguments.size, "error": arguments.error, "blender": bpy.app.version_string, "scenes": rows}
    return results.save("cycles", values, [table(values)])


def measure(name, arguments):
    """Seconds and errors of both programs of one scene."""
    _import(name, arguments.size)
    truth = _render("CYCLES", arguments.truth)[1]
    _render("CONIC", 1)
    conic, steps = [], {}
    for _ in range(arguments.runs):
        seconds, picture = _render("CONIC", 1)
        conic.append(seconds)
        for power in range(1 + int(math.log(arguments.limit, 4))):
            seconds, noisy = _render("CYCLES", 4**power)
            taken = steps.setdefault(4**power, {"seconds": [], "error": _error(noisy, truth)})
            taken["seconds"].append(seconds)
    steps = {n: {"seconds": Spread.of(s["seconds"]).json(), "error": s["error"]} for n, s in steps.items()}
    row = {"conic": Spread.of(conic).json(), "apart": _error(picture, truth), "cycles": steps}
    row["reached"] = reaching(
        {n: s["error"] for n, s in steps.items()},
        {n: s["seconds"]["median"] for n, s in steps.items()},
        arguments.error,
    )
    row["ratio"] = row["reached"]["seconds"] / row["conic"]["median"]
    print(name, {k: v for k, v in row.items() if k != "cycles"}, flush=True)
    return row


def reaching(errors, seconds, error):
    """Samples and seconds until the noise is `error`, from those measured at some numbers of samples (dicts by it).

    Noise falls with the root of the samples, from the last number measured; seconds are a line through first and last.
    """
    first, last = min(errors), max(errors)
    samples = max(last * (errors[last] / error) ** 2, 1.0)
    slope = (seconds[last] - seconds[first]) / (last - first)
    return {
        "samples": round(samples, 1),
        "seconds": seconds[first] + slope * (samples - first),
        "measured": samples <= last,
    }


def _import(name, size):
    """Blender with the scene, and the settings of both engines that make them draw the same."""
    import bpy

    from examples.in_blender import empty_blender

    empty_blender()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"{name}.nff")
        write_nff(standard_scenes.FAMILIES[name](), path, size, size)
        bpy.ops.import_scene.nff(filepath=str(path))
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.conic.max_depth = DEPTH
    cycles = scene.cycles
    cycles.device, cycles.use_adaptive_sampling, cycles.use_denoising = "CPU", False, False
    cycles.max_bounces = cycles.glossy_bounces = cycles.transmission_bounces = DEPTH - 1
    cycles.diffuse_bounces = cycles.volume_bounces = 0
    cycles.sample_clamp_indirect = cycles.sample_clamp_direct = 0.0
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    scene.render.threads_mode = "AUTO"


def _render(engine, samples):
    """Seconds of the render operator, and the picture (h, w, 3) clipped to 0..1."""
    import bpy

    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.conic.samples = engine, samples, samples
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "picture.exr")
        started = time.perf_counter()
        bpy.ops.render.render(write_still=True)
        seconds = time.perf_counter() - started
        image = bpy.data.images.load(scene.render.filepath)
        width, height = image.size
        pixels = np.empty(width * height * 4, np.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
    return seconds, np.clip(pixels.reshape(height, width, 4)[..., :3], 0.0, 1.0)


def _error(picture, truth):
    return float(np.sqrt(np.mean(np.square(picture - truth, dtype=np.float64))))


def table(values):
    size = values["size"]
    head = (
        "scene",
        "Conic, s",
        "Cycles, s",
        "its samples",
        "Cycles at 1 sample, s",
        "noise there",
        "Cycles / Conic",
        "apart",
    )
    made = Table(f"Until no noise is seen, Blender {values['blender']}, {size} x {size}", head)
    for name, row in values["scenes"].items():
        first, reached = row["cycles"][1], row["reached"]
        about = "" if reached["measured"] else "about "
        cells = [digits(row["conic"]["median"]), about + digits(reached["seconds"]), round(reached["samples"])]
        cells += [digits(first["seconds"]["median"]), f"{first['error']:.3f}", about + digits(row["ratio"])]
        made.add(name, *cells, f"{row['apart']:.3f}")
    ratios = [row["ratio"] for row in values["scenes"].values()]
    made.add("geometric mean", *[""] * 5, digits(geometric_mean(ratios)), "")
    made.notes += [f"No noise: {values['error']} root mean square of values from 0 to 1.", *NOTES]
    return made
