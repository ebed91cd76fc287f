"""The light tree and the table of lights: structure, bounds, sums, groups."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine import Camera, Light, Material, Scene, layout, reference
from addon.engine.expression import call, component
from addon.engine.light_packing import lamp_bounds
from addon.engine.light_tree import ALL_SIDES, build_light_tree, merged_cones
from addon.engine.packing import pack
from addon.engine.primitives import Spheres, Triangles
from addon.engine.scene import Geometry, Instances, Visibility
from addon.engine.visibility import GROUPS


def lamps(count, seed=0):
    """Lights of all kinds in all directions."""
    rng = np.random.default_rng(seed)
    made = []
    for number, place in enumerate(rng.normal(size=(count, 3)) * 10.0):
        direction, watts = rng.normal(size=3), 10.0 ** rng.uniform(0.0, 3.0)
        made.append(
            (
                lambda p, d, w: Light.point(p, w, radius=0.2),
                lambda p, d, w: Light.spot(p, d, w, 1.0, 0.5),
                lambda p, d, w: Light.area(p, (1, 0, 0), (0, 1, 0), w, spread=2.0),
                lambda p, d, w: Light.sun(d, w, angle=0.2),
                lambda p, d, w: Light.constant(p, w),
                lambda p, d, w: Light.area(p, (1, 0, 0), (0.5, 1, 0), w, shape="ELLIPSE"),
            )[number % 6](place, direction, watts)
        )
    return made


def below(nodes, number):
    """The leaves below a node."""
    inside = np.arange(number, int(nodes["next"][number]))
    return inside[nodes["next"][inside] == inside + 1]


@pytest.mark.parametrize("count", [1, 2, 9, 100, 20000])
def test_every_light_is_a_leaf_once(count):
    bounds = lamp_bounds(lamps(count), np.zeros(3))
    nodes = build_light_tree(bounds)
    leaves = nodes[nodes["next"] == np.arange(len(nodes)) + 1]
    assert sorted(leaves["light"]) == list(range(count))
    assert len(nodes) == 2 * count - len(np.unique(bounds.group, axis=0))


def test_nodes_hold_what_is_below_them():
    made = lamps(200)
    bounds = lamp_bounds(made, np.zeros(3))
    nodes = build_light_tree(bounds)
    for number in range(len(nodes)):
        node, leaves = nodes[number], nodes[below(nodes, number)]
        assert np.allclose(node["color"], leaves["color"].sum(axis=0), rtol=1e-4)
        assert node["brightness"] == pytest.approx(node["color"].mean(), rel=1e-5)
        distance = np.linalg.norm(leaves["center"].astype(np.float64) - node["center"], axis=1)
        assert (distance + leaves["radius"] <= node["radius"] * (1 + 1e-4) + 1e-5 * np.abs(node["center"]).max()).all()
        if node["cos_axis"] > ALL_SIDES:
            turned = np.arccos(np.clip(leaves["axis"].astype(np.float64) @ node["axis"], -1.0, 1.0))
            assert (turned <= np.arccos(np.clip(node["cos_axis"], -1.0, 1.0)) + 1e-3).all()
        assert node["cos_reach"] == leaves["cos_reach"].min()
        assert len(np.unique(bounds.group[leaves["light"].astype(int)], axis=0)) == 1
        assert node["light"] in leaves["light"]


def test_lights_in_one_place_and_dark_ones():
    same = [Light.point((1, 2, 3), 10.0)] * 50 + [Light.point((0, 0, 0), 0.0)]
    nodes = build_light_tree(lamp_bounds(same, np.zeros(3)))
    assert len(nodes) == 99 and (nodes["radius"] == 0.0).all()
    assert len(build_light_tree(lamp_bounds([Light.point((0, 0, 0), 0.0)], np.zeros(3)))) == 0
    assert len(build_light_tree(lamp_bounds([], np.zeros(3)))) == 0


def test_merged_cones_hold_both():
    rng = np.random.default_rng(4)
    axis = rng.normal(size=(2000, 2, 3))
    axis[:100, 1] = axis[:100, 0]
    axis[100:200, 1] = -axis[100:200, 0]
    axis /= np.linalg.norm(axis, axis=-1, keepdims=True)
    half = rng.uniform(0.0, 2.5, (2000, 2))
    merged, cosine = merged_cones(axis, np.cos(half))
    assert np.allclose(np.linalg.norm(merged, axis=1), 1.0)
    turned = np.arccos(np.clip(np.einsum("nki,ni->nk", axis, merged), -1.0, 1.0))
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))[:, None]
    assert ((turned + half <= angle + 1e-6) | (angle > np.pi - 1e-6)).all()
    between = np.arccos(np.clip((axis[:, 0] * axis[:, 1]).sum(axis=1), -1.0, 1.0))
    apart = half.max(axis=1) < half.min(axis=1) + between
    least = np.minimum((half.sum(axis=1) + between) / 2.0, np.pi)
    assert np.allclose(angle[apart, 0], least[apart], atol=1e-5), "no larger than they must be"


@pytest.mark.parametrize("wide", [False, True])
def test_stretched_spots_lie_within_their_cones(wide):
    rng = np.random.default_rng(5)
    for _ in range(20):
        axes, angle = rng.normal(size=(3, 3)), np.pi if wide else rng.uniform(0.1, 3.0)
        bounds = lamp_bounds([Light.spot((0, 0, 0), None, 1.0, angle, axes=axes)], np.zeros(3))
        local = rng.normal(size=(5000, 3))
        local = local[local[:, 2] / np.linalg.norm(local, axis=1) > np.cos(angle / 2.0)]
        world = local @ np.linalg.inv(axes).T
        cosine = world @ bounds.axis[0] / np.linalg.norm(world, axis=1)
        assert cosine.min() > bounds.cos_reach[0]


def scene_of(*glows, lights=(), **material):
    scene = Scene(camera=Camera.look_at((0, -5, 0), (0, 0, 0)), lights=list(lights))
    scene.materials = [Material(), *(Material(glow=glow, **material) for glow in glows)]
    return scene


def packed(scene):
    return pack(scene, 8192)


def table(pack_of, name, count):
    record = getattr(layout, name.upper())
    texels = pack_of.textures["tables"].reshape(-1, 4)[pack_of.frame[f"{name}_first"] :]
    return texels[: count * record.texels].reshape(-1).view(record.dtype)[:count]


def test_few_lights_have_no_tree():
    assert "HAS_LIGHT_TREE" not in packed(scene_of(lights=lamps(8))).features
    of_many = packed(scene_of(lights=lamps(9)))
    assert {"HAS_LIGHT_TREE", "HAS_LIGHT_SHAPES"} <= of_many.features
    assert of_many.frame["light_count"] == 9 and of_many.frame["light_cut_end"] == of_many.frame["light_node_count"]


def test_what_glows_is_a_light_and_what_glows_not_at_all_is_none():
    scene = scene_of((0, 0, 0), (1, 2, 3), lights=lamps(2))
    scene.add_spheres([(0, 0, 0), (1, 0, 0), (2, 0, 0)], 0.5, [0, 1, 2])
    made = packed(scene)
    assert made.frame["emitter_count"] == 1 and "HAS_EMITTERS" in made.features
    light = table(made, "light", 3)[2]
    assert light["position"].tolist() == [2, 0, 0] and np.allclose(light["color"], [0.25, 0.5, 0.75])
    assert light["visibility"] == Visibility.ALL & ~Visibility.CAMERA
    assert "HAS_EMITTERS" not in packed(scene_of((0, 0, 0))).features


def test_slots_of_instances_say_what_glows():
    scene = scene_of((1, 1, 1))
    matrices = np.tile(np.eye(4), (5, 1, 1))
    matrices[:, 0, 3] = np.arange(5)
    geometry = Geometry(Spheres(center=[(0, 0, 0), (0, 1, 0)], radius=0.1, material=[0, 1]))
    scene.instances = [Instances(geometry, matrices, (0, 1)), Instances(geometry, matrices, (0, 0))]
    made = packed(scene)
    assert made.frame["emitter_count"] == 5
    assert sorted(table(made, "light", 5)["position"][:, 0].tolist()) == [0, 1, 2, 3, 4]
    scene.instances[0] = replace(scene.instances[0], visibility=Visibility.CAMERA | Visibility.SHADOW)
    assert packed(scene).frame["emitter_count"] == 0


@pytest.mark.parametrize("how", ["shared", "one side", "a plane too"])
def test_rays_and_samples_share_what_all_of_is_a_light(how):
    """By the mean area of a material's primitives; else rays alone find it."""
    scene = scene_of((1, 1, 1), emission="FRONT" if how == "one side" else "BOTH")
    scene.add_spheres([(0, 0, 0), (1, 0, 0)], [0.1, 0.3], 1)
    if how == "a plane too":
        scene.add_plane((0, 0, -1), (0, 0, 1), 1)
    made = packed(scene)
    wanted = np.pi * (0.1**2 + 0.3**2) / 2.0 if how == "shared" else 1e30
    assert table(made, "light_shape", 2)["seen_area"] == pytest.approx(np.full(2, wanted), rel=1e-6)
    assert table(made, "material", 2)["glow_area"] == pytest.approx([1e30, wanted], rel=1e-6)


