# SPDX-License-Identifier: GPL-3.0-or-later
"""47,681 atoms by the add-on Molecular Nodes: adenylate kinase in its box of water, opened.

make molecules      or, in the environment that it sets up:
python examples/molecular_nodes.py --output build/molecular_nodes.png [--engine CYCLES]

The structure is `adk_oplsaa` of MDAnalysis' tests: a protein among 11,084 molecules of water, of four sites each, and 4
sodium ions. The rhombic dodecahedron is the cell of the simulation, a nanometre to Blender's metre. All is drawn by
the add-on's own styles and its own material, and ray-traced as exact spheres and cylinders: Conic recognises the balls,
which are instances of ico spheres, and the bonds, which are one mesh of tubes.
"""

import sys
import warnings
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from examples.in_blender import arguments_given, empty_blender, finish, new_light, parser_of
from examples.painted_images import linear

#: The slice of water that is cut out, in angstroms: where its edge is on the y axis, how much x grows to its left and
#: right with the distance from there, where it is put.
SLICE_EDGE, SLICE_SPREAD, SLICE_MOVED = 14.0, (-0.75, 0.75), np.array((84.0, 6.0, 0.0), np.float32)
WATER, SLICE = ("b9d8ec", "5ea6d8"), ("eef5fa", "3f8fcc")  # hydrogen, oxygen
#: How thick things are, in parts of their van der Waals radii and in angstroms.
OPTIONS = {"spheres": {}, "ball_and_stick": {"scale": 0.38, "bond_scale": 0.45}, "sticks": {"scale": 0.3}}
#: The protein's parts by residue, as Schlauderer, Proba and Schulz (1996) name them: style, carbon.
DOMAINS = {
    "core": ("spheres", "d9c29a", "resid 1:29 60:121 160:214"),
    "nmp": ("ball_and_stick", "e07b39", "resid 30:59"),
    "lid": ("sticks", "c2415f", "resid 122:159"),
}
ELEMENTS = {"N": "2f5fd0", "O": "d23b2f", "S": "f0b429", "H": "f2f0ea", "Na": "8a5fd0"}
#: kind, location (of a sun: where it shines from), watts (of a sun: per square metre), color
LIGHTS = (
    ("SUN", (-5.0, -4.5, 7.5), 4.0, "ffeacf"),
    ("POINT", (9.0, -9.0, 6.0), 1400, "cfe0ff"),
    ("POINT", (0.0, -13.0, 5.0), 800, "fff6ea"),
    ("POINT", (-9.0, 5.0, 8.0), 1200, "ffe2c0"),
)


def main():
    parser = parser_of(__file__, __doc__.splitlines()[0], size=(1280, 720))
    parser.add_argument("--engine", default="CONIC", choices=("CONIC", "CYCLES"))
    options = parser.parse_args(arguments_given())
    try:
        import MDAnalysisTests.datafiles
        import molecularnodes
    except ImportError as error:
        sys.exit(f"molecular_nodes.py: {error}; 'make molecules' sets up what it needs and runs it")
    warnings.simplefilter("ignore")  # MDAnalysis' remarks on its own files
    empty_blender()
    molecularnodes.register()
    scene = build_scene(molecularnodes, MDAnalysisTests.datafiles)
    scene.render.engine = options.engine
    if options.engine == "CYCLES":
        scene.cycles.samples = options.samples
    finish(scene, options)


def build_scene(molecularnodes, files):
    """Build the picture in Blender's empty current scene, and return that: all but the resolution and the samples."""
    scene = bpy.context.scene
    scene.render.engine = "CONIC"
    add_molecule(molecularnodes, read_cell(files))
    add_floor(molecularnodes)
    for light in LIGHTS:
        bpy.context.scene.collection.objects.link(new_light(*light))
    scene.world = add_world()
    scene.camera = add_camera((3.6, -26.0, 12.0), (3.6, 0.0, 3.9))
    scene.render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform = "Standard"
    return scene


def read_cell(files):
    """The structure as an MDAnalysis Universe: the whole cell around the protein, on one of its faces, z upwards from
    0, the protein's two arms towards the camera."""
    import MDAnalysis

    universe = MDAnalysis.Universe(str(files.TPR), str(files.GRO), to_guess=())
    atoms = universe.atoms
    elements = ["Na" if name == "NA" else name.strip("0123456789")[0] for name in atoms.names]
    universe.add_TopologyAttr("elements", elements)
    protein = universe.select_atoms("protein")
    protein.unwrap()  # the file has it in pieces, across the borders of the cell
    position = atoms.positions - protein.positions.mean(axis=0)
    cell = universe.trajectory.ts.triclinic_dimensions
    # Each molecule of water where it is nearest to the protein: its first atom decides.
    first = np.unique(atoms.resindices, return_index=True)[1]
    shifts = np.stack(np.meshgrid(*[np.arange(-2, 3)] * 3), axis=-1).reshape(-1, 3) @ cell
    nearest = np.argmin(np.linalg.norm(position[first, None] + shifts, axis=-1), axis=1)
    nearest[np.unique(protein.resindices)] = len(shifts) // 2  # the protein stays whole
    position += shifts[nearest][atoms.resindices]
    arms = universe.select_atoms(" or ".join(f"({DOMAINS[name][2]})" for name in ("nmp", "lid"))).indices
    position = position @ turn(cell[2], position[arms].mean(axis=0)).T
    position[:, 2] -= position[:, 2].min() - 1.5
    atoms.positions = position
    return universe


