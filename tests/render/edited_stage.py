"""A scene that is edited at random, piece by piece, and pictures of what is loaded of it."""

import weakref
from dataclasses import replace

import numpy as np

from addon.engine import (
    Camera,
    Cylinders,
    Geometry,
    Image,
    Instances,
    Light,
    Material,
    Planes,
    Scene,
    Session,
    Settings,
    Spheres,
    Triangles,
    World,
)
from addon.engine.expression import Parameter, call, component
from addon.engine.film_options import DepthCue
from addon.engine.material import surface_attribute, surface_image

SIZE = (40, 30)
CAMERA = Camera.look_at((0.0, -9.0, 3.0), (0.0, 0.0, 0.5), angle=50.0, aspect=SIZE[0] / SIZE[1])


def picture(device, loaded=None, scene=None, settings=None, size=SIZE):
    session = Session(device, loaded)
    if loaded is None:
        session.load(scene, settings)
    session.start(*size)
    while session.step(60.0):
        pass
    pixels = session.pixels()
    session.free()
    return pixels


def update(loaded, scene, settings, seconds=None, quick=False):
    """Bring a scene to the device, in slices where `seconds` are given; the `Update`."""
    made = loaded.prepare(scene, settings, quick)
    while not loaded.apply(made, seconds):
        pass
    return made


