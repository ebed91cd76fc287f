"""What a session does with a device, on one that draws nothing."""

import gc
import weakref

import numpy as np

from addon.engine import Camera, Geometry, Instances, Light, Material, Scene, Session, Settings, Spheres
from addon.engine.expression import Parameter
from addon.engine.material import surface_attribute
from addon.engine.packing import pack


class NoDevice:
    """Keeps what it was asked for."""

    name, max_texture_size = "no device", 16384
    can_compute = False

    def __init__(self):
        self.hosts, self.alive, self.sources, self.released = {}, [], [], []

    def texture(self, texels):
        self.alive.append(sum(host() is not None for host in self.hosts.values()))
        self.hosts[len(self.hosts)] = weakref.ref(texels.base if texels.base is not None else texels)
        return texels.shape

    def target(self, width, height, attachments):
        return (width, height)

    def program(self, source):
        self.sources.append(source)
        return source

    def draw(self, program, target, rectangle, textures, uniforms):
        assert set(program.textures) <= set(textures)

    def read(self, target, attachment, rectangle):
        return np.zeros((rectangle[3], rectangle[2], 4), np.float32)

    def release(self, thing):
        self.released.append(thing)


def scene_of(**material):
    scene = Scene(camera=Camera.look_at((0, -5, 0), (0, 0, 0)), materials=[Material(**material)])
    geometry = Geometry(Spheres(center=np.zeros((2, 3)), radius=1.0, attributes={"id": (1, 1, 1, 1)}))
    scene.instances = [Instances(geometry, np.tile(np.eye(4), (3, 1, 1)))]
    scene.add_spheres([[0, 0, 3]], 1.0)
    scene.add_light(Light.sun((0, 0, 1), 1.0))
    return scene


def loaded(scene, **settings):
    session = Session(NoDevice())
    session.load(scene, Settings(**settings))
    return session


def test_each_array_is_freed_before_the_next_is_uploaded():
    class Collecting(NoDevice):
        def texture(self, texels):
            gc.collect()
            return super().texture(texels)

    session = Session(Collecting())
    session.load(scene_of(), Settings())
    assert len(session.device.alive) >= 4 and not any(session.device.alive)


def test_statistics_of_what_was_loaded_and_drawn():
    session = loaded(scene_of(diffuse=surface_attribute("id")))
    session.start(8, 4)
    assert session.statistics()["seconds"]["first_picture"] == 0.0
    while session.step(1.0):
        pass
    found = session.statistics()
    assert found["primitives"] == {"sphere": 7} and found["instances"] == 3 and found["geometries"] == 1
    assert found["bvh"].keys() == {"nodes", "depth", "sah_cost", "grids"} and found["device"] == "no device"
    assert found["textures"].keys() == {"nodes", "instances", "spheres", "sphere_surfaces", "tables", "attributes"}
    assert found["textures"]["spheres"] == 3 * 16
    assert found["gpu_bytes"] == sum(found["textures"].values()) + 8 * 4 * 16
    assert list(found["seconds"]) == ["build", "upload", "compile", "trace", "first_picture"]
    assert found["build"].keys() == {"bounds", "tree", "records", "instances"}
    first = found["seconds"]["first_picture"]
    assert first >= found["seconds"]["build"] > 0.0
    session.start(8, 4)
    while session.step(1.0):
        pass
    assert session.statistics()["seconds"]["first_picture"] == first, "of the first picture only"


def program_of(scene, **settings):
    """Names defined by the settings and features that the program was made with, by what its text holds."""
    return loaded(scene, **settings).device.sources[0].text


def test_programs_hold_what_the_materials_ask_for():
    plain = program_of(scene_of())
    assert "cull_back_shadow > 0.5" not in plain and "attribute_value" not in plain
    assert "cull_back_shadow > 0.5" in program_of(scene_of(cull_back_shadow=True), shadows="OPAQUE")
    assert "attribute_value" in program_of(scene_of(glow=surface_attribute("id")))


def test_shadow_rays_look_at_surfaces_only_where_one_may_let_them_pass():
    """By structure, so that a parameter that is 0 now compiles nothing anew; it costs nothing meanwhile."""
    glass, clear = {"transmit": 0.9, "ior": 1.5}, {"transmit": 0.9, "ior": 1.0}
    faded = {"transmit": Parameter((0.0, 0.0, 0.0)), "ior": Parameter(1.0)}
    looks = {
        ("OPAQUE", "glass"): False,
        ("OPAQUE", "clear"): False,
        ("OPAQUE", "faded"): False,
        ("TRANSPARENT", "glass"): False,
        ("TRANSPARENT", "clear"): True,
        ("TRANSPARENT", "faded"): True,
        ("TINTED", "glass"): True,
        ("TINTED", "clear"): True,
        ("TINTED", "faded"): True,
    }
    materials = {"glass": glass, "clear": clear, "faded": faded}
    for (shadows, name), expected in looks.items():
        scene = scene_of(**materials[name])
        assert ("#define SHADOWS_PASS true" in program_of(scene, shadows=shadows)) == expected, (shadows, name)
        assert pack(scene, 4096).shadows_pass[shadows] == (expected and name != "faded")
