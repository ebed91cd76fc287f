"""The molecule of the first picture: what is read from a PDB file, and the bonds that are found in it."""

import numpy as np
import pytest

from examples.molecule import (
    COVALENT_RADIUS,
    VAN_DER_WAALS_RADIUS,
    find_1hpv,
    find_bonds,
    half_bonds,
    principal_axes,
    read_pdb,
)

LINE = "HETATM    1 {name:4} LIG A   1    {x:8.3f}{y:8.3f}{z:8.3f}  1.00 20.00          {element:>2}"


@pytest.fixture(scope="module")
def protease():
    return read_pdb(find_1hpv())


@pytest.fixture
def pdb(tmp_path):
    """A function that writes lines to a PDB file and returns its path."""

    def write(*lines):
        path = tmp_path / "made.pdb"
        path.write_text("\n".join(lines) + "\n")
        return path

    return write


def test_1hpv_is_read_whole(protease):
    chains = {chain: int((protease.chain == chain).sum()) for chain in "AB"}
    assert chains == {"A": 758, "B": 758}
    alpha = protease.where(protease.name == "CA")
    assert len(alpha) == 198 and set(alpha.element) == {"C"}  # the alpha carbons of 99 residues twice, no calcium
    first = protease.position[0]
    assert np.allclose(first, (13.120, 39.003, 5.159)) and protease.name[0] == "N" and protease.residue[0] == "PRO"
    assert set(protease.element) == set("CNOS")


def test_amprenavir_has_its_formula_and_the_bonds_of_the_file(protease):
    drug = protease.where(protease.residue == "478")
    formula = {element: int((drug.element == element).sum()) for element in "CNOS"}
    assert formula == {"C": 25, "N": 3, "O": 6, "S": 1}
    assert {tuple(pair) for pair in find_bonds(drug).tolist()} == bonds_of_file()


def bonds_of_file(first=1519):
    """The pairs of the CONECT records, by index from the atom of serial number `first`."""
    pairs = set()
    for line in find_1hpv().read_text().splitlines():
        if line.startswith("CONECT"):
            atom, *others = (int(line[i : i + 5]) - first for i in range(6, len(line[:31].rstrip()), 5))
            pairs |= {(min(atom, other), max(atom, other)) for other in others}
    assert len(pairs) == 37  # 35 atoms and three rings
    return pairs


def test_half_bonds_meet_in_the_middle_and_are_of_the_atom_where_they_begin(protease):
    drug = protease.where(protease.residue == "478")
    bonds = find_bonds(drug)
    base, apex, atom = half_bonds(drug, bonds)
    assert np.array_equal(base, drug.position[atom])
    assert np.array_equal(apex[: len(bonds)], apex[len(bonds) :])
    assert np.allclose(apex[: len(bonds)], drug.position[bonds].mean(axis=1))


def test_principal_axes_are_those_of_a_box(protease):
    random = np.random.default_rng(5)
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    box = random.uniform(-1, 1, (4000, 3)) * (3.0, 2.0, 1.0)
    axes = principal_axes(np.concatenate([box, [[9.0, 0.0, 0.0], [0.0, -7.0, 0.0]]]) @ turn.T)
    assert np.allclose(axes @ axes.T, np.eye(3)) and np.linalg.det(axes) > 0.99
    assert axes[0] @ turn[:, 0] > 0.99 and axes[1] @ turn[:, 1] < -0.99  # towards the two far points


def test_elements_come_from_their_column_or_from_the_name(pdb):
    made = [
        LINE.format(name=name, x=0, y=0, z=i, element=element)
        for i, (name, element) in enumerate(
            [(" CA ", ""), ("CA  ", ""), ("1HB ", ""), ("HG11", "H"), (" FE ", "Fe"), (" C1 ", "1")]
        )
    ]
    assert read_pdb(pdb(*made)).element.tolist() == ["C", "CA", "H", "H", "FE", "C"]


def test_only_the_first_model_is_read(pdb):
    one = LINE.format(name=" C1 ", x=1.5, y=-2.25, z=0, element="C")
    assert read_pdb(pdb("MODEL        1", one, "ENDMDL", "MODEL        2", one, "ENDMDL")).position.tolist() == [
        [1.5, -2.25, 0.0]
    ]


def test_what_is_wrong_with_a_file_is_said(pdb):
    with pytest.raises(ValueError, match=r"made\.pdb: no atoms"):
        read_pdb(pdb("HEADER"))
    with pytest.raises(ValueError, match=r"made\.pdb: columns 31 to 54"):
        read_pdb(pdb("ATOM      1  CA  ALA A   1      here we go"))


def test_an_element_without_radius_is_named(pdb):
    atoms = read_pdb(pdb(LINE.format(name="XX  ", x=0, y=0, z=0, element="XX")))
    for table in (COVALENT_RADIUS, VAN_DER_WAALS_RADIUS):
        with pytest.raises(ValueError, match="XX"):
            atoms.radius(table)
