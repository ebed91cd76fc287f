"""The previews of a material, a world and a light in the Properties editor show what they are of: a red ball, a green
sky, a floor in blue light. The pictures stay in build/app-previews."""

import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.app.screen import blender_window, save_picture, virtual_screen, wait_for

ROOT = Path(__file__).resolve().parents[2]
SIZE = 800, 600
RED, GREEN, BLUE = range(3)

pytestmark = pytest.mark.skipif(not shutil.which("Xvfb"), reason="Xvfb, a virtual screen, is not installed")


@pytest.fixture(scope="module")
def shown(registered, tmp_path_factory):
    """What the window shows, (h, w, 3), by tab."""
    folder = ROOT / "build" / "app-previews" / sys.argv[sys.argv.index("--gpu-backend") + 1]
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    states = tmp_path_factory.mktemp("previews")
    script, log, pictures = Path(__file__).with_name("in_previews.py"), states / "blender.log", {}
    with (
        virtual_screen(states, *SIZE) as (environment, pixels),
        blender_window(environment, SIZE, log, "--python", script, "--", states) as process,
    ):
        for tab in ("MATERIAL", "WORLD", "DATA"):
            wait_for(states / f"{tab}.json", process, log)
            pictures[tab] = pixels()
            save_picture(pictures[tab], folder / f"{tab.lower()}.png")
            (states / f"{tab}.seen").touch()
    return pictures


def of_hue(pixels, channel):
    """Where pixels (h, w, 3) have much more of one channel than of the others, (h, w) bool."""
    others = np.delete(pixels, channel, axis=-1).max(axis=-1)
    return pixels[..., channel] > 1.5 * others + 0.1


def test_a_material_is_shown_on_a_ball(shown):
    ball = of_hue(shown["MATERIAL"], RED)
    rows, columns = np.flatnonzero(ball.sum(axis=1) > 20), np.flatnonzero(ball.sum(axis=0) > 20)
    height, width = np.ptp(rows) + 1, np.ptp(columns) + 1
    assert min(height, width) > 60 and abs(height - width) < 0.15 * height
    within = ball[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    assert 0.6 < within.mean() < 0.85, "a disc fills pi / 4 of its square"


def test_a_world_fills_its_preview(shown):
    sky = of_hue(shown["WORLD"], GREEN)
    rows, columns = np.flatnonzero(sky.sum(axis=1) > 100), np.flatnonzero(sky.sum(axis=0) > 60)
    assert len(rows) > 60 and len(columns) > 200
    assert sky[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1].mean() > 0.95


def test_a_light_lights_the_floor_of_its_preview(shown):
    """In tiles, and brighter below the light than at the floor's far end."""
    pixels = shown["DATA"]
    floor = of_hue(pixels, BLUE) & (pixels[..., RED] < 0.5 * pixels[..., BLUE])
    rows = np.flatnonzero(floor.sum(axis=1) > 200)
    assert len(rows) > 60
    brightness = [np.mean(pixels[row][floor[row]][:, BLUE]) for row in (*rows[20:40], *rows[-20:])]
    assert np.mean(brightness[:20]) > 1.1 * np.mean(brightness[20:])
