"""File > Import > Neutral File Format: what the sync makes of the imported objects is what the engine reads itself."""

import bpy
import numpy as np
import pytest

from addon import operators
from addon.engine import LightKind, render
from addon.engine.nff import read_nff, write_nff
from examples.standard_scenes import balls, mount, tree
from tests.blender.building import Constants, sync

VIEW = "v\nfrom 1 -8 3\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0.5\nresolution 64 48\n"
HEAD = "b 0.1 0.2 0.4\n" + VIEW + "l 5 -6 7\n"
RED = "f 1 0.5 0.25 0.8 0 1 0 1\n"
GLASS = "f 1 1 1 0.1 0.2 30 0.9 1.5\n"
ALL_KINDS = (
    HEAD
    + RED
    + "s -2 0 0 0.5\ns -2 0 1 -0.25\n"
    + "c -1 0 0 0.3  -1 0.5 1 0.3\nc 0 0 0 0.3  0 0.2 1 0.1\nc 1 0 0 0  1 0 1 0.3\nc 2 0 0 -0.3  2 0 1 -0.2\n"
    + "p 4 -3 -1 -1 3 -1 -1 3 3 -1 -3 3 -1\n"
    + "p 5 -1 2 0 1 2 0 1 2 2 0 2 1 -1 2 2\n"
    + "pp 3 2 1 0 0.1 -1 0.2  3 1 0 0 -1 0.1  2 1 1 -0.1 -1 0.2\n"
    + GLASS
    + "s 0 -1 0.2 0.4\np 3 2.2 -1 0 3 -1 0 2.6 -1 1\n"
)


@pytest.fixture
def imports(tmp_path):
    """Imports NFF text, or an engine scene, and gives back what the engine reads of it."""

    def run(text, name="scene", **options):
        path = tmp_path / f"{name}.nff"
        if isinstance(text, str):
            path.write_text(text)
        else:
            write_nff(text, path, 64, 64)
        assert bpy.ops.import_scene.nff(filepath=str(path), **options) == {"FINISHED"}
        return read_nff(path)

    return run


def in_world(scene, kind):
    """The primitives of a kind, wherever they stand: their numbers (n, k) in world space, and their Materials.

    Spheres have center and radius, cylinders and cones both ends with their radii, the wider end first.
    """
    rows, materials = [], []
    blocks = [(scene.shapes, np.eye(4)[None], None)]
    blocks += [(block.geometry, np.asarray(block.matrices), block.materials) for block in scene.instances]
    for geometry, matrices, slots in blocks:
        for part in (part for _, part in geometry.kinds() if part.kind == kind):
            numbers = np.asarray(part.material)
            materials += [scene.materials[n if slots is None else slots[n]] for n in np.tile(numbers, len(matrices))]
            rows += [_moved(part, matrix) for matrix in matrices]
    return np.concatenate(rows), materials


def _moved(part, matrix):
    def points(values):
        return values @ matrix[:3, :3].T + matrix[:3, 3]

    if part.kind == "sphere":
        return np.column_stack([points(part.center), part.radius * np.linalg.norm(matrix[:3, 0])])
    if part.kind == "triangle":
        return np.concatenate([points(part.p0), points(part.p1), points(part.p2)], axis=1)
    radii = (part.radius, part.radius) if part.kind == "cylinder" else (part.base_radius, part.apex_radius)
    axis = part.apex - part.base
    across = np.cross(axis, np.eye(3)[np.abs(axis).argmin(axis=1)])
    across = np.linalg.norm(across @ matrix[:3, :3].T, axis=1) / np.linalg.norm(across, axis=1)
    ends = [np.column_stack([points(p), r * across]) for p, r in zip((part.base, part.apex), radii, strict=True)]
    return np.where((ends[0][:, 3] >= ends[1][:, 3])[:, None], np.hstack(ends), np.hstack(ends[::-1]))


