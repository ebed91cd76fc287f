# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of Blender's data, objects and instances, as arrays for the engine; read whole, never element by element.

A *key* says what a material wants, and is the engine's name of it: `<source>:<name>`, or `<source>.<output>:<name>`
for another output of the node than its colour, with `output` fac or alpha. The sources:

    geometry   of a mesh, point cloud or curves; an empty name is the colour attribute that is active for rendering
    random     of the point of a point cloud or of the curve, without a name
    instancer  of an instance made by geometry nodes, else a property of what instances it, else of the object
    property   a custom property or the path of any other, of the object or its data
    object     what Object Info gives: color, alpha, index, location, random; and its space: space_x, space_y, space_z
    generated  what takes a place in the object to its generated coordinates: scale and offset
    island     a random number of each part of a mesh that is not joined to others, without a name
    point      of a point cloud: position, radius
    hair       of strands: is_strand, intercept, length, thickness

Values are rows of 4 float32, colours scene-linear, alpha last. What is not there is left out: the engine takes 0, as
Blender does.
"""

import numpy as np

from .compat import levels_of_random_ids
from .mesh_values import island_randoms, undeformed
from .raw_attributes import TYPES, read_corner_vertices, values_of
from .spaces import space_rows, texture_space

#: Types of attributes that Cycles knows.
_KNOWN = TYPES.keys() - {"INT32_2D"}
_OF_PRIMITIVES = ("geometry", "random", "generated", "island", "point", "hair")
_SPACE = ("space_x", "space_y", "space_z")


def key_of(source, name="", output=""):
    """The key of an attribute; `output`: fac, alpha, or empty for the colour."""
    return f"{source}.{output}:{name}" if output else f"{source}:{name}"


#: `spaces.texture_space`, by which generated coordinates are found.
GENERATED_SCALE, GENERATED_OFFSET = key_of("generated", "scale"), key_of("generated", "offset")


def parts_of(key):
    """(source, name, output) of a key."""
    head, _, name = key.partition(":")
    source, _, output = head.partition(".")
    return source, name, output


def title_of(key):
    """What a report calls the values of a key that vary over a shape."""
    if key == GENERATED_OFFSET:
        return "its form before modifiers deform it"
    return f"the attribute {parts_of(key)[1] or 'Color'!r}, which is not the same all over it"


def of_primitives(keys):
    """Those of the keys whose values lie on points, faces, corners or curves, sorted: the rest belongs to objects."""
    return tuple(sorted(key for key in keys if parts_of(key)[0] in _OF_PRIMITIVES))


def read_attribute(data, name, output=""):
    """Attribute `name` of evaluated data: (values (n, 4) float32, domain), or None where there is none to render.

    The output is that of Cycles' Attribute node: a number is grey, a pair red and green; `fac` of a pair is its
    first, of all else the mean of three.
    """
    attribute = data.attributes.get(name or getattr(data.attributes, "default_color_name", ""))
    if attribute is None or attribute.data_type not in _KNOWN:
        return None
    read = values_of(attribute)
    read = read[:, None] if read.ndim == 1 else read
    if read.dtype == np.float32 and not (finite := np.isfinite(read)).all():
        read[~finite] = 0.0
    if output == "fac" and read.shape[1] == 2:
        read = read[:, :1]
    return output_of(_as_color(read), output), attribute.domain


def _as_color(read):
    """Rows (n, width) as (n, 4) float32."""
    width = read.shape[1]
    if width == 4:
        return read
    color = np.zeros((len(read), 4), np.float32)
    color[:, : 3 if width == 1 else width] = read
    color[:, 3] = 1.0
    return color


def output_of(color, output):
    """An output of colours (..., 4): colours of the same shape."""
    if not output:
        return color
    grey = np.ones_like(color)
    grey[..., :3] = (color[..., :3].mean(axis=-1) if output == "fac" else color[..., 3])[..., None]
    return grey


def of_triangles(mesh, keys, corners, faces):
    """The attributes of triangles by key, (t, 1 or 3, 4): `corners` (t, 3) of the mesh, `faces` (t,)."""
    found = {}
    for key, values, domain in of_elements(mesh, keys):
        if domain == "CORNER":
            found[key] = values[corners]
        elif domain == "FACE":
            found[key] = values[faces][:, None]
        elif domain == "POINT":
            found[key] = values[read_corner_vertices(mesh)[corners]]
    return found


def of_mesh(mesh, keys):
    """The attributes that are the same all over a mesh, as its exact shape takes them: (4,) by key; None where one
    varies."""
    found = {}
    for key, values, domain in of_elements(mesh, keys):
        if domain in ("CORNER", "FACE", "POINT") and len(values):
            found[key] = values[0] if np.allclose(values, values[0], rtol=1e-4, atol=1e-6) else None
    return found


def of_points(cloud, keys):
    """The attributes of the points of a point cloud by key, (n, 1, 4)."""
    found = {key: values[:, None] for key, values, domain in _read(cloud, keys, "point") if domain == "POINT"}
    return found | {key: values[:, None] for key, values in randoms(keys, len(cloud.points)).items()}


def of_curves(curves, keys):
    """The attributes of hair curves by key: (values (n, 4), POINT or CURVE), a row a control point or a curve."""
    found = {key: (values, domain) for key, values, domain in _read(curves, keys) if domain in ("POINT", "CURVE")}
    return found | {key: (values, "CURVE") for key, values in randoms(keys, len(curves.curves)).items()}


def randoms(keys, count, first=0):
    """The Random output of Point Info and Curves Info for the elements from number `first` on, (count, 4) by key."""
    wanted = [key for key in keys if parts_of(key)[0] == "random"]
    values = _hash(np.arange(first, first + count, dtype=np.uint32), 0) if wanted else None
    return {key: _grey(_unit(values)) for key in wanted}


def _read(data, keys, own_source=""):
    """Yield (key, values (n, 4), domain) of the keys that the data has; `own_source`: a source besides geometry whose
    names are those of its attributes."""
    for key in keys:
        source, name, output = parts_of(key)
        read = read_attribute(data, name, output) if source in ("geometry", own_source) else None
        if read is not None:
            yield key, *read


def of_elements(mesh, keys):
    """Yield (key, values (n, 4), domain) of the keys that a mesh has: its attributes, and what is worked out from its
    parts and from its form before it is deformed."""
    yield from _read(mesh, keys)
    for key in keys:
        if key == key_of("island"):
            yield key, _as_color(island_randoms(mesh)[:, None]), "POINT"
        elif key == GENERATED_OFFSET and (places := undeformed(mesh)) is not None:
            scale, offset = texture_space(mesh)
            yield key, _as_color((places * scale + offset).astype(np.float32)), "POINT"


def of_texture_space(data, keys):
    """What takes a place in the space of data to its generated coordinates, (4,) by key. Of a deformed mesh the offset
    is an attribute of its primitives, which goes before this."""
    if GENERATED_SCALE not in keys:
        return {}
    scale, offset = texture_space(data)
    if hasattr(data, "polygons") and undeformed(data) is not None:
        scale = np.zeros(3)
    return {GENERATED_SCALE: np.append(scale, 1.0), GENERATED_OFFSET: np.append(offset, 1.0)}


def of_instances(cloud, keys):
    """The attributes of instances made by geometry nodes, (n, 4) by key: `cloud` is their `instances_pointcloud()`."""
    found = {}
    for key in keys:
        source, name, output = parts_of(key)
        # Read as a colour whatever its type: even fac of a pair is the mean of three.
        read = read_attribute(cloud, name) if source == "instancer" and name else None
        if read is not None and cloud.attributes[name].data_type != "QUATERNION":
            found[key] = output_of(read[0], output)
    return found


def of_object(obj, keys, matrices, random_ids=None, instancer=None):
    """What an object's copies have, by key: (4,), or (n, 4) where they differ.

    `matrices` (n, 4, 4): where they stand. `random_ids` (n,) as Blender's `random_id`; None for the object itself.
    `instancer`: the object in the scene that makes the copies, whose colour and properties go before the object's own.
    """
    found = {}
    for key in keys:
        source, name, output = parts_of(key)
        if source == "object":
            found[key] = _of_object_info(obj, name, matrices, random_ids, instancer)
        elif source in ("property", "instancer"):
            owners = (instancer, obj) if source == "instancer" else (obj,)
            value = property_value([part for owner in owners if owner for part in (owner, owner.data) if part], name)
            if value is not None:
                found[key] = output_of(value, output)
    return found


def _of_object_info(obj, name, matrices, random_ids, instancer):
    if name in _SPACE:
        return space_rows(matrices)[:, _SPACE.index(name)]
    if name == "location":
        return np.insert(np.asarray(matrices, np.float32)[..., :3, 3], 3, 1.0, axis=-1)
    if name == "random":
        return _grey(_unit(object_random_id(obj.name) if random_ids is None else random_ids))
    if name == "index":
        return _grey(obj.pass_index)
    color = np.array((instancer or obj).color, np.float32)  # Blender's instances have that of what makes them
    return output_of(color, name if name == "alpha" else "")


def _grey(values):
    """Numbers (...,) as colours (..., 4)."""
    return _as_color(np.asarray(values, np.float32).reshape(-1, 1)).reshape(*np.shape(values), 4)


def property_value(owners, name):
    """The first of the owners' properties called `name`, a custom one or a path: (4,), None where none is a number."""
    for owner in owners:
        value = owner.get(name)
        if value is None:
            try:
                value = owner.path_resolve(name)
            except ValueError:
                continue
        color = _of_property(value)
        if color is not None:
            return color
    return None


