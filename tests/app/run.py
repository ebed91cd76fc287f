"""Run pytest inside the Blender application; tools/run_app_tests calls it.

blender -b --gpu-backend vulkan --python tests/app/run.py -- tests/app -q
"""

import os
import sys
import traceback
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def main() -> int:
    """pytest's exit code for the arguments after `--`, with the packages of $CONIC_APP_SITE importable."""
    sys.path.append(os.environ["CONIC_APP_SITE"])  # last: Blender's own packages win
    sys.dont_write_bytecode = True
    os.chdir(ROOT)
    import gpu
    import pytest

    if hasattr(gpu, "init"):  # from 5.2 on: a GPU context in the background, outside of render()
        gpu.init()
    return int(pytest.main(sys.argv[sys.argv.index("--") + 1 :]))


try:
    code = main()
except BaseException:
    traceback.print_exc()
    code = 1
sys.stdout.flush()
sys.stderr.flush()
os._exit(code)  # sys.exit in a script only ends the script: Blender would return 0
