"""The command line, as a user meets it: pictures, statistics, mistakes in one line, and no file left behind."""

import errno
import json
import os
import pty
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from addon.engine import __main__ as command_line
from addon.engine.devices import headless
from addon.engine.errors import DeviceError
from addon.engine.image_file import read_image

ROOT = Path(__file__).resolve().parents[2]
SCENE = """b 0.25 0.5 1
v
from 0 -4 0
at 0 0 0
up 0 0 1
angle 45
hither 0
resolution 24 16
l 0 -100 0
f 1 0.5 0.25 1 0 1 0 1
s 0 0 0 1
"""
SKY = (0.25, 0.5, 1.0)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with scene.nff, where the command line runs."""
    (tmp_path / "scene.nff").write_text(SCENE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def conic(folder, capsys):
    """Runs the command line in this process: exit code and lines on stderr; nothing may come on stdout."""

    def run(*arguments):
        code = command_line.main([str(argument) for argument in arguments])
        out, err = capsys.readouterr()
        assert out == ""
        return code, err.splitlines()

    return run


def start(folder, *arguments, **options):
    """The command line as a process of its own."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "addon.engine", *map(str, arguments)]
    return subprocess.Popen(command, cwd=folder, env=environment, **options)


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_exr_is_linear_and_upright(conic, folder):
    (folder / "scene.nff").write_text(SCENE.replace("s 0 0 0 1", "s 0 0 1.5 0.3"))  # in the upper half
    assert conic("scene.nff", "-o", "out.exr") == (0, [])
    pixels = read_image(folder / "out.exr")
    assert pixels.shape == (16, 24, 4)
    np.testing.assert_allclose(pixels[0, 0], (*SKY, 1.0), rtol=1e-6)
    rows, columns = np.nonzero(pixels[..., 2] < 0.9)
    assert rows.min() > 11  # bottom row first
    assert columns.mean() == pytest.approx(11.5)
    # Where it faces the light, the sphere returns nearly its colour times the light's, whose ratio is kept.
    brightest = pixels[rows, columns].max(axis=0)
    assert 0.9 < brightest[0] <= 1.0
    np.testing.assert_allclose(brightest[:3] / brightest[0], (1.0, 0.5, 0.25), rtol=1e-5)


def test_png_holds_display_values(conic, folder):
    from PIL import Image

    assert conic("scene.nff", "-o", "out.PNG") == (0, [])
    with Image.open(folder / "out.PNG") as image:
        assert (image.size, image.mode) == ((24, 16), "RGB")
        assert image.getpixel((0, 0)) == (137, 188, 255)  # the sRGB curve at 0.25, 0.5 and 1
    np.testing.assert_allclose(read_image(folder / "out.PNG")[0, 0, :3], SKY, atol=0.005)
    assert names(folder) == ["out.PNG", "scene.nff"]


def test_size_keeps_the_vertical_angle(conic, folder):
    heights = []
    for size in ((24, 16), (40, 32), (16, 32)):
        assert conic("scene.nff", "-o", "out.exr", "--size", *size) == (0, [])
        hit = read_image(folder / "out.exr")[..., 2] < 0.9
        assert hit.shape == size[::-1]
        heights.append(hit.any(axis=1).sum() / size[1])
    assert heights == pytest.approx([heights[0]] * 3, abs=1 / 16)


def test_samples_smooth_edges_only(conic, folder):
    levels = []
    for samples in (1, 16):
        assert conic("scene.nff", "-o", "out.exr", "--samples", samples)[0] == 0
        pixels = read_image(folder / "out.exr")
        np.testing.assert_allclose(pixels[0, 0, :3], SKY, rtol=1e-5)
        # Red is 0.25 in the sky and close to 1 well inside the sphere.
        levels.append(((pixels[..., 0] > 0.3) & (pixels[..., 2] > 0.5)).sum())
    assert levels[0] == 0
    assert levels[1] > 8


def test_depth_one_shows_no_reflection(conic, folder):
    (folder / "scene.nff").write_text(SCENE.replace("1 0 1 0 1\n", "0 1 1 0 1\n"))
    center = []
    for depth in (1, 2):
        assert conic("scene.nff", "-o", "out.exr", "--depth", depth)[0] == 0
        center.append(read_image(folder / "out.exr")[3, 12, 2])
    assert center[0] < 0.5
    assert center[1] > 0.9


def test_stats(conic, folder):
    assert conic("scene.nff", "-o", "out.png", "--stats", "stats.json") == (0, [])
    stats = json.loads((folder / "stats.json").read_text())
    assert {"eye", "eye_hit", "reflect", "refract", "shadow"} <= stats["rays"].keys()
    assert stats["rays"]["eye"] == 24 * 16
    assert 0 < stats["rays"]["eye_hit"] < 24 * 16
    assert stats["rays"]["shadow"] <= stats["rays"]["eye_hit"]
    assert stats["primitives"] == {"sphere": 1}
    assert stats["bvh"].keys() >= {"nodes", "depth", "sah_cost"}
    assert list(stats["seconds"]) == ["read", "build", "upload", "compile", "trace", "first_picture"]
    assert all(seconds >= 0.0 for seconds in stats["seconds"].values())
    assert stats["gpu_bytes"] > 0
    assert isinstance(stats["device"], str)


