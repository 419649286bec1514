"""Files: JSON or a plain complaint with its line and column."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.errors import SceneError
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.source import Scan, parse_source, read_source
from sandbox.values.paths import parse_path, path_text

json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(st.characters(exclude_categories=["Cs"])),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(
        st.text(st.characters(exclude_categories=["Cs"])), inner, max_size=4),
    max_leaves=20)


@given(json_values, st.sampled_from([None, 0, 2]), st.booleans())
def test_every_place_is_where_its_value_stands(
    value: object, indent: int | None, ascii: bool,
) -> None:
    text = json.dumps(value, indent=indent, ensure_ascii=ascii)
    scan = Scan(text, Limits())
    assert scan.faults == []
    for path, (place, key) in scan.places.items():
        inner: Any = value
        for step in path:
            inner = inner[step]
        assert json.JSONDecoder().raw_decode(text, place)[0] == inner
        if key >= 0:
            assert json.JSONDecoder().raw_decode(text, key)[0] == path[-1]


@given(st.binary(max_size=200))
def test_any_bytes_are_data_or_problems(tmp_path_factory: pytest.TempPathFactory, content: bytes
                                        ) -> None:
    path = tmp_path_factory.getbasetemp() / "garbage.json"
    path.write_bytes(content)
    try:
        read_source(path)
    except SceneError as error:
        refused = error
    else:
        return
    assert refused.source == str(path)


@pytest.mark.parametrize(("text", "line", "column", "path", "words"), [
    ('{"a": 1,\n "a": 2}', 2, 2, "$.a", "is repeated, first at line 1, column 2"),
    ('{"a": NaN}', 1, 7, "$.a", "NaN is not a number"),
    ('{"a": 1e999}', 1, 7, "$.a", "too large"),
    ('{"a": ' + "1" * 5000 + "}", 1, 7, "$.a", "too large"),
    ('{"a": [1,\n 2', 2, 3, "$.a", "ends inside the list that begins at line 1, column 7"),
    ('{"a": 1,}', 1, 8, "$", "one too many"),
    ('{"a": 1 "b": 2}', 1, 9, "$", "is a comma missing"),
    ("{'a': 1}", 1, 2, "$", "double quotes"), ('{"a": \'b\'}', 1, 7, "$.a", "double quotes"),
    ('{"a": b}', 1, 7, "$.a", "put text in double quotes"),
    ('{"a": True}', 1, 7, "$.a", "write true"), ('{"a": =b}', 1, 7, "$.a", "put an expression in"),
    ('{"a": .5}', 1, 7, "$.a", "not a JSON number"), ('{"a"}', 1, 5, "$", "expected ':'"),
    ('{"a": "b', 1, 7, "$.a", "the file ends inside the text"), ("{} {}", 1, 4, "$", "more text"),
    ('{"a": 1 // why\n}', 1, 9, "$", "no comments"), ('{"a":}', 1, 6, "$.a", "missing before"),
    (r'{"a": "\ud800"}', 1, 7, "$.a", "half a character"), (" \n", 0, 0, "$", "empty"),
])
def test_complaints(text: str, line: int, column: int, path: str, words: str) -> None:
    with pytest.raises(SceneError) as refused:
        parse_source(text, name="x.json")
    problem = refused.value.problems[0]
    assert (problem.line, problem.column, problem.path) == (line, column, path)
    assert words in problem.message


def test_nesting_is_limited_and_the_limit_can_be_raised() -> None:
    opening = '{"a":'
    text = opening * 40 + "1" + "}" * 40
    with pytest.raises(SceneError, match="limit 'nesting' of 32"):
        parse_source(text)
    assert parse_source(text, limits=Limits(nesting=40)).data
    with pytest.raises(SceneError, match="nesting"):
        parse_source(opening * 100_000)


@pytest.mark.parametrize(("content", "words", "place"), [
    (b'{"a":\n "\xe9"}', "not UTF-8 text (byte 0xe9)", (2, 3)),
    ("{}".encode("utf-16"), "UTF-16", (1, 1)), (b"\x89PNG\r\n", "byte 0x89", (1, 1)),
])
def test_other_encodings(tmp_path: Path, content: bytes, words: str, place: tuple[int, int]
                         ) -> None:
    path = tmp_path / "x.json"
    path.write_bytes(content)
    with pytest.raises(SceneError) as refused:
        read_source(path)
    (problem,) = refused.value.problems
    assert words in problem.message
    assert (problem.line, problem.column) == place


def test_missing_files_have_neighbours(tmp_path: Path) -> None:
    (tmp_path / "gripper.json").write_text("{}")
    with pytest.raises(SceneError) as refused:
        read_source(tmp_path / "griper.json")
    assert "gripper.json" in refused.value.problems[0].hint
    with pytest.raises(SceneError, match="this is a directory"):
        read_source(tmp_path)
    with pytest.raises(SceneError, match="no such file"):
        read_source(tmp_path / "gripper.json" / "x.json")
    with pytest.raises(SceneError):
        read_source("a\0b.json")


@given(st.lists(st.integers(0, 999) | st.text(min_size=1, max_size=20), max_size=6))
def test_paths_are_read_as_they_are_written(path: list[int | str]) -> None:
    assert parse_path(path_text(path)) == tuple(path)


def test_file_size_and_a_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "large.json"
    path.write_bytes(b'\xef\xbb\xbf{"about": "' + b"x" * 1000 + b'"}')
    with pytest.raises(SceneError, match="limit 'file_bytes' of 1000"):
        read_source(path, limits=Limits(file_bytes=1000))
    assert read_source(path, limits=Limits(file_bytes=2000)).data["about"]