def assert_same(found, expected, atol=2e-5):
    """The same primitives with the same materials, in any order; a kind without any is not there."""
    (rows, materials), (wanted, wanted_materials) = found, expected
    assert rows.shape == wanted.shape
    distance = np.abs(rows[:, None] - wanted[None]).max(axis=2)
    nearest = distance.argmin(axis=0)
    assert sorted(nearest) == list(range(len(rows)))
    assert distance.min(axis=0).max() < atol
    for place, material in zip(nearest, wanted_materials, strict=True):
        assert_same_material(materials[place], material)


def assert_same_material(found, expected):
    """All that shows: the shares, and the highlight by its coat; the index of an opaque body does not."""
    found = Constants(found)
    highlight = np.multiply(found.coat, ((found.coat_ior - 1.0) / (found.coat_ior + 1.0)) ** 2)
    for name, share in (("diffuse", found.diffuse), ("reflect", found.metallic), ("transmit", found.transmit)):
        seen = np.multiply(share, 1.0 - highlight)
        np.testing.assert_allclose(seen, getattr(expected, name), atol=2e-4, err_msg=name)
    assert found.metallic == found.grazing and not found.roughness
    assert found.fresnel_ior == 1.0 or not any(found.reflect), "nothing by Fresnel but the highlight"
    assert any(found.coat) == any(expected.highlight)
    if any(expected.highlight):
        # GGX is at half its height where Phong's lobe is: the half vector turns half as much as the direction.
        alpha, cosine = found.coat_roughness**2, np.cos(np.arccos(0.5 ** (1.0 / expected.shine)) / 2.0)
        assert alpha**4 / (cosine**2 * (alpha**2 - 1.0) + 1.0) ** 2 == pytest.approx(0.5, rel=1e-2)
        peak = highlight / (4.0 * alpha**2)
        assert peak == pytest.approx(expected.highlight, rel=1e-3) or highlight == pytest.approx((0.2,) * 3, rel=1e-3)
    if any(expected.transmit):
        assert found.ior == pytest.approx(expected.ior, rel=1e-5)


def test_few_spheres_are_objects_with_one_mesh(imports):
    file = imports(balls(1))
    spheres = [obj for obj in bpy.data.objects if obj.conic.primitive == "SPHERE"]
    assert len(spheres) == 10 and len({obj.data for obj in spheres}) == 1
    scene = sync().scene
    assert_same(in_world(scene, "sphere"), in_world(file.scene, "sphere"))
    assert_same(in_world(scene, "triangle"), in_world(file.scene, "triangle"))


def test_many_spheres_are_one_point_cloud(imports):
    file = imports(balls(3))
    clouds = [obj for obj in bpy.data.objects if obj.name.startswith("Spheres")]
    assert len(clouds) == 1 and len(bpy.data.objects) == 1 + 1 + 3 + 1  # with polygons, lights and camera
    if "resize" in bpy.types.PointCloud.bl_rna.functions:
        assert clouds[0].type == "POINTCLOUD"
    assert_same(in_world(sync().scene, "sphere"), in_world(file.scene, "sphere"))


@pytest.mark.parametrize("limit", [200, 10])
def test_cones_are_objects_or_instances(imports, limit):
    file = imports(tree(4), object_limit=limit)
    cones = [obj for obj in bpy.data.objects if obj.name.startswith("Cone")]
    assert len(cones) == (31 if limit == 200 else 1) and len({obj.data for obj in cones}) == 1
    assert_same(in_world(sync().scene, "cone"), in_world(file.scene, "cone"))


def test_cylinders_along_every_direction_are_exact(imports):
    ends = np.random.default_rng(5).normal(size=(60, 2, 3))
    ends[:6, 0], ends[:6, 1] = 0.0, np.concatenate([np.eye(3), -np.eye(3)])
    ends[6, 1] = ends[6, 0] + (0.0, 1e-7, -1.0)
    lines = [f"c {b[0]!r} {b[1]!r} {b[2]!r} 0.1 {a[0]!r} {a[1]!r} {a[2]!r} 0.1" for b, a in ends.tolist()]
    for limit in (100, 0):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        file = imports(HEAD + RED + "\n".join(lines), object_limit=limit)
        rows, materials = in_world(sync().scene, "cylinder")
        wanted, wanted_materials = in_world(file.scene, "cylinder")
        swapped = np.abs(rows[:, None] - wanted).max(axis=2).min(axis=1) > 1e-3  # which end is first says nothing
        rows[swapped] = rows[swapped][:, [4, 5, 6, 7, 0, 1, 2, 3]]
        assert_same((rows, materials), (wanted, wanted_materials))


