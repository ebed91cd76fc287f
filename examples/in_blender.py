# SPDX-License-Identifier: GPL-3.0-or-later
"""What the example scripts have in common: run by a Python that has bpy, or by the application with `blender -b -P`."""

import argparse
import atexit
import sys
from pathlib import Path

import bpy
from mathutils import Vector

from examples.painted_images import linear


def register_conic():
    """Conic from this checkout, unless Blender has it already as an extension."""
    if not hasattr(bpy.types.Scene, "conic"):
        import addon

        addon.register()
        if not bpy.app.binary_path:  # as a module; the application has freed its classes by then
            atexit.register(addon.unregister)


class _Parser(argparse.ArgumentParser):
    def parse_args(self, *arguments):
        options = super().parse_args(*arguments)
        if not (options.output or options.blend):
            self.error("nothing to do: give --output FILE, --blend FILE or both")
        return options


def parser_of(script, description, *, size, samples=8):
    """A parser of the options that all examples have: --output, --blend, --size and --samples."""
    parser = _Parser(prog=Path(script).name, description=description)
    parser.add_argument("--output", metavar="FILE", help="render into this PNG file")
    parser.add_argument("--blend", metavar="FILE", help="save the scene as this .blend file")
    parser.add_argument("--size", type=int, nargs=2, default=size, metavar=("W", "H"))
    parser.add_argument("--samples", type=int, default=samples)
    parser.add_argument("--engine", choices=("CONIC", "CYCLES"), default="CONIC", help="what renders it")
    return parser


def arguments_given():
    """The script's own arguments; under `blender -P` those after `--`."""
    return sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]


def empty_blender():
    """Conic registered, and no scene but an empty one."""
    register_conic()
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def new_light(kind, location, energy, color):
    """A lamp without extent, in no scene yet, that looks at the origin. `color`: six hexadecimal digits."""
    light = bpy.data.lights.new(kind.title(), kind)
    light.energy, light.color = energy, linear(color)
    if kind == "SUN":
        light.angle = 0.0
    else:
        light.shadow_soft_size = 0.0
    lamp = bpy.data.objects.new(light.name, light)
    lamp.location = location
    lamp.rotation_mode = "QUATERNION"
    lamp.rotation_quaternion = (-Vector(location)).to_track_quat("-Z", "Y")
    return lamp


def _render_by_cycles(scene, samples):
    """Let Cycles follow the same light: lamps, sky and what glows on what is diffuse, and the rays of mirrors and
    glass."""
    if not hasattr(scene, "cycles"):
        import addon_utils

        addon_utils.enable("cycles")
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = "CPU", samples, False, False
    cycles.max_bounces, cycles.diffuse_bounces = scene.conic.max_depth - 1, 0
    cycles.glossy_bounces = cycles.transmission_bounces = cycles.transparent_max_bounces = scene.conic.max_depth - 1
    cycles.blur_glossy = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True


def finish(scene, options):
    """Save and render the scene as the options say."""
    scene.render.resolution_x, scene.render.resolution_y = options.size
    scene.conic.samples = options.samples
    if options.engine == "CYCLES":
        _render_by_cycles(scene, options.samples)
    if options.blend:
        bpy.ops.wm.save_as_mainfile(filepath=str(Path(options.blend).resolve()), compress=True)
    if options.output:
        scene.render.filepath = str(Path(options.output).resolve())
        bpy.ops.render.render(write_still=True)
