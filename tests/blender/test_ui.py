"""The interface: settings that are promises, panels shown for Conic, and that nothing of it stays behind."""

import math
import re
from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest

from addon import statistics
from addon.sync.compat import may_lack_nodes
from addon.ui import (
    film,
    film_presets,
    light,
    material,
    object_shape,
    object_visibility,
    render_settings,
    standard_panels,
    world_light,
)
from addon.ui import statistics as statistics_panel
from tests.blender.building import link

RENDER_PANELS = [
    panel
    for module in (render_settings, film, world_light)
    for name, panel in vars(module).items()
    if name.startswith("CONIC_RENDER_PT_")
]

DEFAULTS = {
    "samples": 16,
    "preview_samples": 4,
    "seed": 0,
    "use_animated_seed": False,
    "preview_frame_seconds": 1 / 30,
    "preview_pause": False,
    "max_depth": 8,
    "weight_cutoff": 1 / 512,
    "shadows": "TRANSPARENT",
    "entry": "AUTO",
    "recognise": "ALWAYS",
    "curve_sampling": "PIXELS",
    "curve_tolerance": 0.25,
    "curve_steps": 8,
    "world_light": "SAMPLED",
    "use_ao": False,
    "ao_distance": 1.0,
    "ao_factor": 1.0,
    "use_flat_colors": False,
    "use_depth_cue": False,
    "depth_cue_into": "BACKGROUND",
    "depth_cue_color": (1.0, 1.0, 1.0),
    "depth_cue_strength": 0.8,
    "depth_cue_range": "SCENE",
    "depth_cue_start": 5.0,
    "depth_cue_end": 25.0,
    "use_outlines": False,
    "outline_around": "SHAPES",
    "outline_attribute": "chain_id",
    "outline_color": (0.0, 0.0, 0.0, 1.0),
    "outline_width": 1.5,
    "outline_inner_width": 1.0,
    "outline_crease_angle": math.radians(40.0),
    "outline_depth_step": 1.0,
}
#: Choices by which more settings are shown than else.
MORE = {
    "curve_sampling": "FIXED",
    "depth_cue_into": "COLOR",
    "depth_cue_range": "DISTANCES",
    "outline_around": "ATTRIBUTE",
}


class Layout:
    """Stands for Blender's UILayout, which needs a window: refuses what the data does not have."""

    def __init__(self):
        self.shown, self.text = [], []

    def prop(self, data, name, text=None, expand=False, invert_checkbox=False, toggle=-1, icon="NONE"):
        assert name in data.bl_rna.properties, f"{data} has no {name}"
        self.shown.append(name)

    def label(self, text, icon="NONE"):
        assert isinstance(text, str)
        self.text.append(text)

    def row(self, align=False, heading="", factor=0.0):
        return self

    column = split = row

    def separator(self):
        pass


def draw(panel, **context):
    """What a panel shows, its header included."""
    layout, context = Layout(), SimpleNamespace(**context)
    shown = SimpleNamespace(layout=layout)
    for name in ("option", "draw_settings"):
        if hasattr(panel, name):
            setattr(shown, name, getattr(panel, name).__get__(shown) if name == "draw_settings" else panel.option)
    for draws in (getattr(panel, "draw_header", None), panel.draw):
        if draws:
            draws(shown, context)
    return layout


def conic_panels():
    """The names of Conic's own panels that Blender knows."""
    return {name for name in dir(bpy.types) if name.startswith("CONIC_") and "_PT_" in name}


def test_settings_have_the_promised_names_and_defaults():
    settings = bpy.context.scene.conic
    for name, default in DEFAULTS.items():
        value = getattr(settings, name)
        assert (tuple(value) if isinstance(default, tuple) else value) == pytest.approx(default), name
    own = {p.identifier for p in settings.bl_rna.properties} - {"rna_type", "name"}
    assert own == set(DEFAULTS)


def test_objects_can_be_any_kind():
    items = bpy.types.Object.bl_rna.properties["conic"].fixed_type.properties["primitive"]
    assert items.enum_items.keys() == ["AUTO", "MESH", "SPHERE", "CYLINDER", "CONE", "DISC", "PLANE"]
    assert items.default == "AUTO"


