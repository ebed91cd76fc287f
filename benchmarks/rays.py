"""Millions of rays a second by kind of ray, and the seconds of the processor's part by stage."""

import dataclasses

from . import results, scenes
from .measuring import in_turn
from .peers import Conic
from .tables import Table, digits

DEPTH = 5
SCENES = ("balls", "lattice", "tree", "shells", "mount", "crystal", "teapot", "glass_room", "mirror_room")
STEPS = ("eye", "shadow", "reflect", "refract")


def add_arguments(parser):
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--size", type=int, default=384)
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), help="FAMILY or FAMILY:SIZE")


def run(arguments):
    rows = {name: measure(name, arguments.size, arguments.runs) for name in arguments.scenes}
    values = {"size": arguments.size, "device": Conic.version(), "scenes": rows}
    return results.save("rays", values, [table(values), stages_table(values)])


def variants(scene):
    """The scene and its depth so that one kind of ray comes to the eye rays at a time."""
    dark = dataclasses.replace(scene, lights=[])
    mirrors = [dataclasses.replace(m, transmit=(0.0,) * 3, straight=(0.0,) * 3) for m in scene.materials]
    clear = [dataclasses.replace(m, reflect=(0.0,) * 3) for m in scene.materials]
    return {
        "eye": (dark, 1),
        "shadow": (scene, 1),
        "reflect": (dataclasses.replace(dark, materials=mirrors), DEPTH),
        "refract": (dataclasses.replace(dark, materials=clear), DEPTH),
    }


def measure(name, size, runs):
    """Rays and the seconds that they take beyond the eye rays, by kind; seconds by stage of the whole scene."""
    scene = scenes.make(name)
    made = {kind: Conic(*variant[:1], size, variant[1]) for kind, variant in variants(scene).items()}
    for peer in made.values():
        peer.trace()
    seconds, _ = in_turn({kind: peer.trace for kind, peer in made.items()}, runs)
    kinds = {}
    for kind, peer in made.items():
        rays = peer.rays()[kind]
        base = seconds["eye"].median if kind != "eye" else 0.0
        if rays:
            kinds[kind] = {"rays": rays, "seconds": seconds[kind].median - base, "spread": seconds[kind].json()}
        peer.close()
    whole = Conic(scene, size, DEPTH)
    whole.trace()
    statistics = whole.statistics()
    whole.close()
    print(name, {kind: round(k["rays"] / max(k["seconds"], 1e-9) / 1e6, 2) for kind, k in kinds.items()}, flush=True)
    return {
        "kinds": kinds,
        "build": statistics["build"],
        "seconds": {stage: statistics["seconds"][stage] for stage in ("build", "upload", "compile", "first_picture")},
    }


def table(values):
    size = values["size"]
    made = Table(f"Millions of rays a second by kind, {size} x {size}", ("scene", *STEPS))
    for name, row in values["scenes"].items():
        made.add(name, *(_rate(row["kinds"].get(kind)) for kind in STEPS))
    made.notes += [
        "eye: without lights at depth 1. shadow: the lights' share of the seconds at depth 1. reflect, refract: "
        f"at depth {DEPTH} without lights, mirrors alone and clear bodies without mirrors, less the eye rays' seconds.",
        "Shading belongs to the rays that reach a surface.",
        values["device"],
    ]
    return made


def _rate(kind):
    """Seconds that do not rise above the eye rays' are noise."""
    if kind is None:
        return "-"
    return digits(kind["rays"] / kind["seconds"] / 1e6) if kind["seconds"] > 0.0 else "too short"


def stages_table(values):
    stages = dict.fromkeys(stage for row in values["scenes"].values() for stage in row["build"])
    head = ("scene", *stages, "upload", "compile", "first picture")
    made = Table("Seconds by stage, from the scene to the first picture", head)
    for name, row in values["scenes"].items():
        seconds = row["seconds"]
        cells = [row["build"].get(stage, 0.0) for stage in stages]
        made.add(name, *(f"{s:.3f}" for s in (*cells, seconds["upload"], seconds["compile"], seconds["first_picture"])))
    made.notes.append("The first columns are the parts of building.")
    return made
