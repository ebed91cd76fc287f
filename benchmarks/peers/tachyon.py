"""Tachyon on the scene in its own language."""

import shutil
import subprocess
from pathlib import Path

import numpy as np

from addon.engine import LightKind, SceneError

from .base import Peer, number_in, run_program


class Tachyon(Peer):
    name = "Tachyon"
    unequal = (
        "Tachyon traces in float64, on as many threads as there are cores, over a grid instead of a tree.",
        "Tachyon does not bend light and follows what goes through however deep: scenes with glass are left out.",
        "Tachyon has no cones: cylinders of the mean radius stand for them.",
    )

    @classmethod
    def missing(cls):
        return None if shutil.which("tachyon") else "tachyon is not installed"

    @classmethod
    def version(cls):
        return subprocess.run(["tachyon", "-version"], capture_output=True, text=True).stdout.strip()  # ends with 255

    def __init__(self, scene, size, depth, folder):
        source = Path(folder, "scene.dat")
        source.write_text(scene_text(scene, size, depth))
        self._folder, self._size = folder, size
        self._target = Path(folder, "tachyon.ppm")
        self._command = ["tachyon", str(source), "-format", "PPM48", "-shade_phong", "-o", str(self._target)]

    def trace(self):
        return number_in(run_program(self._command, self._folder), r"Ray Tracing Time:\s+(\d+\.?\d*)")

    def picture(self):
        data = self._target.read_bytes()[-(self._size**2) * 6 :]
        return np.frombuffer(data, ">u2").reshape(self._size, self._size, 3)[::-1, ::-1] / 65535.0


def scene_text(scene, size, depth):
    """The scene in Tachyon's language. Raises SceneError for what it cannot say."""
    if scene.planes or scene.instances or any(light.kind != LightKind.CONSTANT for light in scene.lights):
        raise SceneError("planes, instances and lights with fall-off are not written for Tachyon")
    if any(any(material.transmit) for material in scene.materials):
        raise SceneError("Tachyon does not bend light")
    parts = ["BEGIN_SCENE", f"RESOLUTION {size} {size}", _camera(scene.camera, size, depth)]
    parts += [f"BACKGROUND {_join(scene.world.color)}", *map(_light, scene.lights)]
    parts += [_texture(i, material) for i, material in enumerate(scene.materials)]
    for _, part in scene.shapes.kinds():
        if part.kind not in _WRITERS:
            raise SceneError(f"a {part.kind} is not written for Tachyon")
        parts.append(_WRITERS[part.kind](part))
    return "\n".join([*parts, "END_SCENE", ""])


def _join(values):
    return " ".join(repr(float(x)) for x in values)


def _camera(camera, size, depth):
    """Its ZOOM is the focal length of a picture of height 1. It is left-handed: the picture is seen in a mirror.
    Its rays go through corners of pixels: the view is turned by half a pixel."""
    right, up, back, eye = camera.matrix[:3].T
    half_pixel = camera.window[3] / size
    lines = [
        "CAMERA",
        "PROJECTION PERSPECTIVE",
        f"ZOOM {float(0.5 / camera.window[3])!r}",
        "ASPECTRATIO 1.0",
        "ANTIALIASING 0",
        f"RAYDEPTH {depth}",
        f"CENTER {_join(eye)}",
        f"VIEWDIR {_join(half_pixel * (right - up) - back)}",
        f"UPDIR {_join(up)}",
        "END_CAMERA",
    ]
    return "\n".join(lines)


def _light(light):
    """A light is a ball there, which can be seen: this one is too small."""
    fall = "ATTENUATION CONSTANT 1 LINEAR 0 QUADRATIC 0"
    return f"LIGHT CENTER {_join(light.position)} RAD 1e-6 {fall} COLOR {_join(light.color)}"


def _texture(index, material):
    """Color times DIFFUSE is the matte share, SPECULAR the mirror's."""
    phong = f"PHONG PLASTIC {material.highlight[0]!r} PHONG_SIZE {material.shine!r}"
    return (
        f"TEXDEF M{index} AMBIENT 0 DIFFUSE 1 SPECULAR {material.reflect[0]!r} OPACITY 1 "
        f"{phong} COLOR {_join(material.diffuse)} TEXFUNC 0"
    )


def _lines(form, material, *columns):
    """A line for each row of the columns side by side, then its material."""
    if not len(material):
        return ""
    values = np.concatenate([np.reshape(c, (len(c), -1)) for c in columns], axis=1, dtype=np.float64).tolist()
    return "\n".join(form % (*row, m) for row, m in zip(values, material.tolist(), strict=True))


def _triangles(part):
    smooth = np.stack([part.n0, part.n1, part.n2]).any(axis=(0, 2))
    flat, round_ = part.take(~smooth), part.take(smooth)
    points = "V0 %r %r %r V1 %r %r %r V2 %r %r %r"
    normals = "N0 %r %r %r N1 %r %r %r N2 %r %r %r"
    texts = [
        _lines(f"TRI {points} M%d", flat.material, flat.p0, flat.p1, flat.p2),
        _lines(
            f"STRI {points} {normals} M%d", round_.material,
            round_.p0, round_.p1, round_.p2, round_.n0, round_.n1, round_.n2,
        ),
    ]  # fmt: skip
    return "\n".join(filter(None, texts))


_CYLINDER = "FCYLINDER BASE %r %r %r APEX %r %r %r RAD %r M%d"
_WRITERS = {
    "sphere": lambda part: _lines("SPHERE CENTER %r %r %r RAD %r M%d", part.material, part.center, part.radius),
    "cylinder": lambda part: _lines(_CYLINDER, part.material, part.base, part.apex, part.radius),
    "cone": lambda part: _lines(
        _CYLINDER, part.material, part.base, part.apex, (part.base_radius + part.apex_radius) / 2.0
    ),
    "triangle": _triangles,
}
