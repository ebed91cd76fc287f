"""What surfaces and the sky look like. See `scene` for units."""

from dataclasses import dataclass

import numpy as np

from .errors import SceneError
from .expression import AttributeNumber, Expression, Parameter, absolute, call, expression, largest, less, select
from .visibility import Visibility

_COLORS = (
    "diffuse",
    "reflect",
    "transmit",
    "glow",
    "absorption",
    "highlight",
    "metallic",
    "grazing",
    "edge",
    "translucent",
    "coat",
    "coat_tint",
)
_SHARES = ("roughness", "transmit_roughness", "coat_roughness", "diffuse_roughness", "holdout", "body")


@dataclass(frozen=True)
class Material:
    """The paper's colour class (3.1.1): glow g, reflect r, transmit t, diffuse d, index n0, and absorption.

    Each member but the last three is a number or a scene-linear RGB colour, a `Parameter` of one, or an `Expression`
    that varies over the surface. With `fresnel` the mirror ray has weight r F, the refracted one t (1 - F), and the
    diffuse share is d (1 - r F), F the exact unpolarised reflectance; without it the shares are the constants, as NFF
    has them. `diffuse_covered` and `transmit_covered` say otherwise how much of them loses F to the mirror;
    `fresnel_ior` is the index that F is taken of where it is not that of the body.

    The share of metals is added to the mirror's: it grows from `metallic` to `grazing` at grazing incidence after
    Schlick, and `edge` tints it near 82 degrees (Hoffman 2023, Generating Real-Time Rendering's F82). `roughness` is
    that of Blender: of microfacets of the GGX distribution whose alpha is its square; with it the lights have
    highlights, and with more than one sample the rays are spread. Rough facets lose what they reflect to each other;
    with `multiscatter`, 0 to 1, they give it back; `body` is the weight that glass has in a mixture, which tells what
    of `transmit` is its color. `coat` is the weight of a second mirror, a dielectric's of the index `coat_ior`, which
    lies on top, lets the rest through and tints it. `translucent` is a diffuse share of the light from the other side.
    `diffuse_roughness` is that of Oren and Nayar, as Cycles has it. `normal` is the shading normal, of any length, or
    zero for the surface's own. `holdout` is a share that is cut out of the picture. `straight` is the part of
    `transmit` that shadow rays keep where what bends light blocks them.
    """

    diffuse: tuple = (0.8, 0.8, 0.8)
    reflect: tuple = (0.0, 0.0, 0.0)
    transmit: tuple = (0.0, 0.0, 0.0)
    glow: tuple = (0.0, 0.0, 0.0)
    ior: float = 1.5
    absorption: tuple = (0.0, 0.0, 0.0)  # 1 / length, Beer-Lambert, inside the body
    fresnel: bool = True
    highlight: tuple = (0.0, 0.0, 0.0)  # weight of the lights' Phong highlight
    shine: float = 1.0  # its exponent
    roughness: float = 0.0  # of the mirror
    transmit_roughness: float = 0.0
    diffuse_covered: float | None = None  # None: follows from `fresnel` and `reflect`
    transmit_covered: float | None = None
    fresnel_ior: float = 0.0  # 0: `ior`
    metallic: tuple = (0.0, 0.0, 0.0)
    grazing: tuple = (0.0, 0.0, 0.0)
    edge: tuple = (1.0, 1.0, 1.0)
    multiscatter: float = 0.0
    body: float = 1.0
    translucent: tuple = (0.0, 0.0, 0.0)
    coat: tuple = (0.0, 0.0, 0.0)
    coat_roughness: float = 0.0
    coat_ior: float = 1.5
    coat_tint: tuple = (1.0, 1.0, 1.0)
    diffuse_roughness: float = 0.0
    normal: tuple = (0.0, 0.0, 0.0)
    holdout: float = 0.0
    straight: tuple | None = None  # None: all of `transmit` where `ior` is 1
    bounds_body: bool = True  # False: a single sheet, which bends light but is no border of a medium
    cull_back: bool = False  # rays that meet the back pass through, shadow rays only with the next
    cull_back_shadow: bool = False
    emission: str = "BOTH"  # which sides light what is around: BOTH, FRONT, BACK, NONE; all that glows is seen

    def __post_init__(self):
        for name in _COLORS:
            object.__setattr__(self, name, _checked_color(f"material: {name}", getattr(self, name)))
        self._check("ior", "it must be positive", lambda x: np.isfinite(x) and x > 0.0)
        self._check("coat_ior", "it must be positive", lambda x: np.isfinite(x) and x > 0.0)
        self._check("shine", "it must be finite and not negative", lambda x: np.isfinite(x) and x >= 0.0)
        for name in _SHARES:
            self._check(name, "it must lie between 0 and 1", lambda x: 0.0 <= x <= 1.0)
        if self.diffuse_covered is None:
            object.__setattr__(self, "diffuse_covered", self._share_of_fresnel())
        if self.transmit_covered is None:
            object.__setattr__(self, "transmit_covered", self.fresnel)
        straight = self._unbent() if self.straight is None else _checked_color("material: straight", self.straight)
        object.__setattr__(self, "straight", straight)

    def _share_of_fresnel(self):
        """What the mirror's share is of Fresnel's reflectance."""
        if isinstance(self.fresnel, Expression) or isinstance(self.reflect, Expression):
            return expression(self.fresnel) * largest(self.reflect)
        return self.fresnel * max(self.reflect)

    def _unbent(self):
        """What goes through where the index is 1."""
        if isinstance(self.ior, Expression):
            return select(less(absolute(self.ior - 1.0), 1e-6), self.transmit, 0.0)
        return self.transmit if self.ior == 1.0 else (0.0, 0.0, 0.0)

    def _check(self, name, rule, holds):
        value = getattr(self, name)
        if not isinstance(value, Expression) and not holds(value):
            raise SceneError(f"material: {name} is {value}; {rule}")

    @classmethod
    def mirror(cls, color=(1.0, 1.0, 1.0), roughness=0.0):
        return cls(diffuse=0.0, reflect=color, roughness=roughness, fresnel=False)

    @classmethod
    def metal(cls, color, roughness=0.0, edge=(1.0, 1.0, 1.0)):
        return cls(diffuse=0.0, metallic=color, roughness=roughness, grazing=1.0, edge=edge)

    @classmethod
    def glass(cls, color=(1.0, 1.0, 1.0), ior=1.5, absorption=(0.0, 0.0, 0.0), roughness=0.0):
        rough = {"roughness": roughness, "transmit_roughness": roughness}
        return cls(diffuse=0.0, reflect=1.0, transmit=color, ior=ior, absorption=absorption, **rough)

    @classmethod
    def plastic(cls, color, ior=1.5, roughness=0.0):
        """A diffuse body under a clear surface."""
        return cls(diffuse=color, reflect=1.0, ior=ior, roughness=roughness)