class Stage:
    """What a scene is made of, some of it another from edit to edit; all else stays the same objects."""

    def __init__(self, seed):
        self.rng = np.random.default_rng(seed)
        self.settings = Settings(max_depth=4)
        self.materials = [Material(diffuse=(0.7, 0.5, 0.3)), Material(diffuse=0.2, reflect=0.5)]
        self.images = [self.new_image()]
        self.lights = [Light.sun((0.3, -0.5, 1.0), 2.0)]
        self.world = World((0.1, 0.15, 0.2))
        self.planes = []
        self.shapes = Geometry(self.new_spheres(30, 4.0), name="world")
        self.instances = []

    def scene(self):
        return Scene(
            camera=CAMERA,
            world=self.world,
            lights=list(self.lights),
            materials=list(self.materials),
            images=list(self.images),
            shapes=self.shapes,
            instances=list(self.instances),
            planes=list(self.planes),
        )

    # What things are made of

    def new_spheres(self, count, reach, slots=2):
        rng = self.rng
        center = rng.uniform(-reach, reach, (count, 3)) * (1.0, 1.0, 0.3)
        radius = rng.uniform(0.3, 0.8, count) * 2.0 * reach / count ** (1 / 3) * 0.5
        attributes = {name: rng.random((count, 4)) for name in ("a", "b") if rng.random() < 0.7}
        return Spheres(center=center, radius=radius, material=rng.integers(0, slots, count), attributes=attributes)

    def new_geometry(self):
        count = int(self.rng.choice([1, 7, 40]))
        parts = [self.new_spheres(count, 1.0)]
        if self.rng.random() < 0.5:
            corners = self.rng.uniform(-1.0, 1.0, (3, count, 3))
            attributes = {"a": self.rng.random((count, 3, 4))}
            parts.append(Triangles(p0=corners[0], p1=corners[1], p2=corners[2], attributes=attributes))
        if self.rng.random() < 0.5:
            ends = self.rng.uniform(-1.0, 1.0, (2, count, 3))
            parts.append(Cylinders(base=ends[0], apex=ends[1], radius=0.1, material=1))
        return Geometry(*parts)

    def new_image(self):
        size = self.rng.integers(1, 9, 2)
        pixels = self.rng.random((*size, 4)).astype(np.float32)
        kind = self.rng.integers(3)
        if kind:
            pixels = (255 * pixels).astype(np.uint8)
            pixels[..., 3] = 255 if kind == 1 else pixels[..., 3]
        return Image(pixels, interpolation=str(self.rng.choice(["CLOSEST", "LINEAR"])))

    def new_instances(self, geometry):
        count = int(self.rng.choice([1, 1, 3, 12]))
        matrices = np.tile(np.eye(4), (count, 1, 1))
        matrices[:, :3, :3] += self.rng.uniform(-0.3, 0.3, (count, 3, 3))
        matrices[:, :3, 3] = self.rng.uniform(-4.0, 4.0, (count, 3))
        if self.rng.random() < 0.2:
            matrices = np.eye(4)[None]  # in the world's own space
        attributes = {"a": self.rng.random((len(matrices), 4))} if self.rng.random() < 0.5 else {}
        slots = tuple(self.rng.integers(0, len(self.materials), 2).tolist())
        return Instances(geometry, matrices, slots, attributes=attributes)

    def any_of(self, things):
        return int(self.rng.integers(len(things)))

    # Edits

    def edit(self):
        """Change something; its name."""
        edits = [name for name in dir(self) if name.startswith("edit_")]
        name = str(self.rng.choice(edits))
        getattr(self, name)()
        return name

    def edit_shapes(self):
        self.shapes = Geometry(self.new_spheres(int(self.rng.choice([1, 20, 200])), 4.0), name="world")

    def edit_no_shapes(self):
        self.shapes = Geometry(name="world")

    def edit_many_shapes(self):
        self.shapes = Geometry(self.new_spheres(5000, 4.0), name="world")

    def edit_move_shapes(self):
        old, self.shapes = self.shapes, Geometry(name="world")
        for _, part in old.kinds():
            moved = part.center + self.rng.normal(0.0, 0.02, part.center.shape)
            columns = {"radius": part.radius, "material": part.material, "attributes": part.attributes}
            self.shapes.add(Spheres(center=moved, **columns))
        self.shapes.replaces = weakref.ref(old)

    def edit_add_instances(self):
        known = [placed.geometry for placed in self.instances]
        again = known and self.rng.random() < 0.3
        geometry = known[self.any_of(known)] if again else self.new_geometry()
        self.instances.append(self.new_instances(geometry))

    def edit_remove_instances(self):
        if self.instances:
            del self.instances[self.any_of(self.instances)]

    def edit_move_instances(self):
        if self.instances:
            number = self.any_of(self.instances)
            matrices = self.instances[number].matrices.copy()
            matrices[:, :3, 3] += self.rng.normal(0.0, 0.5, 3)
            self.instances[number] = replace(self.instances[number], matrices=matrices)

    def edit_instanced_geometry(self):
        if self.instances:
            number = self.any_of(self.instances)
            self.instances[number] = replace(self.instances[number], geometry=self.new_geometry())

    def edit_constant(self):
        number = self.any_of(self.materials)
        self.materials[number] = replace(self.materials[number], reflect=float(self.rng.uniform(0.1, 0.5)))

    def edit_surface(self):
        number = self.any_of(self.materials)
        surfaces = [
            lambda: {"diffuse": surface_attribute(str(self.rng.choice(["a", "b"])))},
            lambda: {"diffuse": surface_image(self.any_of(self.images))},
            lambda: {"diffuse": 0.1, "glow": 2.0},
            lambda: {"diffuse": 0.0, "transmit": 0.8, "ior": 1.2},
            lambda: {"diffuse": Parameter(float(self.rng.random())) * component(call("point_position"), 2)},
        ]
        self.materials[number] = Material(**surfaces[self.any_of(surfaces)]())

    def edit_add_material(self):
        self.materials.append(Material(diffuse=tuple(self.rng.random(3))))

    def edit_image(self):
        self.images[self.any_of(self.images)] = self.new_image()

    def edit_add_image(self):
        self.images.append(self.new_image())

    def edit_add_light(self):
        for _ in range(int(self.rng.choice([1, 9]))):
            self.lights.append(Light.point(self.rng.uniform((-4, -4, 0), (4, 4, 8)), 20.0))

    def edit_remove_lights(self):
        del self.lights[self.any_of(self.lights) + 1 :]

    def edit_world(self):
        worlds = [
            lambda: World((0.3, 0.2, 0.1), lights=bool(self.rng.random() < 0.5)),
            lambda: World((0.5, 0.5, 0.5), image=self.any_of(self.images), lights=bool(self.rng.random() < 0.5)),
        ]
        self.world = worlds[self.any_of(worlds)]()

    def edit_plane(self):
        if self.planes and self.rng.random() < 0.4:
            self.planes = []
        else:
            attributes = {"a": self.rng.random(4)} if self.rng.random() < 0.5 else {}
            height = [0.0, 0.0, self.rng.uniform(-3.0, -1.0)]
            self.planes.append(Planes(point=[height], normal=[[0, 0.1, 1]], attributes=attributes))

    def edit_settings(self):
        options = [
            {"samples": 2},
            {"samples": 1},
            {"max_depth": 3},
            {"shadows": "TINTED"},
            {"depth_cue": DepthCue()},
        ]
        self.settings = replace(self.settings, **options[self.any_of(options)])