def test_sides():
    corners = {"p0": (0, 0, 0), "p1": (1, 0, 0), "p2": (0, 1, 0), "material": 1}
    for emission, one_sided, expected in [
        ("BOTH", 0, [0]), ("FRONT", 0, [1]), ("BACK", 0, [-1]), ("NONE", 0, []), ("BOTH", 1, [1]), ("BACK", 1, []),
    ]:  # fmt: skip
        scene = scene_of((1, 1, 1), emission=emission)
        scene.add(Triangles(**corners, one_sided=one_sided))
        made = packed(scene)
        assert table(made, "light", int(made.frame["emitter_count"]))["sides"].tolist() == expected


def test_glow_that_varies_is_asked_where_the_shadow_ray_ends():
    scene = scene_of(component(call("point_uv"), 0))
    scene.add_discs((0, 0, 0), (0, 0, 1), 1.0, 1)
    made = packed(scene)
    assert "HAS_VARYING_EMITTERS" in made.features and made.shadows_pass["OPAQUE"]


def test_planes_that_glow_are_named():
    scene = scene_of((1, 1, 1))
    scene.add_plane((0, 0, 0), (0, 0, 1), 1)
    assert any("infinite plane" in warning for warning in packed(scene).warnings)


def test_groups():
    last = Visibility.group(GROUPS - 1)
    scene = scene_of(lights=[replace(lamps(1)[0], receivers=Visibility.group(0), blockers=last)])
    made = packed(scene)
    assert {"HAS_LIGHT_LINKING", "HAS_VISIBILITY"} <= made.features
    light = table(made, "light", 1)[0]
    assert int(light["blockers"]) == last and int(light["receivers"]) == Visibility.group(0)
    assert last * 2 <= 1 << reference.LOW_BITS, "the integers of records hold them all"
    with pytest.raises(ValueError, match=f"there are {GROUPS} groups, no number {GROUPS}"):
        Visibility.group(GROUPS)
