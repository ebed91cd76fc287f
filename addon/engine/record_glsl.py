"""The GLSL of the records of `layout`: structs, the functions that read them from data textures, the uniform block."""

from . import data_texture, layout, reference


def struct(record):
    """GLSL struct of a record."""
    members = "".join(f"  {field.type} {field.name};\n" for field in record.fields)
    return f"struct {record.struct_name} {{\n{members}}};\n"


def _places(record):
    """Each field of a record with where it lies: (field, number of its texel, its components as a swizzle)."""
    offset = 0
    for field in record.fields:
        texel, first = divmod(offset, 4)
        yield field, texel, "xyzw"[first : first + field.size]
        offset += field.size


def reader(record):
    """GLSL struct of a record and `read_<record>(index)`, which fetches it from its data texture."""
    base = f"int(frame_{record.name}_first) + " if layout.shared(record) else ""
    fetches = "".join(f"  vec4 t{k} = fetch_{record.texture}(texel + {k});\n" for k in range(record.texels))
    values = ""
    for field, texel, components in _places(record):
        value = f"t{texel}.{components}"
        values += f"  record.{field.name} = {f'WHOLE({value})' if field.type == 'int' else value};\n"
    return (
        f"{struct(record)}"
        f"{record.struct_name} read_{record.name}(int index) {{\n"
        f"  int texel = {base}index * {record.texels};\n"
        f"{fetches}"
        f"  {record.struct_name} record;\n"
        f"{values}"
        f"  return record;\n"
        f"}}\n"
    )


def uniform_struct():
    """GLSL struct of the uniform block: groups of four floats only, since vec3 members lie elsewhere in Metal."""
    groups = "".join(f"  vec4 group_{k};\n" for k in range(layout.FRAME.texels))
    return f"struct {layout.FRAME.struct_name} {{\n{groups}}};\n"


def uniforms():
    """GLSL names `frame_<field>` of the members of the uniform block `frame`."""
    return "".join(f"#define frame_{field.name} (frame.group_{k}.{part})\n" for field, k, part in _places(layout.FRAME))


def fetch(texture):
    """GLSL function `fetch_<texture>(texel)` over `texel_<texture>(place)`, which devices define."""
    place = f"ivec2(texel & {data_texture.WIDTH - 1}, texel >> {data_texture.WIDTH_BITS})"
    return f"vec4 fetch_{texture}(int texel) {{\n  return texel_{texture}({place});\n}}\n"


def constants():
    """GLSL defines that go with the packing of nodes and indices.

    WHOLE is the integer that a float of 0 to 2^23 - 1 is: 2^23 more has the integer for its lowest bits. A conversion
    takes graphics processors as long or longer, and LLVM 22, which Mesa's software rasteriser compiles with, makes it
    of six instructions for each pixel.
    """
    leaf_mask = (1 << 32 - reference.INDEX_BITS) - 1
    kinds = "".join(f"#define KIND_{kind.upper()} {number}\n" for number, kind in enumerate(layout.KINDS))
    return (
        f"{kinds}"
        f"#define KIND_COUNT {len(layout.KINDS)}\n"
        f"#define KIND_GRID {layout.GRID_KIND}\n"
        "#define WHOLE(x) (floatBitsToInt((x) + 8388608.0) & 0x7fffff)\n"
        f"#define REFERENCE(first, leaf) ((first) + ((leaf) << {reference.LOW_BITS}))\n"
        f"#define REFERENCE_INDEX(reference) ((reference) & {(1 << reference.INDEX_BITS) - 1})\n"
        f"#define REFERENCE_IS_INNER(reference) (((reference) >> {reference.INDEX_BITS}) == 0)\n"
        f"#define LEAF_OF(reference) ((((reference) >> {reference.INDEX_BITS}) & {leaf_mask}) - 1)\n"
        f"#define LEAF_KIND(leaf) ((leaf) >> {reference.COUNT_BITS})\n"
        f"#define LEAF_COUNT(leaf) (((leaf) & {reference.MAX_LEAF_SIZE - 1}) + 1)\n"
        f"#define JOIN_INDEX(low, high) ((low) + ((high) << {reference.LOW_BITS}))\n"
    )
