"""The table of records: the bytes that numpy writes are the floats that GLSL reads."""

import re

import numpy as np
import pytest

from addon.engine import layout, record_glsl, reference
from addon.engine.record import Field, Record

each_record = pytest.mark.parametrize("record", layout.RECORDS, ids=lambda record: record.name)


SIZES = {"float": 1, "int": 1, "vec2": 2, "vec3": 3, "vec4": 4}


def glsl_reads(record, floats):
    """What `read_<record>` makes of the floats of one record: member name to a list of values."""
    text = record_glsl.reader(record)
    kinds = {name: kind for kind, name in re.findall(r"^  (\w+) (\w+);$", text.split("};")[0], re.MULTILINE)}
    read = {}
    for name, texel, swizzle in re.findall(r"record\.(\w+) = (?:WHOLE\()?t(\d+)\.([xyzw]+)", text):
        assert len(swizzle) == SIZES[kinds[name]], name
        read[name] = [floats[4 * int(texel) + "xyzw".index(c)] for c in swizzle]
    assert list(read) == list(kinds)
    return read


@each_record
def test_bytes_are_read_as_they_were_written(record):
    """Each float has a value of its own; what GLSL reads of each member is what numpy wrote to it."""
    rows = record.zeros(3)
    flat = rows.view(np.float32).reshape(3, -1)
    assert flat.shape[1] == 4 * record.texels
    flat[:] = np.arange(flat.size).reshape(flat.shape)
    for row, floats in zip(rows, flat, strict=True):
        read = glsl_reads(record, floats)
        assert list(read) == list(record.dtype.names)
        for name, values in read.items():
            assert np.ravel(row[name]).tolist() == values, name


@each_record
def test_records_are_fetched_from_their_own_place(record):
    text = record_glsl.reader(record)
    texels = [int(t) for t in re.findall(rf"fetch_{record.texture}\(texel \+ (\d+)\)", text)]
    assert texels == list(range(record.texels))
    assert f"index * {record.texels};" in text
    first = f"{record.name}_first"
    assert (f"frame_{first}" in text) == layout.shared(record)
    if layout.shared(record):
        assert first in layout.FRAME.dtype.names


def test_the_frame_is_read_as_it_was_written():
    """The uniform block is groups of four floats, which every language lays out alike, and a name for each part."""
    assert re.findall(r"  (\w+) group_\d+;", record_glsl.uniform_struct()) == ["vec4"] * layout.FRAME.texels
    assert layout.FRAME.dtype.itemsize == 16 * layout.FRAME.texels
    names = re.findall(r"#define frame_(\w+) \(frame\.group_(\d+)\.([xyzw]+)\)", record_glsl.uniforms())
    assert [name for name, _, _ in names] == list(layout.FRAME.dtype.names)
    for name, group, swizzle in names:
        kind, offset = layout.FRAME.dtype.fields[name][:2]
        assert 16 * int(group) + 4 * "xyzw".index(swizzle[0]) == offset, name
        assert 4 * len(swizzle) == kind.itemsize, name
    assert all(field.type != "int" for field in layout.FRAME.fields), "an int would need its bits, not its value"


def test_no_name_is_given_twice():
    assert len({record.name for record in layout.RECORDS}) == len(layout.RECORDS)
    for record in (*layout.RECORDS, layout.FRAME):
        names = [field.name for field in record.fields]
        assert len(set(names)) == len(names), record.name


INDEX_HIGH_BITS = reference.INDEX_BITS - reference.LOW_BITS


def test_a_field_across_two_texels_is_refused():
    with pytest.raises(ValueError, match="record broken: field b straddles"):
        Record("broken", "", (Field("a", "vec2", ""), Field("b", "vec3", ""), Field("c", "vec3", "")))
    with pytest.raises(ValueError, match="do not fill whole texels"):
        Record("broken", "", (Field("a", "vec3", ""),))


@pytest.mark.parametrize("index", [0, 1, 2**23 - 1, 2**23, 2**23 + 1, 2**24, 2**31 - 1, 2**40 - 1])
def test_indices_survive_float32(index):
    low, high = reference.split_index(index)
    stored = np.float32([low, high])
    assert (stored == [low, high]).all() and low < 2**23, "exact in float32, and with 2^23 more"
    assert int(stored[0]) + (int(stored[1]) << 23) == index


def test_references_survive_float32():
    last = layout.KINDS.index("instance")
    kind, count, high = (
        a.ravel()
        for a in np.meshgrid(range(last + 1), range(1, reference.MAX_LEAF_SIZE + 1), range(1 << INDEX_HIGH_BITS))
    )
    inner = reference.pack_leaf(0, 0, np.arange(1 << INDEX_HIGH_BITS))
    leaf = np.concatenate([reference.pack_leaf(kind, count, high), inner])
    assert len(np.unique(leaf)) == len(leaf) and 0 <= leaf.min() and leaf.max() < 2 ** (32 - reference.LOW_BITS)
    stored = leaf.astype(np.float32)
    assert (stored == leaf).all()
    with pytest.raises(ValueError, match="26 bits"):
        reference.pack_leaf(0, 1, [0, 1 << INDEX_HIGH_BITS])
    for found, given in zip(reference.unpack_leaf(stored[: len(kind)]), (kind, count, high), strict=True):
        assert np.array_equal(found, given)
    assert (reference.unpack_leaf(inner)[1] == 0).all() and np.array_equal(
        reference.unpack_leaf(inner)[2], range(len(inner))
    )


def test_a_kind_s_number_is_its_label():
    from addon.engine.primitives import BY_KIND

    assert [cls.kind for cls in BY_KIND] == list(layout.KINDS[: len(BY_KIND)])
    largest = reference.pack_leaf(layout.KINDS.index("instance"), reference.MAX_LEAF_SIZE, 0)
    assert max(largest, reference.pack_leaf(layout.GRID_KIND, 1, 0)) < 2 ** (32 - reference.LOW_BITS)