def test_all_kinds_become_what_the_engine_reads(imports):
    file = imports(ALL_KINDS)
    scene = sync().scene
    spheres, materials = in_world(file.scene, "sphere")
    outside = spheres[:, 3] > 0.0
    wanted = spheres[outside], [m for m, keep in zip(materials, outside, strict=True) if keep]
    assert_same(in_world(scene, "sphere"), wanted)
    assert_same(in_world(scene, "cylinder"), in_world(file.scene, "cylinder"))
    cones, materials = in_world(file.scene, "cone")
    assert_same(in_world(scene, "cone"), (cones[cones[:, 3] > 0.0], materials[:2]))


def test_what_is_seen_from_inside_only_is_a_mesh_that_faces_inwards(imports):
    imports(HEAD + RED + "s 1 2 3 -2\nc 0 0 0 -1 0 0 2 -0.5\n")
    inside = [obj for obj in bpy.data.objects if obj.name.endswith("inside")]
    assert {obj.conic.primitive for obj in inside} == {"MESH"}
    for obj in inside:
        assert obj.data.materials[0].use_backface_culling and not obj.data.materials[0].use_backface_culling_shadow
        faces = obj.data.polygons
        sides = [face.normal.to_2d().dot(face.center.to_2d()) for face in faces if face.center.to_2d().length > 0.3]
        assert len(sides) >= 32 and max(sides) < 0.0
        assert not obj.data.validate()


@pytest.mark.parametrize(
    "numbers",
    [
        "1 0.9 0.7 0.5 0.5 3.0827 0 1",
        "1 1 1 0.1 0.1 101.148 0.9 1.5",
        "0.2 0.4 0.8 1 0 100000 0 0",
        "1 1 1 0.5 0.5 50000 0 1",
        "0.9 0.8 0.7 0.6 0.3 20 0 1",
        "0.9 0.8 0.7 0.6 0.3 400 0.2 1",
        "1 1 1 0 0.3 7 0.7 1.3",
        "0 0 0 0 0 1 0 1",
    ],
)
def test_materials_keep_their_shares(imports, numbers):
    file = imports(HEAD + f"f {numbers}\ns 0 0 0 1\n")
    scene = sync().scene
    assert_same(in_world(scene, "sphere"), in_world(file.scene, "sphere"))


def test_materials_that_differ_in_colour_are_each_their_own(imports):
    colors = [(1.0, 0.0, 0.0), (0.0, 0.5, 1.0), (0.2, 0.2, 0.2), (0.0, 0.0, 0.0)]
    rows = [f"f {r} {g} {b} 0.5 0.25 3 0 1\ns {3 * i} 0 0 1\n" for i, (r, g, b) in enumerate(colors)]
    file = imports(HEAD + "".join(rows))
    assert_same(in_world(sync().scene, "sphere"), in_world(file.scene, "sphere"))
    assert [material.name for material in bpy.data.materials] == [f"scene {i + 1}" for i in range(4)]
    assert len({obj.data for obj in bpy.data.objects if obj.type == "MESH"}) == len(bpy.data.meshes) == 4


LIGHTS = "l -4 0 3 2 0.5 0\n" + RED + "s 1 1 1 1\ns -1 -1 -1 1\n"


def test_lights_are_the_files(imports):
    file = imports(HEAD + LIGHTS)
    synced = sync()
    for light, wanted in zip(synced.scene.lights, file.scene.lights, strict=True):
        assert light.kind == wanted.kind == LightKind.CONSTANT and light.shadow == wanted.shadow
        np.testing.assert_allclose(light.position, wanted.position, rtol=1e-6)
        np.testing.assert_allclose(light.color, wanted.color, rtol=1e-5)
    assert not synced.messages


