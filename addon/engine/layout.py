"""The one table of GPU records: numpy dtype, GLSL struct and GLSL reader (`record_glsl`) are all made from it.

A record is a sequence of fields that fill whole RGBA32F texels; no field straddles two texels. Records lie one after
the other in a data texture of fixed width, several small record types may share one texture, each from a first texel
of its own. The same description gives the uniform block `Frame`, whose std140 layout is the same sequence of
four-float groups.

Integers are stored as float values, which survives every driver (bit patterns may not). They are not negative and
less than 2^23, so that the shader finds their bits by an addition: `WHOLE` of `record_glsl`. An index that may grow
past that is stored in two fields, see `reference.split_index`.
"""

from .record import Field, Record


def _record(name, texture, *fields, points_into=""):
    return Record(name, texture, tuple(Field(*field) for field in fields), points_into)


NODE = _record(
    "node",
    "nodes",
    ("lower_0", "vec3", "lower corner of the first child's box"),
    ("first_0", "int", "index of the first child: low part"),
    ("upper_0", "vec3", "upper corner of the first child's box"),
    ("leaf_0", "int", "kind, number of primitives (0: inner node) and high part of the index"),
    ("lower_1", "vec3", "the same of the second child"),
    ("first_1", "int", ""),
    ("upper_1", "vec3", ""),
    ("leaf_1", "int", ""),
)
# In place of a tree: a record as large as a node, from its number on the cells, then the items, then what these
# are, see `grid`.
GRID = _record(
    "grid",
    "nodes",
    ("lower", "vec3", "lower corner of the first cell"),
    ("row", "int", "from a cell to the next one along y"),
    ("per_size", "vec3", "1 over the size of a cell"),
    ("layer", "int", "from a cell to the next one along z"),
    ("resolution", "vec3", "cells along each axis, without those around them"),
    ("first_item", "int", "items that would have room in place of the cells"),
    ("first_reference", "int", "references that would have room in place of the cells and items"),
    ("unused", "vec3", ""),
)
GRID_CELL = _record(
    "grid_cell",
    "nodes",
    ("first", "int", "first item in it; where a ray's way ends 1"),
    ("end", "int", "the item after the last; where a ray's way ends 0"),
    ("unused", "vec2", ""),
)
GRID_ITEM = _record(
    "grid_item",
    "nodes",
    ("base", "vec3", "of a cylinder its base, of a sphere its centre"),
    ("radius", "float", "negative: only the inside is seen"),
    ("axis", "vec3", "of a cylinder, unit; 0 for a sphere"),
    ("height", "float", "of a cylinder; 0 for a sphere"),
)
GRID_REFERENCE = _record(
    "grid_reference",
    "nodes",
    ("reference", "int", "index of an item's record as a primitive, twice; 1 more for a cylinder"),
    ("unused", "vec3", ""),
)
INSTANCE = _record(
    "instance",
    "instances",
    ("to_object_x", "vec4", "first row of the 3x4 matrix from world to object space"),
    ("to_object_y", "vec4", "second row"),
    ("to_object_z", "vec4", "third row"),
    ("root", "int", "index of the geometry's root node or grid: low part"),
    ("root_high", "int", "what it is and the high part, as `leaf_0` of a node"),
    ("first_material", "int", "index of the material record of the geometry's material slot 0"),
    ("geometry", "int", "number of the geometry, for its attributes"),
    ("visibility", "int", "which rays see it and how, bits of `scene.Visibility`"),
    ("unused", "vec3", ""),
)
INSTANCE_SURFACE = _record(
    "instance_surface",
    "instances",
    ("to_world_x", "vec4", "first row of the 3x4 matrix from object to world space"),
    ("to_world_y", "vec4", "second row"),
    ("to_world_z", "vec4", "third row"),
)
# Each primitive has two records: what its intersection needs, and what only the nearest hit needs.
SPHERE = _record(
    "sphere",
    "spheres",
    ("center", "vec3", "centre"),
    ("radius", "float", "radius; negative: only the inside is seen"),
)
SPHERE_SURFACE = _record(
    "sphere_surface",
    "sphere_surfaces",
    ("rotation", "vec3", "frame of pole and zero meridian, modified Rodrigues parameters; or (u, v, FIXED_UV): one uv"),
    ("material", "int", "material slot"),
)
CYLINDER = _record(
    "cylinder",
    "cylinders",
    ("base", "vec3", "centre of the base"),
    ("radius", "float", "radius; negative: only the inside is seen"),
    ("axis", "vec3", "from the base centre to the top centre"),
    ("unused", "float", ""),
)
CYLINDER_SURFACE = _record(
    "cylinder_surface",
    "cylinder_surfaces",
    ("meridian", "vec3", "unit vector of u = 0, perpendicular to the axis"),
    ("material", "int", "material slot"),
    ("uv_transform", "vec4", "scale and offset applied to the paper's uv"),
)
CONE = _record(
    "cone",
    "cones",
    ("base", "vec3", "centre of the base"),
    ("base_radius", "float", "radius at the base; negative (with the other): only the inside is seen"),
    ("axis", "vec3", "from the base centre to the apex centre"),
    ("apex_radius", "float", "radius at the apex"),
)
CONE_SURFACE = _record(
    "cone_surface",
    "cone_surfaces",
    ("meridian", "vec3", "unit vector of u = 0, perpendicular to the axis"),
    ("material", "int", "material slot"),
    ("uv_transform", "vec4", "scale and offset applied to the uv"),
    ("planar", "float", "1: uv is the projection along the axis, as on a disc; 0: the paper's"),
    ("unused", "vec3", ""),
)
DISC = _record(
    "disc",
    "discs",
    ("center", "vec3", "centre"),
    ("radius", "float", "radius"),
    ("normal", "vec3", "unit normal"),
    ("unused", "float", ""),
)
DISC_SURFACE = _record(
    "disc_surface",
    "disc_surfaces",
    ("meridian", "vec3", "unit vector of growing u, perpendicular to the normal"),
    ("material", "int", "material slot"),
    ("uv_transform", "vec4", "scale and offset applied to the paper's uv"),
)
TRIANGLE = _record(
    "triangle",
    "triangles",
    ("p0", "vec3", "first vertex"),
    ("one_sided", "float", "1: seen only from where the vertices run counter-clockwise"),
    ("p1", "vec3", "second vertex"),
    ("unused_1", "float", ""),
    ("p2", "vec3", "third vertex"),
    ("unused_2", "float", ""),
)
TRIANGLE_SURFACE = _record(
    "triangle_surface",
    "triangle_surfaces",
    ("n0", "vec3", "normal at the first vertex; all three zero: flat"),
    ("material", "int", "material slot"),
    ("n1", "vec3", "normal at the second vertex"),
    ("u0", "float", "uv of the three vertices"),
    ("n2", "vec3", "normal at the third vertex"),
    ("v0", "float", ""),
    ("uv1", "vec2", ""),
    ("uv2", "vec2", ""),
)
PLANE = _record(
    "plane",
    "tables",
    ("normal", "vec3", "unit normal"),
    ("offset", "float", "W of the plane's equation normal . p + W = 0"),
    ("visibility", "int", "which rays see it and how, bits of `scene.Visibility`"),
    ("unused", "vec3", ""),
)
PLANE_SURFACE = _record(
    "plane_surface",
    "tables",
    ("meridian", "vec3", "unit vector of growing u, perpendicular to the normal"),
    ("material", "int", "material"),
    ("origin", "vec3", "where u = v = 0"),
    ("unused", "float", ""),
)
# In an order that lets a program which needs little of it fetch few texels.
MATERIAL = _record(
    "material",
    "tables",
    ("diffuse", "vec3", "d: share of a light's irradiance / pi that is returned"),
    ("fresnel", "float", "1: the mirror's share `reflect` follows Fresnel; 0: it is constant"),
    ("reflect", "vec3", "r: weight of the mirror ray"),
    ("roughness", "float", "of the mirror; its microfacets' alpha is the square"),
    ("transmit", "vec3", "t: weight of the refracted ray"),
    ("transmit_roughness", "float", ""),
    ("glow", "vec3", "g: radiance given off"),
    ("program", "int", "number of the program that its values come from, 0: none"),
    ("absorption", "vec3", "Beer-Lambert coefficient inside the body, 1 / length"),
    ("ior", "float", "n0: index of refraction of the inside"),
    ("highlight", "vec3", "weight of the lights' Phong highlight"),
    ("shine", "float", "Phong exponent of the highlight"),
    ("diffuse_covered", "float", "share of what is diffuse that lies under the mirror and loses what that takes"),
    ("transmit_covered", "float", "the same of what goes through"),
    ("fresnel_ior", "float", "index of the mirror's surface where it is not `ior`; 0: it is"),
    ("bounds_body", "float", "1: where it transmits it is the border of a medium; 0: a single sheet"),
    ("cull_back", "float", "1: rays that meet the back pass through, but shadow rays"),
    ("cull_back_shadow", "float", "1: shadow rays that meet the back pass through"),
    ("constants", "int", "first texel of the program's constants, from that of all constants"),
    ("holdout", "float", "share that is cut out of the picture"),
    ("metallic", "vec3", "weight of the mirror ray of a metal at normal incidence"),
    ("multiscatter", "float", "1: light that rough facets reflect to each other is given back"),
    ("grazing", "vec3", "what the metal's share grows to at grazing incidence where that is more"),
    ("diffuse_roughness", "float", "of Oren and Nayar"),
    ("edge", "vec3", "F82 tint: what is left of the metal's share near 82 degrees"),
    ("coat_roughness", "float", ""),
    ("coat", "vec3", "weight of a second mirror, a dielectric's, on top of all"),
    ("coat_ior", "float", ""),
    ("coat_tint", "vec3", "what the coat leaves of light that goes straight in and out again"),
    ("glow_area", "float", "as LIGHT_SHAPE's seen_area, of surfaces that glow; 1e30: rays alone find them"),
    ("translucent", "vec3", "share of the light from the other side that is returned"),
    ("body", "float", "weight of the glass whose `transmit` and part of `reflect` these are"),
    ("normal", "vec3", "shading normal in place of the surface's own, on the side of the ray; 0: none"),
    ("unused_3", "float", ""),
    ("straight", "vec3", "part of `transmit` that lets shadow rays through where bodies that bend light block them"),
    ("unused_4", "float", ""),
)
# Texels of the parameters of materials' programs, as `node_programs` packs them.
CONSTANT = _record("constant", "tables", ("value", "vec4", "up to four numbers"))
# Of the light on rough glass, in the order of `glass_energy`.
GLASS_ENERGY = _record(
    "glass_energy",
    "tables",
    ("kept", "vec4", "share that leaves again: of two cosines for an index of refraction, of both for the next index"),
)
LIGHT = _record(
    "light",
    "tables",
    ("position", "vec3", "position; for a sun the unit direction towards it"),
    ("kind", "int", "LIGHT_POINT, LIGHT_CONSTANT, ..., see `scene.LightKind`"),
    ("color", "vec3", "radiance of a white diffuse surface facing it, at distance 1 where it falls off"),
    ("visibility", "int", "bits of `scene.Visibility`: the paths that it lights; SHADOW: what is before it shades"),
    ("receivers", "int", "bits of `scene.Visibility` that what it lights must have; 0: it lights everything"),
    ("blockers", "int", "bits that what casts its shadows must have"),
    ("emitter", "int", "0: a lamp; 1: a surface of the scene that glows, EMITTER_VARIES: not everywhere the same"),
    ("sides", "float", "of what is flat: 1 it shines to the front, -1 to the back, 0 to both"),
)
# A record for each light where one of them has extent or a cone, else none.
LIGHT_SHAPE = _record(
    "light_shape",
    "tables",
    ("axis_x", "vec3", "area: half side or semi-axis; spot: first row of the matrix to where its cone is round"),
    ("radius", "float", "of a ball; of a sun half the angle under which it is seen, in radians"),
    ("axis_y", "vec3", "area: the other half side; spot: second row"),
    ("soft", "float", "1: not a ball but its middle disc, which faces what it lights"),
    ("axis_z", "vec3", "area: unit vector towards where it shines; spot: third row"),
    ("falls_off", "float", "1: with the square of the distance"),
    ("edge", "float", "spot: cosine of half the cone's angle"),
    ("slope", "float", "spot: 1 over the range of the cosine in which the cone's edge grows bright"),
    ("spread", "float", "area: cotangent of half the spread, 0: all around"),
    ("taper", "float", "tube: radius at the end of axis_z over that at its beginning"),
    ("seen_area", "float", "mean area it shows over how often it is asked, of suns solid angle; 0: rays miss it"),
    ("unused", "vec3", ""),
)
# The tree over all lights where they are many, in depth-first order: the first child of node i is i + 1.
LIGHT_NODE = _record(
    "light_node",
    "tables",
    ("center", "vec3", "mean of the lights' places by what they give; of suns far off"),
    ("radius", "float", "of the sphere about it that holds them all"),
    ("axis", "vec3", "unit, middle of the cone of directions in which they shine"),
    ("cos_axis", "float", "cosine of half that cone's angle; -2: they shine to all sides"),
    ("color", "vec3", "sum of what they give, as in LIGHT"),
    ("cos_reach", "float", "cosine of the largest angle under which one is seen off its direction"),
    ("light", "int", "the light of a leaf; else the brightest of those below"),
    ("next", "int", "the next node that is not below this one; i + 1 for leaf i"),
    ("falls_off", "float", "1: with the square of the distance"),
    ("brightness", "float", "mean of the color's channels"),
)
IMAGE = _record(
    "image",
    "tables",
    ("first", "int", "first texel in the image texture: low part"),
    ("first_high", "int", "high part"),
    ("width", "int", "width in pixels"),
    ("height", "int", "height in pixels"),
    ("interpolation", "int", "index into `image.INTERPOLATIONS`"),
    ("extension", "int", "index into `image.EXTENSIONS`"),
    ("packing", "int", "base 2 logarithm of how many pixels share a texel, see `image_packing`"),
    ("coding", "int", "1: sRGB; 2: the colour is divided by alpha"),
    points_into="images",
)
# Of attribute a, for the primitives of kind k of geometry g: number (a * (geometry_count + 1) + g) * KIND_COUNT + k.
# In the place of geometry `geometry_count` stand the instances, as kind KIND_INSTANCE.
ATTRIBUTE = _record(
    "attribute",
    "tables",
    ("first", "int", "first texel in the texture of attributes: low part"),
    ("first_high", "int", "high part"),
    ("base", "int", "index of the geometry's first primitive among the records of its kind: low part"),
    ("base_high", "int", "high part"),
    ("width", "int", "texels a primitive; 0: it has no such attribute"),
    ("unused", "vec3", ""),
    points_into="attributes",
)
# The tree over the map of the world's brightness, see `world_light`.
WORLD_LIGHT_CELL = _record(
    "world_light_cell",
    "world_light",
    ("quarters", "vec4", "brightness of the quarters of a cell, 1 the mean: below left, below right, above both"),
)
#: The uniform block: what changes from draw to draw. Lengths are relative to `Scene.origin`.
FRAME = _record(
    "frame",
    "",
    ("camera_origin", "vec3", "eye, or centre of the window for an orthographic camera"),
    ("orthographic", "float", "1: parallel rays"),
    ("camera_right", "vec3", "unit vector to the right"),
    ("clip_start", "float", "distance of the near plane along the view"),
    ("camera_up", "vec3", "unit vector upwards"),
    ("clip_end", "float", "distance of the far plane along the view"),
    ("camera_forward", "vec3", "unit vector along the view"),
    ("light_count", "float", ""),
    ("raster", "vec4", "scale and offset from gl_FragCoord to the window at unit distance"),
    ("window", "vec4", "left and bottom edge of the picture where the raster has it, and 1 over its width and height"),
    ("world_origin", "vec3", "what positions are relative to"),
    ("seed", "float", "of what is left to chance, less than 2^23"),
    ("world_radiance", "vec3", "of a sky that is the same everywhere"),
    ("glass_energy_first", "float", ""),
    ("world_material", "float", "number of the material whose glow is the sky's radiance"),
    ("shadows_pass", "float", "1: shadow rays may pass through what they meet"),
    ("constant_first", "float", ""),
    ("emitter_count", "float", "records of lights after the lamps: surfaces that glow"),
    ("world_xx", "vec3", "light of the world on a surface as a polynomial of its normal, see `world_light`"),
    ("world_light_levels", "float", "of the tree over the world's brightness"),
    ("world_yy", "vec3", ""),
    ("world_cosine_share", "float", "of the directions to the world that are chosen by the cosine"),
    ("world_zz", "vec3", ""),
    ("world_visibility", "float", "which rays see the world, bits of `scene.Visibility`"),
    ("world_xy", "vec3", ""),
    ("ao_distance", "float", "how far a surface asks for what hides the world"),
    ("world_yz", "vec3", ""),
    ("ao_factor", "float", "share of the world's light that it may take"),
    ("world_zx", "vec3", ""),
    ("ao_rays", "float", "how many ask"),
    ("world_x", "vec3", ""),
    ("seen_lamp_count", "float", "the first so many lights are met by rays"),
    ("world_y", "vec3", ""),
    ("root", "float", "index of the node or grid where rays begin: low part"),
    ("world_z", "vec3", ""),
    ("root_high", "float", "what it is and the high part"),
    ("max_depth", "float", "the eye ray has depth 1"),
    ("weight_cutoff", "float", "rays of smaller weight are not followed"),
    ("film_transparent", "float", "1: the sky leaves alpha 0"),
    ("plane_count", "float", ""),
    ("material_first", "float", "first texels of the records that share a texture"),
    ("light_first", "float", ""),
    ("plane_first", "float", ""),
    ("plane_surface_first", "float", ""),
    ("image_first", "float", ""),
    ("instance_first", "float", ""),
    ("instance_surface_first", "float", ""),
    ("root_count", "float", "0: nothing but planes"),
    ("attribute_first", "float", ""),
    ("geometry_count", "float", "distinct geometries, those in world space among them"),
    ("light_shape_first", "float", ""),
    ("sample", "float", "number of the sample; -1: the only one, which takes the middle of everything"),
    ("depth_cue_color", "vec3", "what is far fades into"),
    ("depth_cue_start", "float", "depth along the view where that begins"),
    ("depth_cue_end", "float", "and where it is complete"),
    ("depth_cue_strength", "float", "share of the colour there"),
    ("depth_cue_background", "float", "1: what is far fades into what is behind everything"),
    ("outline_attribute", "float", "number of the attribute that outlines go around"),
    ("outline_color", "vec4", "not premultiplied"),
    ("outline_width", "float", "in pixels"),
    ("outline_inner_width", "float", "of lines at creases and steps, in pixels"),
    ("outline_crease", "float", "cosine of the least angle of a crease"),
    ("outline_step", "float", "least step behind a line, in units of the window"),
    ("light_node_first", "float", ""),
    ("light_node_count", "float", ""),
    ("light_cut_end", "float", "the node after those of the lamps"),
    ("light_cut_angle", "float", "lamps that are seen under less count as one in a picture of one sample"),
    ("outside_sphere", "vec3", "spheres outside of the trees: index of the first, low and high part; number"),
    ("least_chance", "float", "of a rough ray to be followed"),
    ("outside_cylinder", "vec3", ""),
    ("unused_cylinder", "float", ""),
    ("outside_cone", "vec3", ""),
    ("unused_cone", "float", ""),
    ("outside_disc", "vec3", ""),
    ("unused_disc", "float", ""),
    ("outside_triangle", "vec3", ""),
    ("unused_triangle", "float", ""),
)

