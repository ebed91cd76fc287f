"""The one table of what is shaded as in Cycles: every node, BSDF, light and world, in both engines of the same Blender.

A case is one line in the list CASES of the file of its subject. It is one of two kinds (see `case`):

    Swatch("noise 4D", Node("TexNoise", "Color", noise_dimensions="4D", Vector=PLACE, W=A))
        shows what a node gives, as emission of a plate; many share one picture. `on="sphere"` takes another shape.
    Scene("glossy 0.2 under an area light", partial(ball, GLOSSY, Roughness=0.2), samples=256)
        has a picture of its own; its function builds the scene: objects, camera, lights, world.

`*every("noise", "TexNoise", "Color", noise_dimensions=["2D", "3D"], Vector=PLACE)` is a Swatch of each choice in a
list. A `Node` is written as its type, its output, then by name its settings (lower case) and inputs (capitals, `_` for
spaces): numbers, colors, or other Nodes; `feed` are its inputs in their order. What differs by no more than 2% in the
median passes. A case that cannot is a named exception: it says `tolerance=` and, in `reason=`, why. `since=(5, 0)` and
`until=(5, 0)` bound Blender's version.

`test_shading_table.py` runs them all; `python -m tests.blender.shading_table [words of names]` prints the table.
"""

import os
from functools import cache
from importlib import import_module

import bpy

#: Whether all cases are tested: where the newest Blender is a module, or if CONIC_WHOLE_TABLE is set. Elsewhere it is
#: every eighth, others in each version, since the shaders are the same and Cycles takes its time.
WHOLE = bool(os.environ.get("CONIC_WHOLE_TABLE")) or (bpy.app.version >= (5, 2, 0) and not bpy.app.binary_path)
_SHARE = 8
#: Files of this folder, by subject.
SUBJECTS = ("values", "trees", "textures", "images", "coordinates", "bsdfs", "lights", "worlds", "mirrored", "shadows")


def keys_to_test():
    """The keys of the cases that are tested here."""
    keys = list(cases())
    return keys if WHOLE else keys[sum(bpy.app.version[:2]) % _SHARE :: _SHARE]


@cache
def cases():
    """The cases of this Blender by "subject/name"."""
    found = {}
    for subject in SUBJECTS:
        for case in import_module(f".{subject}", __name__).CASES:
            if case.since <= bpy.app.version[: len(case.since)] and not case.until <= bpy.app.version:
                key = f"{subject}/{case.name}"
                assert key not in found, f"two cases are called {key}"
                found[key] = case
    return found