@pytest.mark.parametrize("owner", ["scene", "object"])
def test_every_setting_is_described(owner):
    data = bpy.context.scene if owner == "scene" else bpy.data.objects.new("any", None)
    for setting in data.conic.bl_rna.properties:
        if setting.identifier not in {"rna_type", "name"}:
            assert setting.description and not setting.description.endswith("."), setting.identifier
            for item in getattr(setting, "enum_items", ()):
                assert item.description, (setting.identifier, item.identifier)


def changed_ids(change):
    """The types of the datablocks that Blender's depsgraph says are changed after `change()`."""
    bpy.context.view_layer.update()
    seen = set()

    def note(_scene, depsgraph):
        seen.update(type(update.id).__name__ for update in depsgraph.updates)

    bpy.app.handlers.depsgraph_update_post.append(note)
    try:
        change()
        bpy.context.view_layer.update()
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(note)
    return seen


@pytest.mark.parametrize(
    "name, value", [("samples", 2), ("weight_cutoff", 0.5), ("shadows", "OPAQUE"), ("recognise", "NEVER")]
)
def test_scene_setting_from_python_reaches_the_depsgraph(name, value):
    assert "Scene" in changed_ids(lambda: setattr(bpy.context.scene.conic, name, value))


def test_object_setting_from_python_reaches_the_depsgraph():
    bpy.ops.mesh.primitive_uv_sphere_add()
    assert "Object" in changed_ids(lambda: setattr(bpy.context.object.conic, "primitive", "MESH"))


@pytest.mark.parametrize("panel", RENDER_PANELS, ids=lambda panel: panel.__name__)
def test_render_panels_show_settings(panel):
    assert draw(panel, scene=bpy.context.scene).shown


def test_render_panels_show_every_setting():
    shown = set()
    for choices in ({}, MORE):
        for name, choice in choices.items():
            setattr(bpy.context.scene.conic, name, choice)
        shown |= {name for panel in RENDER_PANELS for name in draw(panel, scene=bpy.context.scene).shown}
    assert shown >= set(DEFAULTS) | {"film_transparent"}


@pytest.mark.parametrize(
    ("kind", "shape"),
    [
        ("POINT", {"shadow_soft_size", "use_soft_falloff"}),
        ("SUN", {"angle"}),
        ("SPOT", {"shadow_soft_size", "use_soft_falloff", "spot_size", "spot_blend"}),
        ("AREA", {"shape", "size", "spread"}),
    ],
)
def test_light_panel_shows_what_is_rendered(kind, shape):
    drawn = draw(light.CONIC_LIGHT_PT_light, light=bpy.data.lights.new("light", kind))
    assert {"type", "color", "energy", "use_shadow"} | shape <= set(drawn.shown) and not drawn.text


def test_nodes_of_a_light_are_shown(monkeypatch):
    lamp = bpy.data.lights.new("light", "POINT")
    if may_lack_nodes(lamp):
        lamp.use_nodes = True
    monkeypatch.setattr(Layout, "template_node_view", lambda self, *view: self.shown.append(view), raising=False)
    output = lamp.node_tree.get_output_node("CYCLES")
    assert (lamp.node_tree, output, output.inputs["Surface"]) in draw(light.CONIC_LIGHT_PT_nodes, light=lamp).shown
    lamp.node_tree.nodes.clear()
    assert draw(light.CONIC_LIGHT_PT_nodes, light=lamp).text == ["Without an output node it gives no light"]


def described():
    """What the panel of the active object shows."""
    return draw(
        object_shape.CONIC_OBJECT_PT_shape,
        object=bpy.context.object,
        region=SimpleNamespace(width=300),
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get,
    )


def test_object_panel_says_what_it_was_taken_as_and_forgets_when_that_changes():
    bpy.ops.mesh.primitive_uv_sphere_add()
    bpy.context.object.data.shade_smooth()
    first = described()
    assert first.shown == ["primitive"]
    assert "Sphere" in first.text[0] and len(first.text) > 1
    bpy.context.object.data.vertices[100].co *= 1.5
    bpy.context.object.data.update()
    bpy.context.view_layer.update()
    assert "Mesh" in described().text[0]


def edge():
    mesh = bpy.data.meshes.new("edge")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    return mesh