RECORDS = (
    NODE,
    GRID,
    GRID_CELL,
    GRID_ITEM,
    GRID_REFERENCE,
    INSTANCE,
    INSTANCE_SURFACE,
    SPHERE,
    SPHERE_SURFACE,
    CYLINDER,
    CYLINDER_SURFACE,
    CONE,
    CONE_SURFACE,
    DISC,
    DISC_SURFACE,
    TRIANGLE,
    TRIANGLE_SURFACE,
    PLANE,
    PLANE_SURFACE,
    MATERIAL,
    CONSTANT,
    GLASS_ENERGY,
    LIGHT,
    LIGHT_SHAPE,
    LIGHT_NODE,
    IMAGE,
    ATTRIBUTE,
    WORLD_LIGHT_CELL,
)

#: Numbers of the kinds: those of primitives are also the labels of the tree's leaves. Planes stand in no tree.
KINDS = ("sphere", "cylinder", "cone", "disc", "triangle", "instance", "plane")

#: What a reference's kind is where it leads to a grid.
GRID_KIND = len(KINDS)

#: Kinds of primitives.
TREE_KINDS = KINDS[: KINDS.index("instance")]

#: Third number of a sphere's `rotation` where the other two are the uv of all of it: no rotation is as long.
FIXED_UV = 4.0


def shared(record):
    """Whether other records lie in the same texture, so that this one starts at `frame_<record>_first`. Nodes and grids
    are numbered from their texture's first texel on."""
    return record.texture != NODE.texture and sum(other.texture == record.texture for other in RECORDS) > 1
