"""Print the table as Markdown: `python -m tests.blender.shading_table [words]`, of cases whose names hold the words."""

import sys

import bpy
import numpy as np

import addon

from . import cases
from .case import Scene
from .drawing import compare, faults, pictures


def main(words):
    chosen = {key: case for key, case in cases().items() if all(word in key for word in words)}
    print(f"Blender {bpy.app.version_string}\n")
    print("| case | median | largest | light | exception |\n|---|---:|---:|---:|---|")
    medians = {}
    for keys in pictures(chosen):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        for key, compared in compare({key: chosen[key] for key in keys}).items():
            case, largest = chosen[key], compared.errors.max(initial=0.0)
            light = f"{compared.total:+.2%}" if isinstance(case, Scene) else ""
            print(f"| {key} | {compared.median:.3%} | {largest:.2%} | {light} | {case.reason} |", flush=True)
            medians[key] = compared.median
            for text in faults(case, compared):
                print(f"WRONG: {text}")
    _summarize(chosen, medians)


def _summarize(chosen, medians):
    """By subject: how many cases, the median of their medians, the worst of those that are no exceptions."""
    print("\n| subject | cases | median | worst | exceptions |\n|---|---:|---:|---:|---:|")
    for subject in dict.fromkeys(key.split("/")[0] for key in medians):
        of_subject = {key: median for key, median in medians.items() if key.startswith(subject + "/")}
        kept = [median for key, median in of_subject.items() if not chosen[key].reason]
        middle, worst = np.median(list(of_subject.values())), max(kept, default=0.0)
        print(f"| {subject} | {len(of_subject)} | {middle:.3%} | {worst:.2%} | {len(of_subject) - len(kept)} |")


addon.register()
try:
    main(sys.argv[1:])
finally:
    addon.unregister()  # before Python ends, where Blender 4.2 would crash
