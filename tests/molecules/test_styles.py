"""The styles of Molecular Nodes: what Conic takes them as, and the same picture as Cycles', atom by atom."""

import bpy
import numpy as np
import pytest

from addon import statistics
from tests.molecules.building import EXACT, flat_paint, grown, load, look_at, positions_of, rendered, set_style

files = pytest.importorskip("MDAnalysisTests.datafiles", reason="Molecular Nodes is not installed")

SIZE = 320

STYLES = [
    ("spheres", {"sphere": "Point"}),
    ("spheres", {"sphere": "Instance"}),
    ("spheres", {"sphere": "Mesh"}),
    ("ball_and_stick", {}),
    ("ball_and_stick", {"sphere": "Point", "bond_split": "Single"}),
    ("ball_and_stick", {"sphere": "Mesh", "bond_split": "Single"}),
    ("sticks", {}),
    ("sticks", {"sphere": "Mesh"}),
]


@pytest.fixture
def molecule():
    return load(files.PDB_small)


@pytest.mark.parametrize(("style", "options"), STYLES)
def test_a_style_is_exact_shapes_and_cycles_picture(molecule, style, options, tmp_path):
    look_at(positions_of(molecule), 0.6)
    paint = flat_paint()
    exact = EXACT[style] | {name: value for name, value in options.items() if name == "bond_split"}
    set_style(molecule, style, paint, **exact)
    cycles, _ = rendered("CYCLES", tmp_path, SIZE)
    set_style(molecule, style, paint, **options)
    conic, _ = rendered("CONIC", tmp_path, SIZE)
    drawn = statistics.latest().primitives
    atoms, bonds = len(molecule.object.data.vertices), len(molecule.object.data.edges)
    assert "triangle" not in drawn
    assert drawn["sphere"] == atoms
    if style != "spheres":
        assert bonds <= drawn["cylinder"] <= 3 * bonds  # a half of each colour; double bonds twice
    a, b = conic[..., 3] > 0.5, cycles[..., 3] > 0.5
    assert 0.1 < b.mean() < 1.0
    assert not (a & ~grown(b)).any() and not (b & ~grown(a)).any()
    off = np.abs(conic[..., :3] - cycles[..., :3]).max(axis=-1) > 0.02
    assert (off & a & b).mean() < 0.02  # one thing before the other by a hair: tubes of 40 sides are thinner


def test_the_large_structure_is_read_whole(tmp_path):
    molecule = load(files.PDB)
    look_at(positions_of(molecule))
    set_style(molecule, "spheres")  # with Conic as the engine: 47,681 instances of an ico sphere
    bpy.context.scene.render.engine = "CONIC"
    rendered("CONIC", tmp_path, 32)
    assert statistics.latest().primitives == {"sphere": 47681}
