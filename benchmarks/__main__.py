"""Conic measured, one command a result: `python -m benchmarks RESULT [options]`; `RESULT --help` has its options.

Every result is printed and written to build/bench as JSON (with the machine, versions and spreads), Markdown and text.
"""

import argparse
import ast
import importlib
from pathlib import Path

RESULTS = {
    "peers": ("whitted", "Conic beside POV-Ray and Tachyon over all families of scenes"),
    "traversal": ("traversal", "eye and shadow rays beside Mitsuba 3 and Embree"),
    "growth": ("growth", "seconds and bytes against the number of primitives"),
    "trees": ("trees", "building and refitting trees: rate, cost beside the exact sweep, memory"),
    "rays": ("rays", "rays a second by kind, seconds by stage"),
    "entries": ("entries", "the path tracer as fragments and as a compute program"),
    "compile": ("compiling", "compiling the programs, cold and warm"),
    "tests-a-ray": ("tests_a_ray", "nodes and primitives that a ray tests, beside the SAH cost"),
    "plots": ("plots", "pictures of the results that are there"),
    "all": ("everything", "all of these in a row"),
    "cycles": ("cycles", "until a picture has no noise, beside Cycles, in Blender"),
    "first-picture": ("first_picture", "first picture of the default scene of Blender, cold and warm"),
}


def main():
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description=__doc__,
        epilog=f"Of one part each, printed only, with options of their own:\n{_modules()}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="result", required=True)
    for name, (module, said) in RESULTS.items():
        command = commands.add_parser(name, help=said, description=said)
        importlib.import_module(f"benchmarks.{module}").add_arguments(command)
    arguments = parser.parse_args()
    importlib.import_module(f"benchmarks.{RESULTS[arguments.result][0]}").run(arguments)


def _modules():
    """The modules that are run by themselves, a line each: name and what the docstring begins with."""
    lines = []
    for path in sorted(Path(__file__).parent.glob("*.py")):
        text = path.read_text(encoding="utf-8")
        if path.stem != "__main__" and "__name__ ==" in text:
            said = ast.get_docstring(ast.parse(text)).splitlines()[0].partition(": `")[0].rstrip(".")
            lines.append(f"  benchmarks.{path.stem:18} {said}")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
