# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes from and to NFF, the text format of Eric Haines' Standard Procedural Databases.

Colours are taken as scene-linear. `f r g b Kd Ks Shine T ior` becomes a material with diffuse Kd rgb, a white
mirror and a white highlight of weight Ks, a white transmittance T, and no Fresnel. Lights have no fall-off;
those without a colour share 1 as 1/sqrt(number of lights). Polygons are seen from both sides only where T is
above 0.
"""

from dataclasses import dataclass, replace

import numpy as np

from .errors import SceneError
from .nff_records import KIND, SMALLEST, VIEW_FIELDS, NffError, read_records
from .nff_writer import write_nff
from .polygons import PolygonError, triangulate
from .scene import Camera, Light, Material, Scene, World

#: Far clip of a view: NFF has none.
FAR = 1e30
#: Pixels on one side of a picture.
LARGEST_SIDE = 1 << 16

_POINTS = ("p0", "p1", "p2")
_NORMALS = ("n0", "n1", "n2")

__all__ = ["NffError", "NffFile", "Polygons", "read_nff", "write_nff"]


@dataclass(frozen=True)
class Polygons:
    """Polygons one after the other: `size` (n,) int, the vertices of each; `points` (c, 3) float64 of all, and
    their unit `normals` (c, 3), None for flat polygons; `material` (n,) int32; `one_sided` (n,) bool."""

    size: np.ndarray
    points: np.ndarray
    normals: np.ndarray | None
    material: np.ndarray
    one_sided: np.ndarray

    def __len__(self):
        return len(self.size)


@dataclass(frozen=True)
class NffFile:
    """What an NFF file says: the scene, and the picture's `width` and `height` in pixels, for which its
    camera is made. `polygons`: those that are triangles in the scene, as they are in the file."""

    scene: Scene
    width: int
    height: int
    polygons: tuple = ()

    def resized(self, width, height):
        """The same with another size of the picture; the angle from the bottom to the top row stays."""
        _, _, bottom, top = self.scene.camera.window
        half = (top - bottom) / 2.0 * width / height
        camera = replace(self.scene.camera, window=(-half, half, bottom, top))
        return replace(self, scene=replace(self.scene, camera=camera), width=width, height=height)


def read_nff(path):
    """The `NffFile` of the file at `path`.

    Raises NffError (`file:line: what is wrong, what was expected`), or SceneError when the file cannot be
    read.
    """
    records = read_records(path)
    camera, width, height = _view(records)
    scene = Scene(camera=camera, world=_world(records), lights=_lights(records))
    materials = _Materials(records, scene)
    _add_spheres(records, scene, materials)
    _add_cylinders_and_cones(records, scene, materials)
    polygons = tuple(_add_polygons(records, scene, materials, k) for k in ("p", "pp") if len(records.rows(k)))
    return NffFile(scene, width, height, polygons)


def _view(records):
    """Camera, width and height from the one `v` and the fields after it."""
    views = records.rows("v")
    if not len(views):
        raise records.error(len(records), f"the view is missing, expected 'v' with {', '.join(VIEW_FIELDS)}")
    if len(views) > 1:
        raise records.error(views[1], "a second view, expected one 'v'")
    row = int(views[0])
    rows = {}
    for keyword in VIEW_FIELDS:
        found = records.rows(keyword)
        inside = found[(found > row) & (found <= row + len(VIEW_FIELDS))]
        records.refuse(
            ~np.isin(found, inside),
            found,
            f"{keyword!r} stands outside the view, expected it right after 'v'",
        )
        if len(found) != 1:
            at = found[1] if len(found) else row
            raise records.error(at, f"the view has {len(found) or 'no'} {keyword!r}, expected one")
        rows[keyword] = int(found[0])
    value = {keyword: records.columns(np.array([r]), records.counts(r))[0] for keyword, r in rows.items()}
    angle, hither = float(value["angle"][0]), float(value["hither"][0])
    if not 0.0 < angle < 180.0:
        raise records.error(rows["angle"], f"the angle is {angle:g}, expected more than 0 and less than 180 degrees")
    if hither < 0.0:
        raise records.error(rows["hither"], f"hither is {hither:g}, expected a distance from 0 up")
    width, height = value["resolution"]
    if not all(side == np.floor(side) and 1.0 <= side <= LARGEST_SIDE for side in (width, height)):
        raise records.error(
            rows["resolution"],
            f"the resolution is {width:g} x {height:g}, expected whole numbers from 1 to {LARGEST_SIDE}",
        )
    try:
        camera = Camera.look_at(
            value["from"], value["at"], value["up"], angle, aspect=float(width / height), clip=(hither, FAR)
        )
    except SceneError as error:
        raise records.error(row, str(error)) from None
    return camera, int(width), int(height)


def _world(records):
    """The background; black where the file has none."""
    rows = records.rows("b")
    records.refuse(np.arange(len(rows)) > 0, rows, "a second background, expected one 'b'")
    color = records.columns(rows, 3)
    records.refuse((color < 0.0).any(axis=1), rows, "the background is negative, expected colors from 0 up")
    return World(color=tuple(color[0].tolist()) if len(rows) else (0.0, 0.0, 0.0))


def _lights(records):
    rows = records.rows("l")
    lights = []
    for row, colored in zip(rows, records.counts(rows) == 6, strict=True):
        values = records.columns(np.array([row]), 6 if colored else 3)[0]
        color = values[3:] if colored else np.full(3, 1.0 / np.sqrt(len(rows)))
        if (color < 0.0).any():
            raise records.error(row, "the light is negative, expected colors from 0 up")
        lights.append(Light.constant(values[:3].tolist(), color.tolist()))
    return lights


class _Materials:
    """The `f` records: which material each primitive has, and which of them transmit."""

    def __init__(self, records, scene):
        self._records = records
        rows = records.rows("f")
        values = self._checked(rows)
        # Files repeat the same few materials thousands of times.
        unique, first, inverse = np.unique(values, axis=0, return_index=True, return_inverse=True)
        order = np.argsort(first)
        for r, g, b, kd, ks, shine, transmit, ior in unique[order].tolist():
            scene.add_material(
                Material(
                    diffuse=(kd * r, kd * g, kd * b),
                    reflect=ks,
                    transmit=transmit,
                    ior=ior,
                    fresnel=False,
                    highlight=ks,
                    shine=shine,
                )
            )
        self._index = np.argsort(order)[inverse.reshape(-1)]
        self._transmits = values[:, 6] > 0.0
        self._current = np.cumsum(records.kind == KIND["f"]) - 1

    def _checked(self, rows):
        """The eight numbers of each record; opaque ones with an index of refraction of 0, as many files have
        it, get 1."""
        records, values = self._records, self._records.columns(rows, 8)
        for column, name in enumerate(("red", "green", "blue", "Kd", "Ks", "Shine", "T")):
            low = values[:, column] < 0.0
            records.refuse(
                low,
                rows,
                lambda i, c=column, name=name: f"{name} is {values[i, c]:g}, expected a number from 0 up",
            )
        no_index = values[:, 7] < SMALLEST
        records.refuse(
            no_index & (values[:, 6] > 0.0),
            rows,
            lambda i: f"the index of refraction is {values[i, 7]:g} for T {values[i, 6]:g}, expected one above 0",
        )
        values[no_index, 7] = 1.0
        return values

    def of(self, rows):
        """Material (k,) int and whether it transmits (k,) bool, of the primitives that the records `rows`
        are."""
        current = self._current[rows]
        self._records.refuse(current < 0, rows, "a primitive without a material, expected an 'f' before it")
        return self._index[current].astype(np.int32), self._transmits[current]


def _add_spheres(records, scene, materials):
    rows = records.rows("s")
    if len(rows):
        values = records.columns(rows, 4)
        records.refuse(
            np.abs(values[:, 3]) < SMALLEST,
            rows,
            lambda i: f"the sphere's radius is {values[i, 3]:g}, expected one that is not 0",
        )
        scene.add_spheres(values[:, :3], values[:, 3], materials.of(rows)[0])


def _add_cylinders_and_cones(records, scene, materials):
    rows = records.rows("c")
    if not len(rows):
        return
    values = records.columns(rows, 8)
    base, apex, base_radius, apex_radius = values[:, :3], values[:, 4:7], values[:, 3], values[:, 7]
    shown = lambda i: f"{base_radius[i]:g} and {apex_radius[i]:g}"  # noqa: E731
    records.refuse(
        np.maximum(np.abs(base_radius), np.abs(apex_radius)) < SMALLEST,
        rows,
        lambda i: f"the radii are {shown(i)}, expected one that is not 0",
    )
    records.refuse(
        base_radius * apex_radius < 0.0,
        rows,
        lambda i: f"the radii are {shown(i)}, expected both of the same sign",
    )
    records.refuse(
        np.linalg.norm(apex - base, axis=1) < SMALLEST,
        rows,
        "base and apex are the same point, expected a cylinder or cone with a length",
    )
    material, _ = materials.of(rows)
    even = base_radius == apex_radius
    for pick, add, radii in (
        (even, scene.add_cylinders, (base_radius,)),
        (~even, scene.add_cones, (base_radius, apex_radius)),
    ):
        if pick.any():
            add(base[pick], apex[pick], *(radius[pick] for radius in radii), material[pick], caps=False)


def _add_polygons(records, scene, materials, keyword):
    """The `Polygons` of the records `p`, or `pp` with normals; into the scene go their triangles."""
    rows = records.rows(keyword)
    size = records.numbers[records.start[rows]].astype(np.int64)
    first = np.cumsum(size) - size
    corners = _corners(records, rows, size, 6 if keyword == "pp" else 3)
    owners, triangles = [], []
    for n in np.unique(size):  # all polygons with the same number of vertices at once
        polygons = np.flatnonzero(size == n)
        owner, index = _triangles(records, rows[polygons], corners[first[polygons, None] + np.arange(n), :3])
        owners.append(polygons[owner])
        triangles.append(first[polygons[owner], None] + index)
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    owner, of_triangle = owner[order], corners[np.concatenate(triangles)[order]]
    material, transmits = materials.of(rows)
    columns = {name: of_triangle[:, i, :3] for i, name in enumerate(_POINTS)}
    if keyword == "pp":
        columns |= {name: of_triangle[:, i, 3:] for i, name in enumerate(_NORMALS)}
    scene.add_triangles(material=material[owner], one_sided=~transmits[owner], **columns)
    normals = corners[:, 3:] if keyword == "pp" else None
    return Polygons(size, corners[:, :3], normals, material, ~transmits)


def _corners(records, rows, size, width):
    """The vertices (c, width) of the polygons `rows`, which have `size` (k,) each, with normals of length 1."""
    begin = records.start[rows] + 1 - width * (np.cumsum(size) - size)
    corners = records.numbers[np.repeat(begin, width * size) + np.arange(width * size.sum())].reshape(-1, width)
    if width == 6:
        length = np.linalg.norm(corners[:, 3:], axis=1, keepdims=True)
        zero = np.logical_or.reduceat(length[:, 0] < SMALLEST, np.cumsum(size) - size)
        records.refuse(zero, rows, "a vertex normal is 0, expected one with a direction")
        corners[:, 3:] /= length
    return corners


def _triangles(records, rows, points):
    """The triangles of polygons `rows` with points (k, n, 3): which of them each belongs to, and its vertices."""
    try:
        return triangulate(points)
    except PolygonError as error:
        raise records.error(rows[error.index], f"{error.reason}, expected a planar polygon") from None
