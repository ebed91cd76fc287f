"""Lights: where they are, what they give, how large they are."""

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from .errors import SceneError
from .visibility import Visibility

#: Shapes of area lights, by the names of the API.
_AREA_SHAPES = ("RECTANGLE", "ELLIPSE")
#: Area lights of a smaller spread would be seen by nearly no sample.
_LEAST_SPREAD = np.radians(0.1)


class LightKind(IntEnum):
    POINT = 0  # a point or a ball, the same to all sides; falls off with the square of the distance
    CONSTANT = 1  # a point without fall-off, as in NFF
    SUN = 2  # parallel rays, or a disc in the sky
    SPOT = 3  # a point or a ball that shines in a cone
    RECTANGLE = 4  # area lights, which shine to one side
    ELLIPSE = 5
    # Surfaces of the scene that glow; round spheres and discs are POINT and ELLIPSE.
    TRIANGLE = 6
    ELLIPSOID = 7
    TUBE = 8  # side of a cylinder or cone


@dataclass(frozen=True)
class Light:
    """A light. The class methods make it from physical units.

    `color` (3,) is the radiance that a white diffuse surface facing the light returns: at distance 1 of a small light
    that falls off, in front of it if it is an area light, in the middle of its cone if it is a spot.

    A picture of one sample takes the light from the middle of each light, so that it is without noise and its shadows
    are sharp; with more samples, each takes it from another point of the light.
    """

    kind: LightKind
    position: tuple  # where its middle is. SUN: direction towards it
    color: tuple
    shadow: bool = True  # whether what stands before it casts a shadow
    radius: float = 0.0  # POINT, SPOT: of the ball. SUN: half the angle under which it is seen, in radians
    soft: bool = False  # POINT, SPOT: not a ball but its middle disc, which faces each point that it lights
    axes: tuple = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    """(3, 3). Area lights: from the middle to the middle of a side, the same of the side beside it, and the unit
    direction in which it shines. SPOT: the matrix from the world's directions to where its cone is round about +Z."""
    angle: float = np.pi  # SPOT: of the cone, full. Area lights: the spread, beyond half of which it is not seen
    blend: float = 0.0  # SPOT: how much of the cone its soft edge takes, 0 to 1
    falls_off: bool = True  # with the square of the distance; says nothing of CONSTANT and SUN, which never do
    visibility: Visibility = Visibility.ALL
    """Of DIFFUSE, GLOSSY and TRANSMISSION: the ways of surfaces to send on light in which this one is seen. With an
    extent it is there to be seen itself: of CAMERA by the camera, of the others in mirrors and through glass."""
    receivers: int = 0  # the `Visibility.group` that it lights alone; 0: it lights everything
    blockers: int = 0  # the group that casts its shadows alone; 0: everything does

    @classmethod
    def point(cls, position, watts, color=(1.0, 1.0, 1.0), *, radius=0.0, soft=False, shadow=True):
        """A point light, or a ball, of `watts` as Blender counts them: watts / 4 pi per steradian; a white diffuse
        surface returns the irradiance divided by pi."""
        color = _scaled(color, watts / (4.0 * np.pi**2))
        return cls(LightKind.POINT, tuple(position), color, shadow, radius=_checked_radius(radius), soft=soft)

    @classmethod
    def constant(cls, position, color=(1.0, 1.0, 1.0), *, shadow=True):
        """A positional light without fall-off, as the NFF databases have it."""
        return cls(LightKind.CONSTANT, tuple(position), _scaled(color, 1.0), shadow)

    @classmethod
    def sun(cls, towards, strength, color=(1.0, 1.0, 1.0), *, angle=0.0, shadow=True):
        """Light from the direction `towards` (3,), where the sun is seen under `angle` radians; `strength` is the
        irradiance in watts per square metre of a surface that faces it."""
        direction = _direction("sun", towards)
        if not 0.0 <= angle <= np.pi:
            raise SceneError(f"sun: the angle {angle} does not lie between 0 and pi")
        color = _scaled(color, strength / np.pi)
        return cls(LightKind.SUN, tuple(direction), color, shadow, radius=angle / 2.0)

    @classmethod
    def spot(
        cls, position, direction, watts, angle, blend=0.0, color=(1.0, 1.0, 1.0), *, axes=None, radius=0.0, soft=False,
        shadow=True,
    ):  # fmt: skip
        """A point light that only shines in a cone of the full `angle` (radians) about `direction` (3,); `blend`: how
        much of it the soft edge takes, 0 to 1. `axes` (3, 3), instead of a direction: see there, for stretched cones.
        """
        if not 0.0 < angle <= np.pi or not 0.0 <= blend <= 1.0:
            raise SceneError(f"spot: the angle {angle} must lie between 0 and pi, the blend {blend} between 0 and 1")
        if axes is None:
            axes = _frame(_direction("spot", direction))
        ball = cls.point(position, watts, color, radius=radius, soft=soft, shadow=shadow)
        return replace(ball, kind=LightKind.SPOT, axes=_rows(axes), angle=float(angle), blend=float(blend))

    @classmethod
    def area(
        cls, center, x, y, watts, color=(1.0, 1.0, 1.0), *, shape="RECTANGLE", spread=np.pi, direction=None, shadow=True
    ):
        """A rectangle with the sides `x` and `y` (3,), or the ellipse within it, that gives off `watts` to the side of
        `direction`, by default x cross y. `spread` (radians): light leaves it under at most half of it to the
        direction, the more the less, as behind a grid of slats."""
        if shape not in _AREA_SHAPES:
            raise SceneError(f"area light: the shape {shape!r} is none of {', '.join(_AREA_SHAPES)}")
        if not 0.0 <= spread <= np.pi:
            raise SceneError(f"area light: the spread {spread} does not lie between 0 and pi")
        x, y = np.asarray(x, np.float64), np.asarray(y, np.float64)
        facing = np.cross(x, y)
        if not np.linalg.norm(facing) > 0.0:
            raise SceneError(f"area light: the sides {tuple(x.tolist())} and {tuple(y.tolist())} have no area")
        towards = _direction("area light", facing if direction is None else direction)
        kind = LightKind.RECTANGLE if shape == "RECTANGLE" else LightKind.ELLIPSE
        spread = max(float(spread), _LEAST_SPREAD)
        color = _scaled(color, watts / np.pi**2 * _spread_gain(spread))
        return cls(kind, tuple(center), color, shadow, axes=_rows((x / 2.0, y / 2.0, towards)), angle=spread)

    def without_falloff(self):
        """The light that is as bright everywhere as this one at distance 1; a sun is so anyway."""
        if self.kind == LightKind.POINT and self.radius == 0.0:
            return replace(self, kind=LightKind.CONSTANT)
        return replace(self, falls_off=self.kind in (LightKind.CONSTANT, LightKind.SUN))

    @property
    def shaped(self):
        """Whether it is more than a point or parallel rays."""
        return self.kind >= LightKind.SPOT or self.radius > 0.0 or not self.falls_off

    @property
    def shown_area(self):
        """Area that it shows on the mean, of a sun the solid angle; 0 without extent."""
        if self.kind in (LightKind.POINT, LightKind.SPOT):
            return np.pi * self.radius**2
        if self.kind == LightKind.SUN:
            return 4.0 * np.pi * np.sin(self.radius / 2.0) ** 2
        if self.kind == LightKind.CONSTANT:
            return 0.0
        return np.linalg.norm(np.cross(*self.axes[:2])) * (4.0 if self.kind == LightKind.RECTANGLE else np.pi)

    @property
    def rays(self):
        """`visibility` with SHADOW where it casts shadows."""
        bits = self.visibility & (Visibility.ALL & ~Visibility.SHADOW)
        return bits | Visibility.SHADOW if self.shadow else bits


