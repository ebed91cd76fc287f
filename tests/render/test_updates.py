"""A scene that takes the place of another on the device: only what differs is uploaded."""

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest

from addon.engine import (
    Camera,
    Change,
    Geometry,
    Image,
    Instances,
    Light,
    LoadedScene,
    Material,
    Planes,
    Scene,
    SceneError,
    Session,
    Settings,
    Spheres,
    Triangles,
    World,
    data_texture,
    tree_packing,
)
from addon.engine.expression import component
from addon.engine.film_options import Outlines
from addon.engine.material import surface_attribute

from .edited_stage import CAMERA, SIZE, picture, update

# What an edit changes, and what is uploaded


def large(count=20_000, seed=0):
    """Spheres that are a large geometry."""
    rng = np.random.default_rng(seed)
    return Geometry(Spheres(center=rng.uniform(-3, 3, (count, 3)), radius=rng.uniform(0.02, 0.05, count)), name="world")


def ball(radius=1.0):
    return Geometry(Spheres(center=[[0, 0, 0]], radius=radius))


def placed(geometry, *places, slots=(0,)):
    matrices = np.tile(np.eye(4), (len(places), 1, 1))
    matrices[:, :3, 3] = places
    return Instances(geometry, matrices, slots)


def many_places(last):
    """Places (1000, 3) of which the last one is another by this number."""
    places = np.random.default_rng(0).uniform(-4, 4, (1000, 3))
    places[-1] = last
    return places


def simple_scene(**parts):
    parts = {"materials": [Material(diffuse=0.7), Material(diffuse=(0.2, 0.4, 0.6))], "shapes": large()} | parts
    return Scene(camera=CAMERA, lights=[Light.sun((0.3, -0.5, 1.0), 2.0)], **parts)


@pytest.fixture
def loaded(device):
    loaded = LoadedScene(device)
    yield loaded
    loaded.free()


@pytest.fixture
def before(loaded):
    """A scene that is loaded: many spheres, instances, a plane, an image."""
    scene = simple_scene(images=[Image(np.ones((16, 16, 4), np.float32))])
    scene.instances = [placed(ball(), *many_places(1))]
    scene.add_plane((0, 0, -4), (0, 0, 1), 1)
    update(loaded, scene, Settings())
    return scene


def test_nothing_differs(loaded, before):
    version = loaded.version
    moved = replace(before, camera=Camera.look_at((3.0, -9.0, 3.0), (0.0, 0.0, 0.5)))
    made = update(loaded, moved, Settings())
    assert made.change == Change.NONE and made.bytes == {} and loaded.version == version


def test_the_first_scene_changes_everything(loaded):
    made = update(loaded, simple_scene(), Settings())
    assert made.change == ~Change.NONE and {"spheres", "nodes", "tables"} <= set(made.bytes)


EDITS = {
    "a constant": (
        lambda s: replace(s, materials=[s.materials[0], Material(diffuse=0.5)]),
        Change.MATERIALS,
        {"tables": 400},
    ),
    "a light": (
        lambda s: replace(s, lights=[Light.sun((0.3, -0.5, 1.0), 3.0)]),
        Change.LIGHTS,
        {"tables": 400},
    ),
    "the world": (lambda s: replace(s, world=World((0.5, 0.1, 0.1))), Change.WORLD, {"tables": 400}),
    "a plane": (
        lambda s: replace(s, planes=[Planes(point=[[0, 0, -4.5]], normal=[[0, 0, 1]])]),
        Change.PLANES,
        {"tables": 400},
    ),
    "an image": (
        lambda s: replace(s, images=[Image(np.zeros((16, 16, 4), np.float32))]),
        Change.IMAGES,
        {"images": 16 * 16 * 16, "tables": 400},
    ),
    "one of many instances": (
        lambda s: replace(s, instances=[placed(s.instances[0].geometry, *many_places(2))]),
        Change.INSTANCES,
        {"instances": 1001 * 8 * 16, "nodes": 1000 * 4 * 16},
    ),
    "a new mesh": (
        lambda s: replace(s, instances=[*s.instances, placed(ball(0.5), (1, 2, 3))]),
        Change.INSTANCES | Change.GEOMETRY,
        {"instances": 1002 * 8 * 16, "nodes": 1002 * 4 * 16, "spheres": 16, "sphere_surfaces": 16},
    ),
    "no instances": (
        lambda s: replace(s, instances=[]),
        Change.INSTANCES | Change.GEOMETRY,
        {},
    ),
}


