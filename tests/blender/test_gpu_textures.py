"""Textures of Blender's GPU that are changed in part: through the device, and through a scene that is updated."""

from collections import OrderedDict

import bpy
import gpu
import numpy as np
import pytest

from addon.device import WindowDevice
from addon.engine import (
    Camera,
    Geometry,
    Instances,
    Light,
    LoadedScene,
    Material,
    Scene,
    Session,
    Settings,
    Spheres,
    data_texture,
)
from addon.engine.devices import blender_gpu
from addon.engine.devices.blender_gpu import BlenderDevice
from addon.engine.shader_source import ProgramSource


@pytest.fixture(params=[BlenderDevice, WindowDevice])
def device(request):
    if bpy.app.background and not hasattr(gpu, "init"):
        pytest.skip("this Blender has no GPU context without a window")
    gpu.init()
    return request.param()


def texels_of(texture):
    """All texels (n, 4) of a texture."""
    pixels = np.empty(texture.width * texture.height * 4, np.float32)
    buffer = gpu.types.Buffer("FLOAT", pixels.size, pixels)
    framebuffer = gpu.types.GPUFrameBuffer(color_slots=[texture])
    with framebuffer.bind():
        framebuffer.read_color(0, 0, texture.width, texture.height, 4, 0, "FLOAT", data=buffer)
    return pixels.reshape(-1, 4)


def test_any_range_is_written_and_nothing_else(device):
    rng = np.random.default_rng(0)
    texture = device.texture(rng.random((3, data_texture.WIDTH, 4)).astype(np.float32))
    host = texels_of(texture).copy()
    for _ in range(30):
        first = int(rng.integers(3 * data_texture.WIDTH))
        texels = rng.normal(size=(rng.integers(1, 3 * data_texture.WIDTH - first + 1), 4)).astype(np.float32)
        device.update(texture, first, texels)
        host[first : first + len(texels)] = texels
        assert np.array_equal(texels_of(texture), host)


@pytest.mark.parametrize("texels", [100, data_texture.WIDTH, 2 * data_texture.WIDTH])
def test_what_has_grown_begins_as_before(device, texels):
    rng = np.random.default_rng(0)
    shape = (-(-texels // data_texture.WIDTH), min(texels, data_texture.WIDTH), 4)
    old = device.texture(rng.random(shape).astype(np.float32))
    new = device.grown(old, 3 * data_texture.WIDTH)
    assert np.array_equal(texels_of(new)[:texels], texels_of(old))
    small = device.grown(None, 50)
    values = rng.random((20, 4)).astype(np.float32)
    device.update(small, 30, values)
    assert np.array_equal(texels_of(small)[30:50], values)


def test_an_updated_scene_has_the_picture_of_a_fresh_one(device):
    rng = np.random.default_rng(0)
    loaded = LoadedScene(device)
    scene = Scene(
        camera=Camera.look_at((0, -9, 3), (0, 0, 0)), materials=[Material(), Material(diffuse=(0.8, 0.2, 0.1))]
    )
    scene.add_light(Light.sun((0.3, -0.5, 1.0), 2.0))
    for count in (50, 5000, 20):
        center = rng.uniform(-3.0, 3.0, (count, 3))
        scene.shapes = Geometry(Spheres(center=center, radius=2.0 / count ** (1 / 3), material=1), name="world")
        matrix = np.eye(4)
        matrix[:3, 3] = rng.uniform(-2.0, 2.0, 3)
        scene.instances.append(Instances(Geometry(Spheres(center=[[0, 0, 0]], radius=0.7)), matrix))
        update = loaded.prepare(scene, Settings())
        while not loaded.apply(update, 0.0):
            pass
        pictures = []
        for session in (Session(device, loaded), Session(device)):
            if session.loaded is not loaded:
                session.load(scene, Settings())
            session.start(32, 24)
            while session.step(10.0):
                pass
            pictures.append(session.pixels())
            session.free()
        assert np.array_equal(*pictures)
    loaded.free()


def test_programs_that_nobody_asks_for_are_given_back_and_draw_until_then(device, monkeypatch):
    monkeypatch.setattr(blender_gpu, "_PROGRAMS", OrderedDict())
    monkeypatch.setattr(blender_gpu, "_MOST_PROGRAMS", 3)

    def source(number):
        text = f"void main() {{ out_color = vec4({number}.0); }}"
        return ProgramSource("numbered", text, (), "", ("out_color",), ((f"{number}", 1),))

    def drawn(program):
        target = device.target(2, 2, 1)
        device.draw(program, target, (0, 0, 2, 2), {}, np.zeros(4, np.float32))
        return device.read(target, 0, (0, 0, 2, 2))

    first = device.program(source(1))
    assert (drawn(first) == 1.0).all()
    for number in range(2, 9):
        assert (drawn(device.program(source(number))) == number).all()
        assert (drawn(device.program(source(2))) == 2).all()
    assert set(blender_gpu._PROGRAMS) == {source(2), source(7), source(8)}
    assert (drawn(first) == 1.0).all(), "it is kept by who draws with it"
