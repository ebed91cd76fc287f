"""Build and validate the extension with Blender's own tool: python tools/make_zip.py [FOLDER]"""

import importlib.util
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def module_scripts() -> Path:
    """The scripts folder of Blender as a module; Blender itself is not imported."""
    spec = importlib.util.find_spec("bpy")
    if spec is None:
        sys.exit("make_zip: this Python has no Blender module (bpy): run `make zip`, which sets it up")
    return next(Path(spec.origin).parent.glob("[0-9]*/scripts"))


def make_zip(output: Path, scripts: Path, python: str = sys.executable) -> Path:
    """Validate the sources, build the zip in the folder `output`, validate that, and return its path.

    `scripts` is a Blender's scripts folder: its extension tool and its list of tags are used.
    Raises subprocess.CalledProcessError, after the tool's own message, for what Blender would refuse.
    """

    def tool(*arguments: str | Path) -> None:
        subprocess.run([python, scripts / "addons_core/bl_pkg/cli/blender_ext.py", *arguments], check=True)

    tags = f"--valid-tags={scripts / 'modules/_bpy_internal/extensions/tags.py'}"
    output.mkdir(parents=True, exist_ok=True)
    tool("validate", tags, ROOT)
    tool("build", "--source-dir", ROOT, "--output-dir", output)
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text())
    path = output / f"{manifest['id']}-{manifest['version']}.zip"
    tool("validate", tags, path)
    return path


if __name__ == "__main__":
    try:
        print(make_zip(Path(sys.argv[1] if len(sys.argv) > 1 else "dist"), module_scripts()))
    except subprocess.CalledProcessError as error:
        sys.exit(f"make_zip: Blender's extension tool refused: {error}")
