# SPDX-License-Identifier: GPL-3.0-or-later
"""The full sync: everything that Blender's depsgraph shows becomes one engine scene."""

from .scene_reader import SceneReader
from .scene_reader import SyncStatistics as SyncStatistics


def sync_scene(depsgraph, width, height, *, engine=None, camera=None, report, space=None, statistics=None):
    """The engine Scene of a depsgraph, for a frame of width x height pixels: what a `SceneReader` reads at first."""
    return SceneReader(report).read(
        depsgraph, width, height, engine=engine, camera=camera, space=space, statistics=statistics
    )
