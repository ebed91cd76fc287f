"""Lights in Blender's units, the world, and cameras of renders and views."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix, Vector

from addon.engine.errors import SceneError
from addon.engine.scene import LightKind
from addon.sync.camera import camera_of_view
from addon.sync.settings import sync_settings
from tests.blender.building import add_camera, image, link, node, sync, value_of

SINCE_4_5 = pytest.mark.skipif(bpy.app.version < (4, 5, 0), reason="Blender 4.5 brought this property")


def light(kind, matrix=None, **settings):
    """The engine light of a Blender light, and the sync."""
    add_camera()
    data = bpy.data.lights.new("lamp", kind)
    for key, value in settings.items():
        setattr(data, key, value)
    obj = link(data, "lamp")
    if matrix is not None:
        obj.matrix_world = matrix
    synced = sync()
    (made,) = synced.scene.lights
    return made, synced


def test_point_light():
    made, synced = light("POINT", Matrix.Translation((1, 2, 3)), energy=100.0, color=(1.0, 0.5, 0.25))
    assert made.kind == LightKind.POINT and made.position == (1.0, 2.0, 3.0)
    # A white diffuse plane facing it at distance 2 has radiance 0.63326 in Cycles.
    assert np.array(made.color) / 4.0 == pytest.approx((0.6332574, 0.3166287, 0.1583143), rel=1e-5)
    assert not synced.messages


def test_sun():
    turned = Matrix.Translation((9, 9, 9)) @ Euler((0.3, -0.5, 2.0)).to_matrix().to_4x4()
    made, _ = light("SUN", turned, energy=3.0, angle=0.0)
    assert made.kind == LightKind.SUN
    np.testing.assert_allclose(made.position, turned.to_3x3() @ Vector((0, 0, 1)), atol=1e-6)
    assert made.color == pytest.approx((0.9549297,) * 3, rel=1e-5)  # as in Cycles


def test_balls():
    """A radius is not scaled with the object, as in Cycles."""
    made, synced = light("POINT", Matrix.Scale(3.0, 4), shadow_soft_size=0.5, use_soft_falloff=False)
    assert made.radius == 0.5 and not made.soft and not synced.messages


def test_spot():
    """As bright as a point of the same power in the middle of its cone, which is about -Z and stretched as it is."""
    turned = Euler((0.3, -0.5, 2.0)).to_matrix().to_4x4()
    stretched = turned @ Matrix.Diagonal((1.0, 2.0, 0.5, 1.0))
    made, synced = light("SPOT", stretched, energy=100.0, spot_size=1.0, spot_blend=0.25, shadow_soft_size=0.1)
    assert made.kind == LightKind.SPOT and made.soft and made.radius == pytest.approx(0.1) and not synced.messages
    assert made.color[0] / 4.0 == pytest.approx(0.6332574, rel=1e-5)
    assert (made.angle, made.blend) == pytest.approx((1.0, 0.25))
    for local in ((0, 0, -1), (0.1, 0.2, -0.7)):
        seen = np.array(made.axes) @ (stretched.to_3x3() @ Vector(local))
        assert seen / np.linalg.norm(seen) @ (0, 0, 1) == pytest.approx(-local[2] / np.linalg.norm(local), rel=1e-5)


@pytest.mark.parametrize(
    ("settings", "kind", "sides"),
    (
        ({"shape": "SQUARE", "size": 0.5, "size_y": 9.0}, LightKind.RECTANGLE, (1.0, 1.5)),
        ({"shape": "RECTANGLE", "size": 0.5, "size_y": 2.0}, LightKind.RECTANGLE, (1.0, 6.0)),
        ({"shape": "DISK", "size": 0.5, "size_y": 9.0}, LightKind.ELLIPSE, (1.0, 1.5)),
        ({"shape": "ELLIPSE", "size": 0.5, "size_y": 2.0}, LightKind.ELLIPSE, (1.0, 6.0)),
    ),
)
def test_area_lights(settings, kind, sides):
    turned = Euler((0.3, -0.5, 2.0)).to_matrix().to_4x4()
    made, synced = light("AREA", turned @ Matrix.Diagonal((2.0, 3.0, 4.0, 1.0)), energy=100.0, **settings)
    assert made.kind == kind and made.angle == np.pi and not synced.messages
    expected = np.array(turned.to_3x3()) @ np.diag([sides[0] / 2.0, sides[1] / 2.0, -1.0])
    np.testing.assert_allclose(np.transpose(made.axes), expected, atol=1e-5)
    assert made.color[0] / 4.0 == pytest.approx(2.53301, rel=1e-4)  # measured in Cycles, from far off


@pytest.mark.parametrize("kind", ("SUN", "SPOT", "AREA"))
def test_a_light_that_is_scaled_to_zero_is_named(kind):
    add_camera()
    link(bpy.data.lights.new("flat", kind), "flat", scale=(0.0, 0.0, 0.0))
    synced = sync()
    assert synced.warnings("'flat'", "gives no light") and not synced.scene.lights


@pytest.mark.parametrize("kind", ("POINT", "SUN", "SPOT", "AREA"))
def test_a_negative_light_is_named(kind):
    add_camera()
    lamp = link(bpy.data.lights.new("dark", kind), "dark")
    for energy, warned in ((-100.0, True), (0.0, False)):
        lamp.data.energy = energy
        synced = sync()
        assert bool(synced.warnings("'dark'", "negative")) == warned
        assert not warned or not synced.scene.lights


def test_a_camera_in_no_place_is_named():
    add_camera()
    bpy.context.scene.camera.location.x = float("nan")
    bpy.context.view_layer.update()
    with pytest.raises(SceneError, match="not finite"):
        sync()


@SINCE_4_5
def test_a_light_that_is_not_normalized_is_as_bright_as_its_size_in_the_world():
    made, _ = light("AREA", Matrix.Diagonal((2.0, 3.0, 4.0, 1.0)), energy=100.0, size=0.5, normalize=False)
    assert made.color[0] == pytest.approx(100.0 / np.pi**2 * 1.5, rel=1e-5)


@SINCE_4_5
@pytest.mark.parametrize(
    ("settings", "radiance"),
    (
        ({"exposure": 1.0}, 1.2665149),
        ({"normalize": False}, 2.5330298),
        ({"use_temperature": True, "temperature": 3000}, 1.1213984),
    ),
)
def test_light_settings_of_4_5_as_measured_in_cycles(settings, radiance):
    made, _ = light("POINT", energy=100.0, **settings)
    assert made.color[0] / 4.0 == pytest.approx(radiance, rel=1e-3)


@SINCE_4_5
def test_sun_that_is_not_normalized():
    assert light("SUN", energy=3.0, angle=0.0, normalize=False)[0].color[0] == pytest.approx(0.95493, rel=1e-4)


def test_light_nodes():
    add_camera()
    data = bpy.data.lights.new("lamp", "SUN")
    data.energy = np.pi
    if bpy.app.version < (5, 2, 0):
        data.use_nodes = True
    emission = next(n for n in data.node_tree.nodes if n.type == "EMISSION")
    emission.inputs["Strength"].default_value = 2.0
    emission.inputs["Color"].default_value = (1.0, 0.5, 0.25, 1.0)
    link(data)
    assert sync().scene.lights[0].color == pytest.approx((2.0, 1.0, 0.5))


@pytest.mark.parametrize("radius", (0.0, 0.5))
@pytest.mark.parametrize("output", ("Constant", "Quadratic", "Linear"))
def test_falloff(output, radius):
    """Radiance of a white plane that faces the lamp, by the formulas of Cycles' Light Falloff node."""
    add_camera()
    data = bpy.data.lights.new("lamp", "POINT")
    data.energy, data.color, data.shadow_soft_size = 80.0, (1.0, 0.5, 0.25), radius
    if bpy.app.version < (5, 2, 0):
        data.use_nodes = True
    emission = next(n for n in data.node_tree.nodes if n.type == "EMISSION")
    emission.inputs["Color"].default_value = (1.0, 0.5, 1.0, 1.0)
    node(data.node_tree, "LightFalloff", emission.inputs["Strength"], output, Strength=0.5)
    link(data, "lamp", location=(0.0, 0.0, 3.0))
    synced = sync()
    (made,) = synced.scene.lights
    if output == "Linear":
        assert made.kind == LightKind.POINT and synced.warnings("'lamp'", "'Light Falloff'")
        return
    assert made.kind == (LightKind.CONSTANT if output == "Constant" and not radius else LightKind.POINT)
    assert made.radius == radius and (made.kind == LightKind.CONSTANT or made.falls_off == (output == "Quadratic"))
    assert made.color == pytest.approx([80.0 * 0.5 * c / (4.0 * np.pi**2) for c in (1.0, 0.25, 0.25)])
    assert made.position == (0.0, 0.0, 3.0) and not synced.messages


