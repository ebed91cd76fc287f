"""Mitsuba 3, its variant for processors (Embree's trees, code compiled by LLVM), on eye and shadow rays."""

import glob
import importlib.metadata
import importlib.util
import os
import re
import time
from pathlib import Path

import numpy as np

from .base import Peer
from .camera_rays import camera_rays

_VARIANTS = ("llvm_mono", "llvm_ad_mono", "llvm_ad_rgb")
_LLVM = "/usr/lib/*/libLLVM*.so*"


class Mitsuba(Peer):
    name = "Mitsuba 3"
    unequal = (
        "Mitsuba traces triangles and its ellipsoids shape (all spheres in one) in float32 with Embree's trees, on as "
        "many threads as there are cores.",
    )

    @classmethod
    def missing(cls):
        if importlib.util.find_spec("mitsuba") is None:
            return "the Python package mitsuba is not installed"
        if not os.environ.get("DRJIT_LIBLLVM_PATH") and not _libraries():
            return "there is no LLVM library (libLLVM.so), which Mitsuba compiles with"
        return None

    @classmethod
    def version(cls):
        return importlib.metadata.version("mitsuba")

    def __init__(self, scene, size):
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", (_libraries() or [""])[-1])
        import mitsuba

        mitsuba.set_variant(next(name for name in _VARIANTS if name in mitsuba.variants()))
        self._mi = mitsuba
        self._scene = mitsuba.load_dict(_scene_dict(mitsuba, scene))
        eye, direction = camera_rays(scene.camera, size)
        self._eye = mitsuba.Point3f(*eye.tolist())
        self._direction = mitsuba.Vector3f(np.ascontiguousarray(direction.T))
        self._lights = [mitsuba.Point3f(*light.position) for light in scene.lights]
        self._rays = {"eye": len(direction)}

    def trace(self):
        import drjit as dr

        dr.sync_thread()
        start = time.perf_counter()
        hit, shadows, lit = self._kernel()
        dr.eval(hit, shadows, lit)
        dr.sync_thread()
        seconds = time.perf_counter() - start
        self._rays |= {"eye_hit": int(np.array(hit).sum()), "shadow": int(np.array(shadows).sum())}
        self._rays["lit"] = int(np.array(lit).sum())
        return seconds

    def _kernel(self):
        """Of each eye ray: whether it hits, how many lights are in front of the surface and how many shine on it."""
        import drjit as dr

        mi = self._mi
        at = self._scene.ray_intersect(mi.Ray3f(self._eye, self._direction), mi.RayFlags.Minimal, True)
        hit = at.is_valid()
        normal = dr.select(dr.dot(at.n, self._direction) > 0.0, -at.n, at.n)
        shadows, lit = mi.UInt32(0), mi.UInt32(0)
        for light in self._lights:
            front = hit & (dr.dot(normal, light - at.p) > 0.0)
            blocked = self._scene.ray_test(at.spawn_ray_to(light), front)
            shadows += dr.select(front, mi.UInt32(1), 0)
            lit += dr.select(front & ~blocked, mi.UInt32(1), 0)
        return dr.select(hit, mi.UInt32(1), 0), shadows, lit

    def rays(self):
        return self._rays


def _libraries():
    """Paths of LLVM's library, the newest last."""
    return sorted(glob.glob(_LLVM), key=lambda path: [int(digits) for digits in re.findall(r"\d+", Path(path).name)])


def _scene_dict(mitsuba, scene):
    """Spheres and triangles. Raises ValueError for other shapes."""
    shapes = {"type": "scene"}
    for _, part in scene.shapes.kinds():
        if part.kind == "sphere":
            shapes["spheres"] = _ellipsoids(mitsuba, part)
        elif part.kind == "triangle":
            shapes["triangles"] = _mesh(mitsuba, part)
        else:
            raise ValueError(f"Mitsuba has no shape of many {part.kind}s")
    return shapes


def _ellipsoids(mitsuba, part):
    def tensor(values):
        return mitsuba.TensorXf(np.ascontiguousarray(values, np.float32))

    turns = np.tile(np.array([0.0, 0.0, 0.0, 1.0]), (len(part), 1))
    scales = np.repeat(part.radius[:, None], 3, axis=1)
    columns = {"centers": tensor(part.center), "scales": tensor(scales), "quaternions": tensor(turns)}
    return {"type": "ellipsoids", **columns, "opacities": tensor(np.ones((len(part), 1))), "extent": 1.0}


def _mesh(mitsuba, part):
    """Triangles that share no vertices, with flat normals."""
    points = np.stack([part.p0, part.p1, part.p2], axis=1).reshape(-1, 3).astype(np.float32)
    mesh = mitsuba.Mesh("triangles", len(points), len(part))
    values = mitsuba.traverse(mesh)
    values["vertex_positions"] = points.ravel()
    values["faces"] = np.arange(len(points), dtype=np.uint32)
    values.update()
    return mesh
