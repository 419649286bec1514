"""The reference of scenes: models by topic, fields with units and defaults, recorded quantities.

``sandbox explain`` and ``docs/make_reference.py`` print it. The JSON Schema of scenes (draft
2020-12), for editors, is made from the same models; it cannot check expressions, units and names.
"""

from __future__ import annotations

import ast
import inspect
import json
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import pairwise
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import PydanticUndefined, core_schema

from sandbox.elements import fluids, loads, springs, tendons
from sandbox.elements.controllers.equilibrium import FingerGeometry
from sandbox.elements.quantities import BOND_QUANTITIES, GRASP, QUANTITIES
from sandbox.elements.registry import KINDS, Controller, Drive, Joint, members
from sandbox.elements.tendons import NUMBERED
from sandbox.scene import bodies, layers, settings
from sandbox.scene.document import Assembly, Scene
from sandbox.scene.parts import expansion, finger, section, trees
from sandbox.scene.read.scopes import IDENTIFIER, Repeat
from sandbox.values import appearance, numbers, signals, tables
from sandbox.values.spec import Spec, mark_of
from sandbox.values.units import si_unit, units_of

VALUES = "Values over time"  # topic of the models of numbers and values over time
ELEMENTS: Mapping[str, Sequence[type[Spec]]] = {
    "The scene": [Scene, settings.Run, settings.PymunkRun, settings.View, settings.Trace,
                  settings.ShownMeter],
    "Bodies": [bodies.Body, *members(bodies.WrittenShape), signals.Path, bodies.Material,
               bodies.Skin, settings.ContactRule],
    "Joints": members(Joint),
    "Springs": members(springs.Spring),
    "Tendons": [tendons.Tendon, tendons.Guide],
    "Fluid": [fluids.Line, *members(fluids.Chamber), fluids.Valve],
    "Loads": members(loads.Load),
    "Drives": members(Drive),
    VALUES: [signals.Ramp, signals.Table, signals.Formula, signals.Constant],
    "Tables": [tables.NamedTable],
    "Controllers": [*members(Controller), FingerGeometry],
    "Events": [settings.Event],
    "Readings and expectations": [settings.Meter, settings.Expect, settings.Group],
}
"""The models of a scene by topic."""
PARTS: Mapping[str, list[type[Spec]]] = {
    "Finger": [finger.Finger, finger.FingerSprings, finger.FingerTendon],
    "Trees": [trees.RockerTree, trees.PulleyTree, expansion.Leaf],
    "Section": [section.Section],
    "Assembly": [Assembly],
}
"""The models of parts by topic."""
CHOICES = {
    bodies.BodyShape: "[shape](elements.md#bodies)", Joint: "[joint](elements.md#joints)",
    springs.Spring: "[spring](elements.md#springs)", Drive: "[drive](elements.md#drives)",
    fluids.Chamber: "[chamber](elements.md#fluid)", loads.Load: "[load](elements.md#loads)",
    Controller: "[controller](elements.md#controllers)"}
"""Unions by name, with the section of the docs that has their members."""


def field_type(annotation: Any, metadata: tuple[Any, ...] = ()) -> str:
    """The values that a field accepts, as Markdown: ``length [m], > 0``."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if (signal := mark_of(metadata, signals.OverTime)) is not None:
        return f"value over time{signal.unit}"
    if mark_of(metadata, finger.OneForAll) is not None:
        return f"one for all, or {field_type(annotation)}"
    for schema, words in ((appearance.SCHEMA, appearance.WORDS.replace('"all"', '`"all"`')),
                          (appearance.COLOUR_SCHEMA, "colour"), (layers.SCHEMA, layers.WORDS),
                          (settings.WINDOW, '"last TIME", or [from, to]')):
        if schema in metadata:
            return words
    if origin is Annotated:
        return next((name for union, name in CHOICES.items() if union == annotation),
                    field_type(inner[0], (*inner[1:], *metadata)))
    if origin in (Union, UnionType):
        return " or ".join(dict.fromkeys(
            field_type(option, metadata) for option in inner if option is not NoneType))
    if origin is Literal:
        return ", ".join(f"`{_json(value)}`" for value in inner)
    if origin is dict:
        return f"object of name: {field_type(inner[1])}"
    if origin is tuple:
        if annotation == numbers.Point:
            return "point [x, y] [m]"
        if inner[-1] is Ellipsis:
            return f"list of {field_type(inner[0])}"
        kinds = list(dict.fromkeys(map(field_type, inner)))
        return f"[{', '.join(kinds)}]" if len(kinds) > 1 else f"{len(inner)} × {kinds[0]}"
    if annotation is float:
        return _number(metadata)
    if isinstance(annotation, type) and issubclass(annotation, Spec):
        page = "parts" if any(annotation in models for models in PARTS.values()) else "elements"
        return f"[{annotation.__name__}]({page}.md#{annotation.__name__.lower()})"
    named = any(getattr(entry, "pattern", None) == numbers.NAME for part in metadata
                for entry in [part, *getattr(part, "metadata", ())])
    return {str: "name" if named else "text", int: "whole number", bool: "true or false"}.get(
        annotation, "any")


def _number(metadata: tuple[Any, ...]) -> str:
    mark = mark_of(metadata, numbers.Dimension) or numbers.Dimension()
    word = "number" if mark.name in (None, "ratio") else f"{mark.name} [{units_of(mark.name)[0]}]"
    if mark.sign == "> 0" or numbers.POSITIVE in metadata:
        return f"{word}, > 0"
    if numbers.AT_MOST_ONE in metadata:
        return f"{word}, 0 to 1"
    return f"{word}, ≥ 0" if mark.sign or numbers.NOT_NEGATIVE in metadata else word


def _json(value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_json, value))}]"
    return f"{value:.6g}" if isinstance(value, float) else json.dumps(value)


def default(field: FieldInfo) -> str:
    """A field's default as Markdown: ``required`` without one, empty for nothing."""
    if field.is_required():
        return "required"
    value = field.get_default(call_default_factory=True)
    if value is PydanticUndefined or value is None or value in ((), {}, ""):
        return ""
    return "as below" if isinstance(value, Spec) else f"`{_json(value)}`"


