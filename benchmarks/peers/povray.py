"""POV-Ray on the scene in its own language, antialiasing and display off."""

import re
import shutil
from pathlib import Path

import numpy as np

from addon.engine import Settings
from tests.render import povray

from .base import Peer, number_in, run_program


class PovRay(Peer):
    name = "POV-Ray"
    unequal = (
        "POV-Ray traces in float64, on as many threads as there are cores.",
        "POV-Ray keeps lights' last occluders and a light buffer of the picture, which save it shadow tests.",
    )

    @classmethod
    def missing(cls):
        return None if shutil.which("povray") else "povray is not installed"

    @classmethod
    def version(cls):
        return re.search(r"POV-Ray (\S+)", run_program(["povray", "--version"], "/")).group(1)

    def __init__(self, scene, size, depth, folder):
        settings = Settings(max_depth=depth, weight_cutoff=0.0, shadows="TINTED")
        source = Path(folder, "scene.pov")
        source.write_text(povray.scene_text(scene, settings))
        self._folder, self._size = folder, size
        self._target = Path(folder, "povray.ppm")
        options = [f"+W{size}", f"+H{size}", f"+I{source}", f"+O{self._target}", "+FP16", "File_Gamma=1.0", "-A", "-D"]
        self._command = ["povray", *options]

    def trace(self):
        self._printed = run_program(self._command, self._folder)
        return number_in(self._printed, r"Trace Time:.*\((\d+\.?\d*) seconds\)")

    def picture(self):
        data = self._target.read_bytes()[-(self._size**2) * 6 :]
        return np.frombuffer(data, ">u2").reshape(self._size, self._size, 3)[::-1] / 65535.0

    def rays(self):
        """Rays in all but shadow rays, and tests of shadow rays, as POV-Ray counts them."""
        path = number_in(self._printed, r"\nRays:\s+(\d+)")
        shadow = re.search(r"Shadow Ray Tests:\s+(\d+)", self._printed)  # no such line where there are none
        return {"path": int(path), "shadow": int(shadow.group(1)) if shadow else 0}