@pytest.mark.parametrize("kind", ["POINT", "SUN", "SPOT", "AREA"])
def test_a_light_casts_shadows_or_not(kind):
    add_camera()
    data = bpy.data.lights.new("lamp", kind)
    link(data)
    assert sync().scene.lights[0].shadow
    data.use_shadow = False
    assert not sync().scene.lights[0].shadow


def test_instanced_and_hidden_lights():
    add_camera()
    data = bpy.data.lights.new("lamp", "POINT")
    link(data, "hidden", hide_viewport=True)
    collection = bpy.data.collections.new("kept aside")
    collection.objects.link(bpy.data.objects.new("inner", data))
    for x in (1.0, 2.0):
        link(None, "place", location=(x, 0, 0), instance_type="COLLECTION", instance_collection=collection)
    assert sorted(made.position[0] for made in sync().scene.lights) == [1.0, 2.0]


def world(**background):
    add_camera()
    made = bpy.data.worlds.new("sky")
    bpy.context.scene.world = made
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    made.node_tree.nodes.clear()
    output = made.node_tree.nodes.new("ShaderNodeOutputWorld")
    return made, made.node_tree, node(made.node_tree, "Background", output.inputs["Surface"], **background)


def test_a_light_that_is_nowhere_is_reported_and_the_rest_shines():
    add_camera()
    for name, energy, x in (("endless", np.inf, 0.0), ("nowhere", 10.0, np.nan), ("lamp", 10.0, 1.0)):
        data = bpy.data.lights.new(name, "POINT")
        data.energy = energy
        link(data, name, location=(x, 0.0, 2.0))
    synced = sync()
    assert [light.position for light in synced.scene.lights] == [(1.0, 0.0, 2.0)]
    assert synced.warnings("'endless'", "not finite") and synced.warnings("'nowhere'", "not finite")


