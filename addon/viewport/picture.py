# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of one view as it forms: a coarse one at once, finer ones after it, then further samples."""

import time

from .display import Layer
from .pace import MOST

#: How many finished pixels one of a picture is wide, from the finest on. None at 2: it would cost a quarter of the real
#: one, for little.
STEPS = (1, 4, 8, 16, 32)
_FIRST_WIDTH = 8  # of a pixel on the screen, where nothing was measured
_MOST_WIDTH = 32  # of a pixel on the screen, in the coarsest picture
_FINER = 0.6  # of the frame's seconds that a finer first picture may take to be preferred: else it would flicker
_REST = 0.2  # of the seconds for tracing: not worth another tile


class ViewportPicture:
    """Draws views of what an engine `Session` has loaded. `layers`: what there is to show.

    While the user turns the view every redraw begins anew, and shows the first picture of it: as many pixels as can be
    drawn in the time of a frame, by what the last one took.
    """

    def __init__(self, session):
        self.session = session
        self.layers = []
        self.view = None
        self.step = 1  # of the film that is there or forms
        self._whole = self._kept = None  # layers: the last whole film of this view; what views before have shown
        self._edges = None  # of the film that forms, see `Layer`
        self._first_step = None  # of the last first picture
        self._version = None  # of what is loaded, when it was begun

    @property
    def sample(self):
        """How many samples the picture has; 0 while it is a coarse one."""
        return self.session.film.reached[0] if self.step == 1 else 0

    @property
    def sample_seconds(self):
        """What a sample of the whole picture takes, as far as is known."""
        return self._seconds(1)

    @property
    def seconds_left(self):
        """What the samples that it does not have yet take, as far as is known."""
        return max(self._samples - self.sample, 0) * self.sample_seconds

    @property
    def finished(self):
        """Whether nothing is left to be drawn, as long as nobody asks for more samples."""
        return self.sample >= self._samples

    @property
    def keeps(self):
        """Whether parts of the picture before are shown."""
        return self._kept is not None

    @property
    def is_of_what_is_loaded(self):
        """Whether it shows what is loaded now, not what was when it was begun."""
        return self._version == self.session.loaded.version

    def is_of(self, view):
        """Whether it shows this `View` of what is loaded now: it can go on."""
        return self.is_of_what_is_loaded and self.view.key == view.key

    def begin(self, view, seconds):
        """Draw the first picture of a `View`, meant to take `seconds`. Of the same scene, what is there is shown where
        it still is right."""
        self._kept = self._keep(view) if self.is_of_what_is_loaded else None
        self.view, self._whole, self._version = view, None, self.session.loaded.version
        self._first_step = self._choose_step(seconds)
        self._start(self._first_step)
        while self.session.step(seconds, tile_seconds=seconds):
            pass
        self._end_film()
        self._stack()

    def advance(self, seconds):
        """Go on for about `seconds`, or until the picture has become finer or is finished: whether it is."""
        deadline, ended = time.perf_counter() + seconds, False
        self.session.film.samples = min(self.session.film.samples, self._samples)  # there may be fewer to draw now
        while not (self.finished or ended) and (left := deadline - time.perf_counter()) > _REST * seconds:
            if self.session.film.finished:
                self._go_on()
            ended = not self.session.step(0.0, tile_seconds=left)  # one tile: few large ones take less than many
            if ended:
                self._end_film()
        self._stack()
        return ended

    # Films

    def _choose_step(self, seconds):
        """The finest step whose picture is drawn in `seconds`; the one of last time as long as it roughly is. What a
        draw takes whatever its pixels is left out: fewer would not spare it."""
        steps = self._steps_to(_MOST_WIDTH)
        if self._first_step is None:
            return self._steps_to(_FIRST_WIDTH)[-1]
        for step in steps:
            allowed = seconds * (_FINER if step < self._first_step else 1.0)
            if self._seconds(step) <= allowed:
                return step
        return steps[-1]

    def _seconds(self, step):
        """What a sample of the film of a step is expected to take."""
        return self._pixels(step) * self.session.pace.seconds_per_pixel

    def _steps_to(self, width):
        """The steps whose pixels are not wider than so many of the screen, one at least."""
        return [step for step in STEPS if step == 1 or step * self.view.pixel_size <= width]

    def _pixels(self, step):
        _, (_, _, width, height) = self.view.raster(step)
        return width * height

    def _start(self, step):
        """Begin the film of a step; its first sample comes first."""
        size, border = self.view.raster(step)
        width = float(step * self.view.pixel_size)
        self.session.start(*size, camera=self.view.camera, border=border, pixel_size=width)
        self.session.film.samples = 1
        self.step, self._edges = step, self.view.part(size, border)

    def _go_on(self):
        """The film has the samples that it was to have: go on to a finer one, the finest that is there before the next
        redraw, or to the samples of the whole picture."""
        if self.step > 1:
            finer = STEPS[: STEPS.index(self.step)]
            self._start(next((step for step in finer if self._seconds(step) <= MOST), finer[-1]))
        else:
            self.session.film.samples = self._samples

    def _end_film(self):
        """The film has the samples that it was to have: it hides what is coarser."""
        self._whole = self._layer()
        if self._kept and self._whole.pixel <= self._kept.pixel:
            self._kept = None

    @property
    def _samples(self):
        return self.session.loaded.drawn.settings.samples

    # What is shown

    def _stack(self):
        """Put together what is shown: what is finer lies above, and hides what is below."""
        if self.sample > 0:
            self._whole, self._kept = self._layer(), None
        forming = None if self.sample > 0 or self.session.film.finished else self._layer()
        layers = [layer for layer in (self._whole, self._kept, forming) if layer]
        self.layers = sorted(layers, key=lambda layer: -layer.pixel)

    def _layer(self):
        """The film that forms, as it is now."""
        film, lines = self.session.film, self.session.lines
        texture, line_samples = lines.total if lines else (None, 0)
        return Layer(
            color=self.session.device.attachment(film.target, 0),
            reached=film.reached,
            edges=self._edges,
            pixel=(self._edges[1] - self._edges[0]) / film.width,
            lines=texture,
            line_samples=line_samples,
            smooth=self.step > 1,
        )

    def _keep(self, view):
        """The finest that is shown, as a layer of another view; None where that shows all of it otherwise."""
        shift = view.shift_from(self.view) if self._whole else None
        if shift is None:
            return None
        return min((layer for layer in (self._whole, self._kept) if layer), key=lambda layer: layer.pixel).moved(shift)