def _spread_gain(spread):
    """How much brighter an area light is straight ahead for its spread, since it gives off the same watts.

    Seen a off its axis a grid of slats shows 1 - tan a / tan h of the light, h half the spread. This, times the cosine,
    over all directions is pi (1 - h / tan h); without a grid, pi.
    """
    half = spread / 2.0
    return 1.0 / (1.0 - half / np.tan(half))


def _direction(what, vector):
    """A unit vector; SceneError where it has no length."""
    vector = np.asarray(vector, np.float64)
    length = np.linalg.norm(vector)
    if not length > 0.0:
        raise SceneError(f"{what}: the direction {tuple(vector.tolist())} has no length")
    return vector / length


def _checked_radius(radius):
    if not (np.isfinite(radius) and radius >= 0.0):
        raise SceneError(f"light: the radius {radius} must be finite and not negative")
    return float(radius)


def _frame(axis):
    """Three unit vectors (3, 3) at right angles, the last of them `axis`."""
    x = np.cross(np.eye(3)[np.argmin(np.abs(axis))], axis)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(axis, x), axis])


def _rows(matrix):
    return tuple(tuple(row) for row in np.asarray(matrix, np.float64).tolist())


def _scaled(color, factor):
    """An RGB colour, given as three numbers or one, times a factor."""
    return tuple(float(x) for x in np.broadcast_to(np.multiply(color, factor), (3,)))
