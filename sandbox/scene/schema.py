"""The JSON Schema of scenes (draft 2020-12), made from the models.

An editor that finds it by a scene's ``$schema`` completes keys and marks
mistakes. It is a little more generous than the loader: what an expression or a
unit amounts to, and what a name leads to, no schema can say.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from typing import Any, get_args

from pydantic import BaseModel

from sandbox.scene.document import Scene
from sandbox.values.spec import Spec

DRAFT = "https://json-schema.org/draft/2020-12/schema"
IDENTIFIER = "^[A-Za-z][A-Za-z0-9_]*$"
Schema = dict[str, Any]


def scene_schema() -> Schema:
    """The JSON Schema of a scene's file."""
    schema = described(Scene)
    _allow_composing(schema, schema["$defs"])
    schema["properties"]["parameters"]["propertyNames"] = {"pattern": IDENTIFIER}
    schema["properties"]["parameters"].pop("patternProperties", None)
    schema["properties"]["parameters"]["additionalProperties"] = {"anyOf": [
        {"type": "number"}, {"type": "string"}]}
    return {"$schema": DRAFT, **schema, "title": "A scene of sandbox"}


def described(top: type[Spec]) -> Schema:
    """The JSON Schema of a model and of all that it holds, with the words of its docstrings."""
    schema: Schema = top.model_json_schema(by_alias=True, mode="validation")
    _describe(schema, schema["$defs"], top)
    _drop(schema, "discriminator")
    return schema


def _describe(schema: Schema, definitions: Schema, top: type[Spec]) -> None:
    """Give every field the docstring under it.

    pydantic would do so while it builds each model, which costs more than all
    else that loading a scene does; only the schema needs it.
    """
    for model in _models(Spec):
        target = schema if model is top else definitions.get(model.__name__)
        keys = {name: field.alias or name for name, field in model.model_fields.items()}
        if target is None or {*keys.values()} != {*target["properties"]}:
            continue  # not part of the schema; another class may have the same name
        for field, text in descriptions(model).items():
            entry = target["properties"][keys[field]]
            accepted = entry.get("description", "")  # of a number: which units it may have
            entry["description"] = f"{text} {accepted}".strip()


def descriptions(model: type[BaseModel]) -> dict[str, str]:
    """The docstrings of the fields of a model and its bases, by field; ``type`` has a default."""
    said = {field: text for base in reversed(model.__mro__)
            if issubclass(base, BaseModel) and base is not BaseModel
            for field, text in docstrings(base).items()}
    if "type" in model.model_fields:
        tag, = get_args(model.model_fields["type"].annotation)
        said.setdefault("type", f'Which kind it is: always ``"{tag}"``.')
    return said


def _models(model: type[BaseModel]) -> list[type[BaseModel]]:
    below = model.__subclasses__()
    return below + [found for child in below for found in _models(child)]


def docstrings(model: type) -> dict[str, str]:
    """The string below each field of a class, by field; none where its source is unavailable."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(model))).body[0]
    except OSError:
        return {}
    assert isinstance(tree, ast.ClassDef)
    found = {}
    for field, after in zip(tree.body, tree.body[1:], strict=False):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and (
            isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
            and isinstance(after.value.value, str)
        ):
            found[field.target.id] = inspect.cleandoc(after.value.value)
    return found


def _drop(value: Any, key: str) -> None:
    """Remove a keyword of OpenAPI that JSON Schema does not know, at every depth."""
    entries = value.values() if isinstance(value, dict) else value
    if isinstance(value, dict) and isinstance(value.get(key), dict) and "mapping" in value[key]:
        del value[key]
    for entry in list(entries):
        if isinstance(entry, (dict, list)):
            _drop(entry, key)


COMPOSED: Schema = {
    "like": {"type": "string", "description": "The name of a template, whose keys this entry "
             "takes; its own keys go over them, object by object, and lists are replaced whole."},
    "repeat": {
        "description": "Number of copies, counted by i from 0; a number, an expression, or an "
                       "object.",
        "anyOf": [{"type": "integer", "minimum": 1}, {"type": "string", "pattern": "^ *="}, {
            "type": "object", "additionalProperties": False,
            "anyOf": [{"required": ["count"]}, {"required": ["list"]}],
            "properties": {
                "count": {"type": ["integer", "string"], "description": "Of the copies."},
                "list": {"type": "array", "minItems": 1, "description": "A value of the index "
                         "for each copy, or an object of names and values."},
                "index": {"type": "string", "pattern": IDENTIFIER,
                          "description": "The name of the index; i by default."},
                "line": {"type": "array", "minItems": 2, "maxItems": 2,
                         "description": "From one copy to the next [m]."},
                "circle": {"type": "array", "minItems": 2, "maxItems": 2,
                           "description": "Centre of the circle that the copies go round [m]."},
            }}]},
    "include": {"type": "string", "description": "The name of a scene in the same folder, which "
                                                 "becomes an assembly."},
    "parameters": {"type": "object", "description": "Of an assembly: numbers for its "
                   "expressions, before those of the scene that it includes."},
}
"""The words that are gone from a scene before the models see it."""


def _compose_entries(schema: Any) -> None:
    """Let the entries of a list be composed, and those of lists in it, such as a hole's corners."""
    items = schema.get("items") if isinstance(schema, dict) else None
    if not isinstance(items, dict) or "prefixItems" in schema:
        return
    _compose_entries(items)
    schema["items"] = {"anyOf": [items, {"$ref": "#/$defs/Composed"}]}
    schema.pop("minItems", None)  # one entry may expand to several


def _allow_composing(schema: Schema, definitions: Schema) -> None:
    """Entries of lists may be like a template or repeated, parts may include a scene."""
    for model in [schema, *definitions.values()]:
        for entry in model.get("properties", {}).values():
            _compose_entries(entry)
    assembly = definitions["Assembly"]["properties"]
    assembly |= {key: COMPOSED[key] for key in ("parameters",)}
    definitions["Composed"] = {
        "type": "object", "properties": COMPOSED,
        "anyOf": [{"required": [word]} for word in ("like", "repeat", "include")],
        "description": "An entry that is written out before the scene is read."}
    schema["properties"]["templates"]["additionalProperties"] = {"type": "object"}
    schema["properties"]["templates"].pop("patternProperties", None)
