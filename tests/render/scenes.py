"""A scene that has everything, for tests that compare a picture of it with another."""

import numpy as np

from addon.engine import Camera, Geometry, Image, Instances, Light, Material, Scene, Spheres, Triangles, World
from addon.engine.material import surface_image


def still_life(eye=(3.0, -5.0, 2.6), aspect=4.0 / 3.0):
    """All kinds of shapes and lights, an ellipsoid, a smooth mesh, mirror, glass, coat, absorption and an image."""
    camera = Camera.look_at(eye, (0.1, 0.0, 0.6), angle=34.0, aspect=aspect)
    scene = Scene(camera=camera, world=World((0.25, 0.35, 0.5)))
    squares = np.indices((2, 2)).sum(axis=0) % 2
    board = scene.add_image(Image(np.repeat(squares[..., None] * 0.5 + 0.2, 3, axis=-1), interpolation="CLOSEST"))
    floor, red, mirror, glass, blue, syrup, yellow = (
        scene.add_material(material)
        for material in (
            Material(diffuse=surface_image(board), reflect=0.1, fresnel=False),
            Material(diffuse=(0.8, 0.2, 0.1)),
            Material.mirror((0.9, 0.9, 0.85)),
            Material.glass((0.95, 0.98, 0.95)),
            Material.plastic((0.1, 0.25, 0.7)),
            Material.glass(ior=1.3, absorption=(0.2, 1.0, 3.0)),
            Material(diffuse=(0.7, 0.6, 0.15), highlight=0.4, shine=30.0),
        )
    )
    scene.add_plane((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), floor, tile=1.6)
    balls = [(-0.7, 0.9, 0.75), (0.75, -0.75, 0.55), (-1.6, -0.6, 0.3)]
    scene.add_spheres(balls, [0.75, 0.55, 0.3], [mirror, glass, yellow])
    scene.add_cylinders((1.5, 0.6, 0.0), (1.5, 0.6, 1.2), 0.35, blue)
    scene.add_cylinders((-0.7, -1.1, 0.0), (-0.55, -1.1, 0.5), 0.3, yellow, caps=False)
    scene.add_cones((0.0, -1.9, 0.0), (0.0, -1.9, 0.7), 0.35, material=red)
    scene.add_cones((-1.9, 0.6, 0.02), (-1.9, 0.6, 0.9), 0.35, 0.15, syrup)  # off the floor, which hides it otherwise
    scene.add_discs((1.6, -1.3, 0.25), (0.2, -0.3, 1.0), 0.35, red)
    scene.add_triangles((0.3, 0.5, 1.9), (1.3, 0.7, 1.6), (0.4, 1.2, 1.5), yellow)
    roof = Geometry(Spheres(center=(0.0, 0.0, 0.0), radius=0.5), _saddle())
    matrix = np.array([[0.8, 0.3, 0.0, 0.5], [0.0, 0.6, 0.0, 0.3], [0.1, 0.0, 0.7, 0.35], [0.0, 0.0, 0.0, 1.0]])
    scene.instances.append(Instances(roof, matrix, (red, yellow)))
    scene.add_light(Light.point((4.0, -4.0, 6.0), 1500.0))
    scene.add_light(Light.constant((-6.0, -3.0, 4.0), (0.25, 0.25, 0.3)))
    scene.add_light(Light.sun((0.0, -1.0, 3.0), 0.6))
    return scene


def _saddle(steps=6):
    """A smooth mesh: z = 0.8 + x y over a square, two triangles a cell, material slot 1."""
    grid = np.linspace(-0.5, 0.5, steps + 1)
    x, y = np.meshgrid(grid, grid)
    points = np.stack([x, y, 0.8 + x * y], axis=-1)
    normals = np.stack([-y, -x, np.ones_like(x)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)

    def corners(values):
        a, b, c, d = values[:-1, :-1], values[:-1, 1:], values[1:, 1:], values[1:, :-1]
        return (np.stack(pair).reshape(-1, 3) for pair in ((a, a), (b, c), (c, d)))

    p0, p1, p2 = corners(points)
    n0, n1, n2 = corners(normals)
    return Triangles(p0=p0, p1=p1, p2=p2, n0=n0, n1=n1, n2=n2, material=1)
