"""Direct light against Cycles in the same Blender: the same scene, the same lamps, no bounces."""

import bpy
import numpy as np
import pytest

from tests.blender.building import add_camera, link, material, node
from tests.blender.pictures import picture

WIDTH, HEIGHT = 96, 72


@pytest.fixture
def lit_scene():
    """A floor, a smooth exact sphere, a cone, a smooth and a flat mesh, diffuse; no lamp, black sky."""
    scene = bpy.context.scene
    camera = add_camera(type="PERSP", lens=40.0)
    camera.location, camera.rotation_euler = (0.0, -9.0, 5.0), (1.07, 0.0, 0.0)
    bpy.ops.mesh.primitive_plane_add(size=30.0)
    shapes = [bpy.context.object]
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6, radius=1.2, location=(-2.2, 0.0, 1.2))
    shapes.append(bpy.context.object)
    bpy.ops.mesh.primitive_cone_add(vertices=512, radius1=1.0, radius2=0.3, depth=2.0, location=(0.6, 0.5, 1.0))
    shapes.append(bpy.context.object)
    bpy.ops.mesh.primitive_cube_add(size=1.6, location=(2.8, -0.5, 0.8), rotation=(0.0, 0.0, 0.6))
    shapes.append(bpy.context.object)
    bpy.ops.mesh.primitive_torus_add(location=(2.6, 2.0, 1.6), major_segments=96, minor_segments=48)
    shapes.append(bpy.context.object)
    for shape, color in zip(
        shapes, ((0.8, 0.8, 0.8), (0.8, 0.3, 0.2), (0.2, 0.7, 0.3), (0.3, 0.4, 0.9), (0.9, 0.8, 0.1)), strict=True
    ):
        diffuse, tree, output = material()
        node(tree, "BsdfDiffuse", output.inputs["Surface"], Color=(*color, 1.0), Roughness=0.0)
        shape.data.materials.append(diffuse)
        if shape.name.startswith(("Ico", "Cone", "Torus")):
            shape.data.shade_smooth()
            shape.data.set_sharp_from_angle(angle=0.9)  # between the cone's side and its caps
    scene.world = None
    return scene


def add_lamp(kind, energy, **settings):
    data = bpy.data.lights.new(kind, kind)
    data.energy, data.color = energy, (1.0, 0.9, 0.7)
    if kind == "SUN":
        data.angle = 0.0
    else:
        data.shadow_soft_size = 0.0
    return link(data, kind, **settings)


def rendered(scene, engine, folder):
    """The picture by an engine, (height, width, 3), linear."""
    render = scene.render
    render.engine = engine
    render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, HEIGHT, 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = str(folder / f"{engine}.exr")
    bpy.ops.render.render(write_still=True)
    return picture(render.filepath)[..., :3]


def by_both(scene, folder):
    """Pictures by Conic and by Cycles, whose filter is a hundredth of a pixel wide: it too looks at the centres."""
    scene.conic.samples = 1
    scene.cycles.device, scene.cycles.samples = "CPU", 4
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "GAUSSIAN", 0.01
    scene.cycles.max_bounces = 0
    return rendered(scene, "CONIC", folder), rendered(scene, "CYCLES", folder)


def add_point():
    add_lamp("POINT", 1200.0, location=(3.0, -5.0, 6.0))


def add_sun():
    add_lamp("SUN", 2.5, rotation_euler=(0.7, -0.4, 0.2))


@pytest.mark.parametrize("add", [add_point, add_sun])
def test_direct_light_of_diffuse_surfaces(lit_scene, tmp_path, add, record_property):
    """Measured: a mean relative error of 0.05% over all pixels that both light; a dozen of 6000 are off by over 2%."""
    add()
    conic, cycles = by_both(lit_scene, tmp_path)
    lit, lit_in_cycles = conic.max(axis=-1) > 1e-4, cycles.max(axis=-1) > 1e-4
    assert lit.mean() > 0.4
    # Where only one of them is lit, a shadow's edge runs through the pixel.
    assert (lit != lit_in_cycles).mean() < 0.01
    both = lit & lit_in_cycles
    error = np.abs(conic - cycles).mean(axis=-1)[both] / cycles.mean(axis=-1)[both]
    # Over all of them, silhouettes included, where the facetted and the exact shape differ by a pixel here and there.
    record_property("mean relative error", float(error.mean()))
    assert error.mean() < 0.01, f"mean relative error {error.mean():.3%}, largest {error.max():.1%}"
    assert np.mean(error > 0.05) < 0.01
    assert np.median(error) < 0.001


def test_lamps_add_up(lit_scene, tmp_path):
    """Cycles picks one lamp a sample, so that two at a time are noise there: here two are the sum of each alone."""
    lit_scene.conic.samples = 1
    add_point()
    point = rendered(lit_scene, "CONIC", tmp_path)
    add_sun()
    both = rendered(lit_scene, "CONIC", tmp_path)
    bpy.data.objects.remove(bpy.data.objects["POINT"])
    sun = rendered(lit_scene, "CONIC", tmp_path)
    np.testing.assert_allclose(both, point + sun, rtol=1e-4, atol=1e-5)
