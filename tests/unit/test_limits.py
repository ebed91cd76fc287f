"""What does not fit a device is refused from counts alone: before a tree is built or a texture's memory is taken."""

import re

import numpy as np
import pytest

from addon.engine import bvh, data_texture, image_packing, layout, reference
from addon.engine.errors import SceneError
from addon.engine.material import surface_attribute
from addon.engine.packing import pack
from addon.engine.plan import make_plan
from addon.engine.primitives import BY_KIND, Cylinders, Discs, Spheres, Triangles
from addon.engine.residency import Residency
from addon.engine.scene import Camera, Geometry, Image, Instances, Material, Scene

ADVICE = "render it in parts, with fewer of them, or on a device with larger textures"


@pytest.fixture
def nothing_is_built(monkeypatch):
    def refuse(*_, **__):
        raise AssertionError("built or allocated before the limits were checked")

    monkeypatch.setattr(bvh, "build", refuse)
    monkeypatch.setattr(data_texture, "zeros", refuse)
    monkeypatch.setattr(image_packing, "pack_images", refuse)


def scene_of(*parts, instances=(), **material):
    scene = Scene(camera=Camera.look_at((0, -5, 0), (0, 0, 0)), materials=[Material(**material)])
    scene.instances = list(instances)
    for part in parts:
        scene.add(part)
    return scene


def spheres(count, **columns):
    return Spheres(center=np.zeros((count, 3)), radius=1.0, **columns)


def triangles(count):
    return Triangles(p0=np.zeros((count, 3)), p1=[1.0, 0, 0], p2=[0, 1.0, 0])


def copies(geometry, count, **rest):
    return Instances(geometry, np.broadcast_to(np.eye(4), (count, 4, 4)), **rest)


ENDS = np.ones((900, 2, 4))
LARGE = {
    "spheres": (scene_of(spheres(4097)), "4097 spheres need 4097 texels"),
    "discs": (scene_of(Discs(center=np.zeros((2049, 3)), normal=[0, 0, 1], radius=1)), "2049 discs need 4098 texels"),
    "triangles": (scene_of(triangles(1100)), "1100 triangles need 4400 texels"),
    "in two geometries": (
        scene_of(spheres(3000), instances=[copies(Geometry(spheres(2000)), 1)]),
        "5000 spheres need 5000 texels",
    ),
    "instances": (
        scene_of(instances=[copies(Geometry(spheres(1)), 300), copies(Geometry(spheres(2)), 300)]),
        "600 instances need 4800 texels",
    ),
    "attributes": (
        scene_of(
            Cylinders(base=np.zeros((900, 3)), apex=[0, 0, 1.0], radius=1, attributes=dict.fromkeys("abc", ENDS)),
            **{name: surface_attribute(key) for name, key in {"diffuse": "a", "glow": "b", "reflect": "c"}.items()},
        ),
        "the values of 3 attributes need 5400 texels",
    ),
    "nodes": (scene_of(spheres(1100)), "the trees of 1100 shapes need 4396 texels"),
}


@pytest.mark.parametrize("name", LARGE)
def test_what_is_too_large_is_named_before_anything_is_made(name, nothing_is_built):
    scene, message = LARGE[name]
    message = f"the scene is too large for this device: {message}, a texture here holds 4096; {ADVICE}"
    with pytest.raises(SceneError, match=re.escape(message)):
        pack(scene, 1)


def test_what_just_fits():
    assert pack(scene_of(spheres(1000)), 1).textures["spheres"].shape == (1, 1000, 4)
    with pytest.raises(SceneError, match="4097 spheres"):
        pack(scene_of(spheres(4097)), 1)


def test_a_billion_is_refused_at_once(nothing_is_built):
    """Columns of one value take no memory, so that the number alone decides."""
    many = spheres(1).take(np.broadcast_to(np.zeros(1, int), 10**9))
    with pytest.raises(SceneError, match="1000000000 spheres need 1000000000 texels, a texture here holds 67108864"):
        pack(scene_of(many), 16384)


def test_numbers_of_texels_fit_the_integers_of_the_shader():
    assert data_texture.most_texels(16384) == 4096 * 16384
    assert data_texture.most_texels(1 << 30) == (1 << 31) - 1, "GLSL's int, whatever the device says"
    nodes = data_texture.most_texels(16384) // layout.NODE.texels
    assert nodes < 1 << reference.INDEX_BITS, "every node has a reference"


def test_what_references_cannot_count_is_refused(nothing_is_built):
    many = spheres(1).take(np.broadcast_to(np.zeros(1, int), 2**reference.INDEX_BITS + 1))
    with pytest.raises(SceneError, match=f"67108865 spheres need 67108865 texels, a texture here holds {2**26}"):
        pack(scene_of(many), 1 << 20)


@pytest.mark.parametrize("texels", [0, 1, 2**24 - 1, 2**24, 2**24 + 1, 50_000_001, 2**31 - 4097])
def test_records_begin_where_the_frame_can_say(texels):
    """The frame's floats hold whole numbers up to 2^24 only, and those of whole rows beyond."""
    start = data_texture.next_start(texels)
    assert texels <= start < texels + data_texture.WIDTH and int(np.float32(start)) == start
    assert start == texels or texels >= 2**24, "not a texel lost where few are used"


@pytest.mark.parametrize("seed", range(5))
def test_the_bound_of_nodes_holds(seed):
    rng = np.random.default_rng(seed)
    geometries = [Geometry(Spheres(center=rng.random((n, 3)), radius=0.5 / n)) for n in rng.integers(1, 50, 6)]
    geometries.append(Geometry(spheres(20), triangles(30)))
    scene = scene_of(*([spheres(3)] if seed % 2 else []), instances=[copies(g, 3) for g in geometries])
    plan, packed = make_plan(scene), pack(scene, 16384)
    assert packed.statistics["bvh"]["nodes"] <= plan.most_nodes
    assert plan.leaves == 21 + seed % 2 and plan.counts.shape == (8, len(BY_KIND))


def test_images_are_reduced_rather_than_refused():
    scene = scene_of(spheres(3))
    scene.images = [Image(np.zeros((100, 100, 4)), name="wood")]
    assert "was reduced to 50 x 50" in pack(scene, 1).warnings[0]


@pytest.mark.parametrize("name", ["sphere", "triangle", "node"])
def test_what_was_changed_often_is_packed_anew_before_references_run_out(name):
    """Arenas hold what was there before beside what comes: their ends count, not the number of shapes."""
    residency = Residency()
    most = 1 << reference.INDEX_BITS
    residency.arenas[name].end = most
    assert residency.fits(1 << 31)
    residency.arenas[name].end = most + 1
    assert not residency.fits(1 << 31)
