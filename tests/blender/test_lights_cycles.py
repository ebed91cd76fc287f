"""Every kind of light against Cycles in the same Blender: direct light on a floor and a ball, soft shadows included."""

from math import radians

import bpy
import numpy as np
import pytest

from tests.blender.building import add_camera, link, material, node
from tests.blender.pictures import picture

WIDTH, HEIGHT, SAMPLES = 64, 48, 256

#: Kind, settings of the light (`falloff` is the output of a Light Falloff node), of its object. Those that came with
#: Blender 4.5 are left out before.
CASES = {
    "point": ("POINT", {"shadow_soft_size": 0.0}, {}),
    "ball": ("POINT", {"shadow_soft_size": 0.8, "use_soft_falloff": False}, {"scale": (2.0, 1.0, 1.0)}),
    "soft ball": ("POINT", {"shadow_soft_size": 0.8}, {}),
    "soft ball through the floor": ("POINT", {"shadow_soft_size": 1.0}, {"location": (2.0, 0.5, 0.3)}),
    "around everything": ("POINT", {"shadow_soft_size": 20.0, "use_soft_falloff": False}, {}),
    "not normalized ball": ("POINT", {"shadow_soft_size": 0.8, "normalize": False, "energy": 80.0}, {}),
    "spot": ("SPOT", {"shadow_soft_size": 0.0, "spot_blend": 0.0, "spot_size": 0.7}, {}),
    "blended spot": ("SPOT", {"shadow_soft_size": 0.0, "spot_blend": 0.6, "spot_size": 0.8}, {}),
    "spot ball": ("SPOT", {"shadow_soft_size": 0.6, "use_soft_falloff": False, "spot_blend": 0.3}, {}),
    "soft spot ball": ("SPOT", {"shadow_soft_size": 0.6, "spot_blend": 1.0}, {}),
    "stretched spot": ("SPOT", {"shadow_soft_size": 0.0, "spot_blend": 0.4}, {"scale": (1.0, 2.0, 1.5)}),
    "widest spot": ("SPOT", {"shadow_soft_size": 0.0, "spot_size": radians(180.0)}, {}),
    "square": ("AREA", {"shape": "SQUARE", "size": 1.5}, {}),
    "rectangle": ("AREA", {"shape": "RECTANGLE", "size": 0.5, "size_y": 2.0}, {"scale": (1.0, 1.5, 1.0)}),
    "disk": ("AREA", {"shape": "DISK", "size": 2.0}, {}),
    "ellipse": ("AREA", {"shape": "ELLIPSE", "size": 3.0, "size_y": 1.0}, {}),
    "mirrored rectangle": ("AREA", {"shape": "RECTANGLE", "size": 0.5, "size_y": 2.0}, {"scale": (-1.0, 1.0, 1.0)}),
    "rectangle of little spread": ("AREA", {"shape": "RECTANGLE", "size": 3, "size_y": 1, "spread": radians(60)}, {}),
    "disk of little spread": ("AREA", {"shape": "DISK", "size": 2.0, "spread": radians(60)}, {}),
    "ellipse of hardly any spread": ("AREA", {"shape": "ELLIPSE", "size": 5, "size_y": 3, "spread": radians(5)}, {}),
    "not normalized area": ("AREA", {"size": 1.5, "normalize": False, "energy": 300.0}, {"scale": (2.0, 1.0, 1.0)}),
    "exposed area": ("AREA", {"size": 1.0, "exposure": -1.0}, {}),
    "warm area": ("AREA", {"size": 1.0, "use_temperature": True, "temperature": 3000.0}, {}),
    "ball that does not fall off": ("POINT", {"shadow_soft_size": 1.0, "energy": 15.0, "falloff": "Constant"}, {}),
    "spot that does not fall off": ("SPOT", {"spot_blend": 0.5, "energy": 15.0, "falloff": "Constant"}, {}),
    "area that does not fall off": ("AREA", {"size": 2.0, "energy": 15.0, "falloff": "Constant"}, {}),
    "no shadow": ("AREA", {"size": 1.0, "use_shadow": False}, {}),
    "sun": ("SUN", {"angle": 0.0, "energy": 3.0}, {}),
    "soft sun": ("SUN", {"angle": radians(10.0), "energy": 3.0}, {}),
    "half a sky": ("SUN", {"angle": radians(150.0), "energy": 3.0}, {}),
    "not normalized sun": ("SUN", {"angle": radians(10.0), "energy": 300.0, "normalize": False}, {}),
}


