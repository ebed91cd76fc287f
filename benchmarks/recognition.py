"""How long meshes take to be told from exact shapes: `python -m benchmarks.recognition`. Seconds, the best of five."""

import time

import numpy as np

from addon.sync.recognise import MeshArrays, recognise
from tests.made_meshes import mesh_of, uv_sphere


def scan(side):
    """A surface of side x side vertices that is no exact shape, as quads."""
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    quads = np.stack([corner, corner + 1, corner + side + 1, corner + side], 1).astype(np.int32)
    points = np.random.default_rng(0).random((side * side, 3), np.float32)
    offset = np.arange(0, 4 * len(quads) + 1, 4, dtype=np.int32)
    return MeshArrays(points, quads.ravel(), offset, np.ones(len(quads), bool), np.zeros(len(quads), np.int32))


def seconds(mesh):
    """The shortest of a few recognitions of a copy that nothing is remembered of."""
    times = []
    for _ in range(5):
        fresh = MeshArrays(mesh.positions, mesh.corner_vertex, mesh.face_offset, mesh.smooth, mesh.material, mesh.uv)
        started = time.perf_counter()
        recognise(fresh)
        times.append(time.perf_counter() - started)
    return min(times)


if __name__ == "__main__":
    for name, mesh in {"UV sphere, 32 x 16": mesh_of(*uv_sphere()), "a million vertices": scan(1000)}.items():
        print(f"{name:20} {seconds(mesh) * 1e3:8.2f} ms  {recognise(mesh).kind}")
