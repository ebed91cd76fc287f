"""How seconds and bytes grow with the number of primitives: fitted exponents, and the sphereflake's two sizes."""

from . import results, scenes
from .measuring import in_turn, power_law
from .peers import Conic
from .tables import Table, digits

DEPTH = 5
FAMILIES = {
    "balls": ("balls:3", "balls:4", "balls:5", "balls:6"),
    "box": ("box:1e3", "box:1e4", "box:1e5", "box:1e6", "box:1e7"),
    "lattice": ("lattice:6", "lattice:12", "lattice:24", "lattice:48"),
    "tetra": ("tetra:5", "tetra:7", "tetra:9"),
    "crystal": ("crystal:4", "crystal:8", "crystal:16", "crystal:32"),
}
STAGES = ("build", "upload", "trace")


def add_arguments(parser):
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--size", type=int, default=384)
    parser.add_argument("--families", nargs="+", choices=FAMILIES, default=list(FAMILIES))
    parser.add_argument("--most", type=float, default=2e6, help="leave out scenes of more primitives")


def run(arguments):
    families = {}
    for family in arguments.families:
        rows = [measure(name, arguments.size, arguments.runs, arguments.most) for name in FAMILIES[family]]
        rows = [row for row in rows if row]
        count, trace = [row["count"] for row in rows], [row["trace"]["median"] for row in rows]
        families[family] = {"rows": rows, "exponent": power_law(count, trace)[0] if len(rows) > 1 else None}
    values = {"size": arguments.size, "device": Conic.version(), "families": families}
    values["sphereflake"] = _sphereflake(families)
    return results.save("growth", values, [table(values)])


def measure(name, size, runs, most):
    """Seconds by stage, bytes and rays of one scene; None where it has more than `most` primitives."""
    scene = scenes.make(name)
    count = sum(scene.primitive_counts().values())
    if count > most:
        return None
    peer = Conic(scene, size, DEPTH)
    peer.trace()
    seconds, _ = in_turn({"Conic": peer.trace}, runs)
    statistics = peer.statistics()
    row = {
        "name": name,
        "count": count,
        "rays": sum(peer.rays()[kind] for kind in ("eye", "reflect", "refract", "shadow")),
        "trace": seconds["Conic"].json(),
        "seconds": {stage: statistics["seconds"][stage] for stage in STAGES},
        "bytes": sum(statistics["textures"].values()),
        "textures": statistics["textures"],
        "bvh": statistics["bvh"],
    }
    peer.close()
    print(f"{name:12} {count:9} primitives, {row['trace']['median']:.3f} s", flush=True)
    return row


def _sphereflake(families):
    """How many times longer 81 times as many spheres take, None where they were not measured."""
    rows = {row["name"]: row["trace"]["median"] for row in families.get("balls", {"rows": []})["rows"]}
    return rows["balls:6"] / rows["balls:4"] if {"balls:4", "balls:6"} <= rows.keys() else None


def table(values):
    size = values["size"]
    head = (
        "scene",
        "primitives",
        "trace, s (spread)",
        "Mrays/s",
        "exponent",
        "build, s",
        "upload, s",
        "bytes a primitive",
    )
    made = Table(f"Growth of tracing, {size} x {size}, depth {DEPTH}", head)
    for family in values["families"].values():
        for row in family["rows"]:
            trace, last = row["trace"], row is family["rows"][-1]
            made.add(
                row["name"],
                row["count"],
                f"{digits(trace['median'])} ({digits(trace['least'])} to {digits(trace['greatest'])})",
                f"{row['rays'] / trace['median'] / 1e6:.2f}",
                f"{family['exponent']:.2f}" if last and family["exponent"] is not None else "",
                *(digits(row["seconds"][stage]) for stage in ("build", "upload")),
                f"{row['bytes'] / row['count']:.0f}",
            )
    made.notes.append("exponent: of the power of the number of primitives that fits the seconds of its family best.")
    if values["sphereflake"]:
        times = digits(values["sphereflake"])
        made.notes.append(f"A sphereflake of 597,871 spheres, 81 times as many as 7,381, takes {times} times as long.")
    made.notes.append(values["device"])
    return made
