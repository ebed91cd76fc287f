"""The rules of the house: who imports whom, what runs without Blender, one version everywhere."""

import ast
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "addon"
ENGINE = ADDON / "engine"
FILES = [path.relative_to(ADDON).as_posix() for path in sorted(ADDON.rglob("*.py"))]
BLENDER = {"bpy", "bpy_extras", "bl_operators", "bl_ui", "bmesh", "gpu", "gpu_extras", "mathutils", "nodeitems_utils"}


def imports(path: Path) -> set[tuple[int, str]]:
    """Every import statement of a file, at the top or within a function: (dots in front, dotted module name).

    For `from . import a, b` the names are the modules.
    """
    found = set()
    for node in ast.walk(ast.parse(path.read_text(), path)):
        if isinstance(node, ast.Import):
            found |= {(0, alias.name) for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add((node.level, node.module))
        elif isinstance(node, ast.ImportFrom):
            found |= {(node.level, alias.name) for alias in node.names}
    return found


def importers(package: str, folder: Path) -> list[str]:
    """The files of a folder that import a package from outside, relative to the add-on."""
    return [
        path.relative_to(ADDON).as_posix()
        for path in sorted(folder.rglob("*.py"))
        if any(level == 0 and name.partition(".")[0] == package for level, name in imports(path))
    ]


@pytest.mark.parametrize("package", sorted(BLENDER - {"gpu", "gpu_extras"}))
def test_engine_knows_nothing_of_blender(package):
    assert importers(package, ENGINE) == []


@pytest.mark.parametrize("package, file", [("gpu", "blender_gpu.py"), ("moderngl", "headless.py")])
def test_one_file_of_the_engine_imports(package, file):
    assert importers(package, ENGINE) == [f"engine/devices/{file}"]


@pytest.mark.parametrize("file", FILES)
def test_own_modules_are_imported_relatively(file):
    """An installed extension is bl_ext.<repository>.conic: no module is called `addon` there."""
    assert not {name for level, name in imports(ADDON / file) if level == 0 and name.partition(".")[0] == "addon"}


@pytest.mark.parametrize("file", FILES)
def test_only_blender_and_numpy_are_needed(file):
    """moderngl is for use without Blender: only the file of that device imports it."""
    outside = {name.partition(".")[0] for level, name in imports(ADDON / file) if level == 0}
    optional = {"moderngl"} if file == "engine/devices/headless.py" else set()
    assert outside <= {"numpy"} | BLENDER | optional | set(sys.stdlib_module_names)


@pytest.mark.parametrize("file", [file for file in FILES if file.startswith("engine/")])
def test_engine_imports_nothing_above_it(file):
    """The engine's relative imports stay in the engine: the rooms above import it, never the other way."""
    depth = file.count("/")
    assert all(level <= depth for level, _ in imports(ADDON / file))


@pytest.mark.parametrize("module", ["addon", "addon.engine", "conic_checkout"])
def test_imports_without_blender_and_moderngl(module, tmp_path):
    """The root package (under a name like Blender gives it), the add-on, the engine: numpy will do."""
    (tmp_path / "conic_checkout").symlink_to(ROOT, target_is_directory=True)
    code = "\n".join(
        (
            "import sys",
            "for name in ('bpy', 'gpu', 'moderngl', 'mathutils'): sys.modules[name] = None",
            f"sys.path[:0] = [{str(ROOT)!r}, {str(tmp_path)!r}]",
            f"import {module}",
        )
    )
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=tmp_path)
    assert done.returncode == 0, done.stderr


def test_one_version_everywhere():
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text())["version"]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    changelog = re.search(r"^## \[?(\d+\.\d+\.\d+)", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert changelog, "CHANGELOG.md has no heading like '## 0.1.0'"
    assert manifest == project == changelog[1]


def test_every_shader_says_what_it_is():
    """A file of shaders/ is a stage, which has main(), or a library, which has none and no uniform."""
    for path in sorted((ADDON / "shaders").rglob("*.glsl")):
        text = re.sub(r"//[^\n]*|/\*.*?\*/", "", path.read_text(), flags=re.DOTALL)
        has_main = re.search(r"\bvoid\s+main\s*\(", text) is not None
        has_uniform = re.search(r"^\s*uniform\b", text, re.MULTILINE) is not None
        assert path.stem.endswith(("_lib", "_frag", "_vert", "_comp")), path.name
        is_library = path.stem.endswith("_lib")
        assert has_main != is_library, path.name
        assert not (is_library and has_uniform), path.name