def turn(up, front):
    """The rotation (3, 3) that takes the direction `up` to z, and `front` as far as it can towards -y."""
    z = up / np.linalg.norm(up)
    x = np.cross(z, -front)
    x /= -np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])


def add_molecule(molecularnodes, universe):
    """The cell as one object of Molecular Nodes: a style for each part, colours as an attribute of the atoms."""
    atoms = universe.atoms
    water = universe.select_atoms("resname SOL").indices
    slice_of = in_slice(atoms.positions[water], atoms.resindices[water])
    moved = atoms.positions
    moved[water[slice_of]] += SLICE_MOVED
    atoms.positions = moved
    molecule = molecularnodes.Molecule(universe, name="Adenylate kinase in water")
    material = paint(molecularnodes)
    colors = np.ones((len(atoms), 4), np.float32)
    for name, rows, carbon in parts(universe, water, slice_of):
        palette = {**ELEMENTS, "C": carbon} if isinstance(carbon, str) else dict(zip("HO", carbon, strict=True))
        for symbol, color in palette.items():
            colors[rows[atoms.elements[rows] == symbol], :3] = linear(color)
        selected = np.zeros(len(atoms), bool)
        selected[rows] = True
        molecule.store_named_attribute(selected, name=f"is_{name}")
    molecule.store_named_attribute(colors, name="Color", atype="FLOAT_COLOR")
    for name, (style, *_) in DOMAINS.items():
        molecule.add_style(style, selection=f"is_{name}", material=material, **OPTIONS[style])
    molecule.add_style("spheres", selection="is_sodium", material=material, scale=1.0)
    molecule.add_style("spheres", selection="is_water", material=material)
    molecule.add_style("ball_and_stick", selection="is_slice", material=material, **OPTIONS["ball_and_stick"])
    return molecule.object


def parts(universe, water, slice_of):
    """Yield name, rows and the colour of carbon, or those of hydrogen and oxygen, of each part of the cell."""
    for name, (_, carbon, residues) in DOMAINS.items():
        yield name, universe.select_atoms(f"protein and ({residues})").indices, carbon
    yield "sodium", universe.select_atoms("resname NA+").indices, ELEMENTS["Na"]
    yield "water", water[~slice_of], WATER
    yield "slice", water[slice_of], SLICE


def in_slice(position, residue):
    """Which atoms (n,) of water at position (n, 3) belong to the slice: whole molecules, by their first atoms."""
    _, first, of_atom = np.unique(residue, return_index=True, return_inverse=True)
    x, y, _ = position[first].T
    behind = SLICE_EDGE - y
    return ((x < behind * SLICE_SPREAD[1]) & (x > behind * SLICE_SPREAD[0]))[of_atom]


def paint(molecularnodes):
    """The add-on's own material without ambient occlusion, which no ray tracer needs, and with a little light of its
    own, where no lamp reaches."""
    material = molecularnodes.material.Default(roughness=0.4)
    material.ao.i.menu.default_value = "None"
    bsdf = material.bsdf.node
    tree = material.material.node_tree
    tree.links.new(bsdf.inputs["Base Color"].links[0].from_socket, bsdf.inputs["Emission Color"])
    bsdf.inputs["Emission Strength"].default_value = 0.08
    return material.material


def add_floor(molecularnodes):
    bpy.ops.mesh.primitive_plane_add(size=200.0)
    floor = bpy.context.object
    floor.conic.primitive = "PLANE"
    material = bpy.data.materials.new("Floor")
    bsdf = material.node_tree.nodes["Principled BSDF"]
    bsdf.inputs["Base Color"].default_value = (*linear("343e49"), 1.0)
    bsdf.inputs["Roughness"].default_value = 0.05
    floor.data.materials.append(material)


def add_world():
    world = bpy.data.worlds.new("Evening")
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (*linear("4d5f73"), 1.0)
    return world


def add_camera(eye, target):
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.lens = 50.0
    camera.location = eye
    camera.rotation_euler = (Vector(target) - Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(camera)
    return camera


if __name__ == "__main__":
    main()