def test_lights_that_fade_are_right_in_the_middle_of_the_scene(imports):
    imports(HEAD + LIGHTS, use_falloff=True)
    lights = sync().scene.lights
    assert {light.kind for light in lights} == {LightKind.POINT}
    np.testing.assert_allclose([light.position for light in lights], [(5, -6, 7), (-4, 0, 3)], rtol=1e-6)
    seen = [np.divide(light.color, np.dot(light.position, light.position)) for light in lights]
    np.testing.assert_allclose(seen, [(0.5**0.5,) * 3, (2.0, 0.5, 0.0)], rtol=1e-5)


def test_lights_do_not_fade_in_cycles(imports):
    """By the formula of Cycles' Light Falloff node: constant is strength times the squared distance."""
    imports(HEAD + RED + "s 1 1 1 1\ns -1 -1 -1 1\n")
    light = next(obj.data for obj in bpy.data.objects if obj.type == "LIGHT")
    nodes = light.node_tree.nodes
    falloff = next(node for node in nodes if node.type == "LIGHT_FALLOFF")
    (link,) = falloff.outputs["Constant"].links
    assert link.to_socket.name == "Strength"
    radiance = light.energy * falloff.inputs["Strength"].default_value / (4.0 * np.pi**2)
    assert radiance == pytest.approx(1.0, rel=1e-5)


@pytest.mark.parametrize("angle", [1, 40, 178])
def test_camera_background_and_size_are_the_views(imports, angle):
    file = imports(ALL_KINDS.replace("angle 40", f"angle {angle}"))
    render_settings = bpy.context.scene.render
    assert (render_settings.resolution_x, render_settings.resolution_y) == (64, 48)
    scene = sync(64, 48).scene
    np.testing.assert_allclose(scene.camera.matrix, file.scene.camera.matrix, atol=1e-6)
    np.testing.assert_allclose(scene.camera.window, file.scene.camera.window, rtol=1e-5)
    assert scene.camera.clip[0] == pytest.approx(0.5) and scene.camera.clip[1] > 100.0
    np.testing.assert_allclose(scene.world.color.value, (0.1, 0.2, 0.4), rtol=1e-6)


def test_a_scene_without_a_world_gets_one_that_lights_nothing(imports, capfd):
    assert bpy.context.scene.world is None
    imports(ALL_KINDS)
    said = capfd.readouterr()
    assert "Traceback" not in said.out + said.err
    assert not bpy.context.scene.world.cycles_visibility.diffuse


def test_options_leave_the_scenes_own(imports):
    before = bpy.context.scene.render.resolution_x
    imports(ALL_KINDS, use_camera=False, use_lights=False, use_background=False, use_resolution=False)
    scene = bpy.context.scene
    assert scene.camera is None and scene.world is None and scene.render.resolution_x == before
    assert {obj.type for obj in bpy.data.objects} == {"MESH"}


def test_polygons_stay_whole_and_opaque_ones_have_one_side(imports):
    imports(ALL_KINDS)
    meshes = {obj.name: obj.data for obj in bpy.data.objects if obj.name.startswith(("Polygons", "Patches"))}
    sizes = {name: [face.loop_total for face in mesh.polygons] for name, mesh in meshes.items()}
    assert sizes == {"Polygons": [4, 5], "Polygons.001": [3], "Patches": [3]}
    culled = {name: mesh.materials[0].use_backface_culling for name, mesh in meshes.items()}
    assert culled == {"Polygons": True, "Polygons.001": False, "Patches": True}
    sphere = next(obj for obj in bpy.data.objects if obj.name == "Sphere")
    assert not sphere.data.materials[0].use_backface_culling
    assert not any(face.use_smooth for face in meshes["Polygons"].polygons)
    assert not any(mesh.validate() for mesh in meshes.values())


def test_patches_keep_their_normals(imports):
    file = imports(ALL_KINDS)
    mesh = bpy.data.objects["Patches"].data
    normals = np.array([normal.vector for normal in mesh.corner_normals])
    np.testing.assert_allclose(normals, file.polygons[1].normals, atol=1e-3)


