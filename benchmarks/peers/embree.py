"""Embree through embreex: nothing but traversal of triangles, eye and shadow rays."""

import importlib.metadata
import importlib.util
import time

import numpy as np

from .base import Peer
from .camera_rays import camera_rays


class Embree(Peer):
    name = "Embree"
    unequal = (
        "Embree (embreex) is asked ray by ray in one thread, in float32, of triangles alone; its seconds are divided "
        "by the number of cores, as if it ran on all.",
    )

    @classmethod
    def missing(cls):
        return None if importlib.util.find_spec("embreex") else "the Python package embreex is not installed"

    @classmethod
    def version(cls):
        return importlib.metadata.version("embreex")

    def __init__(self, scene, size, cores=1):
        from embreex import rtcore_scene
        from embreex.mesh_construction import TriangleMesh

        parts = {part.kind: part for _, part in scene.shapes.kinds()}
        if set(parts) != {"triangle"}:
            raise ValueError("Embree is compared on scenes of triangles alone")
        triangles = parts["triangle"]
        corners = np.stack([triangles.p0, triangles.p1, triangles.p2], axis=1).astype(np.float32)
        self._scene, self._cores = rtcore_scene.EmbreeScene(), cores
        TriangleMesh(self._scene, corners)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self._normal = normal / np.linalg.norm(normal, axis=-1, keepdims=True)
        eye, self._direction = camera_rays(scene.camera, size)
        self._eye = np.broadcast_to(eye, self._direction.shape).copy()
        self._lights = np.array([light.position for light in scene.lights], np.float32)
        self._shadow_rays = self._prepare()

    def _prepare(self):
        """Origins (n, 3), vectors (n, 3) and lengths of the shadow rays; the time to make them is not measured."""
        found = self._scene.run(self._eye, self._direction, output=1)
        hit = np.flatnonzero(found["primID"] >= 0)
        normal = self._normal[found["primID"][hit]]
        normal = np.where((normal * self._direction[hit]).sum(axis=1, keepdims=True) > 0.0, -normal, normal)
        point = self._eye[hit] + found["tfar"][hit, None] * self._direction[hit]
        scale = np.abs(point).max(axis=1, keepdims=True)
        start = point + 1e-5 * scale * normal
        towards = self._lights[None] - start[:, None]
        front = (towards * normal[:, None]).sum(axis=-1) > 0.0
        origin, vector = np.broadcast_to(start[:, None], towards.shape)[front], towards[front]
        length = np.linalg.norm(vector, axis=-1)
        self._rays = {"eye": len(self._eye), "eye_hit": len(hit), "shadow": len(origin)}
        return origin.copy(), vector / length[:, None], length

    def trace(self):
        start = time.perf_counter()
        self._scene.run(self._eye, self._direction)
        origin, direction, length = self._shadow_rays
        blocked = self._scene.run(origin, direction, dists=length, query="OCCLUDED")
        seconds = time.perf_counter() - start
        self._rays["lit"] = int((blocked != 0).sum())
        return seconds / self._cores

    def rays(self):
        return self._rays
