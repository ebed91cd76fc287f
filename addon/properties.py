# SPDX-License-Identifier: GPL-3.0-or-later
"""Conic's settings: `scene.conic` and `object.conic`. Their names are kept in people's files and scripts.

Each property has an update callback: without one, a value set from Python would reach neither the depsgraph
nor the viewport.
"""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty

from .film_properties import FilmProperties
from .property_update import tag_update

SHADOWS = (
    ("OPAQUE", "Opaque", "Whatever lies between a surface and a light blocks it", 0),
    (
        "TRANSPARENT",
        "Transparent",
        "Light passes through what is transparent, as much as its alpha says. Glass blocks it, as in Cycles",
        2,
    ),
    ("TINTED", "Tinted", "Light passes straight through glass too and takes on its color", 1),
)

WORLD_LIGHTS = (
    (
        "SAMPLED",
        "Sampled",
        "Each sample sends a ray towards the world, mostly to where it is bright. A picture of one sample has the "
        "light of Hemisphere",
    ),
    ("HEMISPHERE", "Hemisphere", "A smooth light from all sides without noise or shadows"),
    ("NONE", "None", "The world is seen but lights nothing"),
)

RECOGNISE = (
    ("ALWAYS", "Always", "Every mesh of exactly the form of Blender's spheres, cylinders, cones or circles"),
    ("SMOOTH", "Smooth Shaded", "Only those shaded smooth; flat shaded ones keep their facets"),
    ("NEVER", "Never", "Only objects whose own setting names a shape"),
)

PRIMITIVES = (
    ("AUTO", "Automatic", "An exact shape where the mesh is recognized as one, else the mesh"),
    ("MESH", "Mesh", "The triangles of the mesh, whatever its form"),
    ("SPHERE", "Sphere", "An exact sphere; an ellipsoid where the object is stretched"),
    ("CYLINDER", "Cylinder", "An exact cylinder along the object's Z axis"),
    ("CONE", "Cone", "An exact cone, pointed or truncated, along the object's Z axis"),
    ("DISC", "Disc", "An exact flat disc"),
    ("PLANE", "Plane", "A plane without end, where the object's X and Y axes lie"),
)

CURVE_SAMPLING = (
    ("PIXELS", "By Pixels", "As many steps as keep curves within a part of a pixel of their true form"),
    ("FIXED", "Fixed", "The same number of steps between any two control points"),
)


ENTRIES = (
    ("AUTO", "Automatic", "The faster kind on this GPU, by a short measurement"),
    ("FRAGMENT", "Fragment", "Pixels are drawn. Works on every GPU"),
    ("COMPUTE", "Compute", "Pixels are computed, which some GPUs do faster. Fragment where the GPU cannot do it"),
)