class FieldRow(NamedTuple):
    """A field of a model; the texts are Markdown."""

    key: str
    type: str
    default: str
    meaning: str


def field_rows(model: type[Spec]) -> Iterator[FieldRow]:
    """The fields of a model; ``type`` first, then those without a default."""
    described = descriptions(model)
    fields = sorted(model.model_fields.items(),
                    key=lambda item: (item[0] != "type", not item[1].is_required()))
    for name, field in fields:
        yield FieldRow(field.alias or name, field_type(field.annotation, tuple(field.metadata)),
                       default(field), markdown(" ".join(described.get(name, "").split())))


def markdown(text: str) -> str:
    """A docstring as Markdown: roles and double backquotes become single ones."""
    return re.sub(r":\w+:`~?([^`]+)`", r"`\1`", text).replace("``", "`")


def about(model: type[Spec]) -> str:
    """A model's docstring as Markdown, one paragraph a line."""
    paragraphs = (model.__doc__ or "").strip().split("\n\n")
    return "\n\n".join(markdown(" ".join(paragraph.split())) for paragraph in paragraphs)


def summary(model: type[Spec]) -> str:
    """The first sentence of a model's docstring, as Markdown."""
    return re.split(r"(?<=\.) (?=[A-Z`])|\n", about(model))[0]


def kinds_of(element: str) -> dict[str, Any]:
    """Facts by ``type`` of a ``joint``, ``spring`` or ``drive``; none of others."""
    return {tag: kind.facts for tag, kind in KINDS.get(f"{element}s", {}).items()
            if hasattr(kind, "facts")}


def recorded_by(element: str, quantity: str) -> list[str]:
    """The kinds of an element that record a quantity, such as ``pin``, ``pin with limits``."""
    kinds = kinds_of(element).items()
    return [tag for tag, each in kinds if quantity in each.records] + [
        f"{tag} with {'dry friction' if field == 'friction' else field}" for tag, each in kinds
        for field, names in getattr(each, "more", {}).items() if quantity in names]


def owners(element: str, quantity: str) -> str:
    """The elements that record a quantity: ``joint``, ``drive: motor, brake``."""
    having = recorded_by(element, quantity)
    lacking = [tag for tag in kinds_of(element)
               if tag not in having and f"{tag} with limits" not in having]
    whole = "pair of bodies" if element == "pair" else element
    if not lacking and not any(" " in word for word in having):
        return whole
    return f"{whole} except {', '.join(lacking)}" if 2 * len(lacking) < len(having) \
        else f"{whole}: {', '.join(having)}"


GUIDED = {"tension": ("tension_0", "tendon with guide friction"),
          "slip": ("slip_1", "tendon with guide friction"),
          "lifted": ("lifted_1", "tendon that can lift off a wheel")}
"""Quantities of tendons that end in a number: an example of each, and the tendons that have it."""


class QuantityRow(NamedTuple):
    """A quantity that a run records; ``about`` is Markdown."""

    element: str  # kind of element, such as joint
    owner: str  # the elements that have it
    name: str
    unit: str
    about: str


def quantity_rows() -> Iterator[QuantityRow]:
    """Every quantity that a run can record; a unit that depends on the kind names the kinds."""
    by_unit: dict[str, list[str]] = {}
    of_springs = " or ".join(si_unit(each.dimension) for each in kinds_of("spring").values())
    for tag, each in kinds_of("drive").items():
        by_unit.setdefault(each.unit or of_springs, []).append(tag)
    of_drives = "; ".join(f"{unit} ({', '.join(tags)})" for unit, tags in by_unit.items())
    for element, names in QUANTITIES.items():
        for name, each in names.items():
            unit = each.unit or (of_drives if element == "drive" else "; ".join(
                f"{facts.friction_unit} ({tag})" for tag, facts in kinds_of("joint").items()
                if name in facts.more.get("friction", ())))
            yield QuantityRow(element, owners(element, name), name, unit, each.about)
    for name, each in GRASP.items():
        yield QuantityRow("body", "object", name, each.unit, each.about)
    for word, (name, holder) in GUIDED.items():
        yield QuantityRow("tendon", holder, name, NUMBERED[word].unit, NUMBERED[word].about)
    for name, each in BOND_QUANTITIES.items():
        yield QuantityRow("", "joint, spring, tendon", name, each.unit, each.about)


