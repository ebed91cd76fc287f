"""What it takes to make strands of curves, for each type of curve: `python -m benchmarks.strands`.

    python -m benchmarks.strands [--curves 125000] [--tolerance 0.003]

Seconds of the processor for sampling the curves and for making the primitives, and how many segments there are. Each
curve has nine points and is 0.8 long.
"""

import argparse
import time

import numpy as np

from addon.engine.strands import Polylines, strands
from addon.sync.curve_sampling import BEZIER, CATMULL_ROM, NURBS, POLY, ControlCurves, Sampling, sample

KINDS = {"catmull-rom": CATMULL_ROM, "poly": POLY, "bezier": BEZIER, "nurbs": NURBS}
_POINTS = 9


def tapered_hair(count, kind):
    """Wavy `ControlCurves` that end in points."""
    rng = np.random.default_rng(0)
    step = (0.0, 0.0, 0.1) + 0.02 * rng.normal(size=(count, _POINTS, 3))
    points = (rng.normal(size=(count, 1, 3)) + np.cumsum(step, axis=1)).reshape(-1, 3)
    return ControlCurves(
        points=points,
        offsets=np.arange(count + 1) * _POINTS,
        radius=np.tile(np.linspace(0.003, 0.0, _POINTS), count),
        kind=np.full(count, kind),
        cyclic=np.zeros(count, bool),
        handles=points[:, None] + np.array([(0.0, 0.0, -0.03), (0.0, 0.0, 0.03)]),
        weight=np.ones(count * _POINTS),
        order=np.full(count, 4),
        knots_mode=np.ones(count, np.int64),
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--curves", type=int, default=125000)
    parser.add_argument("--tolerance", type=float, default=0.003)
    options = parser.parse_args()
    print(f"{'':12}{'segments':>10}{'sampling':>10}{'making':>10}")
    for name, kind in KINDS.items():
        curves = tapered_hair(options.curves, kind)
        start = time.process_time()
        made = sample(curves, Sampling(tolerance=options.tolerance))
        sampled = time.process_time()
        strands(Polylines(made.points, made.offsets, made.radius, made.cyclic))
        end = time.process_time()
        segments = len(made.points) - options.curves
        print(f"{name:12}{segments:10,}{sampled - start:10.2f}{end - sampled:10.2f}")


if __name__ == "__main__":
    main()
