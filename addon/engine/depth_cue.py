"""Where the depth cue begins and ends in a picture."""

import numpy as np


def frame_values(cue, camera, bounds, origin):
    """Members of the record `Frame` for a `DepthCue`; `bounds` (2, 3) of the scene are relative to `origin` (3,)."""
    nearest, farthest = depth_range(camera, bounds, origin)
    start = nearest if cue.start is None else cue.start
    end = farthest if cue.end is None else cue.end
    return {
        "depth_cue_color": cue.color or (0.0, 0.0, 0.0),
        "depth_cue_background": cue.color is None,
        "depth_cue_start": start,
        "depth_cue_end": max(end, start + 1e-6 * max(abs(start), 1e-30)),  # one of them may be the scene's
        "depth_cue_strength": cue.strength,
    }


def depth_range(camera, bounds, origin):
    """(nearest, farthest) depth along the view of what lies within `bounds` (2, 3), relative to `origin`: of the
    ellipsoid in that box, whose corners are mostly empty."""
    matrix = np.asarray(camera.matrix, np.float64)
    forward = -matrix[:3, 2]
    center, half = np.mean(bounds, axis=0), (bounds[1] - bounds[0]) / 2.0
    middle = forward @ (center + origin - matrix[:3, 3])
    reach = np.linalg.norm(forward * half)
    return max(middle - reach, camera.clip[0]), min(middle + reach, camera.clip[1])