def test_strict_takes_a_depth(conic, folder):
    counts = []
    for depth in (1, 3):
        assert conic(
            "scene.nff", "-o", "out.exr", "--strict", "--depth", depth, "--size", 20, 20, "--stats", "a.json"
        ) == (0, [])
        counts.append(json.loads((folder / "a.json").read_text())["rays"])
    assert counts[0]["reflect"] == counts[0]["refract"] == 0
    assert counts[0]["eye_hit"] == counts[1]["eye_hit"] and counts[0]["eye"] == 21 * 21


def test_strict_is_512_with_one_row_and_column_of_rays_more(conic, folder):
    assert conic("scene.nff", "-o", "out.exr", "--strict", "--stats", "a.json") == (0, [])
    assert read_image(folder / "out.exr").shape == (512, 512, 4)
    assert json.loads((folder / "a.json").read_text())["rays"]["eye"] == 513 * 513
    assert conic("scene.nff", "-o", "out.exr", "--strict", "--size", 20, 10, "--stats", "a.json") == (0, [])
    assert read_image(folder / "out.exr").shape == (10, 20, 4)
    assert json.loads((folder / "a.json").read_text())["rays"]["eye"] == 21 * 11


def test_extremes_that_are_allowed(conic, folder):
    assert conic("scene.nff", "-o", "a.png", "--size", 1, 1, "--depth", 1)[0] == 0
    assert conic("scene.nff", "-o", "b.png", "--size", 3000, 1)[0] == 0
    assert read_image(folder / "b.png").shape == (1, 3000, 4)
    assert conic("scene.nff", "-o", "c.png", "--depth", 1024)[0] == 0


MISTAKES = {
    "no arguments": ([], "required"),
    "no output": (["scene.nff"], "-o/--output"),
    "unknown option": (["scene.nff", "-o", "out.png", "--sizes", "1", "2"], "unrecognized arguments"),
    "missing input": (["none.nff", "-o", "out.png"], "none.nff: cannot be read: No such file"),
    "folder as input": (["folder", "-o", "out.png"], "folder: cannot be read: Is a directory"),
    "missing folder": (["scene.nff", "-o", "none/out.png"], "none/out.png: the folder .*none does not exist"),
    "file as folder": (["scene.nff", "-o", "scene.nff/out.png"], "does not exist"),
    "folder as output": (["scene.nff", "-o", "folder.png"], "folder.png: is a folder"),
    "unknown suffix": (["scene.nff", "-o", "out.jpg"], "out.jpg: pictures are written as .png or .exr, not as .jpg"),
    "no suffix": (["scene.nff", "-o", "out"], "not as a name without suffix"),
    "stats folder": (["scene.nff", "-o", "out.png", "--stats", "none/s.json"], "none/s.json: the folder"),
    "stats is scene": (["scene.nff", "-o", "out.png", "--stats", "./scene.nff"], "must be different files"),
    "stats is picture": (["scene.nff", "-o", "out.png", "--stats", "folder/../out.png"], "must be different"),
    "size 0": (["scene.nff", "-o", "out.png", "--size", "0", "5"], "--size: '0' is no whole number from 1 to 16384"),
    "size -1": (["scene.nff", "-o", "out.png", "--size", "-1", "5"], "--size"),
    "size huge": (["scene.nff", "-o", "out.png", "--size", "99999", "5"], "--size: '99999' is no whole number"),
    "size word": (["scene.nff", "-o", "out.png", "--size", "big", "5"], "--size: 'big' is no whole number"),
    "one size": (["scene.nff", "-o", "out.png", "--size", "5"], "--size"),
    "samples 0": (["scene.nff", "-o", "out.png", "--samples", "0"], "--samples: '0' is no whole number from 1"),
    "samples huge": (["scene.nff", "-o", "out.png", "--samples", "9" * 30], "--samples: '9+' is no whole number"),
    "depth 0": (["scene.nff", "-o", "out.png", "--depth", "0"], "--depth: '0' is no whole number from 1"),
    "depth huge": (["scene.nff", "-o", "out.png", "--depth", "1000000"], "--depth: '1000000' is no whole number"),
    "strict and samples": (["scene.nff", "-o", "out.png", "--strict", "--samples", "4"], "leave --samples out"),
}


@pytest.mark.parametrize("case", MISTAKES)
def test_mistakes_are_one_line_and_leave_nothing(conic, folder, case):
    arguments, message = MISTAKES[case]
    (folder / "folder").mkdir()
    (folder / "folder.png").mkdir()
    code, lines = conic(*arguments)
    assert code == 2
    assert len(lines) == 1, lines
    assert lines[0].startswith("conic: ")
    assert re.search(message, lines[0])
    assert names(folder) == ["folder", "folder.png", "scene.nff"]
    assert (folder / "scene.nff").read_text() == SCENE


