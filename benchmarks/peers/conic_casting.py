"""Conic's traversal without its shading: a program of its own over a loaded scene's trees."""

import time
from pathlib import Path

import numpy as np

from addon.engine import shader_source
from addon.engine.drawn_scene import frame_record

from .conic import Conic

_FOLDERS = (Path(__file__).resolve().parents[1] / "shaders", shader_source.SHADER_FOLDER)


class ConicCasting(Conic):
    """Eye rays and shadow rays to point lights: hits, normals and shadow tests alone."""

    def __init__(self, scene, size, depth=1, folder=None, **settings):
        super().__init__(scene, size, depth, folder, **settings)
        self._drawn = self.session.loaded.drawn
        self._program = self.device().program(self._source())
        self._target = self.device().target(size, size, 1)

    def trace(self):
        device, drawn, camera = self.device(), self._drawn, self.scene.camera
        self.session.start(self.size, self.size)
        frame = frame_record(drawn.frame_values(camera) | {"raster": self.session.film.raster(0, camera.window)})
        device.clear(self._target, 0)
        start = time.perf_counter()
        device.draw(self._program, self._target, (0, 0, self.size, self.size), drawn.textures, frame)
        device.read(self._target, 0, (0, 0, 1, 1))  # waits for the GPU
        return time.perf_counter() - start

    def rays(self):
        counted = self.device().read(self._target, 0, (0, 0, self.size, self.size)).sum(axis=(0, 1), dtype=np.float64)
        hits, shadows, lit = (int(number) for number in counted[:3])
        return {"eye": self.size**2, "eye_hit": hits, "shadow": shadows, "lit": lit}

    def close(self):
        self.device().release(self._target)
        super().close()

    def _source(self):
        lights = [light.position - self._drawn.packed.origin for light in self.scene.lights]
        return shader_source.program(
            "cast_frag.glsl",
            self._drawn.features & (shader_source.SPARE | {"HAS_GRID_ALONE"}),
            self._drawn.packed.constants | {"CAST_LIGHTS": len(lights)},
            folders=_FOLDERS,
            generated=(("cast_lights_lib.glsl", _lights_glsl(lights)),),
        )


def _lights_glsl(positions):
    """The function `cast_light(i)` of constants."""
    cases = (f"  if (i == {i}) {{ return vec3({x:.9g}, {y:.9g}, {z:.9g}); }}" for i, (x, y, z) in enumerate(positions))
    return "\n".join(["vec3 cast_light(int i)", "{", *cases, "  return vec3(0.0);", "}", ""])