@dataclass(frozen=True)
class World:
    """What a ray that hits nothing sees: `color`, an Expression too, times an equirectangular image where there is one.

    The image is seen as Blender maps it: its centre towards +X, u = 1/2 - atan2(y, x) / 2 pi. With `lights` the world
    also lights diffuse surfaces; `visibility` says which rays of the camera, mirrors and refraction see it. `detail`:
    how many texels around the horizon its finest parts need, so that none of its light is missed; 0 where it is
    smooth.
    """

    color: tuple = (0.05, 0.05, 0.05)
    image: int = -1
    lights: bool = False
    visibility: Visibility = Visibility.ALL
    detail: int = 0

    def __post_init__(self):
        object.__setattr__(self, "color", _checked_color("world: color", self.color))

    @property
    def radiance(self):
        """Its colour (3,), or an Expression of it."""
        if self.image < 0:
            return self.color
        uv = call("panorama_uv", call("point_position"))
        return expression(self.color) * call("image_sample", Parameter(self.image, "int"), uv)


def surface_image(number):
    """The colour of an image of the scene by the surface's uv."""
    return call("image_sample", Parameter(number, "int"), call("point_uv"))


def surface_attribute(key):
    """The colour of an attribute: of the primitive where its geometry has it, else of the instance, else 0."""
    return call("attribute_value", AttributeNumber(key))


def _checked_color(name, value):
    """An Expression, or three floats from a colour or one number for all three; SceneError where one is negative or not
    finite."""
    if isinstance(value, Expression):
        return value
    value = np.broadcast_to(np.asarray(value, np.float64), (3,))
    if not np.isfinite(value).all() or (value < 0.0).any():
        raise SceneError(f"{name} is {tuple(value.tolist())}; it must be finite and not negative")
    return tuple(value.tolist())