@pytest.fixture
def scene():
    """A floor and a smooth exact ball, diffuse, under a black sky."""
    camera = add_camera(lens=40.0)
    camera.location, camera.rotation_euler = (0.0, -7.0, 3.5), (1.13, 0.0, 0.0)
    diffuse, tree, output = material()
    node(tree, "BsdfDiffuse", output.inputs["Surface"], Color=(0.8, 0.7, 0.6, 1.0))
    bpy.ops.mesh.primitive_plane_add(size=30.0)
    bpy.context.object.data.materials.append(diffuse)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6, radius=1.0, location=(0.0, 0.0, 1.3))
    bpy.context.object.data.materials.append(diffuse)
    bpy.context.object.data.shade_smooth()
    bpy.context.scene.world = None
    return bpy.context.scene


def add_light(kind, settings, placing):
    data, settings = bpy.data.lights.new("light", kind), dict(settings)
    falloff = settings.pop("falloff", None)
    if falloff:
        if bpy.app.version < (5, 2, 0):
            data.use_nodes = True
        emission = next(n for n in data.node_tree.nodes if n.type == "EMISSION")
        node(data.node_tree, "LightFalloff", emission.inputs["Strength"], falloff, Strength=1.0)
    if not all(hasattr(data, name) for name in settings):
        pytest.skip("this Blender has no such setting")
    for name, value in ({"energy": 400.0, "color": (1.0, 0.9, 0.7)} | settings).items():
        setattr(data, name, value)
    # Cycles shows the camera what lights have an extent.
    return link(
        data, **{"location": (2.0, -1.5, 4.0), "rotation_euler": (0.35, 0.4, 0.3), "visible_camera": False} | placing
    )


def rendered(scene, engine, folder):
    """The picture by an engine, (height, width, 3), linear; both filter by the square of the pixel."""
    render = scene.render
    render.engine = engine
    render.resolution_x, render.resolution_y, render.resolution_percentage = WIDTH, HEIGHT, 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = str(folder / f"{engine}.exr")
    scene.conic.samples = SAMPLES
    scene.cycles.device, scene.cycles.samples = "CPU", SAMPLES
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 1.0
    scene.cycles.max_bounces, scene.cycles.light_sampling_threshold = 0, 0.0
    bpy.ops.render.render(write_still=True)
    return picture(render.filepath)[..., :3]


@pytest.mark.parametrize("case", CASES)
def test_direct_light(scene, tmp_path, case, record_property):
    add_light(*CASES[case])
    conic, cycles = rendered(scene, "CONIC", tmp_path), rendered(scene, "CYCLES", tmp_path)
    brightest = cycles.max()
    error = np.abs(conic - cycles).sum(axis=-1) / np.maximum(cycles.sum(axis=-1), 0.01 * brightest)
    lit = cycles.max(axis=-1) > 0.01 * brightest
    record_property("median relative error", float(np.median(error[lit])))
    assert lit.mean() > 0.05
    assert np.median(error[lit]) < 0.02, f"median relative error {np.median(error[lit]):.3%}"
    assert np.mean(error > 0.25) < 0.03, "of pixels at the edges of shadows and cones, where both are noisy"
    assert conic.sum() / cycles.sum() == pytest.approx(1.0, abs=0.003)