def test_shared_corners_are_one_vertex_and_backs_stay(imports):
    """A folded pair, the back of one of them, and a polygon with a corner given twice."""
    corners = ("0 0 0", "1 0 0", "0 1 0", "0 0 1")
    faces = ((0, 1, 2), (0, 3, 1), (2, 1, 0), (0, 0, 1, 2))
    imports(HEAD + RED + "".join(f"p {len(f)} " + " ".join(corners[i] for i in f) + "\n" for f in faces))
    mesh = bpy.data.objects["Polygons"].data
    assert [len(f) for f in faces] == [face.loop_total for face in mesh.polygons]
    assert len(mesh.vertices) == 4 + 3 + 4
    assert mesh.polygons[2].normal.z == pytest.approx(-1.0)


def test_nothing_is_made_of_files_with_a_mistake(imports, tmp_path):
    good, bad = tmp_path / "good.nff", tmp_path / "bad.nff"
    good.write_text(ALL_KINDS)
    bad.write_text(HEAD + RED + "s 0 0 0 1\ns 0 0 x 1\n")
    for message, names in (
        (r"bad\.nff:12: unknown record 'x'", ("good.nff", "bad.nff")),
        (r"missing\.nff: cannot be read", ("good.nff", "missing.nff")),
    ):
        with pytest.raises(RuntimeError, match=message):
            bpy.ops.import_scene.nff(directory=str(tmp_path), files=[{"name": name} for name in names])
        made = (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.collections, bpy.data.worlds)
        assert not any(len(data) for data in made)


def test_several_files_have_a_collection_each(tmp_path):
    for name, text in (("one", ALL_KINDS), ("two", HEAD.replace("0.4", "0.9") + RED + "s 0 0 0 1\n")):
        (tmp_path / f"{name}.nff").write_text(text)
    bpy.ops.import_scene.nff(directory=str(tmp_path), files=[{"name": "one.nff"}, {"name": "two.nff"}])
    scene = bpy.context.scene
    assert [collection.name for collection in scene.collection.children] == ["one", "two"]
    assert scene.camera.name in bpy.data.collections["one"].objects
    assert scene.world.name == "one"
    assert set(bpy.context.selected_objects) == set(bpy.data.objects)


@pytest.mark.parametrize("make", [lambda: balls(2), lambda: mount(3), lambda: tree(3)], ids=["balls", "mount", "tree"])
@pytest.mark.parametrize("limit", [1000, 1])
def test_pictures_are_those_of_the_file(imports, make, limit):
    pytest.importorskip("moderngl", reason="the application does not have it")
    file = imports(make(), object_limit=limit)
    found, wanted = (render(each, 64, 64).pixels[..., :3] for each in (sync(64, 64).scene, file.scene))
    error = np.abs(found - wanted).max(axis=-1)
    assert np.ptp(wanted) > 0.3, "the picture shows something"
    assert np.median(error) < 0.005 and error.mean() < 0.015
    assert np.quantile(error, 0.98) < 0.15, "highlights, which are dimmer, and mirrors near the edge"


def test_menu_and_drop_are_there_while_registered():
    def entries():
        return [f.__name__ for f in bpy.types.TOPBAR_MT_file_import._dyn_ui_initialize()]

    assert entries().count("draw_entry") == 1
    handler = bpy.types.IMPORT_SCENE_FH_nff
    assert handler.bl_file_extensions == ".nff" and handler.bl_import_operator == "import_scene.nff"
    operator = bpy.ops.import_scene.nff.get_rna_type()
    assert all(p.description for p in operator.properties if p.identifier.startswith(("use_", "object_")))
    assert bpy.types.IMPORT_SCENE_OT_nff.bl_options == {"REGISTER", "UNDO", "PRESET"}
    operators.unregister()
    try:
        assert "draw_entry" not in entries()
        assert not hasattr(bpy.types, "IMPORT_SCENE_FH_nff")
    finally:
        operators.register()
