"""Conic beside POV-Ray and Tachyon: the same scenes, same pixels, a ray through each, same depth, in turn."""

import contextlib
import tempfile

import numpy as np

from . import results, scenes
from .measuring import geometric_mean, in_turn
from .peers import WHITTED
from .tables import Table, digits

DEPTH = 5
SCENES = (*scenes.FAMILIES, "balls:6")
NOTES = (
    "Seconds are those of tracing as each program reports them: reading, building and compiling apart. Of each two "
    "runs the second one counts.",
    "Conic traces in float32, on the GPU or, with Mesa's driver, on the processor's cores.",
    "Equal: eye rays through the middle of each pixel, depth 5 with the eye ray as 1, no cut-off by weight, no shadow "
    "rays towards lights behind a surface. 'differ': the share of pixels that are not Conic's within 2%.",
)


def add_arguments(parser):
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--size", type=int, default=384)
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), help="FAMILY or FAMILY:SIZE")


def run(arguments):
    absent = {peer.name: peer.missing() for peer in WHITTED if peer.missing()}
    rows = {name: measure(name, arguments.size, arguments.runs, absent) for name in arguments.scenes}
    values = {
        "size": arguments.size,
        "depth": DEPTH,
        "versions": {peer.name: peer.version() for peer in WHITTED if peer.name not in absent},
        "absent": absent,
        "scenes": rows,
    }
    return results.save("peers", values, [table(values)])


def measure(name, size, runs, absent):
    """Seconds, ratios to Conic's, and how far the pictures are apart, by program, of one scene."""
    scene = scenes.make(name)
    reasons, peers = dict(absent), {}
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory())
        for peer in WHITTED:
            if peer.name in absent:
                continue
            try:
                peers[peer.name] = peer(scene, size, DEPTH, folder)
            except Exception as error:  # what a peer cannot draw is named in the table
                reasons[peer.name] = str(error)
                continue
            stack.callback(peers[peer.name].close)
        seconds, failures = in_turn({program: peer.trace for program, peer in peers.items()}, runs, twice=True)
        pictures = {program: peers[program].picture() for program in seconds}
        rays = peers["Conic"].rays()
        theirs = peers["POV-Ray"].rays() if "POV-Ray" in seconds else None
    row = {
        "primitives": scene.primitive_counts(),
        "rays": rays,
        "povray_rays": theirs,
        "seconds": {program: spread.json() for program, spread in seconds.items()},
        "ratio": {p: spread.median / seconds["Conic"].median for p, spread in seconds.items()},
        "differ": {p: differing(picture, pictures["Conic"]) for p, picture in pictures.items()},
        "reasons": reasons | failures,
    }
    said = ", ".join(f"{p} {s.median:.2f} s ({row['ratio'][p]:.2f})" for p, s in seconds.items())
    print(f"{name:12} {said}", flush=True)
    return row


def differing(a, b, tolerance=0.02):
    """Share of the pixels of two pictures (h, w, 3) that differ by more than `tolerance` in some channel."""
    return float((np.abs(a - b).max(axis=-1) > tolerance).mean())


def table(values):
    """The table of what `run` measured."""
    programs = [peer.name for peer in WHITTED]
    others = programs[1:]
    head = ["scene", "primitives", "rays, millions", *(f"{p}, s" for p in programs)]
    head += [f"{p} / Conic" for p in others] + [f"{p} differ" for p in others]
    size = values["size"]
    made = Table(f"Tracing, {size} x {size}, depth {values['depth']}: median seconds (least to greatest)", head)
    for name, row in values["scenes"].items():
        rays = sum(row["rays"][kind] for kind in ("eye", "reflect", "refract", "shadow"))
        cells = [name, sum(row["primitives"].values()), f"{rays / 1e6:.2f}"]
        cells += [_seconds(row["seconds"].get(p)) for p in programs]
        cells += [digits(row["ratio"][p]) if p in row["ratio"] else "-" for p in others]
        cells += [f"{100 * row['differ'][p]:.1f}%" if p in row["differ"] else "-" for p in others]
        made.add(*cells)
    means = {p: [row["ratio"][p] for row in values["scenes"].values() if p in row["ratio"]] for p in others}
    for what, function in (("geometric mean", geometric_mean), ("least", min)):
        cells = [digits(function(ratios)) if ratios else "-" for ratios in means.values()]
        made.add(what, *[""] * (2 + len(programs)), *cells, *[""] * len(others))
    made.notes += [*NOTES, *(sentence for peer in WHITTED for sentence in peer.unequal)]
    made.notes += [f"{p}: {version}" for p, version in values["versions"].items()]
    left_out = {}
    for name, row in values["scenes"].items():
        for program, reason in row["reasons"].items():
            left_out.setdefault((program, reason), []).append(name)
    made.notes += [f"{p} is not there ({reason}): {', '.join(names)}." for (p, reason), names in left_out.items()]
    return made


def _seconds(spread):
    if spread is None:
        return "-"
    return f"{digits(spread['median'])} ({digits(spread['least'])} to {digits(spread['greatest'])})"
