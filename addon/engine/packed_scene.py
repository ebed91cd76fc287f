"""What packing makes of a scene, and what differs between two of them."""

from dataclasses import dataclass

import numpy as np

from . import layout
from .changes import Change
from .residency import Residency

#: What the records of each name in the texture of tables tell of; those of materials tell of more than one.
_SECTIONS = {
    "light": Change.LIGHTS,
    "light_shape": Change.LIGHTS,
    "light_node": Change.LIGHTS,
    "plane": Change.PLANES,
    "plane_surface": Change.PLANES,
    "image": Change.IMAGES,
    "attribute": Change.ATTRIBUTES,
}

_DARK = (
    "the scene has no light: the sky is seen but lights nothing, so that other surfaces are black; add a light or let "
    "the world light the scene"
)
_GLOWS_IN_VAIN = (
    "all light comes from surfaces that glow, which light others only in a picture of more than one sample; "
    "take more samples or add a light"
)


@dataclass
class PackedScene:
    """What a session uploads. `uploads`: `Upload`s by texture. `frame`: values of the `Frame` record that depend on the
    scene alone. `features` and `constants`: of the shader. `origin` (3,): what positions are relative to. `bounds`
    (2, 3): of all but planes. `statistics`: see `Session.statistics`. `residency`: what the next scene may share.
    `change`: from the scene before, of what is not in the tables. `tables`: which texels of that texture are the
    records of a name; `table_texels` (n, 4) are its texels, None unless they are kept."""

    origin: np.ndarray
    uploads: dict
    frame: dict
    features: frozenset
    constants: dict
    programs: str
    world: object
    world_programs: object
    shadows_pass: dict  # whether shadow rays may pass through something, by `Settings.shadows`
    bounds: np.ndarray
    statistics: dict
    warnings: list
    residency: Residency
    change: Change
    tables: dict
    table_texels: np.ndarray | None
    needs_light: bool  # whether without the world's light surfaces are black

    @property
    def textures(self):
        """What is to be uploaded, float32 (height, width, 4) by name."""
        return {name: upload.texels for name, upload in self.uploads.items()}

    def table(self, name):
        """The texels (n, 4) of the records of a name."""
        return self.table_texels[self.tables[name]]

    def warnings_with(self, settings):
        """The warnings of a picture with some `Settings`."""
        is_dark = self.needs_light and not (self.world.lights and settings.world_light != "NONE")
        in_vain = settings.samples == 1 and self.lit_by_surfaces_alone
        return [*self.warnings, *([_DARK] if is_dark else []), *([_GLOWS_IN_VAIN] if in_vain else [])]

    @property
    def lit_by_surfaces_alone(self):
        """Whether surfaces that glow are the only lights."""
        return self.frame["emitter_count"] > 0 and not self.frame["light_count"] and not self.world.lights


def table_changes(before, now):
    """The `Change` from one `PackedScene` to another of what lies in the texture `tables`."""
    if before.table_texels is None or now.table_texels is None:
        return ~Change.NONE
    change = Change.NONE
    for name, flag in _SECTIONS.items():
        if not np.array_equal(before.table(name), now.table(name)):
            change |= flag
    for flag, was, is_now in zip(
        (Change.MATERIALS, Change.LIGHTS, Change.WORLD), _materials(before), _materials(now), strict=True
    ):
        if not all(map(np.array_equal, was, is_now)):
            change |= flag
    return change


def _materials(packed):
    """Of a `PackedScene` arrays of what makes its materials, of what the lights tell of them, of what makes its
    world."""
    records = packed.table("material").reshape(-1).view(layout.MATERIAL.dtype).copy()
    constants, area = packed.table("constant"), records["glow_area"].copy()
    records["glow_area"] = 0.0
    first = int(records["constants"][-1]) if records["program"][-1] else len(constants)
    records["constants"][-1] = 0
    texels = records.view(np.float32).reshape(len(records), -1)
    seen = np.array([packed.frame["world_visibility"]])
    return (texels[:-1], constants[:first]), (area,), (texels[-1], constants[first:], seen)
