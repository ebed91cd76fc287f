"""The pictures of cases by both engines, and how they differ."""

from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np

from tests.blender.building import add_camera, material, node, sync
from tests.blender.pictures import picture

from .case import Node, Scene, Swatch
from .shapes import PIXELS, SHAPES

#: Swatches of a picture.
_MOST = 36
#: Emission of a swatch where its node gives 0, so that what is negative is seen too.
_OFFSET = 1.0
#: A difference counts in relation to at least this part of the brightest.
_FLOOR = 0.05


@dataclass(frozen=True)
class Compared:
    """The pixels (n, 3) that both engines draw something in, float64. `seen`: their share of those that either does."""

    conic: np.ndarray
    cycles: np.ndarray
    seen: float
    warnings: list = field(default_factory=list)

    @property
    def errors(self):
        """The relative error (n,) of each pixel."""
        size = np.abs(self.cycles).sum(axis=-1)
        difference = np.abs(self.conic - self.cycles).sum(axis=-1)
        relative = difference / np.maximum(size, max(_FLOOR * size.max(initial=0.0), 1e-6))
        return np.nan_to_num(relative, nan=np.inf)

    @property
    def median(self):
        return float(np.median(self.errors)) if len(self.errors) else np.inf

    @property
    def wrong(self):
        """The share of pixels that differ by more than 10%."""
        return float((self.errors > 0.1).sum() / max(len(self.errors), 1))

    @property
    def total(self):
        """How much more light Conic's picture has, in relation to Cycles'."""
        return float(self.conic.sum() / max(self.cycles.sum(), 1e-6) - 1.0)

    @property
    def spread(self):
        """How much Cycles' pixels vary, in relation to the brightest."""
        return float(np.ptp(self.cycles, axis=0).max() / max(np.abs(self.cycles).max(), 1e-6))


def faults(case, compared):
    """What is wrong with a case, as texts."""
    told = any(case.told in text for text in compared.warnings) if case.told else not compared.warnings
    checks = {
        f"warnings: {compared.warnings}": told,
        f"they draw other pixels: {compared.seen:.1%} are the same": compared.seen > 0.85,
        "nothing is seen": len(compared.errors) > 20 and (case.black or compared.cycles.any()),
        "what should vary does not": case.constant or compared.spread > 0.02,
        f"median relative error {compared.median:.2%}": compared.median < case.tolerance,
        f"{compared.total:+.2%} light": not isinstance(case, Scene) or abs(compared.total) < case.total,
        f"{compared.wrong:.1%} of the pixels differ by more than 10%": compared.wrong <= case.few,
    }
    return [text for text, right in checks.items() if not right]


def pictures(cases):
    """The cases (a dict by key) in the lists of keys that share a picture."""
    alone = [[key] for key, case in cases.items() if not isinstance(case, Swatch)]
    subjects = {}
    for key, case in cases.items():
        if isinstance(case, Swatch):
            subjects.setdefault(key.split("/")[0], []).append(key)
    shared = [keys[i : i + _MOST] for keys in subjects.values() for i in range(0, len(keys), _MOST)]
    return shared + alone


def compare(cases):
    """Draw cases that share a picture, in an empty Blender: `Compared` by their keys."""
    first = next(iter(cases.values()))
    return _compare_swatches(cases) if isinstance(first, Swatch) else _compare_scene(cases)


