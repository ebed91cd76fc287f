"""What swatches are shown on: objects that fill the square from -0.5 to 0.5, seen from above."""

import bpy
import numpy as np

from tests.blender.building import link, mesh_of

#: Faces along an edge of the plate, and pixels along an edge of a swatch: whole numbers of pixels in a face.
FACES, PIXELS = 8, 24


def _attribute(mesh, name, data_type, domain, values):
    made = mesh.attributes.new(name, data_type, domain)
    made.data.foreach_set("color" if data_type == "FLOAT_COLOR" else "vector", np.ravel(values).astype(np.float32))


def _values(rng):
    """Four attributes (4, FACES^2, 4) of faces: a third anything, a third colors, a third from what is special."""
    count = FACES**2
    anything, colors = rng.uniform(-1.5, 2.5, (4, count, 4)), rng.uniform(0.02, 0.98, (4, count, 4))
    special = rng.choice([0.0, 1.0, -1.0, 0.5, 2.0], (4, count, 4))
    kind = rng.permutation(count) % 3
    return np.choose(kind[:, None], [anything, colors, special])


def _plate_mesh():
    if "plate" in bpy.data.meshes:
        return bpy.data.meshes["plate"]
    n = FACES + 1
    x, y = (a.ravel() / FACES - 0.5 for a in np.meshgrid(np.arange(n), np.arange(n)))
    corner = (np.arange(FACES)[:, None] * n + np.arange(FACES)).ravel()
    faces = np.stack([corner, corner + 1, corner + n + 1, corner + n], axis=-1)
    mesh = mesh_of(np.stack([x, y, 0.0 * x], axis=-1), faces.tolist(), "plate")
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", (np.stack([x, y], -1) + 0.5)[faces].ravel())
    for name, values in zip("abcd", _values(np.random.default_rng(5)), strict=True):
        _attribute(mesh, name, "FLOAT_COLOR", "FACE", values)
    _attribute(mesh, "place", "FLOAT_VECTOR", "POINT", np.stack([3.1 * x - 0.2, 2.7 * y + 0.4, x + 2.0 * y + 0.3], -1))
    mesh.materials.append(None)
    return mesh


def plate():
    """A square of faces with attributes, of which all plates share the mesh."""
    return link(_plate_mesh(), "plate")


def _primitive(add, smooth=True, **settings):
    def make():
        getattr(bpy.ops.mesh, f"primitive_{add}_add")(**settings, rotation=(0.9, 0.3, 0.2))
        made = bpy.context.object
        if smooth:
            made.data.shade_smooth()
            made.data.set_sharp_from_angle(angle=0.5)
        made.data.materials.append(None)
        return made

    return make


SHAPES = {
    "plate": plate,
    "sphere": _primitive("uv_sphere", radius=0.48, segments=64, ring_count=32),
    "cylinder": _primitive("cylinder", radius=0.3, depth=0.6, vertices=128),
    "cone": _primitive("cone", radius1=0.4, radius2=0.1, depth=0.6, vertices=128),
    "disc": _primitive("circle", False, radius=0.45, vertices=128, fill_type="NGON"),
    "cube": _primitive("cube", False, size=0.5),
}
