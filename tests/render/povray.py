"""Writes an engine scene in POV-Ray 3.7's language and renders it there, with what both have in common.

POV-Ray computes in float64, one ray through each pixel's centre. Where its light model differs, it is refused:

- it tints shadows by the surfaces' transmittance, always;
- it does not absorb what is reflected inside a body, so that absorption goes without reflection;
- its Fresnel share of transmission follows `conserve_energy`, so that the reflected colour must be white;
- a diffuse body under a coat is two layers, the upper one clear.

Both take the same coordinates: only `look_at` and rotations know of POV-Ray's left hand, and neither is used.
"""

import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from addon.engine import LightKind, SceneError
from addon.engine.material_packing import expressions_of

_FAR = 1e5  # where a sun stands
_NEAR = 1e-3  # fade_distance: far below any distance to a light, so that 2 / (1 + (d / f)^2) is 2 f^2 / d^2


class NotInPovrayError(SceneError):
    """The scene asks for what POV-Ray's light model does not have."""


def render(scene, width, height, settings):
    """The scene by POV-Ray: (height, width, 3) float64, linear, clipped to 0..1, bottom row first.

    Raises FileNotFoundError when POV-Ray is not installed and RuntimeError with its messages when it fails.
    """
    program = shutil.which("povray")
    if program is None:
        raise FileNotFoundError("povray is not installed: 'make test' does it, or apt-get install povray")
    with tempfile.TemporaryDirectory() as folder:
        source, picture = Path(folder, "scene.pov"), Path(folder, "scene.ppm")
        source.write_text(scene_text(scene, settings))
        options = [f"+W{width}", f"+H{height}", f"+I{source}", f"+O{picture}", "+FP16", "File_Gamma=1.0"]
        done = subprocess.run(
            [program, *options, "-A", "-D", "+WT1", "Verbose=off"],
            capture_output=True,
            text=True,
            timeout=120,
            cwd=folder,
        )
        if done.returncode or not picture.is_file():
            raise RuntimeError(f"povray failed:\n{done.stderr[-3000:]}")
        return _read_ppm(picture.read_bytes(), width, height)


def _read_ppm(data, width, height):
    """A 16-bit PPM, whose header may hold comments: its samples are the end of the file."""
    header, values = data[: -width * height * 6], np.frombuffer(data[-width * height * 6 :], ">u2")
    if not header.startswith(b"P6") or not header.endswith(b"65535\n"):
        raise RuntimeError(f"povray wrote no 16-bit PPM of {width} x {height}: {header[:80]}")
    return values.reshape(height, width, 3)[::-1] / 65535.0


def scene_text(scene, settings):
    """The scene in POV-Ray's language. Raises NotInPovrayError for what it cannot say."""
    transmits = any(max(material.transmit) > 0.0 for material in scene.materials)
    if transmits and scene.lights and settings.shadows != "TINTED":
        raise NotInPovrayError("POV-Ray has no opaque shadows of transparent bodies")
    if settings.weight_cutoff > 0.0 or settings.samples > 1 or settings.corner_rays or scene.world.image >= 0:
        raise NotInPovrayError("compare without weight cut-off, with one sample and a plain sky")
    parts = [
        "#version 3.7;",
        f"global_settings {{ assumed_gamma 1.0 max_trace_level {settings.max_depth} adc_bailout 0 ambient_light 0 }}",
        f"background {{ {_rgb(scene.world.color)} }}",
        _camera(scene.camera),
        *(_light(light) for light in scene.lights),
        *(f"#declare M{i} = material {{ {_material(m)} }}" for i, m in enumerate(scene.materials)),
        *_geometry(scene.shapes, range(len(scene.materials))),
        *(_planes(planes) for planes in scene.planes),
    ]
    for instance in scene.instances:
        for matrix in instance.matrices:
            parts += _geometry(instance.geometry, instance.materials, matrix)
    return "\n".join(parts) + "\n"


def _vector(values):
    return f"<{', '.join(f'{float(value):.17g}' for value in values)}>"


def _rgb(color):
    return f"rgb {_vector(color)}"