def test_no_world_is_black():
    add_camera()
    assert sync().scene.world.color == (0.0, 0.0, 0.0)


def test_world_of_a_color():
    world(Color=(0.1, 0.2, 0.3, 1.0), Strength=2.0)
    synced = sync()
    assert synced.scene.world.color.value == pytest.approx((0.2, 0.4, 0.6)) and synced.scene.world.image == -1
    assert not synced.messages


def environment(tree, background):
    pixels = np.zeros((4, 8, 4), np.float32)
    pixels[..., 0] = np.arange(8)
    pixels[..., 3] = 1.0
    made = node(tree, "TexEnvironment", background.inputs["Color"])
    made.image = image(pixels, "panorama", float_buffer=True)
    return made


def test_world_of_an_image():
    _, tree, background = world(Strength=2.0)
    environment(tree, background)
    scene = sync().scene
    assert value_of(scene.world.color, image_sample=(0.1, 0.2, 0.3, 1.0)) == pytest.approx((0.2, 0.4, 0.6))
    np.testing.assert_allclose(scene.images[0].pixels[0, :, 0], np.arange(8))


def test_world_that_is_not_understood():
    _, tree, background = world(Color=(0.1, 0.2, 0.3, 1.0))
    node(tree, "TexIES", background.inputs["Color"])
    synced = sync()
    assert synced.scene.world.color.value == pytest.approx((0.1, 0.2, 0.3))
    assert len(synced.warnings("'sky'", "'IES Texture'")) == 1 == len(synced.messages)


def projected(camera, point):
    """Where an engine camera shows a world point in its picture: 0 to 1 from the left and from the bottom."""
    x, y, z = (np.linalg.inv(camera.matrix) @ (*point, 1.0))[:3]
    if not camera.orthographic:
        x, y = x / -z, y / -z
    left, right, bottom, top = camera.window
    return (x - left) / (right - left), (y - bottom) / (top - bottom)