def objects_that_rays_meet():
    """An object of each kind, by name."""
    bpy.ops.mesh.primitive_cube_add()
    collection = bpy.data.collections.new("copied")
    collection.objects.link(bpy.context.object)
    empty = link(None, "instances", instance_type="COLLECTION", instance_collection=collection)
    return {
        "mesh": bpy.context.object,
        "points": link(bpy.data.pointclouds.new("points"), "points"),
        "hair": link(bpy.data.hair_curves.new("hair"), "hair"),
        "curve": link(bpy.data.curves.new("curve", "CURVE"), "curve"),
        "text": link(bpy.data.curves.new("text", "FONT"), "text"),
        "instances": empty,
        "edges": link(edge(), "edges"),
    }


@pytest.mark.parametrize(
    "name, settings",
    [
        ("mesh", ["primitive"]),
        ("points", []),
        ("hair", []),
        ("curve", ["primitive", "strand_radius"]),
        ("text", ["primitive"]),
        ("instances", []),
        ("edges", ["primitive", "strand_radius"]),
    ],
)
def test_object_panel_shows_the_settings_of_each_kind_of_object(name, settings):
    bpy.context.view_layer.objects.active = objects_that_rays_meet()[name]
    bpy.context.scene.render.engine = "CONIC"
    assert object_shape.CONIC_OBJECT_PT_shape.poll(bpy.context)
    drawn = described()
    assert drawn.shown == settings
    assert drawn.text[0].startswith("Rendered as: ") and len(drawn.text) > 1


@pytest.mark.parametrize("name", ["points", "hair", "curve", "text", "instances", "edges"])
def test_object_panel_of_a_hidden_object(name):
    """Blender has not evaluated it, and asking for what it makes raises."""
    obj = bpy.context.view_layer.objects.active = objects_that_rays_meet()[name]
    obj.hide_viewport = True
    bpy.context.view_layer.update()
    assert described().text[0] == "Rendered as: Not known"
    obj.hide_viewport = False
    bpy.context.view_layer.update()
    assert described().text[0] != "Rendered as: Not known"


def test_nothing_that_rays_cannot_meet_has_a_panel_of_its_shape():
    bpy.context.scene.render.engine = "CONIC"
    for data in (None, bpy.data.lights.new("light", "POINT"), bpy.data.cameras.new("camera")):
        bpy.context.view_layer.objects.active = link(data)
        assert not object_shape.CONIC_OBJECT_PT_shape.poll(bpy.context)
        is_light = data is not None and data.id_type == "LIGHT"
        assert object_visibility.CONIC_OBJECT_PT_ray_visibility.poll(bpy.context) == is_light


RAYS = {"visible_camera", "visible_diffuse", "visible_glossy", "visible_transmission", "visible_shadow"}


@pytest.mark.parametrize("name", ["mesh", "points", "hair", "instances"])
def test_what_sees_an_object_can_be_set_with_blenders_panel_and_ours(name):
    obj = bpy.context.view_layer.objects.active = objects_that_rays_meet()[name]
    bpy.context.scene.render.engine = "CONIC"
    blenders, own = bpy.types.OBJECT_PT_visibility, object_visibility.CONIC_OBJECT_PT_ray_visibility
    assert blenders.poll(bpy.context) and own.poll(bpy.context) and own.bl_parent_id == blenders.__name__
    assert set(draw(own, object=obj).shown) == RAYS | {"is_shadow_catcher"}
    assert {"hide_render", "is_holdout"} <= set(draw(blenders, object=obj, engine="CONIC").shown)


def test_which_rays_a_light_reaches_can_be_set():
    obj = bpy.context.view_layer.objects.active = link(bpy.data.lights.new("light", "POINT"))
    bpy.context.scene.render.engine = "CONIC"
    panel = object_visibility.CONIC_OBJECT_PT_ray_visibility
    assert panel.poll(bpy.context) and set(draw(panel, object=obj).shown) == RAYS - {"visible_shadow"}


@pytest.mark.skipif(not hasattr(bpy.types, "OBJECT_PT_light_linking"), reason="Blender has these panels from 4.3 on")
def test_what_a_light_is_linked_to_can_be_set():
    assert "OBJECT_PT_shading" in shown_panels()
    assert {bpy.types.OBJECT_PT_light_linking.bl_parent_id, bpy.types.OBJECT_PT_shadow_linking.bl_parent_id} == {
        "OBJECT_PT_shading"
    }


