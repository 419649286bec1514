"""The builders as editors and type checkers read them: words, types and sentences of each."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from typing import Any

from sandbox.build import BUILDERS
from sandbox.build.builders import FIRST, Entry, EntryBuilder, Family
from sandbox.scene.document import Scene
from sandbox.scene.schema import scene_schema

WIDTH = 100
"""Of a line."""
HEAD = '''"""Scenes without dictionaries: builders whose words an editor completes.

Written by docs/make_reference.py from the models of scenes.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from sandbox.build.builders import EntryBuilder, Family

Number = float | str
"""In SI, or a text with a unit, or an expression: ``0.01``, ``"10 mm"``, ``"=length / 2"``."""
Entry = dict[str, Any]
"""What a builder returns, or a dictionary as a scene's file has it."""

BUILDERS: dict[str, EntryBuilder | Family]
'''
NUMBER = frozenset({"float", "str"})
PLAIN = {"string": "str", "number": "float", "integer": "int", "boolean": "bool"}


def stub() -> str:
    """The text of ``sandbox/build/__init__.pyi``."""
    schema = scene_schema()
    lines = [HEAD]
    for name, builder in BUILDERS.items():
        if isinstance(builder, Family):
            lines += ["", f"class _{name.capitalize()}:"]
            for each in builder:
                lines += ["    @staticmethod", *_function(each, schema, "    ")]
            lines += ["", f"{name}: _{name.capitalize()}"]
        else:
            lines += ["", *_function(builder, schema, "")]
    return "\n".join(lines) + "\n"


def _function(builder: EntryBuilder, schema: Entry, indent: str) -> Iterator[str]:
    model = builder.model
    properties = (schema if model is Scene else schema["$defs"][model.__name__])["properties"]
    words = list(builder.__signature__.parameters)
    yield f"{indent}def {builder.__name__}("
    if words and words[0] != FIRST:
        yield f"{indent}    *,"
    for word in words:
        least = "" if word in builder.required else " | None = None"
        found = type_of(properties[builder.fields[word]])
        found = found.removesuffix(" | None") if least else found
        yield from textwrap.wrap(f"{word}: {found}{least},", WIDTH, break_long_words=False,
                                 initial_indent=f"{indent}    ",
                                 subsequent_indent=f"{indent}        ")
        if word == FIRST:
            yield f"{indent}    *,"
    yield f"{indent}) -> Entry:"
    text = builder.__doc__.replace("\\", "\\\\")
    told = [line for part in f'"""{text}'.splitlines() for line in _wrapped(part, f"{indent}    ")]
    yield from [*told, f'{indent}    """']


def _wrapped(line: str, indent: str) -> list[str]:
    inner = line[:len(line) - len(line.lstrip())]
    return textwrap.wrap(line.strip(), WIDTH, initial_indent=indent + inner,
                         subsequent_indent=f"{indent}{inner}    " if inner else indent) or [""]


def type_of(schema: Any) -> str:
    """What a piece of the schema takes, as a type of Python."""
    options = list(dict.fromkeys(_options(schema)))
    if set(options) >= NUMBER:
        options = ["Number", *(each for each in options if each not in NUMBER)]
    if "None" in options:
        options = [*(each for each in options if each != "None"), "None"]
    return "Any" if "Any" in options or not options else " | ".join(options)


def _options(schema: Entry) -> Iterator[str]:
    if "anyOf" in schema or "oneOf" in schema:
        for option in schema.get("anyOf") or schema["oneOf"]:
            yield from _options(option)
    elif "$ref" in schema:
        yield "Entry"
    elif "const" in schema or "enum" in schema:
        choices = schema.get("enum") or [schema["const"]]
        yield f"Literal[{', '.join(map(repr, choices))}]"
    elif schema.get("type") == "array":
        yield f"Sequence[{_item(schema)}]"
    elif schema.get("type") == "object":
        inner = schema.get("additionalProperties", {})
        yield f"Mapping[str, {type_of(inner) if isinstance(inner, dict) else 'Any'}]"
    elif schema.get("type") == "null":
        yield "None"
    elif isinstance(schema.get("type"), list):
        yield from (PLAIN[each] for each in schema["type"])
    else:
        yield PLAIN.get(schema.get("type", ""), "Any")


def _item(schema: Entry) -> str:
    inner = [option for each in schema.get("prefixItems") or [schema.get("items", {})]
             for option in [type_of(each)]]
    return " | ".join(dict.fromkeys(inner))
