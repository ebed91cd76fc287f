"""Light against Cycles that is no line of the shading table: what lights nothing, and shadows that are alpha."""

import bpy
import numpy as np
import pytest

from tests.blender.shading_table.drawing import draw, set_render
from tests.blender.shading_table.lights import floor_and_ball, glow, mesh
from tests.blender.shading_table.worlds import new_world

BLUE = (0.3, 0.6, 0.9, 1.0)


@pytest.fixture
def scene():
    """A floor and a ball without light."""
    floor_and_ball()
    scene = bpy.context.scene
    scene.world = None
    set_render(scene, (48, 36), samples=16)
    return scene


def test_a_world_that_diffuse_rays_do_not_see_lights_nothing(scene):
    new_world(BLUE, hidden_from=("diffuse", "camera"))
    assert [pixels[..., :3].max() for pixels in draw(scene)] == [0.0, 0.0]


def test_what_is_not_sampled_lights_nothing(scene):
    """Cycles finds it by chance alone, and only where diffuse rays go on."""
    glow(mesh("plane", size=1.5), sampling="NONE", location=(1.5, -0.8, 3.2))
    conic, _cycles = draw(scene)
    assert conic[..., :3].max() == 0.0


def test_a_shadow_catcher_in_the_light_of_the_world(scene):
    """Its alpha is what the ball takes of the world's light."""
    new_world(BLUE, strength=1.5)
    set_render(scene, (64, 48), samples=256)
    floor = next(obj for obj in scene.objects if obj.name.startswith("Plane"))
    floor.is_shadow_catcher = True
    conic, cycles = (pixels[..., 3] for pixels in draw(scene))
    shadow = (cycles > 0.2) & (cycles < 0.9)
    assert shadow.mean() > 0.05
    assert np.median(np.abs(conic - cycles)[shadow] / cycles[shadow]) < 0.03
    assert conic[shadow].mean() == pytest.approx(cycles[shadow].mean(), rel=0.01)
