"""Particle hair as strands."""

import bpy
import numpy as np
import pytest

from addon.sync.attributes import randoms
from addon.sync.curve_sampling import Sampling
from addon.sync.particle_hair import strands_of_particles
from tests.blender.building import parts


def particle_hair(children=0, **settings):
    bpy.ops.mesh.primitive_plane_add()
    obj = bpy.context.object
    obj.location, obj.rotation_euler, obj.scale = (1.0, 2.0, 3.0), (0.3, 0.2, 0.1), (2.0, 2.0, 2.0)
    obj.modifiers.new("hair", "PARTICLE_SYSTEM")
    made = obj.particle_systems[0].settings
    made.type, made.count, made.hair_length, made.display_step, made.render_step = "HAIR", 20, 1.0, 2, 3
    if children:
        made.child_type = "SIMPLE"
        if hasattr(made, "child_nbr"):
            made.child_nbr = children
        if hasattr(made, "child_percent"):
            made.child_percent = children
        made.rendered_child_count = children
    for name, value in settings.items():
        setattr(made, name, value)
    return obj


def read_particles(obj, **settings):
    """The strands of an object's particle systems, as a viewport has them."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return strands_of_particles(obj.evaluated_get(depsgraph), Sampling(steps=1), False, **settings)


def test_particle_hair_tapers_from_root_to_tip():
    obj = particle_hair(root_radius=2.0, tip_radius=0.5, radius_scale=0.1, use_close_tip=False)
    (made,) = read_particles(obj)
    found = parts(made.read)
    assert made.read.dropped == 0
    assert len(found["sphere"]) == 20 * 5 and len(found["cone"]) == 20 * 4
    per_hair = found["sphere"].radius.reshape(20, 5)
    np.testing.assert_allclose(per_hair, np.tile(np.linspace(0.1, 0.025, 5), (20, 1)), rtol=0.05)
    roots = found["sphere"].center.reshape(20, 5, 3)[:, 0]
    assert np.abs(roots[:, 2]).max() < 1e-4 and np.abs(roots[:, :2]).max() <= 1.0001, "on the plane, in its space"


def test_closed_tips_and_shapes_of_particle_hair():
    obj = particle_hair(root_radius=1.0, tip_radius=0.0, radius_scale=0.1, use_close_tip=True, shape=0.5)
    (made,) = read_particles(obj)
    found = parts(made.read)
    assert len(found["sphere"]) == 20 * 4
    np.testing.assert_allclose(
        found["sphere"].radius.reshape(20, 4), np.tile(0.05 * (1.0 - np.arange(4) / 4.0) ** 2, (20, 1)), rtol=0.1
    )


def test_children_take_the_place_of_particle_hair():
    obj = particle_hair(children=3)
    (made,) = read_particles(obj)
    assert len(parts(made.read)["sphere"]) == 20 * 3 * 4  # the tips are closed


def test_the_slot_of_particle_hair():
    obj = particle_hair()
    for name in "ab":
        obj.data.materials.append(bpy.data.materials.new(name))
    obj.particle_systems[0].settings.material = 2
    for slot_count, slot in ((2, 1), (1, 0)):
        (made,) = read_particles(obj, slot_count=slot_count)
        assert all((part.material == slot).all() for part in parts(made.read).values())


def test_hairs_have_random_numbers_over_all_particle_systems():
    """Cycles counts the hairs of an object, and takes a hash of the number."""
    obj = particle_hair()
    obj.modifiers.new("more", "PARTICLE_SYSTEM")
    obj.particle_systems[1].settings = obj.particle_systems[0].settings
    made = read_particles(obj, keys=("random:", "geometry:Color"))
    values = [part.attributes["random:"][:, :, 0] for hair in made for part in parts(hair.read).values()]
    assert all((of_part == of_part[:, :1]).all() for of_part in values), "one for a hair"
    found = np.unique(np.concatenate([of_part[:, 0] for of_part in values]))
    expected = randoms(("random:",), 40)["random:"][:, 0]
    np.testing.assert_array_equal(found, np.sort(expected))
    assert not np.intersect1d(values[0], values[-1]).size, "the second system goes on counting"


@pytest.mark.parametrize("scale", [(1.0, 1.0, 0.0), (0.0, 0.0, 0.0)])
def test_hair_of_an_object_that_is_scaled_flat(scale):
    obj = particle_hair()
    obj.scale = scale
    (made,) = read_particles(obj)
    found = parts(made.read)
    assert found and all(np.isfinite(part.bounds()).all() for part in found.values())


def test_particles_that_are_no_hair_paths():
    obj = particle_hair(render_type="NONE")
    assert read_particles(obj) == []
    obj.particle_systems[0].settings.render_type = "PATH"
    obj.modifiers[0].show_viewport = False
    assert read_particles(obj) == []
