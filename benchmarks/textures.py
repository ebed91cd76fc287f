"""What procedural textures cost: `python -m benchmarks.textures`.

Milliseconds until a program with one call of a texture has drawn for the first time, less those of a program without
one, and nanoseconds a pixel for drawing again: with the texture, and where all its arguments are 0, as they are for
materials without it. All are seconds of the processor, on which Mesa's driver compiles and draws, of all its cores
together; drivers' caches are off.
"""

import os
import time

os.environ["MESA_SHADER_CACHE_DISABLE"] = "true"

import numpy as np

from addon.engine.devices.headless import HeadlessDevice
from tests.shaders import harness

_PIXELS = 256 * 256
_PLACES = {"1d": "b.x * a.w", "2d": "b.x * a.xy", "3d": "b.x * a.xyz", "4d": "b.x * a.xyz, b.x * a.w"}
#: What follows the place; b.x is 1, or 0 where there is no texture, and drivers cannot know.
_NOISE = "b.x, 2.0 * b.x, 0.5, 2.0, 0.0, 1.0, {distortion} * b.x, int(b.y), true, 3 * int(b.x), color"
_VORONOI = "b.x, 0.0, 0.5, 2.0, 1.0, 0.5, 1.0, {feature} * int(b.x), int(b.y), false, color, position"
_GABOR = "b.x, 2.0, 0.5, {direction}, 8 * int(b.x), color.x, color.y"


def calls():
    """GLSL of a texture by name."""
    found = {}
    for dimensions, place in _PLACES.items():
        for distortion in (0.0, 1.0):
            arguments = _NOISE.format(distortion=distortion)
            name = f"noise {dimensions} distorted" if distortion else f"noise {dimensions}"
            found[name] = f"noise_texture_{dimensions}({place}, {arguments})"
        for feature in ("F1", "SMOOTH_F1", "EDGE"):
            arguments = _VORONOI.format(feature=f"VORONOI_{feature}")
            found[f"voronoi {dimensions} {feature}"] = f"voronoi_texture_{dimensions}({place}, {arguments})"
    for dimensions, direction in (("2d", "a.z"), ("3d", "a.zxy")):
        arguments = _GABOR.format(direction=direction)
        found[f"gabor {dimensions}"] = f"gabor_texture_{dimensions}({_PLACES[dimensions]}, {arguments})"
    return found


def drawn(device, call, there):
    """Seconds for drawing all pixels with a call."""
    side = np.arange(256) * (5.0 / 256)
    x, y = (axis.ravel() for axis in np.meshgrid(side, side))
    columns = x, y, 0.3 * x + 0.2, 0.7 * y, there, 0.0, 0.0, 0.0
    start = time.process_time()
    outputs = ("out_value", "out_color", "out_position")
    harness.run_values(
        device,
        "texture_frag.glsl",
        *(np.broadcast_to(column, _PIXELS) for column in columns),
        constants={"TEST_CALL": f"vec4({call})"},
        outputs=outputs,
    )
    return time.process_time() - start


def cost(call):
    """Seconds until the first picture beyond those of the second, and of the second with and without the texture."""
    device = HeadlessDevice()
    first = drawn(device, call, 1.0)
    again = min(drawn(device, call, 1.0) for _ in range(3))
    without = min(drawn(device, call, 0.0) for _ in range(3))
    device.close()
    return first - again, again, without


def main():
    cost("a.x")  # what is only once in a process
    base, drawing, _ = cost("a.x")
    print(f"{'':24}{'compiled (ms)':>16}{'ns a pixel':>12}{'where none':>12}")
    for name, call in calls().items():
        compiled, again, without = cost(call)
        nanoseconds = ((seconds - drawing) / _PIXELS * 1e9 for seconds in (again, without))
        print(f"{name:24}{1000 * (compiled - base):16.0f}{''.join(f'{n:12.0f}' for n in nanoseconds)}", flush=True)


if __name__ == "__main__":
    main()
