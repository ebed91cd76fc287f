"""Both entries of the path tracer, fragments and compute, over the same scenes: which one is faster on this GPU."""

from addon.engine import entries

from . import results, scenes
from .measuring import geometric_mean, in_turn
from .peers import Conic
from .rays import DEPTH
from .tables import Table, digits

SCENES = ("balls", "balls:6", "lattice", "tree", "shells", "mount", "crystal", "teapot", "glass_room", "mirror_room")
ENTRIES = "FRAGMENT", "COMPUTE"


def add_arguments(parser):
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), help="FAMILY or FAMILY:SIZE")


def run(arguments):
    device = Conic.device()
    if not device.can_compute:
        raise SystemExit(f"{device.name} has no compute programs")
    rows = {name: measure(name, arguments.size, arguments.samples, arguments.runs) for name in arguments.scenes}
    values = {"size": arguments.size, "samples": arguments.samples, "device": device.name, "scenes": rows}
    entries.settle(device, "AUTO")
    values |= {"probe": entries.probe(device)[0], "auto": entries.known(device, "AUTO")}
    return results.save("entries", values, [table(values)])


def measure(name, size, samples, runs):
    """Rays of a picture, and the seconds of tracing and of compiling by entry."""
    scene = scenes.make(name)
    made = {entry: Conic(scene, size, DEPTH, samples=samples, entry=entry) for entry in ENTRIES}
    for peer in made.values():
        peer.trace()
    seconds, _ = in_turn({entry: peer.trace for entry, peer in made.items()}, runs)
    rays = made["FRAGMENT"].rays()
    compiling = {entry: peer.statistics()["seconds"]["compile"] for entry, peer in made.items()}
    for peer in made.values():
        peer.close()
    print(name, {entry: round(spread.median, 3) for entry, spread in seconds.items()}, flush=True)
    return {
        "rays": sum(rays[kind] for kind in ("eye", "shadow", "reflect", "refract")),
        "seconds": {entry: spread.json() for entry, spread in seconds.items()},
        "compile": compiling,
        "ratio": seconds["FRAGMENT"].median / seconds["COMPUTE"].median,
    }


def table(values):
    title = f"Both entries, {values['size']} x {values['size']}, {values['samples']} samples: millions of rays a second"
    made = Table(title, ("scene", "fragments", "compute", "compute / fragments", "compile, s", "compile, s"))
    for name, row in values["scenes"].items():
        rates = (digits(row["rays"] / row["seconds"][entry]["median"] / 1e6) for entry in ENTRIES)
        compiling = (f"{row['compile'][entry]:.2f}" for entry in ENTRIES)
        made.add(name, *rates, f"{row['ratio']:.2f}", *compiling)
    mean = geometric_mean([row["ratio"] for row in values["scenes"].values()])
    made.add("geometric mean", "", "", f"{mean:.2f}", "", "")
    probe = values["probe"]["FRAGMENT"] / values["probe"]["COMPUTE"]
    made.notes += [
        "A ratio above 1 means that compute is faster. Compiling: fragments, then compute.",
        f"The probe's ratio is {probe:.2f}; AUTO means {values['auto']} here.",
        values["device"],
    ]
    return made
