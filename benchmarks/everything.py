"""All results in a row, the quick ones of each, then the plots: what `make bench` runs."""

import subprocess
import sys
import time

# Each in a process of its own, with options that are to keep all of it under a quarter of an hour on two cores.
COMMANDS = (
    ("peers", "--size", "384", "--runs", "3"),
    ("traversal", "--size", "512", "--runs", "5"),
    ("growth", "--size", "384", "--runs", "3"),
    ("trees",),
    ("rays", "--size", "256", "--runs", "3"),
    ("entries", "--size", "256", "--runs", "3", "--scenes", "balls", "lattice", "shells", "mount", "crystal", "teapot"),
    ("compile", "--runs", "3"),
    ("first-picture", "--runs", "3"),
    ("cycles", "--size", "128", "--runs", "2", "--limit", "64"),
    ("tests-a-ray",),
    ("plots",),
)


def add_arguments(parser):
    parser.add_argument("--docs", action="store_true", help="write the plots into docs/ too")


def run(arguments):
    failed = []
    for command in COMMANDS:
        more = ["--docs"] if command == ("plots",) and arguments.docs else []
        started = time.perf_counter()
        done = subprocess.run([sys.executable, "-m", "benchmarks", *command, *more])
        print(f"== {command[0]}: {time.perf_counter() - started:.0f} s\n", flush=True)
        failed += [command[0]] if done.returncode else []
    if failed:
        sys.exit(f"failed: {', '.join(failed)}")
