"""NFF files out: round trips, and what the format cannot hold."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.engine import Camera, Instances, Light, Material, Scene, SceneError, Triangles, World
from addon.engine.material import surface_image
from addon.engine.nff import read_nff, write_nff
from tests.unit.shape_arrays import areas, corners, shapes

NUMBER = st.floats(-1e5, 1e5, allow_subnormal=False).map(lambda x: round(x, 9))


@st.composite
def scenes(draw):
    """Scenes that NFF can hold, of all kinds of primitives."""
    random = np.random.default_rng(draw(st.integers(0, 1 << 32)))
    camera = Camera.look_at(
        random.normal(size=3) * 10.0 ** random.uniform(-4, 5),
        random.normal(size=3),
        random.normal(size=3),
        random.uniform(1.0, 170.0),
        aspect=1.5,
        clip=(random.uniform(0.0, 2.0), 1e30),
    )
    scene = Scene(camera=camera, world=World(color=tuple(random.random(3))))
    for _ in range(draw(st.integers(0, 3))):
        scene.add_light(Light.constant(random.normal(size=3), random.random(3)))
    for transmit in (0.0, 0.5):
        mirror = random.random()
        material = Material(
            diffuse=random.random(3), reflect=mirror, highlight=mirror, shine=random.random() * 99.0,
            transmit=transmit, ior=random.uniform(1.0, 2.0), fresnel=False,
        )  # fmt: skip
        index, n = scene.add_material(material), draw(st.integers(1, 5))
        a, b, c = 10.0 ** random.uniform(-4, 5) * random.normal(size=(3, n, 3))
        sign = np.where(random.random(n) < 0.5, -1.0, 1.0)
        scene.add_spheres(a, sign * random.uniform(0.1, 1.0, n), index)
        scene.add_cylinders(a, b, sign * random.uniform(0.1, 1.0, n), index, caps=False)
        scene.add_cones(a, b, sign * random.uniform(0.1, 0.5, n), sign * random.uniform(0.6, 1.0, n), index, caps=False)
        scene.add_triangles(a, b, c, index, one_sided=int(transmit == 0.0))
        normals = random.normal(size=(3, n, 3))
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        scene.add_triangles(a, c, b, index, one_sided=int(transmit == 0.0), n0=normals[0], n1=normals[1], n2=normals[2])
    return scene


@given(scenes())
def test_round_trip(tmp_path_factory, scene):
    path = tmp_path_factory.mktemp("nff") / "scene.nff"
    write_nff(scene, path, 60, 40)
    file = read_nff(path)
    assert (file.width, file.height) == (60, 40)
    back = file.scene
    assert back.materials == scene.materials
    assert back.lights == scene.lights
    assert back.world == scene.world
    np.testing.assert_allclose(back.camera.matrix, scene.camera.matrix, rtol=1e-12, atol=1e-11)
    np.testing.assert_allclose(back.camera.window, scene.camera.window, rtol=1e-12)
    assert back.camera.clip == scene.camera.clip
    for (_, before), (_, after) in zip(scene.shapes.kinds(), back.shapes.kinds(), strict=True):
        names = [c.name for c in before.columns if not c.name.startswith(("uv", "meridian", "pole"))]
        np.testing.assert_allclose(_sorted_rows(after, names), _sorted_rows(before, names), rtol=1e-13, atol=1e-15)


def _sorted_rows(primitives, names):
    rows = np.concatenate([np.reshape(getattr(primitives, name), (len(primitives), -1)) for name in names], axis=1)
    return rows[np.lexsort(np.round(rows, 9).T)]


def test_two_sided_opaque_triangles_are_written_both_ways(tmp_path):
    scene = Scene(camera=Camera.look_at((0, -5, 0), (0, 0, 0)))
    scene.add_material(Material(fresnel=False))
    scene.add_triangles([(0, 0, 0)], [(1, 0, 0)], [(0, 0, 1)])
    write_nff(scene, tmp_path / "a.nff", 8, 8)
    found = shapes(read_nff(tmp_path / "a.nff").scene, Triangles)
    normals = areas(corners(found))
    assert found.one_sided.all()
    np.testing.assert_allclose(normals, [(0, -0.5, 0), (0, 0.5, 0)])


def _plain_scene():
    scene = Scene(camera=Camera.look_at((0, -5, 0), (0, 0, 0)))
    scene.add_material(Material(fresnel=False))
    scene.add_spheres([(0, 0, 0)], 1.0)
    return scene


def _with_material(**values):
    def change(scene):
        scene.materials[0] = Material(**{"fresnel": False} | values)

    return change


def _with_camera(**values):
    def change(scene):
        scene.camera = Camera(**vars(scene.camera) | values)

    return change


CANNOT = {
    "Fresnel": _with_material(fresnel=True),
    "glow": _with_material(glow=1.0),
    "absorption": _with_material(absorption=1.0),
    "values that vary over the surface": _with_material(diffuse=surface_image(0)),
    "a coloured mirror": _with_material(reflect=(1, 0, 0)),
    "a coloured transmittance": _with_material(transmit=(1, 0, 0)),
    "a highlight other than the mirror": _with_material(reflect=1.0),
    "an orthographic camera": _with_camera(orthographic=True),
    "a camera with a shift": _with_camera(window=(-0.5, 1, -1, 1)),
    "a camera of aspect 2": _with_camera(window=(-2, 2, -1, 1)),
    "a far clip": _with_camera(clip=(0, 10)),
    "a scene without a camera": lambda scene: setattr(scene, "camera", None),
    "an image as the world": lambda scene: setattr(scene, "world", World(image=0)),
    "a light of kind SUN": lambda scene: scene.add_light(Light.sun((0, 0, 1), 1.0)),
    "infinite planes": lambda scene: scene.add_plane([(0, 0, 0)], [(0, 0, 1)]),
    "discs": lambda scene: scene.add_discs([(0, 0, 0)], [(0, 0, 1)], 1.0),
    "instances": lambda scene: scene.instances.append(Instances(scene.shapes, np.eye(4))),
    "whose material is not in the scene": lambda scene: scene.add_spheres([(0, 0, 0)], 1.0, 1),
}


@pytest.mark.parametrize("what", CANNOT)
def test_what_nff_cannot_hold_is_named_and_nothing_written(tmp_path, what):
    scene = _plain_scene()
    write_nff(scene, tmp_path / "plain.nff", 8, 8)
    CANNOT[what](scene)
    with pytest.raises(SceneError, match="NFF cannot hold .*" + what):
        write_nff(scene, tmp_path / "wrong.nff", 8, 8)
    assert [path.name for path in tmp_path.iterdir()] == ["plain.nff"]
