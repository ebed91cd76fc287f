# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes to NFF text: every number with the digits that give it back exactly, and an error for what NFF has
no words for."""

import numpy as np

from .errors import SceneError
from .material_packing import expressions_of
from .output_file import written_whole
from .primitives import Cones, Cylinders, Discs, Spheres, Triangles
from .scene import LightKind


def write_nff(scene, path, width, height):
    """Write `scene` (Scene) as NFF for a picture of width x height pixels.

    Raises SceneError where the scene holds what NFF cannot (instances, planes, discs, images, Fresnel, ...),
    ConicError where the file cannot be written.
    """
    text = format_nff(scene, width, height)
    with written_whole(path) as temporary:
        temporary.write_text(text, encoding="ascii")


def format_nff(scene, width, height):
    """The text that `write_nff` writes."""
    lines = [_world(scene), _view(scene.camera, width, height), *map(_light, scene.lights)]
    shapes = _shapes(scene)
    for index, material in enumerate(scene.materials):
        chunks = [_records(shape, shape.material == index, material, index) for shape in shapes]
        if any(chunks):
            lines += [_material(material, index), *chunks]
    return "".join(lines)


def _refuse(bad, what):
    if bad:
        raise SceneError(f"NFF cannot hold {what}")


def _join(*values):
    return " ".join(repr(float(x)) for x in np.concatenate([np.ravel(v) for v in values]))


def _world(scene):
    _refuse(scene.world.image >= 0, "an image as the world")
    return f"b {_join(scene.world.color)}\n"


def _view(camera, width, height):
    _refuse(camera is None, "a scene without a camera")
    _refuse(camera.orthographic, "an orthographic camera")
    _refuse(camera.clip[1] < 1e30, f"a far clip ({camera.clip[1]:g}); set it to 1e30")
    left, right, bottom, top = camera.window
    aspect = (right - left) / (top - bottom)
    _refuse(
        not np.allclose([left + right, bottom + top], 0.0, atol=1e-9 * (top - bottom)),
        "a camera with a shift",
    )
    _refuse(
        not np.isclose(aspect * height, width, rtol=1e-9),
        f"a camera of aspect {aspect:g} for {width} x {height} pixels",
    )
    matrix = np.asarray(camera.matrix, np.float64)
    eye, back, up = matrix[:3, 3], matrix[:3, 2], matrix[:3, 1]
    # `at` at a distance like that of the eye from the origin keeps the digits of the direction.
    at = eye - back * max(1.0, float(np.linalg.norm(eye)))
    angle = 2.0 * np.degrees(np.arctan((top - bottom) / 2.0))
    return (
        f"v\nfrom {_join(eye)}\nat {_join(at)}\nup {_join(up)}\nangle {_join(angle)}\n"
        f"hither {_join(camera.clip[0])}\nresolution {width} {height}\n"
    )


def _light(light):
    _refuse(
        light.kind != LightKind.CONSTANT,
        f"a light of kind {light.kind.name}: only CONSTANT, without fall-off",
    )
    return f"l {_join(light.position, light.color)}\n"


def _shapes(scene):
    _refuse(bool(scene.instances), "instances; add their shapes to the scene itself")
    _refuse(bool(scene.planes), "infinite planes")
    shapes = [shape for _, shape in scene.shapes.kinds()]
    for shape in shapes:
        _refuse(isinstance(shape, Discs), "discs")
        used = (shape.material >= 0) & (shape.material < len(scene.materials))
        _refuse(not used.all(), f"a {shape.kind} whose material is not in the scene")
    return shapes


def _material(material, index):
    name = f"material {index}: "
    _refuse(bool(expressions_of(material)), name + "values that vary over the surface")
    _refuse(material.fresnel, name + "Fresnel reflection; make it with fresnel=False")
    _refuse(any(material.glow), name + "glow")
    _refuse(any(material.absorption), name + "absorption")
    for what, color in (("mirror", material.reflect), ("transmittance", material.transmit)):
        _refuse(len(set(color)) > 1, name + f"a coloured {what}")
    _refuse(material.reflect != material.highlight, name + "a highlight other than the mirror: both are Ks")
    # Kd = 1 leaves the colour its digits.
    numbers = (material.diffuse, 1.0, material.reflect[0], material.shine, material.transmit[0], material.ior)
    return f"f {_join(*numbers)}\n"


def _records(shape, pick, material, index):
    """The records of the rows `pick` (n,) bool of one kind of primitives."""
    if not pick.any():
        return ""
    shape = shape.take(np.flatnonzero(pick))
    if isinstance(shape, Triangles):
        return _triangles(shape, material, index)
    if isinstance(shape, Spheres):
        return _lines("s %r %r %r %r\n", shape.center, shape.radius)
    if isinstance(shape, Cylinders):
        radii = (shape.radius, shape.radius)
    elif isinstance(shape, Cones):
        radii = (shape.base_radius, shape.apex_radius)
    return _lines("c %r %r %r %r %r %r %r %r\n", shape.base, radii[0], shape.apex, radii[1])


def _triangles(shape, material, index):
    """Polygons; NFF shows those of an opaque material from one side only, so that two-sided ones are written
    both ways."""
    transmits = any(material.transmit)
    one_sided = shape.one_sided != 0
    _refuse(transmits and one_sided.any(), f"material {index}: a triangle that transmits light but has one side")
    p, n = (np.stack([getattr(shape, f"{letter}{i}") for i in range(3)], axis=1) for letter in "pn")
    if not transmits:
        double = ~one_sided
        p, n = (np.concatenate([x, x[double, ::-1]]) for x in (p, n))
    smooth = (n != 0.0).any(axis=(1, 2))
    flat = _lines("p 3\n" + 3 * "%r %r %r\n", p[~smooth])
    return flat + _lines("pp 3\n" + 3 * "%r %r %r %r %r %r\n", np.concatenate([p, n], axis=2)[smooth])


def _lines(form, *columns):
    """One record of the form `form` for each row of the columns side by side; repr gives the fewest digits
    that suffice."""
    values = np.concatenate([np.reshape(c, (len(c), c[:1].size or 1)) for c in columns], axis=1, dtype=np.float64)
    return (form * len(values)) % tuple(values.ravel().tolist())
