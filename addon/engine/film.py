"""The picture while it forms: samples, tiles, accumulation. A film is a rectangle of float pixels on a device."""

from dataclasses import dataclass

import numpy as np

#: What one draw may take before a driver or a user who waits loses patience, in seconds. Where the processor draws, one
#: of its threads has nothing to do at the end of each.
TILE_SECONDS = 0.16
#: The alpha of a sample that the driver gave up: far above what samples sum up to.
UNENDED_ALPHA = 1e30
_FIRST_TILE_PIXELS = 4096
#: Bands of a film whose pixels are known to cost as much as each other.
_BANDS = 32
#: How many times more or less pixels may be said to cost by what one tile took.
_MOST_CHANGE = 4.0
#: Seconds that a draw may be said to take for no pixels.
_MOST_FIXED = 0.004
#: Tiles are of so many rows and columns, or a multiple: rasterisers work on blocks, those at an edge twice.
_BAND_ROWS, _TILE_COLUMNS = 8, 16


@dataclass(frozen=True)
class Tile:
    """A rectangle (x, y, width, height) of the film and the sample that is drawn in it."""

    rectangle: tuple
    sample: int


def _whole(size, block):
    """The largest multiple of `block` up to `size`, at least one."""
    return max(int(size // block), 1) * block


def sample_offset(sample):
    """Where in its pixel a sample lies, (2,) in [0, 1): the first in the centre, the others evenly around it.

    The R2 sequence (Roberts 2018, The Unreasonable Effectiveness of Quasirandom Sequences).
    """
    plastic = 1.32471795724474602596
    return np.mod(0.5 + sample * np.array([1.0 / plastic, 1.0 / plastic**2]), 1.0)


class Pace:
    """What pixels cost in each of some bands of a film's height: learned from tile to tile, and kept from picture to
    picture, which mostly have the dear ones in the same place."""

    def __init__(self):
        self._costs = np.full(_BANDS, TILE_SECONDS / _FIRST_TILE_PIXELS)  # seconds of a pixel
        self._fixed = _MOST_FIXED  # seconds of a draw of no pixels

    @property
    def seconds_per_pixel(self):
        """Of all bands."""
        return float(self._costs.mean())

    def rows(self, seconds, first, film):
        """How many rows of a `Film` from number `first` on take about `seconds`, a real number."""
        costs = self._costs[np.arange(first, film.height) * _BANDS // film.height] * film.width
        ends = np.cumsum(costs)
        whole = int(np.searchsorted(ends, seconds))
        if whole == len(ends):
            return float(whole)
        return whole + (seconds - (ends[whole - 1] if whole else 0.0)) / costs[whole]

    def learn(self, tile, film, seconds):
        """A tile of a `Film` took `seconds`. One measure may be wrong: it does not change much at once. Other bands may
        have changed as well: they follow it half the way."""
        _, y, width, height = tile.rectangle
        self._fixed = min(self._fixed, seconds)
        bands = np.arange(y, y + height) * _BANDS // film.height
        expected = float(self._costs[bands].sum()) * width
        change = np.clip(max(seconds - self._fixed, 0.5 * seconds) / expected, 1.0 / _MOST_CHANGE, _MOST_CHANGE)
        if seconds < 2.0 * self._fixed:
            change = min(change, 1.0)  # of so few pixels it is not known what more would cost
        factors = np.full(_BANDS, np.sqrt(change))
        factors[bands] = change
        self._costs *= factors


class Film:
    """Pixels being summed up sample by sample, tile by tile.

    `width`, `height`: of the whole frame; `border` (x, y, width, height): the part that is rendered. With
    `corner_rays` the film has a row and a column more, and a pixel is the mean of its four corners. `pace`: known from
    pictures before. `bytes`: what it takes on the GPU.
    """

    def __init__(self, device, width, height, *, border=None, samples=1, corner_rays=False, attachments=1, pace=None):
        self.frame_size = (width, height)
        self.border = border or (0, 0, width, height)
        self.samples, self.corner_rays = samples, corner_rays
        self.width, self.height = self.border[2] + corner_rays, self.border[3] + corner_rays
        self._device = device
        self.target = device.target(self.width, self.height, attachments)
        self.bytes = self.width * self.height * 16 * attachments
        self.unended = 0
        self.pace = pace or Pace()
        self._sample = self._x = self._y = self._band = 0

    @property
    def finished(self):
        return self._sample >= self.samples

    @property
    def progress(self):
        """Share of the work that is done, 0 to 1."""
        rows = self._y + self._band * self._x / self.width
        return min((self._sample + rows / self.height) / self.samples, 1.0)

    @property
    def sample(self):
        return min(self._sample, self.samples - 1)

    @property
    def reached(self):
        """(samples, rows, band, x): pixels have so many samples; those of the first rows, and those left of x in the
        `band` of rows above, have one more."""
        return self._sample, self._y, self._band, self._x

    def next_tile(self, seconds=TILE_SECONDS):
        """The tile to draw now, of a size that takes about `seconds`; `advance` says that it was drawn."""
        rows = self.pace.rows(seconds, self._y, self)
        if self._x == 0:
            self._band = min(_whole(rows, _BAND_ROWS), self.height - self._y)
        width = self.width - self._x
        if rows < self._band:
            width = min(width, _whole(self.width * rows / self._band, _TILE_COLUMNS))
        return Tile((self._x, self._y, width, self._band), self._sample)

    def advance(self, tile, seconds):
        """A tile was drawn in `seconds`: go on to the next."""
        self.pace.learn(tile, self, seconds)
        self._x += tile.rectangle[2]
        if self._x >= self.width:
            self._x, self._y = 0, self._y + self._band
            if self._y >= self.height:
                self._y, self._sample = 0, self._sample + 1

    def raster(self, sample, window):
        """Scale and offset (4,) from gl_FragCoord in the film to the camera's window (left, right, bottom, top)."""
        left, right, bottom, top = window
        scale = np.array([right - left, top - bottom]) / self.frame_size
        inside = np.zeros(2) if self.corner_rays else sample_offset(sample)
        offset = np.array([left, bottom]) + (np.array(self.border[:2]) + inside - 0.5) * scale
        return np.concatenate([scale, offset])

    def pixels(self):
        """What is there so far, (height, width, 4) float32 of the border, bottom row first, premultiplied alpha.

        Pixels that no sample has reached yet are 0. `unended` is then the number of pixels with samples that the driver
        gave up.
        """
        total = self._device.read(self.target, 0, (0, 0, self.width, self.height))
        counts = np.full((self.height, self.width, 1), self._sample, np.float32)
        if not self.finished:
            counts[: self._y] += 1.0
            counts[self._y : self._y + self._band, : self._x] += 1.0
        mean = total / np.maximum(counts, 1.0)
        unended = total[..., 3] >= UNENDED_ALPHA
        mean[unended, 3] = 1.0
        self.unended = int(unended.sum())
        return self.of_pixels(mean)

    def of_pixels(self, values):
        """Values (height, width, n) of the film's rays as those of its pixels."""
        if not self.corner_rays:
            return values
        return (values[:-1, :-1] + values[1:, :-1] + values[:-1, 1:] + values[1:, 1:]) / 4.0

    def counters(self, attachment):
        """Sums over all pixels and samples of an attachment that counts, (4,) float64."""
        values = self._device.read(self.target, attachment, (0, 0, self.width, self.height))
        return values.sum(axis=(0, 1), dtype=np.float64)

    def release(self):
        self._device.release(self.target)