def _of_property(value):
    several = hasattr(value, "__len__")
    if isinstance(value, str) or (several and not 1 <= len(value) <= 4):
        return None
    try:
        numbers = np.array(value if several else [value], np.float32)
    except (TypeError, ValueError):  # a pointer, a collection
        return None
    return np.nan_to_num(_as_color(numbers[None])[0], posinf=0.0, neginf=0.0) if numbers.ndim == 1 else None


def object_random_id(name):
    """Blender's random id of an object that stands there itself, from its name."""
    return int(_hash(_hash_string(name), 0))


def instance_random_ids(name, instancer_name, persistent_ids):
    """Blender's random ids (n,) of instances.

    `name`: of the object that is instanced; `instancer_name`: of the one in the scene that makes the instances;
    `persistent_ids` (n, levels): the number on each level, the innermost first.
    """
    ids = np.full(len(persistent_ids), _hash_string(name), np.uint32)
    numbers = np.asarray(persistent_ids).astype(np.uint32)
    absent = levels_of_random_ids(numbers.shape[1]) - numbers.shape[1]
    numbers = np.pad(numbers, ((0, 0), (0, absent)), constant_values=0x7FFFFFFF)
    for number in numbers.T:
        ids = _hash(ids, number)
    return ids ^ _hash(_hash_string(instancer_name), 0) if name != instancer_name else ids


def _unit(ids):
    """Random ids as numbers from 0 to 1."""
    return np.asarray(ids, np.uint32).astype(np.float32) * np.float32(1.0 / 0xFFFFFFFF)


def _hash_string(text):
    value = 0
    for byte in text.encode():
        value = (value * 37 + byte) & 0xFFFFFFFF
    return value


def _hash(x, y):
    """A hash of arrays of uint32: the end of Bob Jenkins' lookup3 (2006) for the two words x and y."""
    start = np.uint32(0xDEADBEEF + (2 << 2) + 13)
    with np.errstate(over="ignore"):  # wraps around
        a, b, c = np.asarray(x, np.uint32) + start, np.asarray(y, np.uint32) + start, start
        for turn, next_turn, last_turn in ((14, 11, 25), (16, 4, 14)):
            c = (c ^ b) - _rotated(b, turn)
            a = (a ^ c) - _rotated(c, next_turn)
            b = (b ^ a) - _rotated(a, last_turn)
        return (c ^ b) - _rotated(b, 24)


def _rotated(x, bits):
    return (x << np.uint32(bits)) | (x >> np.uint32(32 - bits))
