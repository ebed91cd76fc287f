"""How pictures are compared: first the masks (what is seen where), then the values where both see the same."""

from pathlib import Path

import numpy as np
from PIL import Image

#: Where a failed comparison leaves its pictures.
FAILURES = Path(__file__).resolve().parents[2] / "build" / "test_render"


def mean_squared_error(a, b, mask):
    """Of two pictures (h, w, 3), values clipped to 0..1, over the pixels of mask (h, w) bool."""
    difference = np.clip(a, 0.0, 1.0) - np.clip(b, 0.0, 1.0)
    return float(np.mean(np.square(difference, dtype=np.float64)[mask]))


def psnr(a, b, mask):
    """Peak signal to noise ratio in dB for a peak of 1; inf for equal pictures."""
    error = mean_squared_error(a, b, mask)
    return float("inf") if error == 0.0 else -10.0 * np.log10(error)


def grown(mask):
    """Mask (h, w) bool with all eight neighbours of its pixels."""
    padded = np.pad(mask, 1)
    rows = padded[:-2] | padded[1:-1] | padded[2:]
    return rows[:, :-2] | rows[:, 1:-1] | rows[:, 2:]


def silhouette_distance(a, b, limit=8):
    """How far two masks (h, w) bool are apart in pixels: the Hausdorff distance where diagonal neighbours count 1.

    `limit` + 1 stands for all that is larger, and for a mask that is empty when the other is not.
    """
    grown_a, grown_b = a, b
    for distance in range(limit + 1):
        if not (a & ~grown_b).any() and not (b & ~grown_a).any():
            return distance
        grown_a, grown_b = grown(grown_a), grown(grown_b)
    return limit + 1


def encoded(picture):
    """A linear picture (h, w, 3), bottom row first, as sRGB bytes, top row first."""
    linear = np.clip(picture[::-1, :, :3], 0.0, 1.0)
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
    return (srgb * 255.0 + 0.5).astype(np.uint8)


def save_difference(name, ours, theirs, gain=16.0):
    """Leave ours, theirs and their difference times `gain` (grey: none) side by side; the file's path."""
    FAILURES.mkdir(parents=True, exist_ok=True)
    difference = np.clip(0.5 + gain * (np.asarray(ours, np.float64)[..., :3] - theirs[..., :3]), 0.0, 1.0)
    strip = np.concatenate([encoded(ours), encoded(theirs), (difference[::-1] * 255.0 + 0.5).astype(np.uint8)], axis=1)
    path = FAILURES / f"{name}.png"
    Image.fromarray(strip).save(path)
    return path