def _camera(camera):
    """Its axes as they are: a ray is direction + x right + y up for x, y in -1/2..1/2."""
    if camera.clip[0] != 0.0 or camera.clip[1] < 1e10:
        raise NotInPovrayError("POV-Ray's camera has no clip distances")
    left, right, bottom, top = camera.window
    x, y, z, eye = camera.matrix[:3].T
    shift = (left + right) / 2.0 * x + (bottom + top) / 2.0 * y
    location, direction = (eye + shift, -z) if camera.orthographic else (eye, shift - z)
    return (
        f"camera {{ {'orthographic' if camera.orthographic else 'perspective'} location {_vector(location)} "
        f"right {_vector((right - left) * x)} up {_vector((top - bottom) * y)} direction {_vector(direction)} }}"
    )


def _light(light):
    if light.kind == LightKind.SUN:
        position, extra = np.multiply(light.position, _FAR), "parallel point_at <0, 0, 0>"
        color = light.color
    elif light.kind == LightKind.CONSTANT:
        position, extra, color = light.position, "", light.color
    else:
        position, extra = light.position, f"fade_distance {_NEAR} fade_power 2"
        color = np.divide(light.color, 2.0 * _NEAR**2)
    return f"light_source {{ {_vector(position)} {_rgb(color)} {extra} }}"


def _material(material):
    """Texture and interior of a material."""
    if expressions_of(material):
        raise NotInPovrayError("what varies over a surface is not written for POV-Ray")
    reflects, transmits = max(material.reflect) > 0.0, max(material.transmit) > 0.0
    absorbs = max(material.absorption) > 0.0
    if transmits and (max(material.diffuse) > 0.0 or max(material.glow) > 0.0):
        raise NotInPovrayError("a transparent body that is diffuse or glows is not written for POV-Ray")
    if material.fresnel and (transmits or reflects) and material.reflect != (1.0, 1.0, 1.0):
        raise NotInPovrayError("with Fresnel, POV-Ray conserves energy only for white reflection")
    if absorbs and reflects:
        raise NotInPovrayError("POV-Ray does not absorb what is reflected inside a body")
    interior = f"interior {{ ior {material.ior:.17g} {_attenuation(material.absorption) if absorbs else ''} }}"
    if transmits:
        clear = f"pigment {{ rgbf {_vector((*material.transmit, 1.0))} }} finish {{ ambient 0 diffuse 0"
        return f"texture {{ {clear} {_reflection(material)} }} }} {interior}"
    if material.fresnel and reflects:
        coat = f"pigment {{ rgbt <1, 1, 1, 1> }} finish {{ ambient 0 diffuse 0 {_reflection(material)} }}"
        return f"texture {{ {_lambert(material)} }} texture {{ {coat} }} {interior}"
    return f"texture {{ {_lambert(material, _reflection(material))} }}"


def _reflection(material):
    if max(material.reflect) == 0.0:
        return ""
    if material.fresnel:
        return f"reflection {{ rgb 0, {_rgb(material.reflect)} fresnel on }} conserve_energy"
    return f"reflection {{ {_rgb(material.reflect)}, {_rgb(material.reflect)} }}"


def _lambert(material, more=""):
    """Pigment and finish of what is diffuse and glows; POV-Ray multiplies both by one pigment."""
    diffuse, glow = np.array(material.diffuse), np.array(material.glow)
    if ((diffuse == 0.0) & (glow > 0.0)).any() and diffuse.any():
        raise NotInPovrayError("a colour that glows must be diffuse as well, or nothing be diffuse")
    pigment = diffuse if diffuse.any() else np.ones(3)
    emission = np.divide(glow, pigment, out=np.zeros(3), where=pigment > 0.0)
    if len(set(material.highlight)) > 1:
        raise NotInPovrayError("POV-Ray's Phong highlight is white")
    phong = f"phong {material.highlight[0]:.17g} phong_size {material.shine:.17g}" if material.highlight[0] else ""
    return (
        f"pigment {{ {_rgb(pigment)} }} finish {{ ambient 0 diffuse {1 if diffuse.any() else 0} "
        f"emission {_rgb(emission)} {phong} {more} }}"
    )


