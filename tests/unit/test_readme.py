"""What the README says is so: its library example runs as it stands, and what it names is there."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()
#: Blocks between fences, [(language, text)].
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```", README, re.MULTILINE | re.DOTALL)
CODE = re.findall(r"(?<!`)`([^`\n]+)`(?!`)", README)
MAKEFILE = (ROOT / "Makefile").read_text()


def test_the_library_example_runs_as_it_stands(capsys):
    (example,) = (text for language, text in BLOCKS if language == "python")
    assert example.count("960, 540") == 1 and example.count("(540, 960, 4)") == 1
    names = {}
    exec(compile(example.replace("960, 540", "96, 54"), "README.md", "exec"), names)  # small: it is to be quick
    pixels = np.asarray(names["picture"].pixels)
    assert pixels.shape == (54, 96, 4) and pixels.dtype == np.float32
    assert capsys.readouterr().out.startswith("(54, 96, 4) ")
    assert np.isfinite(pixels).all() and np.median(pixels[..., :3]) > 0.05
    red = (pixels[..., 0] > 2.0 * pixels[..., 1]) & (pixels[..., 0] > 0.1)
    assert red.mean() > 0.01, "its red spheres are seen"
    assert pixels[-5:, :, 2].mean() > pixels[-5:, :, 0].mean() > 0.0, "the sky is at the top"


def test_the_command_line_is_the_one_that_it_shows():
    (shown,) = (text for language, text in BLOCKS if not language and "python -m" in text)
    help_text = subprocess.run(
        [sys.executable, "-m", "addon.engine", "--help"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout
    options = re.findall(r"(?<![\w-])--?[a-z]\w*", shown.replace("-m addon.engine", ""))
    assert set(options) >= {"-o", "--size", "--samples"}
    for option in options:
        assert re.search(rf"(?<![\w-]){option}\b", help_text), option


@pytest.mark.parametrize("target", sorted(set(re.findall(r"`make ([\w-]+)`", README))))
def test_make_has_each_target(target):
    assert re.search(rf"^{re.escape(target)}:", MAKEFILE, re.MULTILINE)


def test_targets_are_named():
    assert {"render", "test", "zip"} <= set(re.findall(r"`make ([\w-]+)`", README))


def named_paths():
    """Paths of the checkout that the README names: its links, its code, and the layout's first column."""
    paths = {link for link in re.findall(r"\]\(([^)]+)\)", README) if "://" not in link}
    # What is built or stands elsewhere, as `dist/`, is no part of the checkout.
    first = {path.name for path in ROOT.iterdir()} - {"dist", "build", ".venv"}
    words = (word for code in CODE for word in shlex.split(code.replace("'", "")))
    paths |= {word for word in words if "/" in word and word.split("/")[0] in first}
    (layout,) = (text for _, text in BLOCKS if text.startswith("addon/engine"))
    for line in layout.splitlines():
        folder, *others = re.split(r",\s+", re.split(r"\s{2,}", line)[0])
        paths |= {folder, *(str(Path(folder).parent / other) for other in others)}
        paths |= {f"{folder}/{name}" for name in re.findall(r"\b\w+\.(?:py|glsl)\b", line.partition("  ")[2])}
    (tests,) = (line for line in layout.splitlines() if line.startswith("tests "))
    names = re.sub(r"\([^)]*\)", "", tests.removeprefix("tests")).split(",")
    return sorted(paths | {f"tests/{name.strip()}" for name in names})


@pytest.mark.parametrize("path", named_paths())
def test_each_path_is_there(path):
    assert (ROOT / path).exists()


def test_paths_are_found():
    assert {"docs/first_picture.jpg", "addon/engine", "addon/render_engine.py", "tests/blender"} <= set(named_paths())
