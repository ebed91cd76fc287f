"""The zip: what it holds, and that a fresh Blender installs it, renders with it, and forgets it again."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import bpy
import pytest

from tools.make_zip import make_zip

# Runs in a Blender of its own: sys.argv ends with the zip and the picture to write.
USE = """
import os, sys, bpy
package, picture = sys.argv[-2:]
module = "bl_ext.user_default.conic"
bpy.ops.extensions.package_install_files(filepath=package, repo="user_default", enable_on_install=True)
assert module in bpy.context.preferences.addons, list(bpy.context.preferences.addons.keys())

render = bpy.context.scene.render
render.engine = "CONIC"
render.resolution_x, render.resolution_y, render.resolution_percentage = 32, 24, 100
render.filepath = picture
bpy.ops.render.render(write_still=True)

for _ in range(2):  # disabling leaves nothing behind that enabling again would stumble over
    bpy.ops.preferences.addon_disable(module=module)
    assert not hasattr(bpy.types.Scene, "conic")
    bpy.ops.preferences.addon_enable(module=module)
    assert bpy.context.scene.conic

repo = next(r for r in bpy.context.preferences.extensions.repos if r.module == "user_default")
bpy.ops.extensions.package_uninstall(repo_directory=repo.directory, pkg_id="conic")
assert not os.path.exists(os.path.join(repo.directory, "conic"))
assert module not in bpy.context.preferences.addons
print("installed, rendered, uninstalled", flush=True)
"""


@pytest.fixture(scope="module")
def package(tmp_path_factory) -> Path:
    """The zip, built and validated by the tool of the Blender that runs this test."""
    scripts = Path(bpy.utils.system_resource("SCRIPTS"))
    return make_zip(tmp_path_factory.mktemp("dist"), scripts)


def test_zip_holds_only_what_is_needed(package):
    names = zipfile.ZipFile(package).namelist()
    assert {name.partition("/")[0] for name in names} <= {
        "blender_manifest.toml",
        "__init__.py",
        "addon",
        "LICENSE",
        "README.md",
    }
    assert {"blender_manifest.toml", "__init__.py", "addon/__init__.py", "LICENSE"} <= set(names)
    suffixes = {Path(name).suffix for name in names if name.startswith("addon/")}
    assert suffixes <= {".py", ".glsl", ".png", ".json"}
    assert any(name.startswith("addon/shaders/") and name.endswith("_frag.glsl") for name in names)


def test_fresh_blender_installs_renders_and_uninstalls(package, tmp_path):
    script, picture = tmp_path / "use.py", tmp_path / "picture.png"
    script.write_text(USE)
    if bpy.app.binary_path:
        command = [bpy.app.binary_path, "-b", "--python-exit-code", "1", "--python", script, "--"]
    else:
        command = [sys.executable, script]
    done = subprocess.run(
        [*command, package, picture],
        env={**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "user")},
        capture_output=True,
        text=True,
        timeout=240,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "installed, rendered, uninstalled" in done.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")
