# SPDX-License-Identifier: GPL-3.0-or-later
"""The styles of Molecular Nodes by Conic and by Cycles: `.venvs/molecules/bin/python -m benchmarks.molecules`.

    python -m benchmarks.molecules [--file structure.pdb] [--size 480]

For each style of a structure, by default the 47,681 atoms of `adk_oplsaa`: what Conic takes it as, the seconds that it
needs to read it and to render it (both engines one sample a pixel, Blender's evaluation included), and how the picture
differs from Cycles' of the same object with the add-on's exact points and finest tubes: `outline`, pixels that one of
the two covers more than a pixel away from the other's silhouette, and `color`, the share of the pixels that both cover
whose colour differs by more than 0.02.
"""

import argparse
import tempfile

import numpy as np

from addon import statistics
from examples.in_blender import empty_blender
from tests.molecules.building import EXACT, flat_paint, grown, load, look_at, positions_of, rendered, set_style

STYLES = (
    ("spheres", {"sphere": "Point"}),
    ("spheres", {"sphere": "Instance"}),
    ("spheres", {"sphere": "Mesh"}),
    ("ball_and_stick", {}),
    ("sticks", {}),
    ("sticks", {"sphere": "Mesh"}),
)


def compare(molecule, style, options, size, folder):
    """Print one line."""
    paint = flat_paint()
    set_style(molecule, style, paint, **EXACT[style])
    cycles, cycles_seconds = rendered("CYCLES", folder, size)
    set_style(molecule, style, paint, **options)
    conic, conic_seconds = rendered("CONIC", folder, size)
    found = statistics.latest()
    a, b = conic[..., 3] > 0.5, cycles[..., 3] > 0.5
    outline = int((a & ~grown(b)).sum() + (b & ~grown(a)).sum())
    off = np.abs(conic[..., :3] - cycles[..., :3]).max(axis=-1)[a & b] > 0.02
    name = f"{style} {options.get('sphere', '')}"
    seconds = f"{found.seconds['read']:7.2f} {conic_seconds:7.2f} {cycles_seconds:7.2f}"
    shapes = statistics.primitives_text(found.primitives)
    print(f"{name:24}{seconds} {outline:8} {off.mean():8.3%}  {shapes}", flush=True)


def main():
    parser = argparse.ArgumentParser(prog="python -m benchmarks.molecules", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--file", help="a file that Molecular Nodes reads")
    parser.add_argument("--size", type=int, default=480)
    arguments = parser.parse_args()
    if arguments.file is None:
        import MDAnalysisTests.datafiles

        arguments.file = MDAnalysisTests.datafiles.PDB
    empty_blender()
    molecule = load(arguments.file)
    look_at(positions_of(molecule))
    print(f"{'':24}{'read':>7} {'Conic':>7} {'Cycles':>7} {'outline':>8} {'color':>8}  taken as")
    with tempfile.TemporaryDirectory() as folder:
        for style, options in STYLES:
            compare(molecule, style, options, arguments.size, folder)


if __name__ == "__main__":
    main()