def test_a_wrong_scene_leaves_the_old_picture(conic, folder):
    (folder / "out.png").write_text("an old picture")
    (folder / "scene.nff").write_text(SCENE + "s 0 0 0 nan\n")
    code, lines = conic("scene.nff", "-o", "out.png", "--stats", "stats.json")
    assert code == 2
    assert lines == ["scene.nff:12: the number 'nan' is not finite, or larger than 1e+18 in size"]
    assert (folder / "out.png").read_text() == "an old picture"
    assert names(folder) == ["out.png", "scene.nff"]


def test_a_failed_write_leaves_the_old_picture(conic, folder, monkeypatch):
    (folder / "out.png").write_text("an old picture")

    def full(path, _):
        Path(path).write_text("half a pic")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("addon.engine.image_file._write_png", full)
    code, lines = conic("scene.nff", "-o", "out.png", "--stats", "stats.json")
    assert (code, lines) == (2, ["conic: out.png: cannot be written: No space left on device"])
    assert (folder / "out.png").read_text() == "an old picture"
    assert names(folder) == ["out.png", "scene.nff"]


def test_a_read_only_picture_is_not_replaced(folder):
    """In a process without the superuser's rights, where the system tells whether a file may be written."""
    (folder / "out.png").write_text("an old picture")
    (folder / "out.png").chmod(0o444)
    folder.chmod(0o755)
    real = os.access
    if real(folder / "out.png", os.W_OK):  # the superuser may write all: pretend not to be
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(os, "access", lambda path, mode: "out.png" not in str(path) and real(path, mode))
            assert command_line.main(["scene.nff", "-o", "out.png"]) == 2
    else:
        assert command_line.main(["scene.nff", "-o", "out.png"]) == 2
    assert (folder / "out.png").read_text() == "an old picture"


def test_a_link_stays_a_link(conic, folder):
    (folder / "real").mkdir()
    (folder / "out.png").symlink_to(folder / "real" / "picture.png")
    assert conic("scene.nff", "-o", "out.png")[0] == 0
    assert (folder / "out.png").is_symlink()
    assert names(folder / "real") == ["picture.png"]


def test_no_driver_is_one_line(conic, folder, monkeypatch):
    def no_driver(_self, *_arguments, **_keywords):
        raise DeviceError("there is no OpenGL driver; install libegl1 and libgl1-mesa-dri")

    monkeypatch.setattr(headless.HeadlessDevice, "__init__", no_driver)
    code, lines = conic("scene.nff", "-o", "out.png")
    assert (code, lines) == (2, ["conic: there is no OpenGL driver; install libegl1 and libgl1-mesa-dri"])
    assert names(folder) == ["scene.nff"]


@pytest.mark.parametrize("module, package", [("PIL.Image", "Pillow"), ("OpenEXR", "OpenEXR")])
def test_a_missing_package_is_told_before_rendering(conic, folder, monkeypatch, module, package):
    monkeypatch.setitem(sys.modules, module, None)
    code, lines = conic("none.nff", "-o", "out.png" if package == "Pillow" else "out.exr")
    assert code == 2
    assert f"python -m pip install {package}" in lines[0]


def test_help_names_every_option(conic, capsys):
    with pytest.raises(SystemExit) as stopped:
        command_line.main(["--help"])
    assert stopped.value.code == 0
    text = capsys.readouterr().out
    for option in ("SCENE.nff", "--output", "--size", "--samples", "--depth", "--strict", "--stats"):
        assert option in text


def test_silence_in_a_pipe(folder):
    process = start(folder, "scene.nff", "-o", "out.png", stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.communicate(timeout=120) == (b"", b"")
    assert process.returncode == 0


def slow(folder):
    """Arguments of a picture that takes many seconds."""
    return "scene.nff", "-o", "out.png", "--stats", "stats.json", "--size", 1024, 1024, "--samples", 512


def read_terminal(terminal, seconds, until):
    """What comes on a terminal until a pattern is there, or its other end is closed."""
    text, end = b"", time.monotonic() + seconds
    while time.monotonic() < end and not (until and re.search(until, text)):
        try:
            piece = os.read(terminal, 4096)
        except OSError:  # how Linux says that the other end is closed
            break
        if not piece:
            break
        text += piece
    return text


def test_progress_on_a_terminal_and_interrupt(folder):
    (folder / "out.png").write_text("an old picture")
    terminal, other_end = pty.openpty()
    process = start(folder, *slow(folder), stderr=other_end)
    os.close(other_end)
    try:
        shown = read_terminal(terminal, 120.0, rb"[1-9]\d*%.*\r.*%")
        process.send_signal(signal.SIGINT)
        rest = read_terminal(terminal, 60.0, None)
        assert process.wait(60) == 130
    finally:
        process.kill()
        os.close(terminal)
    assert re.search(rb"\r\[#*-+\] +\d+%  \d+:\d\d", shown)
    assert b"interrupted, nothing was written" in rest
    assert b"Traceback" not in rest
    assert (folder / "out.png").read_text() == "an old picture"
    assert names(folder) == ["out.png", "scene.nff"]