def _compare_swatches(cases):
    columns = int(np.ceil(np.sqrt(len(cases))))
    for i, case in enumerate(cases.values()):
        _add_swatch(case, i % columns, i // columns)
    camera = add_camera(type="ORTHO", ortho_scale=float(columns))
    camera.location = (columns / 2.0 - 0.5, columns / 2.0 - 0.5, 10.0)
    scene = bpy.context.scene
    scene.world = None
    set_render(scene, (columns * PIXELS, columns * PIXELS), samples=1)
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "GAUSSIAN", 0.01
    messages = sync().messages
    cells = [_cells(rendered, columns) for rendered in draw(scene)]
    found = {}
    for i, (key, case) in enumerate(cases.items()):
        conic, cycles = (c[i] for c in cells)
        numbers = cycles[:, :3].any(axis=-1) | (cycles[:, 3] < 0.5)  # Cycles shows black what is none
        conic, cycles = conic[numbers], cycles[numbers]
        values = [(c[..., :3] - _OFFSET) / case.scale for c in (conic, cycles)]
        warnings = [text for _, text in messages if repr(_material_name(case)) in text]
        found[key] = _compared(*values, conic[..., 3] > 0.5, cycles[..., 3] > 0.5, warnings)
    return found


def _compare_scene(cases):
    ((key, case),) = cases.items()
    scene = bpy.context.scene
    scene.world = None
    set_render(scene, case.size, case.samples)
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 1.0
    case.build()
    messages = sync().messages
    conic, cycles = (_blocks(np.minimum(p, case.brightest), case.blocks).reshape(-1, 4) for p in draw(scene))
    lit = [p[:, :3].sum(axis=-1) > 1e-3 * cycles[:, :3].sum(axis=-1).max() for p in (conic, cycles)]
    return {key: _compared(conic[:, :3], cycles[:, :3], *lit, [text for _, text in messages])}


def _blocks(pixels, size):
    """The means (height / size, width / size, 4) of squares of pixels."""
    height, width, channels = pixels.shape
    return pixels.reshape(height // size, size, width // size, size, channels).mean(axis=(1, 3))


def _compared(conic, cycles, drawn_by_conic, drawn_by_cycles, warnings):
    both, either = drawn_by_conic & drawn_by_cycles, drawn_by_conic | drawn_by_cycles
    return Compared(conic[both], cycles[both], both.sum() / max(either.sum(), 1), warnings)


def _material_name(case):
    return case.name[:60]


def _add_swatch(case, column, row):
    made, tree, output = material(_material_name(case))
    emission = node(tree, "Emission", output.inputs["Surface"], Strength=1.0)
    shift = node(tree, "VectorMath", emission.inputs["Color"])
    shift.operation = "MULTIPLY_ADD"
    shift.inputs[1].default_value, shift.inputs[2].default_value = (case.scale,) * 3, (_OFFSET,) * 3
    if isinstance(case.shown, Node):
        tree.links.new(case.shown.build(tree), shift.inputs[0])
    else:
        case.shown(tree, shift.inputs[0])
    shape = SHAPES[case.on]()
    shape.location = (column, row, 0.0)
    shape.material_slots[0].link = "OBJECT"
    shape.material_slots[0].material = made
    for name, value in case.of_object.items():
        setattr(shape, name, value)


def _cells(pixels, columns):
    """The swatches (columns^2, PIXELS^2, 4) of a picture, from the lower left by rows."""
    cells = pixels.reshape(columns, PIXELS, columns, PIXELS, 4).transpose(0, 2, 1, 3, 4)
    return cells.reshape(columns**2, PIXELS**2, 4)


def set_render(scene, size, samples):
    """What both engines have in common; Cycles takes twice as many samples, where it is the noisier one."""
    render = scene.render
    render.film_transparent = True
    render.resolution_x, render.resolution_y = size
    render.resolution_percentage = 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.image_settings.color_mode = "RGBA"
    scene.conic.samples, scene.conic.weight_cutoff, scene.conic.max_depth = samples, 0.0, 8
    cycles = scene.cycles
    cycles.device, cycles.samples = "CPU", max(2 * samples, 4)
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.max_bounces = cycles.glossy_bounces = cycles.transmission_bounces = cycles.transparent_max_bounces = 7
    cycles.diffuse_bounces, cycles.light_sampling_threshold = 0, 0.0
    cycles.blur_glossy = cycles.sample_clamp_indirect = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True


def draw(scene):
    """The scene (height, width, 4) float64 by Conic and by Cycles."""
    with TemporaryDirectory() as folder:
        for engine in ("CONIC", "CYCLES"):
            scene.render.engine = engine
            scene.render.filepath = str(Path(folder) / f"{engine}.exr")
            bpy.ops.render.render(write_still=True)
            yield picture(scene.render.filepath).astype(np.float64)
