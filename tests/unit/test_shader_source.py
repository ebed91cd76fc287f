"""The composer of programs: includes, conditions, line numbers and its errors."""

import re

import pytest

from addon.engine import layout, shader_source
from addon.engine.node_programs import NodePrograms
from addon.engine.record import Field, Record
from addon.engine.shader_source import FEATURES, SHADER_FOLDER, ShaderSourceError, program

KINDS = [f"HAS_{kind.upper()}" for kind in layout.KINDS if kind != "instance"]


@pytest.fixture
def compose(tmp_path):
    """compose(features=(), **files): a program of files by name without ending, from main.glsl."""

    def of(*features, **files):
        for name, text in files.items():
            (tmp_path / f"{name}.glsl").write_text(text)
        return program("main.glsl", features, folders=(tmp_path,))

    return of


GENERATED = (("programs_lib.glsl", NodePrograms().text()),)


def body(source):
    """The program's lines from files, without the constants that every program has."""
    text = source.text.splitlines()
    return [line for line, (file, _) in zip(text, source.lines, strict=True) if file.endswith(".glsl")]


def test_a_file_is_included_once(compose):
    source = compose(main='#include "a.glsl"\n#include "b.glsl"\nmain', a='#include "b.glsl"\na', b="b")
    assert body(source) == ["b", "a", "main"]


def test_files_that_include_each_other_end(compose):
    assert body(compose(main='#include "a.glsl"\nmain', a='#include "main.glsl"\na')) == ["a", "main"]


def test_conditions_are_decided_here(compose):
    text = "#ifdef HAS_SPHERE\nsphere\n#ifndef HAS_CONE\nno cone\n#else\ncone\n#endif\n#else\nnone\n#endif\nend"
    assert body(compose("HAS_SPHERE", main=text)) == ["sphere", "no cone", "end"]
    assert body(compose("HAS_SPHERE", "HAS_CONE", main=text)) == ["sphere", "cone", "end"]
    assert body(compose(main=text)) == ["none", "end"]
    assert body(compose("HAS_CONE", main=text)) == ["none", "end"]


def test_what_is_conditioned_away_is_not_included(compose):
    text = '#ifdef HAS_SPHERE\n#include "missing.glsl"\n#include <sphere>\n#endif\nend'
    source = compose(main=text)
    assert body(source) == ["end"] and source.textures == ()


def test_every_line_knows_its_origin(compose):
    source = compose(main='first\n#include "a.glsl"\nlast', a="#ifdef HAS_SPHERE\nx\n#endif\ny")
    text = source.text.splitlines()
    origins = {line: source.origin(number) for number, line in enumerate(text, 1)}
    assert origins["first"] == ("main.glsl", 1) and origins["last"] == ("main.glsl", 3)
    assert origins["y"] == ("a.glsl", 4)
    number = text.index("y") + 1
    assert f"> a.glsl:4: {text[number - 1]}" in source.listing(number)
    assert source.origin(10**6) == ("main.glsl", 3), "a driver that counts too far gets the last line"


def test_records_bring_their_reader_and_texture_once(compose):
    source = compose(main="#include <sphere>\n#include <sphere>\n#include <light>\n#include <material>\n")
    assert source.textures == ("spheres", "tables")
    assert source.text.count("struct Sphere {") == 1
    assert source.text.count("vec4 fetch_tables(int texel)") == 1


def test_a_record_of_images_brings_their_texels(compose):
    assert compose(main="#include <image>").textures == ("tables", "images")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("\n#ifdef HAS_SPHRE\n#endif", "main.glsl:2: HAS_SPHRE is not a known feature"),
        ("#else", "main.glsl:1: #else without #ifdef"),
        ("x\n#endif", "main.glsl:2: #endif without #ifdef"),
        ("#ifdef HAS_SPHERE", "main.glsl: an #ifdef is not closed"),
        ('#include "missing.glsl"', "main.glsl:1: no shader file missing.glsl"),
        ("#include <missing>", "main.glsl:1: #include <missing> names no file and no record"),
        ("#include missing", "main.glsl:1: #include missing names no file and no record"),
    ],
)
def test_errors_name_file_and_line(compose, text, message):
    with pytest.raises(ShaderSourceError, match=re.escape(message)):
        compose(main=text)


