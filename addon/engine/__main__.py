# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: python -m addon.engine SCENE.nff -o OUT.png|OUT.exr

Colours are scene-linear throughout; a PNG gets display values by the sRGB curve, an EXR keeps the linear
ones. What is wrong is said in one line on stderr, with exit code 2 and no file written; Ctrl-C ends with 130,
and no file either.
"""

import argparse
import json
import os
import signal
import sys
import threading
import time
from contextlib import ExitStack
from dataclasses import replace

from .entries import ENTRIES
from .errors import ConicError
from .film_options import LARGEST_LINE, DepthCue, Outlines
from .image_file import check_suffix, write_image
from .nff import NffError, read_nff
from .output_file import check_writable, written_whole

STRICT_SIZE = (512, 512)  # of the databases' rules
LARGEST_SIDE = 16384
LARGEST_SAMPLES = 1 << 20
LARGEST_DEPTH = 1024

_STEP = 0.1  # seconds between two updates of the progress bar


_interrupted = threading.Event()


def _interrupt(_signal, _frame):
    """Ctrl-C. Python loses an exception that is raised while it frees something, so the render looks at the event."""
    _interrupted.set()
    raise KeyboardInterrupt


def main(arguments=None):
    """Run the command line; the exit code."""
    progress = Progress(sys.stderr)
    _interrupted.clear()
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, _interrupt)
    try:
        _run(_parse(arguments), progress)
    except NffError as error:  # begins with the file and the line
        return progress.fail(f"{error}", 2)
    except ConicError as error:
        return progress.fail(f"conic: {error}", 2)
    except MemoryError:
        return progress.fail("conic: there is not enough memory for this scene or picture", 2)
    except KeyboardInterrupt:
        return progress.fail("conic: interrupted, nothing was written", 130)
    return 0


class _Parser(argparse.ArgumentParser):
    """Errors of the command line itself, in one line as all others."""

    def error(self, message):
        raise ConicError(f"{message}; --help lists the options")


def _parse(arguments):
    parser = _Parser(prog="python -m addon.engine", description="Render an NFF scene with Conic.", allow_abbrev=False)
    parser.add_argument("scene", metavar="SCENE.nff")
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="the picture, .png or .exr")
    size = _whole_number(1, LARGEST_SIDE)
    parser.add_argument("--size", nargs=2, type=size, metavar=("W", "H"), help="pixels; else the scene's resolution")
    samples = _whole_number(1, LARGEST_SAMPLES)
    parser.add_argument("--samples", type=samples, metavar="N", help="rays per pixel (1: through its centre)")
    depth = _whole_number(1, LARGEST_DEPTH)
    parser.add_argument("--depth", type=depth, metavar="D", help="deepest ray, the eye ray is 1 (8)")
    parser.add_argument(
        "--strict",
        action="store_true",
        help="the databases' rules: corner rays averaged, depth 5 unless --depth, no cut-off, 512 512 unless --size",
    )
    outline = _number(0.0, LARGEST_LINE)
    parser.add_argument(
        "--outlines", nargs="?", type=outline, const=Outlines.width, metavar="W", help="outlines, W pixels wide (1.5)"
    )
    strength = _number(0.0, 1.0)
    parser.add_argument(
        "--depth-cue", nargs="?", type=strength, const=0.8, metavar="S", help="fade the share S of the farthest (0.8)"
    )
    parser.add_argument("--flat-colors", action="store_true", help="no shading: surfaces as the file colours them")
    parser.add_argument(
        "--entry",
        choices=[name.lower() for name in ENTRIES],
        help="kind of shader that traces (auto: the faster one)",
    )
    parser.add_argument("--stats", metavar="FILE.json", help="write ray counts, times and sizes")
    options = parser.parse_args(arguments)
    if options.strict and (options.samples or 1) > 1:
        parser.error("--strict casts one ray through each corner of a pixel: leave --samples out")
    return options


def _whole_number(least, most):
    return _parser_of(int, "whole number", least, most)


def _number(least, most):
    return _parser_of(float, "number", least, most)


def _parser_of(kind, name, least, most):
    def parse(text):
        try:
            value = kind(text)
        except ValueError:
            value = None
        if value is None or not least <= value <= most:
            raise argparse.ArgumentTypeError(f"{text!r} is no {name} from {least} to {most}")
        return value

    return parse


def _run(options, progress):
    """Read, render, write; all that can be known to fail is looked at before the long part."""
    _check_outputs(options)
    begun = time.perf_counter()
    file = read_nff(options.scene)
    size = options.size or (STRICT_SIZE if options.strict else (file.width, file.height))
    if max(size) > LARGEST_SIDE:
        raise ConicError(f"the picture is {size[0]} x {size[1]}, expected at most {LARGEST_SIDE} a side; use --size")
    file = file.resized(*size)
    read_seconds = time.perf_counter() - begun
    pixels, statistics, warnings = _render(file, _settings(options), progress)
    statistics["seconds"] = {"read": read_seconds} | statistics["seconds"]
    with ExitStack() as stack:
        if options.stats:
            temporary = stack.enter_context(written_whole(options.stats))
            temporary.write_text(json.dumps(statistics, indent=2) + "\n", encoding="utf-8")
        write_image(options.output, pixels)
    progress.clear()
    for warning in warnings:
        progress.say(f"conic: warning: {warning}")


def _check_outputs(options):
    check_suffix(options.output)
    outputs = [options.output, *([options.stats] if options.stats else [])]
    for path in outputs:
        check_writable(path)
    paths = [os.path.realpath(path) for path in (options.scene, *outputs)]
    if len(set(paths)) < len(paths):
        raise ConicError("the scene, the picture and the statistics must be different files")


def _settings(options):
    from .settings import Settings

    entry = options.entry and options.entry.upper()
    given = {"samples": options.samples, "max_depth": options.depth, "entry": entry}
    given = {name: value for name, value in given.items() if value is not None}
    settings = Settings.strict() if options.strict else Settings()
    return replace(
        settings,
        **given,
        count_rays=bool(options.stats),
        flat_colors=options.flat_colors,
        outlines=None if options.outlines is None else Outlines(width=options.outlines),
        depth_cue=None if options.depth_cue is None else DepthCue(strength=options.depth_cue),
    )


def _render(file, settings, progress):
    """Pixels, statistics and warnings of the picture."""
    # Here, so that a mistake on the command line or in the file is told without a GPU driver.
    from .devices.headless import HeadlessDevice
    from .session import Session

    progress.show(0.0)
    session = Session(HeadlessDevice())
    try:
        session.load(file.scene, settings)
        session.start(file.width, file.height)
        while session.step(_STEP):
            if _interrupted.is_set():
                raise KeyboardInterrupt
            progress.show(session.progress)
        return session.pixels(), session.statistics(), list(session.warnings)
    finally:
        session.free()


class Progress:
    """A bar on a terminal, nothing in a pipe."""

    WIDTH = 40

    def __init__(self, stream):
        self._stream = stream
        self._terminal = stream.isatty()
        self._begun = time.perf_counter()

    def show(self, fraction):
        """Draw the bar at `fraction` (0..1)."""
        if self._terminal:
            filled = int(self.WIDTH * fraction)
            minutes, seconds = divmod(int(time.perf_counter() - self._begun), 60)
            bar = "#" * filled + "-" * (self.WIDTH - filled)
            print(f"\r[{bar}] {fraction:4.0%}  {minutes}:{seconds:02}", end="", file=self._stream, flush=True)

    def clear(self):
        """Take the bar away."""
        if self._terminal:
            print("\r\x1b[K", end="", file=self._stream, flush=True)

    def say(self, line):
        print(line, file=self._stream)

    def fail(self, line, code):
        """Say what went wrong; gives `code` back."""
        self.clear()
        self.say(line)
        return code


if __name__ == "__main__":
    sys.exit(main())
