# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of the families of Eric Haines' Standard Procedural Databases, of any size: balls, tree, tetra,
mount, lattice.

As a script it writes one as NFF: python examples/standard_scenes.py balls 5 -o balls5.nff
"""

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from addon.engine.errors import ConicError
from addon.engine.nff import write_nff
from addon.engine.scene import Camera, Light, Material, Scene, World

SIZE = 512
SKY = (0.078, 0.361, 0.753)
FLAT = 100000.0  # the exponent of a highlight that is not to be seen


def balls(depth=4):
    """A sphereflake: (9^(depth + 1) - 1) / 8 mirroring spheres over a square, 7381 by default; each has nine
    a third as large."""
    scene = standard_scene((2.1, 1.3, 1.7), (0, 0, 0), (0, 0, 1), 0.01, [(4, 3, 2), (1, -4, 4), (-3, 1, 5)])
    add_square(scene, 12.0, -0.5, nff_material((1, 0.75, 0.33), 0.8))
    mirror = scene.add_material(nff_material((1, 0.9, 0.7), 0.5, 0.5, 3.0827))
    children = _nine_directions()
    center, direction, radius = np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]]), 0.5
    for level in range(depth + 1):
        scene.add_spheres(center, radius, mirror)
        if level < depth:
            direction = np.einsum("nij,kj->nki", _turn_up_to(direction), children)
            center = (center[:, None] + direction * (radius * 4.0 / 3.0)).reshape(-1, 3)
            direction, radius = direction.reshape(-1, 3), radius / 3.0
    return scene


def _nine_directions():
    """Where a ball carries its children: nine of the twelve neighbours in the closest packing of equal
    spheres, (9, 3)."""
    height = np.sqrt(2.0 / 3.0)
    above = _on_circle(45.0 + 120.0 * np.arange(3), height)
    return np.concatenate([above, _on_circle(15.0 + 60.0 * np.arange(6), 0.0)])


def _on_circle(degrees, z):
    angle, radius = np.radians(degrees), np.sqrt(1.0 - z * z)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(len(angle), z)], axis=-1)


def _turn_up_to(direction):
    """The rotations (n, 3, 3) by the smallest angle that take +Z to the unit vectors `direction` (n, 3)."""
    x, y, z = direction.T
    down = z < -1.0 + 1e-12
    a = 1.0 / np.where(down, 1.0, 1.0 + z)
    turn = np.stack([1.0 - x * x * a, -x * y * a, x, -x * y * a, 1.0 - y * y * a, y, -x, -y, z], axis=-1).reshape(
        -1, 3, 3
    )
    turn[down] = np.diag([-1.0, 1.0, -1.0])
    return turn


def tree(depth=11):
    """A tree of 2^(depth + 1) - 1 cones, each with a sphere on its tip, on a square under seven lights; depth
    11 by default."""
    lights = [
        (-5, 5, 50),
        (30, -30, 30),
        (-40, -30, 20),
        (10, 30, 40),
        (-30, 40, 10),
        (50, 25, 20),
        (-10, -60, 30),
    ]
    scene = standard_scene((4.5, 0.4, 2), (0, 0, 1.5), (0, 0, 1), 1.0, lights)
    add_square(scene, 50.0, 0.0, nff_material((0.2, 0.7, 0.2), 1.0))
    wood = scene.add_material(nff_material((0.55, 0.4, 0.2), 1.0))
    # Each branch carries two: by how much they lean, towards where, and their length in parts of its own.
    forks = [(40.0, 0.0, 0.65), (25.0, 140.0, 0.7)]
    turns = np.stack([rotation_z(around) @ rotation_y(lean) @ rotation_z(90.0) for lean, around, _ in forks])
    lengths = np.array([length for *_, length in forks])
    base, frame, length, radius = np.zeros((1, 3)), np.eye(3)[None], np.ones(1), 0.15
    for _ in range(depth + 1):
        tip, tip_radius = base + length[:, None] * frame[:, :, 2], 0.67 * radius
        scene.add_cones(base, tip, radius, tip_radius, wood, caps=False)
        scene.add_spheres(tip, tip_radius, wood)
        base, radius = np.repeat(tip, 2, axis=0), tip_radius
        frame = np.einsum("nij,kjl->nkil", frame, turns).reshape(-1, 3, 3)
        length = np.outer(length, lengths).ravel()
    return scene


def rotation_y(degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def rotation_z(degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def tetra(depth=6):
    """Sierpinski's tetrahedron: 4^depth triangles seen from outside, 4096 by default."""
    eye, target = (1.02285, -3.17715, -2.17451), (-0.004103, -0.004103, 0.216539)
    scene = standard_scene(eye, target, (-0.816497, -0.816497, 0.816497), 1.0, [(2, -18, -5)])
    red = scene.add_material(nff_material((1, 0.2, 0.2), 1.0))
    corners = np.array([(-1, -1, 1), (-1, 1, -1), (1, -1, -1), (1, 1, 1)], np.float64)
    center = np.zeros((1, 3))
    for level in range(1, depth):
        center = (center[:, None] + corners * 0.5**level).reshape(-1, 3)
    solids = center[:, None] + corners * 0.5 ** max(depth - 1, 0)
    faces = solids[:, [(0, 1, 2), (3, 2, 1), (2, 3, 0), (1, 0, 3)]].reshape(-1, 3, 3)
    scene.add_triangles(*np.moveaxis(faces, 1, 0), red, one_sided=1)
    return scene