@pytest.mark.parametrize("name", EDITS)
def test_an_edit_uploads_what_is_its_own(loaded, before, name):
    edit, change, most = EDITS[name]
    version = loaded.version
    made = update(loaded, edit(before), Settings())
    assert made.change == change | Change.FILM and loaded.version == version + 1
    assert set(made.bytes) == set(most)
    assert all(made.bytes[texture] <= count for texture, count in most.items()), made.bytes


@pytest.mark.parametrize(
    "option, change",
    [({"max_depth": 5}, Change.PROGRAM), ({"weight_cutoff": 0.1}, Change.NONE), ({"samples": 4}, Change.NONE)],
)
def test_a_setting_uploads_nothing(loaded, before, option, change):
    made = update(loaded, before, replace(Settings(), **option))
    assert made.change == change | Change.FILM and made.bytes == {}


def test_a_program_serves_as_long_as_it_can_and_no_longer(loaded, before):
    source = loaded.drawn.source
    nothing = replace(
        before, instances=[], planes=[], shapes=Geometry(Triangles(p0=[[0, 0, 0]], p1=[1, 0, 0], p2=[0, 0, 1]))
    )
    for scene, serves in ((replace(before, instances=[]), True), (replace(before, planes=[]), True), (nothing, False)):
        update(loaded, scene, Settings())
        assert (loaded.drawn.source == source) == serves
        assert np.array_equal(picture(loaded.device, loaded), picture(loaded.device, None, scene, Settings()))
    assert "HAS_SPHERE" not in loaded.drawn.features


def test_what_moves_a_little_is_refitted_and_what_moves_far_is_built(loaded):
    scene = simple_scene()
    update(loaded, scene, Settings())
    part = dict(scene.shapes.kinds())[0]
    cost = loaded.drawn.packed.statistics["bvh"]["sah_cost"]
    for step, change in ((0.01, Change.REFIT), (0.01, Change.REFIT), (3.0, Change.GEOMETRY)):
        old = scene.shapes
        center = part.center + np.random.default_rng(1).normal(0.0, step, part.center.shape)
        scene = replace(scene, shapes=Geometry(Spheres(center=center, radius=part.radius), name="world"))
        scene.shapes.replaces = weakref.ref(old)
        del old
        gc.collect()
        made = update(loaded, scene, Settings())
        assert made.change & ~Change.PROGRAM == change | Change.FILM, "a deeper tree needs a larger stack"
        assert np.array_equal(picture(loaded.device, loaded), picture(loaded.device, None, scene, Settings()))
    assert loaded.drawn.packed.statistics["bvh"]["sah_cost"] < 3.0 * cost


def test_of_another_number_nothing_is_refitted(loaded):
    scene = simple_scene()
    update(loaded, scene, Settings())
    new = replace(scene, shapes=large(19_999))
    new.shapes.replaces = weakref.ref(scene.shapes)
    assert update(loaded, new, Settings()).change == Change.GEOMETRY | Change.FILM


def test_what_was_given_back_is_used_again(loaded):
    """Playing an animation takes twice the memory of a frame, and some to spare as trees differ in their nodes, however
    long it is."""
    rooms = []
    for seed in range(12):
        update(loaded, simple_scene(shapes=large(seed=seed)), Settings())
        rooms.append(sum(loaded.texture_bytes.values()))
    assert max(rooms) < 3.5 * rooms[0] and len(set(rooms[2:])) <= 2


def test_a_setting_or_scene_that_is_refused_leaves_what_is_there(loaded, before):
    expected = picture(loaded.device, loaded)
    with pytest.raises(SceneError):
        loaded.prepare(replace(before, instances=[placed(ball(), (0, 0, 0), slots=(7,))]), Settings())
    assert np.array_equal(picture(loaded.device, loaded), expected)


def test_an_update_that_is_dropped_half_way_leaves_what_is_there(loaded, before):
    expected = picture(loaded.device, loaded)
    for _ in range(3):
        made = loaded.prepare(replace(before, shapes=large(30_000, 5)), Settings())
        while "spheres" not in made.bytes:
            assert not loaded.apply(made, 0.0)
        assert np.array_equal(picture(loaded.device, loaded), expected)
        loaded.drop(made)
        assert np.array_equal(picture(loaded.device, loaded), expected)
    update(loaded, before, Settings())
    assert np.array_equal(picture(loaded.device, loaded), expected)


