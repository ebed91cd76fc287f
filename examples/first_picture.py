# SPDX-License-Identifier: GPL-3.0-or-later
"""The first picture: HIV-1 protease and amprenavir, the drug that stops it, among glass, mirror and a globe.

python examples/first_picture.py --output build/first_picture.png     with Blender as a module (bpy)
blender -b -P examples/first_picture.py -- --output first.png --pdb 1hpv.pdb

The atoms are those of PDB entry 1HPV (Kim et al., J. Am. Chem. Soc. 117 (1995) 1181), a nanometre to Blender's
metre. The objects are Blender's own spheres, cylinders, a cone and a circle, which share their meshes; Conic renders
them as exact shapes.
"""

import sys
from math import radians
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from examples.in_blender import arguments_given, empty_blender, finish, new_light, parser_of
from examples.molecule import (
    PACKAGE,
    VAN_DER_WAALS_RADIUS,
    Atoms,
    find_1hpv,
    find_bonds,
    half_bonds,
    principal_axes,
    read_pdb,
)
from examples.painted_images import globe, linear, studio
from examples.shader_trees import new_material, new_world, shader
from examples.stage import Stage, add_camera, new_image

DRUG = "478"  # the residue's name in the file
NANOMETRE = 0.1  # per angstrom

CHAINS = {"A": "8fb8c9", "B": "e0c39a"}
ELEMENTS = {"C": "e9e5dc", "N": "2e5fd0", "O": "d62f2f", "S": "f2b632"}

PROTEIN_CENTER = (1.9, 3.8)  # over the floor
DRUG_CENTER, DRUG_SIZE, DRUG_TURN = (-1.6, -1.0, 1.64), 2.8, (radians(-20.0), 0.0, radians(-12.0))
ATOM_RADIUS, HETERO_RADIUS, BOND_RADIUS = 0.135, 0.15, 0.05
STAND_RADIUS, STAND_HEIGHT = 2.1, 0.12

#: longitude, latitude, half width, half height in degrees, radiance
SOFTBOXES = ((-150, 50, 22, 16, 8.0), (-30, 45, 14, 22, 6.0), (100, 55, 40, 10, 1.5))
#: kind, location (of a sun: where it shines from), watts (of a sun: per square metre), color
LIGHTS = (
    ("SUN", (-4, -5, 7), 2.7, "fff1de"),
    ("POINT", (7, -7, 5), 900, "cfe0ff"),
    ("POINT", (-1, -11, 3), 700, "ffffff"),
    ("POINT", (-5, 7, 6), 900, "ffe2c0"),
)


def main():
    options = parse_arguments()
    try:
        atoms = read_pdb(options.pdb or find_1hpv())
    except (OSError, ValueError) as error:
        sys.exit(f"first_picture.py: {error}")
    empty_blender()
    finish(build_scene(atoms), options)


def parse_arguments():
    parser = parser_of(__file__, __doc__.splitlines()[0], size=(960, 540))
    parser.add_argument("--pdb", metavar="FILE", help=f"PDB entry 1HPV; without it, the file in the package {PACKAGE}")
    return parser.parse_args(arguments_given())


def build_scene(atoms):
    """Build the picture in Blender's empty current scene, and return that: all but the resolution and the samples."""
    stage = Stage()
    add_protein(stage, atoms.where(np.isin(atoms.chain, list(CHAINS))))
    add_drug(stage, atoms.where(atoms.residue == DRUG))
    add_still_life(stage)
    for light in LIGHTS:
        stage.collection.objects.link(new_light(*light))
    scene = bpy.context.scene
    scene.world = studio_world()
    scene.camera = add_camera(stage, (0.3, -13.5, 4.2), (0.0, 0.0, 1.45))
    scene.render.engine = "CONIC"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.compression = 90
    scene.view_settings.view_transform = "Standard"
    scene.conic.max_depth = 10
    scene.conic.shadows = "TINTED"  # light comes through glass
    return scene