Schema = dict[str, Any]


class _Schemas(GenerateJsonSchema):
    """Without discriminators, a keyword of OpenAPI that JSON Schema does not have."""

    def tagged_union_schema(self, schema: core_schema.TaggedUnionSchema) -> Schema:
        return {"oneOf": super().tagged_union_schema(schema)["oneOf"]}


DRAFT = "https://json-schema.org/draft/2020-12/schema"


def scene_schema() -> Schema:
    """The JSON Schema of a scene's file."""
    schema = described(Scene)
    definitions, properties = schema["$defs"], schema["properties"]
    for model in [schema, *definitions.values()]:
        for entry in model.get("properties", {}).values():
            _compose_entries(entry)
    definitions["Assembly"]["properties"]["parameters"] = COMPOSED["parameters"]
    definitions["Composed"] = {
        "type": "object", "properties": COMPOSED,
        "anyOf": [{"required": [word]} for word in ("like", "repeat", "include")],
        "description": "An entry that is expanded before the scene is read."}
    for key in ("templates", "parameters"):
        properties[key].pop("patternProperties", None)
    properties["templates"]["additionalProperties"] = {"type": "object"}
    properties["parameters"]["propertyNames"] = {"pattern": f"^{IDENTIFIER.pattern}$"}
    properties["parameters"]["additionalProperties"] = {"anyOf": [
        {"type": "number"}, {"type": "string"}]}
    return {"$schema": DRAFT, **schema, "title": "A scene of sandbox"}


def described(top: type[Spec]) -> Schema:
    """The JSON Schema of a model and of all that it holds, with its docstrings as descriptions."""
    schema: Schema = top.model_json_schema(schema_generator=_Schemas)
    waiting: list[type[BaseModel]] = [Spec]
    while waiting:
        model = waiting.pop()
        waiting += model.__subclasses__()
        target = schema if model is top else schema.get("$defs", {}).get(model.__name__)
        keys = {name: field.alias or name for name, field in model.model_fields.items()}
        if target is None or {*keys.values()} != {*target["properties"]}:
            continue  # not part of the schema; another class may have the same name
        for field, text in descriptions(model).items():
            entry = target["properties"][keys[field]]
            units = entry.get("description", "")  # of a number
            entry["description"] = f"{text} {units}".strip()
    return schema


def descriptions(model: type[BaseModel]) -> dict[str, str]:
    """The docstrings of the fields of a model and its bases, by field; ``type`` has a default."""
    found = {field: text for base in reversed(model.__mro__)
             if issubclass(base, BaseModel) and base is not BaseModel
             for field, text in docstrings(base).items()}
    if "type" in model.model_fields:
        tag, = get_args(model.model_fields["type"].annotation)
        found.setdefault("type", f'Which kind it is: always ``"{tag}"``.')
    return found


def docstrings(model: type) -> dict[str, str]:
    """The string below each field of a class, by field; none where its source is unavailable."""
    found = {}
    body = _classes(model.__module__).get(model.__qualname__.rpartition(".")[2], [])
    for field, after in pairwise(body):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and (
            isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
            and isinstance(after.value.value, str)
        ):
            found[field.target.id] = inspect.cleandoc(after.value.value)
    return found


@cache
def _classes(module: str) -> dict[str, list[ast.stmt]]:
    """The statements of each class of a module, by its name; none without its source."""
    try:
        tree = ast.parse(inspect.getsource(sys.modules[module]))
    except (OSError, TypeError):
        return {}
    return {node.name: node.body for node in ast.walk(tree) if isinstance(node, ast.ClassDef)}


COMPOSED: Schema = {
    "like": {"type": "string", "description": "Name of a template whose keys this entry takes "
             "and overrides with its own, object by object; lists are replaced whole."},
    "repeat": {
        "description": "Number of copies, counted by i from 0; a number, an expression, or an "
                       "object.",
        "anyOf": [{"type": "integer", "minimum": 1}, {"type": "string", "pattern": "^ *="},
                  described(Repeat)]},
    "include": {"type": "string", "description": "The name of a scene in the same folder, which "
                                                 "becomes an assembly."},
    "parameters": {"type": "object", "description": "Of an assembly: numbers for its "
                   "expressions, before those of the scene that it includes."},
}
"""Keys that composition removes."""


def _compose_entries(schema: Any) -> None:
    """Let the entries of a list be composed, and those of lists in it, such as a hole's corners."""
    items = schema.get("items") if isinstance(schema, dict) else None
    if not isinstance(items, dict) or "prefixItems" in schema:
        return
    _compose_entries(items)
    schema["items"] = {"anyOf": [items, {"$ref": "#/$defs/Composed"}]}
    schema.pop("minItems", None)  # one entry may expand to several
