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
from sandbox.scene.elements.spec import Spec

DRAFT = "https://json-schema.org/draft/2020-12/schema"
IDENTIFIER = "^[A-Za-z][A-Za-z0-9_]*$"
LIKE = ("The name of a template, whose keys this part takes; its own keys go over them, object by "
        "object, and lists are replaced whole.")
Schema = dict[str, Any]


def scene_schema() -> Schema:
    """The JSON Schema of a scene's file."""
    schema = Scene.model_json_schema(by_alias=True, mode="validation")
    definitions: Schema = schema["$defs"]
    _describe(schema, definitions)
    _drop(schema, "discriminator")
    _allow_templates(schema, definitions)
    schema["properties"]["parameters"]["propertyNames"] = {"pattern": IDENTIFIER}
    schema["properties"]["parameters"].pop("patternProperties", None)
    schema["properties"]["parameters"]["additionalProperties"] = {"anyOf": [
        {"type": "number"}, {"type": "string"}]}
    return {"$schema": DRAFT, **schema, "title": "A scene of sandbox"}


def _describe(schema: Schema, definitions: Schema) -> None:
    """Give every field the docstring under it.

    pydantic would do so while it builds each model, which costs more than all
    else that loading a scene does; only the schema needs it.
    """
    for model in _models(Spec):
        target = schema if model is Scene else definitions.get(model.__name__)
        if target is None:
            continue
        for field, text in descriptions(model).items():
            entry = target["properties"][model.model_fields[field].alias or field]
            accepted = entry.get("description", "")  # of a number: which units it may have
            entry["description"] = f"{text} {accepted}".strip()


def descriptions(model: type[BaseModel]) -> dict[str, str]:
    """What stands below each field of a model and of those that it is derived from, by field.

    A ``type`` needs no words of its own.
    """
    said = {field: text for base in reversed(model.__mro__)
            if issubclass(base, BaseModel) and base is not BaseModel
            for field, text in _docstrings(base).items()}
    if "type" in model.model_fields:
        tag, = get_args(model.model_fields["type"].annotation)
        said.setdefault("type", f'Which kind it is: always ``"{tag}"``.')
    return said


def _models(model: type[BaseModel]) -> list[type[BaseModel]]:
    below = model.__subclasses__()
    return below + [found for child in below for found in _models(child)]


def _docstrings(model: type[BaseModel]) -> dict[str, str]:
    """The string below each field of a class, by field."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(model))).body[0]
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


def _allow_templates(schema: Schema, definitions: Schema) -> None:
    """Parts may leave to a template what they have in common with it; templates hold any of it."""
    parts = schema["properties"]["parts"]["items"]
    members = parts.pop("oneOf")
    kinds = [definitions[member["$ref"].rpartition("/")[2]] for member in members]
    known: Schema = {"like": {"type": "string", "description": LIKE}}
    for kind in kinds:
        for key, entry in kind["properties"].items():
            known.setdefault(key, {"description": entry.get("description", "")})
    known["type"] = {"enum": [kind["properties"]["type"]["const"] for kind in kinds]}
    definitions["Template"] = {
        "type": "object", "properties": known,
        "description": "What parts have in common, by the keys of parts."}
    definitions["PartLike"] = {
        "type": "object", "required": ["like", "name"], "properties": known,
        "description": "A part that takes what it does not say itself from a template."}
    parts["anyOf"] = [*members, {"$ref": "#/$defs/PartLike"}]
    schema["properties"]["templates"]["additionalProperties"] = {"$ref": "#/$defs/Template"}
    schema["properties"]["templates"].pop("patternProperties", None)