def add_protein(stage, protein):
    """The enzyme as space-filling spheres on the floor, a colour a chain, its two-fold axis upright."""
    materials = {chain: glossy_paint(f"Chain {chain}", color, 0.5) for chain, color in CHAINS.items()}
    wide, up, _ = principal_axes(protein.position)
    position = protein.position @ np.stack([wide, np.cross(up, wide), up], axis=-1) * NANOMETRE
    radius = protein.radius(VAN_DER_WAALS_RADIUS) * NANOMETRE
    low, high = position.min(axis=0), position.max(axis=0)
    position -= (*(low + high)[:2] / 2, (position[:, 2] - radius).min())
    position[:, :2] += PROTEIN_CENTER
    for name, chain, center, size in zip(protein.name, protein.chain, position, radius, strict=True):
        stage.place(f"Chain {chain} {name}", stage.ball, materials[chain], center, size)


def add_drug(stage, drug):
    """The drug as balls and sticks above the stand, a colour an element, each bond in the colours of its two atoms."""
    materials = {element: glossy_paint(f"Atom {element}", color, 0.05) for element, color in ELEMENTS.items()}
    long, wide, _ = principal_axes(drug.position)
    axes = np.stack([long, np.cross(wide, long), wide], axis=-1)
    position = (drug.position - drug.position.mean(axis=0)) @ axes * (NANOMETRE * DRUG_SIZE)
    position = position @ np.array(Euler(DRUG_TURN).to_matrix()).T + DRUG_CENTER
    placed = Atoms(position, drug.element, drug.name, drug.residue, drug.chain)
    for name, element, center in zip(drug.name, drug.element, position, strict=True):
        radius = ATOM_RADIUS if element == "C" else HETERO_RADIUS
        stage.place(f"Drug {name}", stage.ball, materials[element], center, radius)
    for base, apex, atom in zip(*half_bonds(placed, find_bonds(drug)), strict=True):
        stage.place_rod(f"Bond of {drug.name[atom]}", materials[drug.element[atom]], base, apex, BOND_RADIUS)


def add_still_life(stage):
    """The floor without end, the stand with its mirror, the glass and mirror spheres, the globe and the cone."""
    floor = stage.place("Floor", stage.square, glossy_paint("Floor", "4f5c69", 0.05), (0, 0, 0), 1)
    floor.conic.primitive = "PLANE"
    x, y, _ = DRUG_CENTER
    half = STAND_HEIGHT / 2
    stand = glossy_paint("Stand", "1d2733", 0.05)
    stage.place("Stand", stage.drum, stand, (x, y, half), (STAND_RADIUS, STAND_RADIUS, half))
    dark_mirror = mirror("Dark Mirror", (0.55, 0.58, 0.62))
    stage.place("Disc", stage.disc, dark_mirror, (x, y, STAND_HEIGHT + 0.001), 0.94 * STAND_RADIUS)
    glass = new_material("Glass", shader("BsdfGlass", Roughness=0.0, IOR=1.5))
    stage.place("Glass Sphere", stage.ball, glass, (1.3, -2.4, 0.82), 0.82)
    stage.place("Mirror Sphere", stage.ball, mirror("Mirror", (0.92, 0.93, 0.95)), (3.95, -0.2, 1.0), 1.0)
    stage.place("Cone", stage.cone, glossy_paint("Cone", "e8803a", 0.05), (3.0, -2.9, 0.525), (0.42, 0.42, 0.525))
    painted = shader("TexImage", image=new_image("Globe", globe(), is_float=False))
    earth = new_material("Globe", shader("BsdfPrincipled", Base_Color=painted, Roughness=0.05))
    stage.place("Globe", stage.ball, earth, (-4.55, 0.3, 0.85), 0.85, Euler((0.0, radians(23.0), radians(165.0))))


def glossy_paint(name, color, roughness):
    """Paint of a colour."""
    return new_material(name, shader("BsdfPrincipled", Base_Color=(*linear(color), 1.0), Roughness=roughness))


def mirror(name, color):
    return new_material(name, shader("BsdfGlossy", Color=(*color, 1.0), Roughness=0.0))


def studio_world():
    image = new_image("Studio", studio(linear("a9bccb"), linear("2f4a6b"), SOFTBOXES), is_float=True)
    return new_world("Studio", shader("Background", Color=shader("TexEnvironment", image=image), Strength=1.0))


if __name__ == "__main__":
    main()
