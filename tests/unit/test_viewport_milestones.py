# SPDX-License-Identifier: GPL-3.0-or-later
"""What benchmarks.viewport tells from pictures: when a view shows something, the picture, every pixel, all samples."""

import numpy as np
import pytest

from benchmarks.viewport_milestones import has_changed, milestones

SHAPE = 96, 128


def disc(x, noise=0.0, step=1):
    """A textured disc at column x before a dark ground, each `step`-th pixel of it shown as large; (h, w, 3) uint8."""
    rows, columns = np.mgrid[: SHAPE[0], : SHAPE[1]]
    inside = (rows - 48) ** 2 + (columns - x) ** 2 < 40**2
    grain = np.random.default_rng(0).random(SHAPE) * 60.0
    value = np.where(inside, 150.0 + grain, 30.0) + noise * np.random.default_rng(1).normal(size=SHAPE)
    value = value[::step, ::step].repeat(step, 0).repeat(step, 1)[: SHAPE[0], : SHAPE[1]]
    return np.clip(value, 0, 255).astype(np.uint8)[..., None].repeat(3, axis=-1)


BEFORE, LAST = disc(40), disc(80)


def test_each_milestone_at_its_picture():
    shown = [(0.1, BEFORE), (0.2, disc(80, step=16)), (0.3, disc(80, step=4)), (0.4, disc(80, noise=8.0)), (0.5, LAST)]
    assert milestones(BEFORE, shown) == {"first": 0.2, "seen": 0.3, "sharp": 0.4, "done": 0.5}


@pytest.mark.parametrize("ground", [0, 30, 90])
def test_a_blank_picture_shows_nothing(ground):
    blank = np.full_like(BEFORE, ground)
    assert set(milestones(BEFORE, [(0.1, blank), (0.2, LAST)]).values()) == {0.2}


def test_half_resolution_is_not_every_pixel():
    found = milestones(BEFORE, [(0.1, disc(80, step=2)), (0.2, LAST)])
    assert found["seen"] == 0.1 and found["sharp"] == 0.2


def test_it_is_done_when_it_stays():
    found = milestones(BEFORE, [(0.1, LAST), (0.2, disc(80, step=4)), (0.3, LAST), (0.4, LAST)])
    assert found["seen"] == 0.1 and found["done"] == 0.3


def test_noise_is_no_change():
    assert has_changed(BEFORE, LAST)
    assert not has_changed(LAST, disc(80, noise=1.0))
    assert not has_changed(BEFORE, np.full_like(BEFORE, 90)), "blank: the new picture is still to come"
