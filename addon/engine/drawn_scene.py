"""All that a draw of a loaded scene needs to know."""

from dataclasses import dataclass

import numpy as np

from . import depth_cue, layout
from .packed_scene import PackedScene
from .scene import Camera, Scene
from .scene_program import counts_rays
from .settings import Settings
from .shader_source import ProgramSource
from .world_light import WorldLight

#: Seeds that a float of `Frame` tells apart.
_SEEDS = 1 << 23


@dataclass(eq=False)
class DrawnScene:
    """All that a draw needs. `textures` and the texels that there is room for are by name; `source` and `features`
    are those of the `program`. `scene`: what it was made of, None unless its trees are to be improved."""

    scene: Scene | None
    packed: PackedScene
    settings: Settings
    camera: Camera
    world_light: WorldLight | None
    world_digest: bytes
    textures: dict
    rooms: dict
    source: ProgramSource
    features: frozenset
    program: object

    @property
    def counts(self):
        """Whether rays are counted."""
        return counts_rays(self.settings)

    @property
    def entry(self):
        """Which entry of the path tracer the program has, FRAGMENT or COMPUTE."""
        return "COMPUTE" if self.source.is_compute else "FRAGMENT"

    @property
    def outputs(self):
        """What the program writes, an attachment of the film each."""
        return self.source.outputs

    def frame_values(self, camera):
        """Members of the record `Frame` that depend on the scene, the settings and the camera."""
        matrix = np.asarray(camera.matrix, np.float64)
        packed, settings = self.packed, self.settings
        left, right, bottom, top = camera.window
        values = {
            **packed.frame,
            **(self.world_light.frame if self.world_light else {}),
            "camera_origin": matrix[:3, 3] - packed.origin,
            "camera_right": matrix[:3, 0],
            "camera_up": matrix[:3, 1],
            "camera_forward": -matrix[:3, 2],
            "orthographic": camera.orthographic,
            "clip_start": camera.clip[0],
            "clip_end": camera.clip[1],
            "window": (left, bottom, 1.0 / (right - left), 1.0 / (top - bottom)),
            "world_origin": packed.origin,
            "seed": settings.seed % _SEEDS,
            "max_depth": settings.max_depth,
            "shadows_pass": packed.shadows_pass[settings.shadows],
            "weight_cutoff": settings.weight_cutoff,
            "least_chance": settings.least_chance,
            "ao_distance": settings.ao_distance or 1e30,
            "ao_factor": settings.ao_factor,
            "ao_rays": settings.ao_rays,
            "film_transparent": settings.film_transparent,
        }
        if settings.depth_cue:
            values |= depth_cue.frame_values(settings.depth_cue, camera, packed.bounds, packed.origin)
        return values

    def draw(self, device, target, rectangle, values):
        """Draw a rectangle of a target whose attachments are `outputs`; `values`: members of the record `Frame`."""
        device.draw(self.program, target, rectangle, self.textures, frame_record(values))

    def draw_outside(self, device):
        """Draw one pixel of a target that is thrown away, and whose sides, as most do, are no powers of two: Mesa's
        software rasteriser compiles compute programs anew where these are."""
        scratch = device.target(3, 3, len(self.outputs))
        self.draw(device, scratch, (0, 0, 1, 1), self.frame_values(self.camera))
        device.read(scratch, 0, (0, 0, 1, 1))
        device.release(scratch)


def frame_record(values):
    """The uniform block (n,) float32 of members of the record `Frame` by name."""
    record = layout.FRAME.zeros(1)
    for name, value in values.items():
        record[name] = value
    return record.view(np.float32)
