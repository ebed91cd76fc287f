# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's cameras and views as the engine's."""

import numpy as np

from ..engine.errors import SceneError
from ..engine.scene import Camera


def camera_of_render(engine, depsgraph, width, height, *, camera=None, reports=None):
    """The camera of a render of width x height pixels, the full frame without its border.

    `engine` (a RenderEngine) gives the eye of a stereo pair and its override; without one, the scene's camera is
    used, or the object `camera`. Raises SceneError when there is none, or it is an object of another type.
    """
    scene = depsgraph.scene_eval
    camera = camera or (engine and engine.camera_override) or scene.camera
    if camera is None:
        raise SceneError(
            f"scene {scene.name!r} has no camera; add one with Add > Camera, or choose one in the scene's settings"
        )
    if camera.type != "CAMERA":
        kind = camera.type.replace("_", " ").lower()
        raise SceneError(
            f"scene {scene.name!r}: {camera.name!r} ({kind}) is set as its camera, but is not a camera; choose one in "
            "the scene's settings"
        )
    camera = camera.evaluated_get(depsgraph)
    data = camera.data
    if data.type not in ("PERSP", "ORTHO") and reports is not None:
        kind = "panoramic" if data.type == "PANO" else data.type.lower()
        reports.warn(f"camera {camera.name!r}: a {kind} camera is not rendered, perspective is used instead")
    if data.dof.use_dof and reports is not None:
        reports.warn(f"camera {camera.name!r}: depth of field is not rendered")
    render = scene.render
    projection = camera.calc_matrix_camera(
        depsgraph, x=width, y=height, scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y
    )
    matrix = engine.camera_model_matrix(camera) if engine is not None else camera.matrix_world
    window = _window(np.array(projection, np.float64))
    if engine is not None:
        window = _eye_window(window, engine.camera_shift_x(camera) - data.shift_x, data.sensor_fit)
    return Camera(_without_scale(matrix, camera.name), window, data.type == "ORTHO", (data.clip_start, data.clip_end))


def camera_of_view(_region, region_data):
    """The camera of a 3D view of `region` and `region_data` (a RegionView3D): perspective, orthographic, or through a
    camera with the view's zoom and offset. The window's matrix already has the region's form.
    """
    projection = np.array(region_data.window_matrix, np.float64)
    matrix = _without_scale(np.linalg.inv(np.array(region_data.view_matrix, np.float64)), "view")
    orthographic = not region_data.is_perspective
    start, end = _clip(projection, orthographic)
    if orthographic:  # the near plane lies behind the eye; the engine's rays begin in the window
        matrix[:3, 3] -= matrix[:3, 2] * start
        start, end = 0.0, end - start
    return Camera(matrix, _window(projection), orthographic, (start, end))


def frame_in_view(camera, scene, region_data):
    """Edges (left, right, bottom, top) of what a camera object renders, in a viewport that looks through it: the region
    goes from 0 to 1. `camera`, `scene` are evaluated."""
    corners = np.ones((4, 4))
    corners[:, :3] = np.array(camera.data.view_frame(scene=scene), np.float64)
    to_window = np.array(region_data.window_matrix, np.float64) @ np.array(region_data.view_matrix, np.float64)
    seen = corners @ _without_scale(camera.matrix_world, camera.name).T @ to_window.T
    seen = 0.5 * seen[:, :2] / seen[:, 3:] + 0.5
    (left, bottom), (right, top) = seen.min(axis=0), seen.max(axis=0)
    return left, right, bottom, top


def _window(projection):
    """The picture's edges (left, right, bottom, top) at distance 1, or in world units, from a projection matrix (4, 4).

    Perspective: x_ndc = (P00 x + P02 z) / -z at z = -1; orthographic: x_ndc = P00 x + P03.
    """
    perspective = projection[3, 2] != 0.0
    edges = []
    for row in (0, 1):
        scale, offset = projection[row, row], projection[row, 2] if perspective else -projection[row, 3]
        edges += [(offset - 1.0) / scale, (offset + 1.0) / scale]
    return tuple(float(edge) for edge in edges)


def _eye_window(window, shift, sensor_fit):
    """The window of one eye of an off-axis stereo pair, which the projection matrix leaves out: moved sideways by
    `shift` times the length of the side that the sensor fits."""
    left, right, bottom, top = window
    horizontal = sensor_fit == "HORIZONTAL" or (sensor_fit == "AUTO" and right - left >= top - bottom)
    offset = shift * ((right - left) if horizontal else (top - bottom))
    return left + offset, right + offset, bottom, top


def _clip(projection, orthographic):
    """Distances of the near and far plane along the view of a projection matrix (4, 4) with z_ndc from -1 to 1."""
    a, b = projection[2, 2], projection[2, 3]
    if orthographic:
        return float((b + 1.0) / a), float((b - 1.0) / a)
    return float(b / (a - 1.0)), float(b / (a + 1.0)) if a < -1.0 else 1e30


def _without_scale(matrix, name):
    """A camera's matrix (4, 4) float64 with axes of length 1, as Blender takes it."""
    matrix = np.array(matrix, np.float64)
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    if not np.isfinite(matrix).all():
        raise SceneError(f"camera {name!r} is in a place or of a scale that is not finite")
    if not (lengths > 0.0).all():
        raise SceneError(f"camera {name!r} is scaled to zero; give it a scale")
    matrix[:3, :3] /= lengths
    return matrix