def _attenuation(absorption):
    """exp(-(1 - fade_color) length / fade_distance) is what a fade_power of 1000 and more means."""
    peak = max(absorption)
    return f"fade_power 1001 fade_distance {1.0 / peak:.17g} fade_color {_rgb(1.0 - np.divide(absorption, peak))}"


def _planes(planes):
    return "\n".join(
        f"plane {{ {_vector(n)}, {float(n @ p):.17g} material {{ M{m} }} }}"
        for n, p, m in zip(planes.normal, planes.point, planes.material, strict=True)
    )


def _geometry(geometry, materials, matrix=None):
    """The objects of a geometry. Cylinders and cones with discs on their ends become solids of POV-Ray."""
    parts = {part.kind: part for _, part in geometry.kinds()}
    discs = parts.get("disc")
    caps = {_end(*row) for row in zip(discs.center, discs.radius, discs.material, strict=True)} if discs else set()
    used, texts = set(), []

    def closed(*ends):
        """Whether each of the ends (center, radius, material) of some radius has a disc, which is then used up."""
        keys = {_end(*end) for end in ends if end[1] > 0.0}
        used.update(keys & caps if keys <= caps else ())
        return "" if keys <= caps else "open"

    for kind, part in parts.items():
        if kind not in ("disc", "triangle"):
            texts += _WRITERS[kind](part, closed)
    if discs:
        free = [_end(*row) not in used for row in zip(discs.center, discs.radius, discs.material, strict=True)]
        texts += _discs(discs.take(np.array(free)))
    if "triangle" in parts:
        texts += _meshes(parts["triangle"])
    placed = "" if matrix is None else f"matrix {_vector(np.asarray(matrix)[:3].T.ravel())}"
    return [f"{shape} material {{ M{materials[slot]} }} {placed} }}" for shape, slot in texts]


def _end(center, radius, material):
    return (*np.round(center, 9).tolist(), round(float(radius), 9), int(material))


def _spheres(part, _closed):
    rows = zip(part.center, part.radius, part.material, strict=True)
    return [(f"sphere {{ {_vector(center)}, {radius:.17g}", slot) for center, radius, slot in rows]


def _cylinders(part, closed):
    rows = zip(part.base, part.apex, part.radius, part.material, strict=True)
    return [
        (f"cylinder {{ {_vector(a)}, {_vector(b)}, {r:.17g} {closed((a, r, slot), (b, r, slot))}", slot)
        for a, b, r, slot in rows
    ]


def _cones(part, closed):
    rows = zip(part.base, part.apex, part.base_radius, part.apex_radius, part.material, strict=True)
    return [
        (f"cone {{ {_vector(a)}, {ra:.17g}, {_vector(b)}, {rb:.17g} {closed((a, ra, slot), (b, rb, slot))}", slot)
        for a, b, ra, rb, slot in rows
    ]


def _discs(part):
    rows = zip(part.center, part.normal, part.radius, part.material, strict=True)
    return [(f"disc {{ {_vector(center)}, {_vector(n)}, {r:.17g}", slot) for center, n, r, slot in rows]


def _meshes(part):
    """A mesh for each material, so that a closed surface of triangles has one interior."""
    if part.one_sided.any():
        raise NotInPovrayError("POV-Ray's triangles have two sides")
    return [(f"mesh {{ {_triangles(part.take(part.material == slot))}", slot) for slot in np.unique(part.material)]


def _triangles(part):
    texts = []
    for points, normals in zip(
        np.stack([part.p0, part.p1, part.p2], axis=1), np.stack([part.n0, part.n1, part.n2], axis=1), strict=True
    ):
        smooth = bool(normals.any())
        corners = np.stack([points, normals], axis=1).reshape(-1, 3) if smooth else points
        texts.append(f"{'smooth_' if smooth else ''}triangle {{ {', '.join(_vector(c) for c in corners)} }}")
    return " ".join(texts)


_WRITERS = {"sphere": _spheres, "cylinder": _cylinders, "cone": _cones}
