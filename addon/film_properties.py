# SPDX-License-Identifier: GPL-3.0-or-later
"""What the film shows beyond light, of `scene.conic`: flat colors, depth cue and outlines."""

import math

from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, StringProperty

from .property_update import tag_update

DEPTH_CUE_INTO = (
    ("BACKGROUND", "Background", "The world behind everything, or nothing where the film is transparent"),
    ("COLOR", "Color", "A color of its own"),
)

DEPTH_CUE_RANGE = (
    ("SCENE", "Scene", "From the nearest to the farthest that the scene holds"),
    ("DISTANCES", "Distances", "Between two distances along the view"),
)

OUTLINE_AROUND = (
    ("SHAPES", "Shapes", "Each exact shape, as an atom, and each mesh"),
    ("OBJECTS", "Objects", "Each object or instance, whatever shapes it is made of"),
    ("ATTRIBUTE", "Attribute", "What has one value of an attribute, as a chain of a molecule"),
)


class FilmProperties:
    """Mix-in of the settings of a scene."""

    use_flat_colors: BoolProperty(
        name="Flat Colors",
        description="Surfaces have their own color wherever light comes from: no shading, no shadows",
        default=False,
        update=tag_update,
    )
    use_depth_cue: BoolProperty(
        name="Depth Cue",
        description="What is far fades away, as in fog",
        default=False,
        update=tag_update,
    )
    depth_cue_into: EnumProperty(
        name="Fade Into",
        description="What is seen in place of what is far",
        items=DEPTH_CUE_INTO,
        default="BACKGROUND",
        update=tag_update,
    )
    depth_cue_color: FloatVectorProperty(
        name="Color",
        description="What is far fades into this color",
        size=3,
        default=(1.0, 1.0, 1.0),
        min=0.0,
        soft_max=1.0,
        subtype="COLOR",
        update=tag_update,
    )
    depth_cue_strength: FloatProperty(
        name="Strength",
        description="How much of the farthest is gone",
        default=0.8,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=tag_update,
    )
    depth_cue_range: EnumProperty(
        name="Range",
        description="Between which distances from the camera the depth cue grows",
        items=DEPTH_CUE_RANGE,
        default="SCENE",
        update=tag_update,
    )
    depth_cue_start: FloatProperty(
        name="Start",
        description="Distance along the view where the depth cue begins",
        default=5.0,
        min=0.0,
        soft_max=1000.0,
        subtype="DISTANCE",
        update=tag_update,
    )
    depth_cue_end: FloatProperty(
        name="End",
        description="Distance along the view from which on the depth cue has its full strength",
        default=25.0,
        min=0.0,
        soft_max=1000.0,
        subtype="DISTANCE",
        update=tag_update,
    )
    use_outlines: BoolProperty(
        name="Outlines",
        description="Draw lines around what is seen, and where its surface has creases and steps",
        default=False,
        update=tag_update,
    )
    outline_around: EnumProperty(
        name="Around",
        description="What has an outline of its own",
        items=OUTLINE_AROUND,
        default="SHAPES",
        update=tag_update,
    )
    outline_attribute: StringProperty(
        name="Attribute",
        description="Name of the attribute: each of its values has an outline, as each chain by chain_id",
        default="chain_id",
        update=tag_update,
    )
    outline_color: FloatVectorProperty(
        name="Color",
        description="Color of the lines; alpha lets what is below show through",
        size=4,
        default=(0.0, 0.0, 0.0, 1.0),
        min=0.0,
        max=1.0,
        subtype="COLOR",
        update=tag_update,
    )
    outline_width: FloatProperty(
        name="Width",
        description="Width of the outlines in pixels",
        default=1.5,
        min=0.0,
        soft_max=8.0,
        max=64.0,
        step=10,
        precision=1,
        subtype="PIXEL",
        update=tag_update,
    )
    outline_inner_width: FloatProperty(
        name="Inner Width",
        description="Width of the lines within an outline, at creases and steps, in pixels",
        default=1.0,
        min=0.0,
        soft_max=8.0,
        max=64.0,
        step=10,
        precision=1,
        subtype="PIXEL",
        update=tag_update,
    )
    outline_crease_angle: FloatProperty(
        name="Crease Angle",
        description="Surfaces that meet at a larger angle have a line between them",
        default=math.radians(40.0),
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
        update=tag_update,
    )
    outline_depth_step: FloatProperty(
        name="Depth Step",
        description="How far a surface must lie behind another for a line between them, compared with what the "
        "height of the picture shows there",
        default=1.0,
        min=0.0,
        soft_max=20.0,
        max=100.0,
        precision=1,
        subtype="PERCENTAGE",
        update=tag_update,
    )
