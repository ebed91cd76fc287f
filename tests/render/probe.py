"""What the tests of optics ask a renderer: the light along single rays, and formulas in float64 to compare it with."""

import numpy as np

from addon.engine import Camera, render


def along(device, scene, origin, direction, settings):
    """The light (3,) float64 that arrives at origin (3,) from direction (3,), by a picture of one pixel."""
    up = (0.0, 0.0, 1.0) if abs(direction[2]) < 0.9 * np.linalg.norm(direction) else (0.0, 1.0, 0.0)
    scene.camera = Camera.orthographic_at(origin, np.add(origin, direction), 1e-3, up=up)
    return render(scene, 1, 1, settings, device=device).pixels[0, 0, :3].astype(np.float64)


def fresnel(cos_i, n_from, n_to):
    """Unpolarised reflectance by both amplitudes (Born and Wolf 1.5.2), 1 at total reflection."""
    angle_i = np.arccos(np.clip(cos_i, -1.0, 1.0))
    sin_t = n_from / n_to * np.sin(angle_i)
    with np.errstate(invalid="ignore"):
        cos_t = np.sqrt(1.0 - sin_t**2)
        r_s = (n_from * cos_i - n_to * cos_t) / (n_from * cos_i + n_to * cos_t)
        r_p = (n_to * cos_i - n_from * cos_t) / (n_to * cos_i + n_from * cos_t)
        return np.where(sin_t >= 1.0, 1.0, (r_s**2 + r_p**2) / 2.0)


class GlassBalls:
    """A float64 ray tracer for nothing but dielectric balls, none of which cross, under a white sky.

    `balls`: (center, radius, index, absorption) each. A point's medium is the smallest ball that holds it: unlike in
    the renderer, no book is kept of what a ray has entered.
    """

    def __init__(self, balls):
        self.balls = [
            (np.array(center, float), radius, index, np.array(a, float)) for center, radius, index, a in balls
        ]

    def medium(self, point):
        """Index and absorption (3,) at a point."""
        inside = [ball for ball in self.balls if np.linalg.norm(point - ball[0]) < ball[1]]
        return min(inside, key=lambda ball: ball[1])[2:] if inside else (1.0, np.zeros(3))

    def light(self, origin, direction, depth):
        """What arrives along a ray, (3,), when it may branch until a ray of this depth."""
        t, center = self._nearest(origin, direction)
        if not np.isfinite(t):
            return np.ones(3)
        absorption = self.medium(origin + 0.5 * t * direction)[1]
        if depth == 1:
            return np.zeros(3)
        point = origin + t * direction
        normal = (point - center) / np.linalg.norm(point - center)
        normal = -normal if normal @ direction > 0.0 else normal
        n_from, n_to = (self.medium(point + side * 1e-9 * normal)[0] for side in (1.0, -1.0))
        cos_i = -normal @ direction
        share = float(fresnel(cos_i, n_from, n_to))
        result = np.zeros(3)
        if share > 0.0:
            result += share * self.light(point + 1e-9 * normal, direction + 2.0 * cos_i * normal, depth - 1)
        if share < 1.0:
            tangent = n_from / n_to * (direction + cos_i * normal)
            refracted = tangent - np.sqrt(1.0 - tangent @ tangent) * normal
            result += (1.0 - share) * self.light(point - 1e-9 * normal, refracted, depth - 1)
        return result * np.exp(-absorption * t)

    def _nearest(self, origin, direction):
        """Distance to the nearest surface and the centre of its ball."""
        best = (np.inf, None)
        for center, radius, _, _ in self.balls:
            along_ray = (center - origin) @ direction
            root = radius**2 - np.sum((center - origin - along_ray * direction) ** 2)
            if root > 0.0:
                roots = [t for t in (along_ray - np.sqrt(root), along_ray + np.sqrt(root)) if t > 0.0]
                best = min([best, *((t, center) for t in roots)], key=lambda hit: hit[0])
        return best