def test_an_unknown_feature_is_refused(compose):
    with pytest.raises(ShaderSourceError, match="unknown feature HAS_TORUS"):
        compose("HAS_TORUS", main="")


def test_folders_are_searched_in_order_and_records_can_be_added(tmp_path):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
    (tmp_path / "a/main.glsl").write_text('#include "ray_lib.glsl"\n#include <probe>\nours')
    (tmp_path / "b/ray_lib.glsl").write_text("theirs")
    probe = Record("probe", "probes", (Field("value", "vec4", ""),))
    source = program("main.glsl", folders=(tmp_path / "a", tmp_path / "b"), records=(probe,))
    assert [line for line in body(source) if line] == ["theirs", "ours"] and source.textures == ("probes",)


def test_the_same_request_gives_the_same_program():
    assert program("film_frag.glsl", KINDS, {"A": 1, "B": 2}) is program(
        "film_frag.glsl", KINDS[::-1], {"B": 2, "A": 1}
    )
    assert "#define A 1" in program("film_frag.glsl", KINDS, {"A": 1}).text


def test_every_feature_is_tested_and_every_library_used():
    text = {path.name: path.read_text() for path in SHADER_FOLDER.glob("*.glsl")}
    tested = set(re.findall(r"#ifn?def (\w+)", "\n".join(text.values())))
    assert tested == FEATURES
    libraries = {name for name in text if name.endswith("_lib.glsl")}
    included = set(re.findall(r'#include "(\S+)"', "\n".join(text.values())))
    python = "\n".join(path.read_text() for path in SHADER_FOLDER.parent.rglob("*.py"))
    called = {name for name in libraries if any(f'"{word}' in python for word in _functions_of(text[name]))}
    assert included - {GENERATED[0][0]} <= libraries <= included | called


def _functions_of(text):
    """The names of a library's functions; of those for 1, 2, ... dimensions what they have in common too."""
    names = set(re.findall(r"^[A-Za-z]\w+ (\w+)\(", text, re.M))
    return names | {re.sub(r"(_lookup3)?_\dd$", "_", name) for name in names}


def test_libraries_keep_the_rules_of_the_house():
    """No uniform, no preprocessor of their own but defines, functions named after the file."""
    for path in SHADER_FOLDER.glob("*_lib.glsl"):
        text = re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.S)
        assert not re.search(r"^\s*(uniform|layout|in|out) .*;", text, re.M), path.name
        stem = re.sub("(_texture|_nodes)?_lib.glsl$", "", path.name)
        functions = re.findall(r"^[A-Za-z]\w+ (\w+)\(", text, re.M)
        assert functions or stem == "ray", path.name
        for name in functions:
            assert name.startswith((f"{stem}_", "point_beside")), f"{path.name}: {name}"


@pytest.mark.parametrize("feature", sorted(FEATURES))
def test_a_program_has_only_the_textures_it_uses(feature):
    source = shader_source.program("film_frag.glsl", {feature}, generated=GENERATED)
    kind = feature.removeprefix("HAS_").lower()
    for record in layout.RECORDS:
        if record.texture in ("tables", "nodes", "instances"):
            continue
        assert (record.texture in source.textures) == record.name.startswith(kind), record.texture
    assert ("instances" in source.textures) == (feature == "HAS_INSTANCES")


def test_structs_have_no_constructors():
    """Metal's language has none of GLSL's kind: structs are filled member by member."""
    text = program("film_frag.glsl", FEATURES, {}, generated=GENERATED).text
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    structs = re.findall(r"\bstruct (\w+)", text)
    assert {"Ray", "Surface", "Sphere"} <= set(structs)
    for name in structs:
        assert not re.search(rf"\b{name}\s*\(", text), name
