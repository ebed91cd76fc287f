# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a viewport is, from nothing but the pictures that it showed, whichever engine drew them."""

import numpy as np

#: Of one action, seconds from its beginning until the screen shows ...
MILESTONES = {
    "first": "something of the new picture: nearer to it than to the one before, and not blank",
    "seen": "the new picture recognisably: means of 8 x 8 pixels correlate by more than 0.9 with the last picture's",
    "sharp": "every pixel: differences of neighbouring pixels correlate with the last picture's by more than 0.4",
    "done": "all samples",
}
BLOCK = 8  # pixels
SEEN = 0.9
SHARP = 0.4
DIFFERENCE = 12 / 255  # a pixel that differs by more has changed


def milestones(before, shown):
    """Seconds to each of MILESTONES, from `before` (h, w, 3) uint8 and `shown`, a list of (seconds, picture)."""
    before, last = (_gray(picture) for picture in (before, shown[-1][1]))
    changed = np.abs(last - before) > DIFFERENCE
    found = {}
    for seconds, picture in shown:
        for name in _reached(_gray(picture), before, last, changed):
            found.setdefault(name, seconds)
    found["done"] = _done([(seconds, _gray(picture)) for seconds, picture in shown], last)
    return {name: found[name] for name in MILESTONES}


def _reached(now, before, last, changed):
    """The names of what the picture `now` has reached, all pictures (h, w) float32."""
    new = _rms((now - last)[changed]) < _rms((now - before)[changed])
    if not new or now[changed].std() < 0.25 * last[changed].std():
        return
    yield "first"
    if _correlation(_blocks(now), _blocks(last)) > SEEN:
        yield "seen"
        if _correlation(_fine(now), _fine(last)) > SHARP:
            yield "sharp"


def _done(shown, last):
    """Seconds until the picture is, for ever, the last one."""
    same = [np.abs(picture - last).mean() < 0.25 / 255 for _, picture in shown]
    first = len(same) - same[::-1].index(False) if False in same else 0
    return shown[min(first, len(shown) - 1)][0]


def has_changed(before, now):
    """Whether a thousandth of the pixels of two pictures (h, w, 3) uint8 differ, and `now` is not blank."""
    before, now = _gray(before), _gray(now)
    return bool((np.abs(now - before) > DIFFERENCE).mean() > 1e-3 and now.std() > DIFFERENCE)


def _gray(picture):
    return picture.astype(np.float32).mean(axis=-1) / np.float32(255.0)


def _rms(values):
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else 0.0


def _blocks(picture):
    """Means of blocks of BLOCK x BLOCK pixels."""
    height, width = (length - length % BLOCK for length in picture.shape)
    return picture[:height, :width].reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK).mean(axis=(1, 3))


def _fine(picture):
    """What of a picture is finer than two pixels: differences to the means of the neighbours."""
    around = picture[:-2, 1:-1] + picture[2:, 1:-1] + picture[1:-1, :-2] + picture[1:-1, 2:]
    return picture[1:-1, 1:-1] - around / 4.0


def _correlation(a, b):
    a, b = a - a.mean(), b - b.mean()
    size = float(np.sqrt((a * a).sum() * (b * b).sum()))
    return float((a * b).sum()) / size if size else 0.0