def test_where_there_is_no_room_beside_what_lies_there_all_is_laid_out_anew(loaded, monkeypatch):
    monkeypatch.setattr(data_texture, "most_texels", lambda size: 2 * data_texture.WIDTH)
    scenes = []
    for seed in range(2):
        places = np.random.default_rng(seed).uniform(-4, 4, (900, 3))
        scenes.append(simple_scene(shapes=large(10, seed), instances=[placed(ball(), *places)]))
    update(loaded, scenes[0], Settings())
    made = update(loaded, scenes[1], Settings())
    assert Change.ALL_TEXTURES in made.change
    assert np.array_equal(picture(loaded.device, loaded), picture(loaded.device, None, scenes[1], Settings()))
    assert update(loaded, scenes[1], Settings()).change == Change.NONE


def test_what_has_changed_without_a_trace_stays_when_good_trees_come(loaded):
    scene = simple_scene(shapes=large(tree_packing.QUICK_FROM))
    update(loaded, scene, Settings(samples=2), quick=True)
    better = loaded.prepare_better()
    moved = replace(scene, camera=Camera.look_at((0.0, -8.0, 0.0), (0.0, 0.0, 0.0)))
    assert update(loaded, moved, Settings(samples=3), quick=True).change == Change.NONE
    assert loaded.apply(better) and not loaded.can_improve
    assert loaded.drawn.settings.samples == 3 and loaded.drawn.camera is moved.camera


def test_lines_around_another_attribute_begin_a_new_picture(loaded):
    """Both attributes are there for the material's sake, so that nothing else differs."""
    material = Material(diffuse=surface_attribute("a"), metallic=component(surface_attribute("b"), 0))
    values = {"a": (1.0, 1.0, 1.0, 1.0), "b": (0.0, 1.0, 0.0, 1.0)}
    shapes = Geometry(Spheres(center=np.zeros((2, 3)), radius=1.0, attributes=values), name="both")
    scene = replace(simple_scene(shapes=shapes), materials=[material], outline_attribute="a")
    settings = Settings(outlines=Outlines(around="ATTRIBUTE"))
    update(loaded, scene, settings)
    assert update(loaded, replace(scene), settings).change == Change.NONE
    assert update(loaded, replace(scene, outline_attribute="b"), settings).change == Change.FILM


def test_sessions_of_one_scene_begin_anew_when_it_changes(loaded, before):
    sessions = [Session(loaded.device, loaded) for _ in range(2)]
    for size, session in zip((SIZE, (20, 20)), sessions, strict=True):
        session.start(*size)
        session.step(60.0)
    scene = replace(before, world=World((0.9, 0.1, 0.1)))
    update(loaded, scene, Settings())
    for size, session in zip((SIZE, (20, 20)), sessions, strict=True):
        while session.step(60.0):
            pass
        assert np.array_equal(session.pixels(), picture(loaded.device, None, scene, Settings(), size))
        session.free()
    assert loaded.drawn is not None, "it is not theirs"


# Quick trees, and good ones after them


def test_good_trees_take_the_place_of_quick_ones_and_the_picture_goes_on(device, loaded):
    scene = simple_scene(instances=[placed(large(seed=1), (0, 0, 2), (3, 0, 1))])
    settings = Settings(samples=4)
    assert loaded.apply(loaded.prepare(scene, settings, quick=True)) and loaded.can_improve
    session = Session(device, loaded)
    session.start(40, 30)
    session.film.samples = 2
    while session.step(1.0):
        pass
    version, source = loaded.version, loaded.drawn.source
    made = loaded.prepare_better()
    assert made.change == Change.TREES and made.improves
    assert loaded.apply(made) and not loaded.can_improve
    assert loaded.version == version and loaded.drawn.source == source
    session.film.samples = 4
    while session.step(1.0):
        pass
    expected = picture(device, None, scene, settings, size=(40, 30))
    assert np.abs(session.pixels() - expected).max() < 1e-5
    session.free()


def test_lines_begin_anew_with_good_trees(loaded):
    loaded.apply(loaded.prepare(simple_scene(), Settings(outlines=Outlines()), quick=True))
    assert loaded.prepare_better().change == Change.TREES | Change.FILM


def test_a_scene_of_good_trees_cannot_improve(loaded, before):
    assert not loaded.can_improve
    loaded.apply(loaded.prepare(replace(before, shapes=ball()), Settings(), quick=True))
    assert not loaded.can_improve, "few shapes have a good tree at once"


def test_an_edit_makes_the_better_trees_of_the_scene_before_useless(loaded):
    scene = simple_scene()
    loaded.apply(loaded.prepare(scene, Settings(), quick=True))
    better = loaded.prepare_better()
    loaded.apply(loaded.prepare(replace(scene, materials=[Material(diffuse=0.1)] * 2), Settings(), quick=True))
    with pytest.raises(RuntimeError, match="before another one was applied"):
        loaded.apply(better)
    assert loaded.can_improve and loaded.prepare_better().improves
