"""How a picture is made, apart from what is in it."""

from dataclasses import dataclass

from .errors import SceneError


@dataclass(frozen=True)
class Settings:
    """Render settings. Raises SceneError for values out of range.

    `samples`: rays through each pixel; the first goes through its centre. One takes the middle of each light, for a
    picture without noise; of more, each takes another point of it. `max_depth`: the eye ray is 1.
    `weight_cutoff`: rays of a smaller share of the pixel are not followed, 0 follows all. `tinted_shadows`: shadow
    rays pass through transmitting bodies and take on their colour; otherwise all bodies are opaque to them, as in the
    paper. `film_transparent`: alpha 0 where the eye sees the sky. `count_rays`: compile the variant of the shader
    that counts. `corner_rays`: rays through the corners of the pixels, four averaged, one row and column more than
    pixels. `stack_limit`: the most rays that wait at a time; with more needed, what is dropped is counted and
    reported.
    """

    samples: int = 1
    max_depth: int = 8
    weight_cutoff: float = 1.0 / 512.0
    tinted_shadows: bool = False
    film_transparent: bool = False
    count_rays: bool = False
    corner_rays: bool = False
    stack_limit: int = 32

    def __post_init__(self):
        for name, lowest, highest in (
            ("samples", 1, 1 << 20),
            ("max_depth", 1, 1024),
            ("stack_limit", 1, 64),
        ):
            if not lowest <= getattr(self, name) <= highest:
                raise SceneError(f"{name} is {getattr(self, name)}; it must lie between {lowest} and {highest}")
        if not 0.0 <= self.weight_cutoff < 1.0:
            raise SceneError(f"weight_cutoff is {self.weight_cutoff}; it must be at least 0 and less than 1")

    @classmethod
    def strict(cls):
        """The rules of the Standard Procedural Databases, under which ray counts are published."""
        return cls(max_depth=5, weight_cutoff=0.0, corner_rays=True, count_rays=True)

    @property
    def stack_size(self):
        """Rays that can wait: a path of this depth never has more than max_depth - 1 of them."""
        return min(max(self.max_depth - 1, 1), self.stack_limit)

    @property
    def may_drop(self):
        return self.stack_size < self.max_depth - 1