@pytest.mark.parametrize("fit", ("AUTO", "HORIZONTAL", "VERTICAL"))
@pytest.mark.parametrize("size", ((64, 48), (48, 64)))
@pytest.mark.parametrize("kind", ("PERSP", "ORTHO"))
@pytest.mark.parametrize("aspect", (1.0, 2.0))
def test_camera_shows_points_where_blender_does(kind, size, fit, aspect):
    from bpy_extras.object_utils import world_to_camera_view

    camera = add_camera(type=kind, sensor_fit=fit, shift_x=0.1, shift_y=-0.2, lens=30.0, ortho_scale=7.0)
    camera.rotation_euler = (0.4, 0.2, 0.6)
    camera.scale = (2.0, 3.0, 0.5)
    render = bpy.context.scene.render
    render.pixel_aspect_x = aspect
    render.resolution_x, render.resolution_y = size
    made = sync(*size).scene.camera
    bpy.context.view_layer.update()
    camera.scale = (1.0, 1.0, 1.0)  # world_to_camera_view minds the scale, Blender's renders do not
    bpy.context.view_layer.update()
    for point in ((0.0, 0.0, 0.0), (1.0, 0.5, -2.0), (-2.0, 1.0, 3.0)):
        expected = world_to_camera_view(bpy.context.scene, camera, Vector(point))
        assert projected(made, point) == pytest.approx(tuple(expected)[:2], abs=2e-5)
    assert made.clip == pytest.approx((camera.data.clip_start, camera.data.clip_end))
    np.testing.assert_allclose(made.matrix[:3, :3].T @ made.matrix[:3, :3], np.eye(3), atol=1e-6)


def test_panorama_is_reported():
    add_camera(type="PANO")
    synced = sync()
    assert not synced.scene.camera.orthographic and synced.warnings("'camera'", "a panoramic camera is not rendered")


def view(window, matrix):
    return SimpleNamespace(window_matrix=window, view_matrix=matrix.inverted(), is_perspective=window[3][2] != 0.0)


@pytest.mark.parametrize("kind", ("PERSP", "ORTHO"))
def test_view_through_a_camera_is_the_cameras(kind):
    camera = add_camera(type=kind, shift_x=0.1, lens=30.0)
    camera.rotation_euler = (0.4, 0.2, 0.6)
    made = sync().scene.camera
    window = camera.calc_matrix_camera(bpy.context.evaluated_depsgraph_get(), x=64, y=48)
    seen = camera_of_view(None, view(window, camera.matrix_world))
    for point in ((0.0, 0.0, 0.0), (1.0, 0.5, -2.0)):
        assert projected(seen, point) == pytest.approx(projected(made, point), abs=1e-5)
    if kind == "PERSP":
        assert seen.clip == pytest.approx(made.clip, rel=1e-3)


def test_orthographic_view_sees_what_is_behind_its_eye():
    window = Matrix(((0.1, 0, 0, 0), (0, 0.2, 0, 0), (0, 0, -2 / 2000, 0), (0, 0, 0, 1)))  # from -1000 to 1000
    seen = camera_of_view(None, view(window, Matrix.Translation((1, 2, 3))))
    assert seen.orthographic and seen.window == pytest.approx((-10, 10, -5, 5))
    np.testing.assert_allclose(seen.matrix[:3, 3], (1, 2, 1003), rtol=1e-5)
    assert seen.clip == pytest.approx((0.0, 2000.0), rel=1e-5)


def test_settings():
    scene = bpy.context.scene
    scene.conic.samples, scene.conic.preview_samples, scene.conic.max_depth = 7, 3, 5
    scene.conic.shadows, scene.conic.weight_cutoff = "OPAQUE", 1.0
    scene.render.film_transparent = True
    settings = sync_settings(scene)
    assert (settings.samples, settings.max_depth, settings.shadows) == (7, 5, "OPAQUE")
    assert settings.film_transparent and settings.weight_cutoff < 1.0
    assert sync_settings(scene, preview=True).samples == 3
    scene.conic.seed = 2**31 - 1
    scene.frame_set(-4)
    assert sync_settings(scene).seed == 2**31 - 1
    scene.conic.use_animated_seed = True
    assert sync_settings(scene).seed == 2**31 - 5
    scene.frame_set(7)
    assert sync_settings(scene).seed == 6


def test_a_world_of_volume_is_named():
    _, tree, _ = world()
    output = next(other for other in tree.nodes if other.type == "OUTPUT_WORLD")
    node(tree, "VolumePrincipled", output.inputs["Volume"])
    assert len(sync().warnings("'sky'", "'Principled Volume' is not rendered; its volume is left out")) == 1
