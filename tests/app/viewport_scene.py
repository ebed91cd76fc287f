"""The scene that the tests of the viewport in Blender's window share: three balls on a floor, and where they are."""

from contextlib import contextmanager

import numpy as np

from tests.app.remote import open_window

SIZE = 960, 640
RED, GREEN, BLUE = range(3)

SCENE = """
from addon.viewport import kept_scenes, scenes
from addon.viewport.history import Draw, Load, records

def view(number=0):
    return view_parts(number)["area"].spaces.active

def numbers():
    "Of the log since the last call."
    found = list(records)
    records.clear()
    loads, draws = ([r for r in found if isinstance(r, kind)] for kind in (Load, Draw))
    return {
        "loads": [[str(load.change), sum((load.bytes or {}).values()), load.error] for load in loads],
        "began": sum(draw.began for draw in draws),
        "kept": sum(draw.kept for draw in draws),
        "steps": [draw.step for draw in draws],
        "samples": [draw.sample for draw in draws],
        "finished": bool(draws) and draws[-1].finished,
        "seconds": [draw.seconds for draw in draws],
    }

scene = bpy.context.scene
scene.render.engine = "CONIC"
scene.view_settings.view_transform = "Standard"
scene.conic.preview_samples = 4
scene.render.resolution_x, scene.render.resolution_y = 480, 270
with bpy.context.temp_override(**view_parts()):
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.ops.conic.plane_add(location=(0.0, 0.0, -1.0))
    colors = {"red": (0.8, 0.02, 0.02), "green": (0.02, 0.6, 0.02), "blue": (0.02, 0.05, 0.8)}
    for x, (name, color) in zip((-2.2, 0.0, 2.2), colors.items()):
        bpy.ops.conic.sphere_add(location=(x, 0.0, 0.0))
        bpy.context.object.name = name
        material = bpy.data.materials.new(name)
        material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1.0)
        bpy.context.object.data.materials.append(material)
bpy.ops.ed.undo_push(message="Scene")
view().overlay.show_floor = view().overlay.show_axis_x = view().overlay.show_axis_y = False
view().overlay.show_cursor = view().show_gizmo = False
view().shading.type = "RENDERED"
"""

#: Run before each test: the view and the balls are where they were.
RESET = """
space, parts = view(), view_parts()
space.shading.type = "RENDERED"
space.use_render_border = bpy.context.scene.render.use_border = False
bpy.context.scene.conic.preview_pause = False
turned = space.region_3d
turned.view_perspective, turned.view_distance = "PERSP", 12.0
turned.view_location, turned.view_rotation = (0.0, 0.0, 0.0), (0.83, 0.43, 0.16, 0.32)
"""


@contextmanager
def scene_in_window(folder):
    """A `Window` that shows the scene rendered. At the end nothing of it is left, and no error was printed."""
    with open_window(folder, SIZE, "app-viewport") as window:
        window.run(SCENE)
        window.rest()
        yield window
        window.run(RESET + "space.shading.type = 'SOLID'")
        window.rest(0.5)
        assert scenes(window) == 0, "nothing is kept for ever"
        assert "Traceback" not in window.said(), window.said()


def reset(window):
    """Have the view as it was at first, at rest, and the log empty."""
    window.run(RESET)
    window.rest()
    window.run("records.clear()")


def scenes(window):
    """How many scenes there are, but for those that wait for somebody to come back."""
    return window.run("kept_scenes.let_go(); result = len(scenes._scenes)")


def region(window, number=0):
    """x, y, width, height of a 3D viewport."""
    return window.run("r = view_parts(n)['region']\nresult = [r.x, r.y, r.width, r.height]", n=number)


def middle(window):
    x, y, width, height = region(window)
    return x + width // 2, y + height // 2


def ball(pixels, channel):
    """Where a ball of a color is seen: (x, y) of its middle and its area, in pixels; None where there is none."""
    others = np.delete(pixels, channel, axis=-1).max(axis=-1)
    rows, columns = np.nonzero((pixels[..., channel] > 1.8 * others + 0.04)[:, : int(0.8 * SIZE[0])])
    return (columns.mean(), rows.mean(), len(rows)) if len(rows) > 30 else None


def log(window):
    found = window.run("result = numbers()")
    print(found)
    return found


def assert_only_turned(found):
    """Every redraw of a moving view began anew and nothing was loaded."""
    assert not [load for load in found["loads"] if load[0] != "Change.NONE"]


def changes(found):
    """Names of the changes that were loaded."""
    return [load[0].removeprefix("Change.") for load in found["loads"] if load[0] != "Change.NONE"]


def far(before, after):
    """How far a ball has moved, in pixels."""
    return np.linalg.norm(np.subtract(before[:2], after[:2]))
