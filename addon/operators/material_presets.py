# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials from a menu: molecule, glass, metals and more, as Principled BSDFs that any engine renders."""

from dataclasses import dataclass, field

import bpy

from .nff_materials import new_node, new_tree


@dataclass(frozen=True)
class Preset:
    """`inputs` of the Principled BSDF by name; `color` (r, g, b), scene-linear, is its base colour and the one in the
    viewport. Metals: reflectance at normal incidence."""

    name: str
    description: str
    color: tuple
    inputs: dict = field(default_factory=dict)


def _metal(name, color, roughness):
    description = f"{name} without rust or paint"
    return Preset(name, description, color, {"Metallic": 1.0, "Roughness": roughness})


PRESETS = {
    "MOLECULE": Preset(
        "Molecule",
        "Matte, for atoms; the film's outlines are turned on",
        (0.55, 0.57, 0.6),
        {"Roughness": 1.0, "Specular IOR Level": 0.0},
    ),
    "GLASS": Preset(
        "Glass", "Clear glass", (1.0, 1.0, 1.0), {"Roughness": 0.0, "IOR": 1.5, "Transmission Weight": 1.0}
    ),
    "WATER": Preset(
        "Water", "Clear water", (1.0, 1.0, 1.0), {"Roughness": 0.0, "IOR": 1.333, "Transmission Weight": 1.0}
    ),
    "GOLD": _metal("Gold", (1.0, 0.782, 0.344), 0.15),
    "SILVER": _metal("Silver", (0.972, 0.96, 0.915), 0.1),
    "COPPER": _metal("Copper", (0.955, 0.638, 0.538), 0.15),
    "ALUMINUM": _metal("Aluminum", (0.913, 0.922, 0.924), 0.25),
    "IRON": _metal("Iron", (0.562, 0.565, 0.578), 0.3),
    "CHROME": _metal("Chrome", (0.55, 0.556, 0.554), 0.03),
    "PLASTIC": Preset("Plastic", "Glossy plastic", (0.6, 0.04, 0.02), {"Roughness": 0.15, "IOR": 1.46}),
    "RUBBER": Preset("Rubber", "Dull black rubber", (0.025, 0.025, 0.027), {"Roughness": 0.7, "IOR": 1.52}),
    "EMITTER": Preset(
        "Emitter",
        "Gives off light",
        (0.0, 0.0, 0.0),
        {"Emission Color": (1.0, 0.85, 0.6, 1.0), "Emission Strength": 5.0, "Specular IOR Level": 0.0},
    ),
}


def apply(preset, material):
    """Give a material the nodes of a `Preset`, in place of its own."""
    tree, output = new_tree(material)
    bsdf = new_node(tree, "BsdfPrincipled", 1, **{"Base Color": (*preset.color, 1.0)}, **preset.inputs)
    tree.links.new(bsdf.outputs["BSDF"], output.inputs["Surface"])
    shown = preset.inputs.get("Emission Color", preset.color)
    material.diffuse_color = (*shown[:3], 1.0)
    material.metallic = preset.inputs.get("Metallic", 0.0)
    material.roughness = preset.inputs.get("Roughness", 0.5)


class CONIC_OT_material_preset(bpy.types.Operator):
    """Make the active material one of these, in place of its nodes; a new one in an empty slot"""

    bl_idname = "material.conic_preset"
    bl_label = "Material Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: bpy.props.EnumProperty(
        name="Preset",
        description="What the material becomes",
        items=[(key, preset.name, preset.description) for key, preset in PRESETS.items()],
    )

    @classmethod
    def description(cls, context, properties):
        return f"{PRESETS[properties.preset].description}. In place of the active material's nodes"

    @classmethod
    def poll(cls, context):
        material = _active_material(context)
        if material is None and not hasattr(getattr(context.object, "data", None), "materials"):
            cls.poll_message_set("There is no object that can have a material")
            return False
        if material is not None and not material.is_editable:
            cls.poll_message_set("The material belongs to another file")
            return False
        return True

    def execute(self, context):
        preset, material = PRESETS[self.preset], _active_material(context)
        if material is None:
            material = bpy.data.materials.new(preset.name)
            context.object.active_material = material
        apply(preset, material)
        if self.preset == "MOLECULE":
            context.scene.conic.use_outlines = True
        return {"FINISHED"}


def _active_material(context):
    """The material of the tab, which may be pinned, else of the active object."""
    return getattr(context, "material", None) or getattr(context.object, "active_material", None)


class CONIC_MT_material_presets(bpy.types.Menu):
    bl_label = "Presets"

    def draw(self, context):
        for key, preset in PRESETS.items():
            self.layout.operator(CONIC_OT_material_preset.bl_idname, text=preset.name).preset = key


register, unregister = bpy.utils.register_classes_factory((CONIC_OT_material_preset, CONIC_MT_material_presets))
