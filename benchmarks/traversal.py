"""Conic beside Mitsuba 3 and Embree on eye and shadow rays: how fast trees are traversed, all else apart."""

import contextlib
import dataclasses
import os

from addon.engine import Material

from . import results, scenes
from .measuring import geometric_mean, in_turn
from .peers import TRAVERSAL, Conic, ConicCasting, Embree, Remote
from .tables import Table, digits

SCENES = ("balls", "balls:6", "shells", "box:1e5", "mount", "tetra", "teapot", "gears")
PICTURE = "with shading"  # Conic's own program of the path tracer, on the same rays
NOTES = (
    "Each traces the same eye rays and, from what they hit, a shadow ray to each light in front. It is asked for hits, "
    "normals and shadow tests alone. A ratio above 1 means that Conic is faster.",
    "'with shading' is Conic's path tracer, which makes a picture of matte surfaces of the same rays.",
    "Rays are counted by each program; smooth normals of the teapot are flat in the others. Mitsuba's "
    "ellipsoids lose digits far from the eye: more eye rays hit small spheres.",
)


def add_arguments(parser):
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), help="FAMILY or FAMILY:SIZE")


def run(arguments):
    absent = {peer.name: peer.missing() for peer in TRAVERSAL if peer.missing()}
    rows = {name: measure(name, arguments.size, arguments.runs, absent) for name in arguments.scenes}
    versions = {peer.name: peer.version() for peer in (Conic, *TRAVERSAL) if peer.name not in absent}
    values = {"size": arguments.size, "versions": versions, "absent": absent, "scenes": rows}
    return results.save("traversal", values, [table(values)])


def measure(name, size, runs, absent):
    """Seconds, ratios to Conic's and counted rays by program, of one scene."""
    scene, reasons = matte(scenes.make(name)), dict(absent)
    with contextlib.ExitStack() as stack:
        peers = {"Conic": ConicCasting(scene, size), PICTURE: Conic(scene, size, 1, shadows="OPAQUE")}
        for own in peers.values():
            stack.callback(own.close)
        for peer in TRAVERSAL:
            if peer.name in absent:
                continue
            try:
                cores = (os.cpu_count(),) if peer is Embree else ()
                peers[peer.name] = Remote(peer, scene, size, *cores)
            except Exception as error:  # what a peer cannot draw is named in the table
                reasons[peer.name] = str(error)
                continue
            stack.callback(peers[peer.name].close)
        warm, failures = in_turn({program: peer.trace for program, peer in peers.items()}, 1)
        seconds, later = in_turn({program: peers[program].trace for program in warm}, runs, twice=True)
        rays = {program: peers[program].rays() for program in seconds}
    conic = seconds["Conic"].median
    print(name, {p: round(s.median, 4) for p, s in seconds.items()}, failures | later, flush=True)
    return {
        "primitives": scene.primitive_counts(),
        "rays": rays,
        "seconds": {program: spread.json() for program, spread in seconds.items()},
        "ratio": {program: spread.median / conic for program, spread in seconds.items()},
        "reasons": reasons | failures | later,
    }


def matte(scene):
    """The scene with diffuse surfaces alone: shadow rays leave from each."""
    materials = [Material(m.diffuse if any(m.diffuse) else m.transmit, fresnel=False) for m in scene.materials]
    return dataclasses.replace(scene, materials=materials)


def table(values):
    others = [peer.name for peer in TRAVERSAL]
    programs = ["Conic", PICTURE, *others]
    head = ["scene", "primitives", "rays, millions", *(f"{p}, Mrays/s" for p in programs)]
    made = Table(
        f"Eye and shadow rays, {values['size']} x {values['size']}: millions of rays a second (spread)",
        [*head, *(f"{p} / Conic, time" for p in others)],
    )
    for name, row in values["scenes"].items():
        rays = {p: (counted["eye"] + counted["shadow"]) / 1e6 for p, counted in row["rays"].items()}
        cells = [name, sum(row["primitives"].values()), f"{rays['Conic']:.2f}"]
        for p in programs:
            s = row["seconds"].get(p)
            cells.append(_rates(rays[p], s) if s else "-")
        made.add(*cells, *(digits(row["ratio"][p]) if p in row["ratio"] else "-" for p in others))
    means = [[row["ratio"][p] for row in values["scenes"].values() if p in row["ratio"]] for p in others]
    made.add("geometric mean", *[""] * (2 + len(programs)), *(digits(geometric_mean(m)) if m else "-" for m in means))
    made.notes += [*NOTES, *(sentence for peer in TRAVERSAL for sentence in peer.unequal)]
    made.notes += [f"{p}: {version}" for p, version in values["versions"].items()]
    left_out = {}
    for name, row in values["scenes"].items():
        for program, reason in row["reasons"].items():
            left_out.setdefault((program, reason), []).append(name)
    made.notes += [f"{p} is not there ({reason}): {', '.join(names)}." for (p, reason), names in left_out.items()]
    return made


def _rates(rays, seconds):
    """Median, least and greatest rate of so many rays."""
    median, least, greatest = (rays / seconds[name] for name in ("median", "greatest", "least"))
    return f"{median:.1f} ({least:.1f} to {greatest:.1f})"
