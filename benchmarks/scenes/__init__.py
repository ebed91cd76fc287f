"""The scenes that are measured: families of any size, of the standard procedural databases and beside them.

They say only what every peer can: matte surfaces, mirrors, clear bodies, lights without fall-off, one color all
around. `comparable` takes away what the databases have beyond that.
"""

import dataclasses

from addon.engine import Geometry, Triangles
from examples import standard_scenes

from .boxes import random_box
from .crystal import crystal
from .gears import gears
from .rings import rings
from .rooms import glass_room, mirror_room
from .shells import shells
from .teapot import teapot

FAMILIES = standard_scenes.FAMILIES | {
    "rings": rings,
    "gears": gears,
    "teapot": teapot,
    "shells": shells,
    "box": random_box,
    "crystal": crystal,
    "glass_room": glass_room,
    "mirror_room": mirror_room,
}


def make(name):
    """The scene `family` or `family:size` as all peers can draw it. Raises ValueError for an unknown one."""
    family, _, size = name.partition(":")
    if family not in FAMILIES:
        raise ValueError(f"no family of scenes is called {family!r}; there are {', '.join(FAMILIES)}")
    return comparable(FAMILIES[family](*([int(float(size))] if size else [])))


def comparable(scene):
    """The scene without what some peer lacks: a near plane, triangles with one side, bodies both clear and matte."""
    shapes = Geometry(name=scene.shapes.name)
    for _, part in scene.shapes.kinds():
        if isinstance(part, Triangles):
            columns = {column.name: getattr(part, column.name) for column in part.columns}
            part = Triangles(**columns | {"one_sided": 0})
        shapes.add(part)
    camera = dataclasses.replace(scene.camera, clip=(0.0, 1e30))
    return dataclasses.replace(scene, shapes=shapes, camera=camera, materials=[*map(_clear, scene.materials)])


def _clear(material):
    if not any(material.transmit):
        return material
    return dataclasses.replace(material, diffuse=(0.0, 0.0, 0.0), highlight=(0.0, 0.0, 0.0))
