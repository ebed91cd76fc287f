"""Pictures of results in build/bench: `python -m benchmarks plots [--docs]`. It needs matplotlib."""

import importlib.util
from pathlib import Path

from . import results

DOCS = Path(__file__).resolve().parents[1] / "docs"
COLORS = {"POV-Ray": "#4477aa", "Tachyon": "#66ccee", "Mitsuba 3": "#228833", "Embree": "#ccbb44"}


def add_arguments(parser):
    parser.add_argument("--docs", action="store_true", help="write them into docs/ too")


def run(arguments):
    if importlib.util.find_spec("matplotlib") is None:
        print("Nothing is plotted: this Python has no matplotlib")
        return
    import matplotlib

    matplotlib.use("Agg")
    for name, draw in {"peers": _ratios, "traversal": _ratios, "growth": _growth}.items():
        values = results.load(name)
        if values is None:
            print(f"{name}: not measured yet, python -m benchmarks {name}")
            continue
        for folder in [results.FOLDER, *([DOCS] if arguments.docs else [])]:
            path = folder / f"bench_{name}.png"
            draw(values, path)
            print(path)


def _figure(width, height):
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(width, height), layout="constrained")
    axes.spines[["top", "right"]].set_visible(False)
    return figure, axes


def _save(figure, path):
    from matplotlib import pyplot

    figure.savefig(path, dpi=100)
    pyplot.close(figure)


def _ratios(values, path):
    """Bars: seconds of each program in parts of Conic's, by scene."""
    names = list(values["scenes"])
    programs = [p for p in COLORS if any(p in row["ratio"] for row in values["scenes"].values())]
    figure, axes = _figure(9.0, 3.6)
    width = 0.8 / max(len(programs), 1)
    for place, program in enumerate(programs):
        shown = [
            (i, values["scenes"][n]["ratio"][program])
            for i, n in enumerate(names)
            if program in values["scenes"][n]["ratio"]
        ]
        x = [i + (place - (len(programs) - 1) / 2.0) * width for i, _ in shown]
        axes.bar(x, [ratio for _, ratio in shown], width, label=program, color=COLORS[program], bottom=0.0)
    axes.axhline(1.0, color="black", linewidth=1.0)
    axes.set_yscale("log")
    axes.set_ylim(bottom=0.8 * min(1.0, *(row["ratio"][p] for row in values["scenes"].values() for p in row["ratio"])))
    _tell_values(axes)
    axes.set_xticks(range(len(names)), names, rotation=30, ha="right")
    axes.set_ylabel("seconds / Conic's seconds")
    axes.set_title(f"Above 1: Conic is faster ({values['size']} x {values['size']})", fontsize=10)
    axes.legend(frameon=False, ncols=len(programs) or 1, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    _save(figure, path)


def _tell_values(axes):
    """Numbers at a logarithmic axis of values, not powers of ten."""
    lower, upper = axes.get_ylim()
    ticks = (part * 10.0**power for power in range(-4, 4) for part in (1, 2, 5))
    axes.set_yticks([tick for tick in ticks if lower <= tick <= upper])
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter("")


def _growth(values, path):
    """Lines: seconds of tracing against the number of primitives, by family."""
    figure, axes = _figure(9.0, 3.6)
    for name, family in values["families"].items():
        count, seconds = [row["count"] for row in family["rows"]], [row["trace"]["median"] for row in family["rows"]]
        exponent = family["exponent"]
        axes.loglog(count, seconds, "o-", label=name if exponent is None else f"{name}: n^{exponent:.2f}")
    axes.set_xlabel("primitives")
    axes.set_ylabel("seconds of tracing")
    _tell_values(axes)
    axes.set_title(f"{values['size']} x {values['size']}, depth 5", fontsize=10)
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
    _save(figure, path)
