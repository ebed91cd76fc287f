"""How a picture is made, apart from what is in it."""

from dataclasses import dataclass, replace

import numpy as np

from .entries import ENTRIES
from .errors import SceneError
from .film_options import DepthCue, Outlines

WORLD_LIGHTS = ("SAMPLED", "HEMISPHERE", "NONE")
SHADOWS = ("OPAQUE", "TRANSPARENT", "TINTED")
#: Rays of ambient occlusion in a picture of one sample.
AO_RAYS = 16


@dataclass(frozen=True)
class Settings:
    """Render settings. Raises SceneError for values out of range.

    `samples`: rays through each pixel; the first goes through its centre. One takes the middle of each light, for a
    picture without noise; of more, each takes another point of it. `max_depth`: the eye ray is 1.
    `weight_cutoff`: rays of a smaller share of the pixel are not followed, 0 follows all. `film_transparent`: alpha 0
    where the eye sees the sky. `count_rays`: compile the variant of the shader that counts. `corner_rays`: rays
    through the corners of the pixels, four averaged, one row and column more than pixels. `seed`: pictures of more than
    one sample have other noise with another. `stack_limit`: the most
    rays that wait at a time; with more needed, what is dropped is counted and reported. `flat_colors`: surfaces have
    their diffuse colour wherever light comes from. `depth_cue`, `outlines`: None for none.

    `shadows`: OPAQUE, whatever is in the way blocks a light, as in the paper; TRANSPARENT, what transmits without
    bending lets its share of the light through, as in Cycles; TINTED, all that transmits does, straight, glass too.

    `world_light`, of worlds that light: SAMPLED by shadow rays, at one sample as HEMISPHERE, which is smooth and has no
    shadows, or NONE. `use_ao`: what is within `ao_distance` (0: however far) takes the share `ao_factor` of the
    hemisphere's light away.

    `entry`: how the GPU is given its work, FRAGMENT or COMPUTE; AUTO, as is faster on the device. The picture is the
    same.
    """

    samples: int = 1
    max_depth: int = 8
    weight_cutoff: float = 1.0 / 512.0
    shadows: str = "OPAQUE"
    film_transparent: bool = False
    count_rays: bool = False
    corner_rays: bool = False
    seed: int = 0
    stack_limit: int = 32
    flat_colors: bool = False
    depth_cue: DepthCue | None = None
    outlines: Outlines | None = None
    world_light: str = "SAMPLED"
    use_ao: bool = False
    ao_distance: float = 1.0
    ao_factor: float = 1.0
    entry: str = "AUTO"

    def __post_init__(self):
        for name, lowest, highest in (
            ("samples", 1, 1 << 20),
            ("max_depth", 1, 1024),
            ("seed", 0, 2**31 - 1),
            ("stack_limit", 1, 64),
        ):
            if not lowest <= getattr(self, name) <= highest:
                raise SceneError(f"{name} is {getattr(self, name)}; it must lie between {lowest} and {highest}")
        if not 0.0 <= self.weight_cutoff < 1.0:
            raise SceneError(f"weight_cutoff is {self.weight_cutoff}; it must be at least 0 and less than 1")
        for name, known in (("world_light", WORLD_LIGHTS), ("shadows", SHADOWS), ("entry", ENTRIES)):
            if getattr(self, name) not in known:
                raise SceneError(f"{name} is {getattr(self, name)!r}; it must be one of {', '.join(known)}")
        if not (np.isfinite(self.ao_distance) and self.ao_distance >= 0.0):
            raise SceneError(f"ao_distance is {self.ao_distance}; it must be finite and not negative")
        if not 0.0 <= self.ao_factor <= 1.0:
            raise SceneError(f"ao_factor is {self.ao_factor}; it must lie between 0 and 1")

    @classmethod
    def strict(cls):
        """The rules of the Standard Procedural Databases, under which ray counts are published."""
        return cls(max_depth=5, weight_cutoff=0.0, corner_rays=True, count_rays=True)

    def draws_as(self, other):
        """Whether a sample is the same with both: of how many, matters only where it is one."""
        mine, others = (replace(each, samples=min(each.samples, 2), entry="AUTO") for each in (self, other))
        return mine == others

    @property
    def least_chance(self):
        """Of a rough ray that brings little to be followed: about four of a pixel are, fewer are seen as noise."""
        return 2.0 ** min(np.ceil(np.log2(4.0 / self.samples)), 0.0)

    @property
    def samples_world(self):
        """Whether the world lights by shadow rays."""
        return self.world_light == "SAMPLED" and self.samples > 1

    @property
    def ao_rays(self):
        """Rays at a lit surface that ask for what hides the world: few of many samples, so many that one is smooth."""
        return 1 if self.samples > 1 else AO_RAYS

    @property
    def stack_size(self):
        """Rays that can wait: a path of this depth never has more than max_depth - 1 of them."""
        return min(max(self.max_depth - 1, 1), self.stack_limit)

    @property
    def may_drop(self):
        return self.stack_size < self.max_depth - 1

    @property
    def film_features(self):
        """Features of the shaders that flat colours, depth cue and outlines need."""
        features = {"HAS_GUIDE"} if self.depth_cue or self.outlines else set()
        if self.flat_colors:
            features.add("FLAT_COLORS")
        if self.depth_cue:
            features.add("HAS_DEPTH_CUE")
        if self.outlines:
            features |= {"HAS_OUTLINES", self.outlines.feature}
        return features