def mount(depth=6, seed=3):
    """A fractal mountain of 2 * 4^depth triangles, 8192 by default, under four glass spheres; `seed` makes
    the landscape."""
    scene = standard_scene((-1.6, 1.6, 1.7), (0, 0, 0), (0, 0, 1), 0.01, [(-100, -100, 100)])
    glass = scene.add_material(nff_material((1, 1, 1), 0.1, 0.1, 101.148, 0.9, 1.5))
    centers = [(-0.8, 0.8, 1.20821), (-0.661196, 0.661196, 0.930598)]
    centers += [(-0.749194, 0.98961, 0.930598), (-0.98961, 0.749194, 0.930598)]
    scene.add_spheres(np.array(centers), 0.17, glass)
    rock = scene.add_material(nff_material((0.5, 0.45, 0.35), 1.0))
    height = _landscape(depth, np.random.default_rng(seed))
    side = np.linspace(-1.0, 1.0, len(height))
    points = np.stack([*np.meshgrid(side, side, indexing="ij"), height], axis=-1)
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    lower, upper = np.stack([a, b, c], axis=2), np.stack([c, d, a], axis=2)
    faces = np.stack([lower, upper], axis=2).reshape(-1, 3, 3)
    scene.add_triangles(*np.moveaxis(faces, 1, 0), rock, one_sided=1)
    return scene


def _landscape(depth, random):
    """Heights (2^depth + 1, 2^depth + 1) by midpoint displacement (Fournier, Fussell, Carpenter 1982),
    dimension 2.2."""
    height, spread = np.zeros((2, 2)), 0.5
    for _ in range(depth):
        n = 2 * len(height) - 1
        finer = np.zeros((n, n))
        finer[::2, ::2] = height
        finer[1::2, ::2] = (height[1:] + height[:-1]) / 2.0
        finer[:, 1::2] = (finer[:, :-2:2] + finer[:, 2::2]) / 2.0
        moved = np.ones((n, n), bool)
        moved[::2, ::2] = False
        finer += np.where(moved, random.normal(0.0, spread, (n, n)), 0.0)
        height, spread = finer, spread * 0.5**0.8
    return height


def lattice(n=12):
    """A cube of (n + 1)^3 small mirroring spheres on a grid, with 3 n (n + 1)^2 struts between them."""
    h = 1.0 / n
    lights = [(2, 0.5, 0.5), (-1, 0.5, 0.5), (0.5, 2, 0.5), (0.5, -1, 0.5), (0.5, 0.5, 2), (0.5, 0.5, -1)]
    scene = standard_scene(
        (0.5 + h / 2, 1, 1 - h / 2), (0.5 + h / 2, -1, -1 - h / 2), (0.2, 1, 0), 0.0, lights, angle=60.0
    )
    grid = np.stack(np.meshgrid(*[np.arange(n + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    joint = scene.add_material(nff_material((0.9, 0.9, 0.9), 0.5, 0.5, 3.0827))
    scene.add_spheres(grid * h, 0.25 * h, joint)
    for axis in range(3):
        strut = scene.add_material(nff_material(np.where(np.arange(3) == axis, 0.9, 0.1), 0.99))
        start, step = grid[grid[:, axis] < n] * h, np.eye(3)[axis] * h
        scene.add_cylinders(start + 0.12375 * step, start + 0.87625 * step, 0.0625 * h, strut, caps=False)
    return scene


FAMILIES = {"balls": balls, "tree": tree, "tetra": tetra, "mount": mount, "lattice": lattice}


def standard_scene(eye, target, up, hither, lights, angle=45.0):
    """A scene without shapes under the databases' sky; its lights, at the points given, add up to white."""
    camera = Camera.look_at(eye, target, up, angle, clip=(hither, 1e30))
    color = (1.0 / np.sqrt(len(lights)),) * 3
    return Scene(camera=camera, world=World(color=SKY), lights=[Light.constant(at, color) for at in lights])


def nff_material(color, kd, ks=0.0, shine=FLAT, transmit=0.0, ior=1.0):
    """The material of NFF's `f` record."""
    diffuse = tuple(kd * np.asarray(color, np.float64))
    return Material(diffuse=diffuse, reflect=ks, highlight=ks, shine=shine, transmit=transmit, ior=ior, fresnel=False)


def add_square(scene, half, z, material):
    """A square that is seen from above."""
    a, b, c, d = (half * np.array([(x, y, z / half)]) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1)))
    index = scene.add_material(material)
    scene.add_triangles(a, b, c, index, one_sided=1)
    scene.add_triangles(a, c, d, index, one_sided=1)


def main():
    parser = argparse.ArgumentParser(description="Write a scene of the Standard Procedural Databases' families as NFF.")
    parser.add_argument("family", choices=FAMILIES)
    parser.add_argument(
        "size", type=int, nargs="?", help="how deep it branches, or its side; the databases' if left out"
    )
    parser.add_argument("-o", "--output", required=True, help="the NFF file")
    arguments = parser.parse_args()
    size = () if arguments.size is None else (arguments.size,)
    try:
        write_nff(FAMILIES[arguments.family](*size), arguments.output, SIZE, SIZE)
    except ConicError as error:
        parser.error(str(error))


if __name__ == "__main__":
    main()