class ConicSceneSettings(FilmProperties, bpy.types.PropertyGroup):
    """`scene.conic`"""

    samples: IntProperty(
        name="Render",
        description="Rays through each pixel in the final render. One goes through its center and takes the middle "
        "of each light, which gives sharp shadows without noise; more make the shadows of large lights soft and "
        "blur what rough surfaces reflect and refract",
        default=16,
        min=1,
        soft_max=256,
        max=65536,
        update=tag_update,
    )
    preview_samples: IntProperty(
        name="Viewport",
        description="Rays through each pixel in the viewport and in previews",
        default=4,
        min=1,
        soft_max=64,
        max=65536,
        update=tag_update,
    )
    seed: IntProperty(
        name="Seed",
        description="Which noise pictures of more than one sample have",
        default=0,
        min=0,
        update=tag_update,
    )
    use_animated_seed: BoolProperty(
        name="Animate Seed",
        description="Other noise in each frame",
        default=False,
        update=tag_update,
    )
    preview_frame_seconds: FloatProperty(
        name="Frame",
        description="How long a redraw of the viewport may take while something happens. While the view turns, the "
        "picture has as many pixels as are drawn in this time. Less is smoother, more is sharper. At rest, tracing may "
        "keep what you do waiting for up to a tenth of a second",
        default=1.0 / 30.0,
        min=0.001,
        soft_min=1.0 / 120.0,
        soft_max=0.25,
        max=10.0,
        precision=3,
        step=0.5,
        subtype="TIME_ABSOLUTE",
        unit="TIME_ABSOLUTE",
        update=tag_update,
    )
    preview_pause: BoolProperty(
        name="Pause Viewport",
        description="Keep the pictures of rendered viewports as they are. Where the view turns, a coarse picture shows",
        default=False,
        update=tag_update,
    )
    max_depth: IntProperty(
        name="Max Depth",
        description="Longest chain of rays that is followed. 1 is what the camera sees directly",
        default=8,
        min=1,
        soft_max=32,
        max=64,
        update=tag_update,
    )
    weight_cutoff: FloatProperty(
        name="Cut-Off",
        description="Rays that contribute less than this share to a pixel are not followed. 0 follows all",
        default=1.0 / 512.0,
        min=0.0,
        max=0.999,
        soft_max=0.1,
        precision=4,
        step=0.1,
        update=tag_update,
    )
    shadows: EnumProperty(
        name="Shadows",
        description="What the shadows of transparent surfaces and of glass look like",
        items=SHADOWS,
        default="TRANSPARENT",
        update=tag_update,
    )
    world_light: EnumProperty(
        name="World",
        description="How the world lights surfaces that are not mirrors",
        items=WORLD_LIGHTS,
        default="SAMPLED",
        update=tag_update,
    )
    use_ao: BoolProperty(
        name="Ambient Occlusion",
        description="Darken corners and hollows: what is near hides a part of the Hemisphere light",
        default=False,
        update=tag_update,
    )
    ao_distance: FloatProperty(
        name="Distance",
        description="What is farther away hides nothing. 0 sets no limit",
        default=1.0,
        min=0.0,
        soft_max=100.0,
        subtype="DISTANCE",
        update=tag_update,
    )
    ao_factor: FloatProperty(
        name="Factor",
        description="How much of the Hemisphere light can be hidden",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=tag_update,
    )
    entry: EnumProperty(
        name="Shader",
        description="Kind of shader that traces the rays. The picture is the same",
        items=ENTRIES,
        default="AUTO",
        update=tag_update,
    )
    recognise: EnumProperty(
        name="Recognize",
        description="Which meshes are rendered as the exact shape that they stand for",
        items=RECOGNISE,
        default="ALWAYS",
        update=tag_update,
    )
    curve_sampling: EnumProperty(
        name="Curves",
        description="How curves and hair are cut into straight pieces",
        items=CURVE_SAMPLING,
        default="PIXELS",
        update=tag_update,
    )
    curve_tolerance: FloatProperty(
        name="Tolerance",
        description="How far a straight piece may be off its curve, in pixels",
        default=0.25,
        min=0.001,
        soft_min=0.05,
        soft_max=4.0,
        max=100.0,
        subtype="PIXEL",
        update=tag_update,
    )
    curve_steps: IntProperty(
        name="Steps",
        description="Straight pieces between two control points. 0 takes each curve's own resolution",
        default=8,
        min=0,
        soft_max=64,
        max=1024,
        update=tag_update,
    )


class ConicObjectSettings(bpy.types.PropertyGroup):
    """`object.conic`"""

    primitive: EnumProperty(
        name="Render As",
        description="The exact shape that this object is rendered as",
        items=PRIMITIVES,
        default="AUTO",
        update=tag_update,
    )
    strand_radius: FloatProperty(
        name="Strand Radius",
        description=(
            "Radius of curves without bevel and of edges without faces; 0 does not render them. "
            "A curve's own point radii multiply it"
        ),
        default=0.0,
        min=0.0,
        soft_max=1.0,
        subtype="DISTANCE",
        precision=4,
        step=0.1,
        update=tag_update,
    )


_SETTINGS = ((bpy.types.Scene, ConicSceneSettings), (bpy.types.Object, ConicObjectSettings))


def register():
    for owner, settings in _SETTINGS:
        bpy.utils.register_class(settings)
        owner.conic = PointerProperty(type=settings, name="Conic")


def unregister():
    for owner, settings in reversed(_SETTINGS):
        del owner.conic
        bpy.utils.unregister_class(settings)