def test_material_panel_shows_backface_culling_and_the_index():
    shown = draw(material.CONIC_MATERIAL_PT_settings, material=bpy.data.materials.new("any")).shown
    assert shown == ["use_backface_culling", "use_backface_culling_shadow", "pass_index"]


def test_statistics_panel_shows_the_newest_figures(monkeypatch):
    panel = statistics_panel.CONIC_RENDER_PT_statistics
    monkeypatch.setattr(statistics, "_latest", None)
    assert draw(panel).text == ["Nothing rendered yet"]
    statistics.publish(statistics.Statistics("Viewport", primitives={"sphere": 1234567}, seconds={"read": 1.23}))
    text = [label.strip() for label in draw(panel).text]
    assert text[0] == "Viewport"
    assert text[text.index("Spheres") + 1] == "1,234,567" and text[text.index("Read") + 1] == "1.2 s"


@pytest.mark.parametrize("engine, shown", [("CONIC", True), ("BLENDER_WORKBENCH", False)])
def test_own_panels_are_there_for_conic_only(engine, shown):
    bpy.context.scene.render.engine = engine
    for panel in RENDER_PANELS:
        assert panel.poll(bpy.context) == shown


def shown_panels():
    """The names of Blender's own panels that are shown for Conic."""
    return {panel.__name__ for panel in standard_panels.standard_panels() if "CONIC" in panel.COMPAT_ENGINES}


def test_standard_panels_are_shown():
    shown = shown_panels()
    assert standard_panels.BORROWED <= shown
    assert {
        "RENDER_PT_output",
        "RENDER_PT_format",
        "RENDER_PT_color_management",
        "DATA_PT_lens",
        "DATA_PT_camera",
        "DATA_PT_context_light",
        "WORLD_PT_context_world",
        "MATERIAL_PT_custom_props",
        "DATA_PT_context_pointcloud",
        "DATA_PT_pointcloud_attributes",
        "DATA_PT_context_curves",
        "DATA_PT_CURVES_attributes",
        "PARTICLE_PT_render",
    } <= shown
    assert not shown & standard_panels.REFUSED
    assert not [name for name in shown if "freestyle" in name.lower()]


def test_nothing_stays_behind_and_it_can_come_back(registered):
    before = conic_panels()
    for _ in range(2):
        registered.unregister()
        try:
            assert not hasattr(bpy.types.Scene, "conic") and not hasattr(bpy.types.Object, "conic")
            assert not conic_panels() and not hasattr(bpy.types, "CONIC_MT_add")
            assert not shown_panels()
            assert object_shape._forget not in bpy.app.handlers.depsgraph_update_post
        finally:
            registered.register()
    assert conic_panels() == before and len(before) >= 6
    assert bpy.context.scene.conic.samples == 16


def test_film_presets_are_found_and_set_only_what_a_preset_keeps():
    """What a preset sets are settings that there are, and that one made by a user holds too."""
    (folder,) = bpy.utils.preset_paths(film_presets.CONIC_PT_film_presets.preset_subdir)
    kept = {value.partition(".")[2] for value in film_presets.CONIC_OT_film_preset_add.preset_values}
    files = sorted(Path(folder).glob("*.py"))
    assert [file.stem for file in files] == ["CAD", "goodsell", "molecule", "photo"]
    for file in files:
        names = set(re.findall(r"^(?:conic|render)\.(\w+) =", file.read_text(), re.MULTILINE))
        assert names and names <= kept, file
        bpy.ops.script.execute_preset(filepath=str(file), menu_idname="CONIC_PT_film_presets")
        assert bpy.context.scene.conic.use_outlines == (file.stem != "photo")


def test_a_preset_of_the_film_is_kept_and_comes_back(tmp_path, monkeypatch):
    conic = bpy.context.scene.conic
    conic.use_outlines, conic.outline_width = True, 3.0
    monkeypatch.setattr(bpy.utils, "user_resource", lambda kind, path="", create=False: str(tmp_path))
    assert bpy.ops.render.conic_film_preset_add(name="Mine") == {"FINISHED"}
    conic.use_outlines, conic.outline_width = False, 1.0
    bpy.ops.script.execute_preset(filepath=str(tmp_path / "Mine.py"), menu_idname="CONIC_PT_film_presets")
    assert conic.use_outlines and conic.outline_width == 3.0
