"""``sandbox explain``: the reference of scenes in the terminal."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import fields
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import click

from sandbox.cli.console import Console
from sandbox.cli.options import elements_option
from sandbox.wording import meant

if TYPE_CHECKING:
    from sandbox.values.spec import Spec

WIDTH = 100
"""Of the text, in characters, or that of the terminal if it is narrower."""
ONE_LINE = 90
"""Characters of an example on one line."""
TABLES = ("limits", "layers")
"""Topics that are no element."""


class _Element(NamedTuple):
    """An element of a scene, and where it is written."""

    topic: str
    """Heading of the reference."""
    name: str
    """Such as ``drives.motor`` or ``tendons.guides``."""
    key: str
    """Key under which it stands; empty if there are several."""
    tag: str
    """Its ``type``, or empty."""
    model: type[Spec]

    def names(self) -> set[str]:
        """Names of it, or of its list."""
        parts = self.name.split(".")
        ends = {".".join(parts[i:]) for i in range(len(parts))}
        return (ends | {self.key, self.model.__name__.lower()}) - {""}


@click.command()
@click.argument("name", required=False)
@elements_option
def explain(name: str | None) -> None:
    """Explain an element, a field group or a quantity.

    NAME is an element such as pin or drives.motor, a list such as joints, a
    block such as run, expect or finger, a quantity such as tension, or limits or
    layers. Prints fields with units and defaults, an example, and the recorded
    quantities. Without NAME lists all by topic.
    """
    console = Console()
    console.result(*(_overview() if name is None else _explained(name)))


def _explained(name: str) -> list[str]:
    """The text about a name.

    Raises:
        BadParameter: an unknown name, with a suggestion.
    """
    from sandbox.scene.reference import quantity_rows

    word = name.strip().lower()
    if word == "limits":
        return _limit_lines()
    if word == "layers":
        return _layer_lines()
    elements = [each for each in _elements() if word in each.names()]
    exact = [each for each in elements if each.name == word]
    elements = exact or elements
    rows = [row for row in quantity_rows() if word in (row.name, f"{row.element}.{row.name}")]
    if not elements and not rows:
        known = [*TABLES, *(each for element in _elements() for each in sorted(element.names())),
                 *(row.name for row in quantity_rows())]
        raise click.BadParameter(f"there is no element or quantity {name!r}.{meant(word, known)} "
                                 "'sandbox explain' lists them.", param_hint="NAME")
    lines = []
    if len(elements) == 1:
        lines = _element_lines(elements[0])
    elif elements:
        lines = _definitions([(each.name, _summary(each)) for each in elements])
    if rows:
        lines += [*([""] if lines else []), *_quantity_lines(
            [(row.name, row.unit, f"{row.about} ({row.owner})") for row in rows])]
    return lines


def _overview() -> list[str]:
    """All elements and quantities by topic."""
    from sandbox.scene.reference import quantity_rows

    topics: dict[str, list[str]] = {}
    for each in _elements():
        topics.setdefault(each.topic, []).append(each.name)
    quantities: dict[str, list[str]] = {}
    for row in quantity_rows():
        quantities.setdefault(row.owner if row.owner == "object" else row.element, []).append(
            row.name)
    return [*_definitions([(topic, ", ".join(names)) for topic, names in topics.items()]),
            "", "Quantities", *_definitions([(f"  {element or 'released connection'}",
                                              ", ".join(names))
                                             for element, names in quantities.items()]),
            "", f"Also: {', '.join(TABLES)}. 'sandbox explain NAME' prints one."]


def _elements() -> list[_Element]:
    """All elements, in the order of the reference."""
    from sandbox.elements.element import tag_of
    from sandbox.scene.document import registered
    from sandbox.scene.reference import ELEMENTS, PARTS, VALUES

    places = _places()
    return [_Element(topic, *(places[model] if model in places and topic != VALUES
                              else (_snake_case(model.__name__), "")), tag_of(model), model)
            for topic, models in {**ELEMENTS, **PARTS, "Your own": registered()}.items()
            for model in models]


def _places() -> dict[type[Spec], tuple[str, str]]:
    """The outermost place of each model: a name such as ``drives.motor``, and the key."""
    from sandbox.elements.element import tag_of
    from sandbox.scene.document import Scene

    found: dict[type[Spec], tuple[str, str]] = {Scene: ("scene", "")}
    waiting: list[type[Spec]] = [Scene]
    for model in waiting:
        above = "" if model is Scene else f"{found[model][0]}."
        for name, field in model.model_fields.items():
            key = field.alias or name
            for used in _models(field.annotation):
                if used not in found:
                    found[used] = (f"{above}{key}.{tag_of(used)}".rstrip("."), key)
                    waiting.append(used)
    return found


def _snake_case(name: str) -> str:
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()


def _models(annotation: Any) -> Iterator[type[Spec]]:
    from sandbox.values.spec import Spec

    if isinstance(annotation, type) and issubclass(annotation, Spec):
        yield annotation
    for inner in get_args(annotation):
        yield from _models(inner)


def _element_lines(each: _Element) -> list[str]:
    """Description, fields, example and quantities of an element."""
    from sandbox.elements.element import NAMED
    from sandbox.scene.reference import about, field_rows, kinds_of, quantity_rows, recorded_by

    lines = []
    for paragraph in about(each.model).split("\n\n"):
        lines += [*_wrapped(paragraph), ""]
    lines[0] = f"{each.name}: {lines[0]}"
    lines += ["Fields", *_definitions([
        (f"  {row.key}", "; ".join(filter(None, (
            _plain(row.type), row.default if row.default in ("", "required", "as below")
            else f"default {_plain(row.default)}"))) + f". {_plain(row.meaning)}")
        for row in field_rows(each.model)])]
    if example := _example(each):
        lines += ["", "Example", *(f"  {line}" for line in example.splitlines())]
    one = NAMED[each.key].one if each.key in NAMED and each.name.startswith(each.key) else ""
    rows = [row for row in quantity_rows() if one and row.element == one and (
        not kinds_of(one) or any(kind.split()[0] == each.tag
                                for kind in recorded_by(one, row.name)))]
    if rows:
        lines += ["", "Quantities", *_quantity_lines(
            [(row.name, _unit_of(row.unit, each.tag),
              row.about + (" (of an object)" if row.owner == "object" else "")) for row in rows])]
    return lines


def _unit_of(units: str, tag: str) -> str:
    """The unit for a kind of element, of units such as ``N m (pin); N (slot)``."""
    return next((unit for unit, kinds in re.findall(r"([^;(]+) \(([^)]*)\)", units)
                 if tag in kinds.split(", ")), units).strip()


def _example(each: _Element) -> str:
    """An entry of this kind in the shipped scenes, as JSON; empty if there is none.

    Of those that fit on a line the one with the most keys, otherwise the shortest.
    """
    from sandbox.scene.library import shipped_scenes

    keys = {field.alias or name for name, field in each.model.model_fields.items()}
    found = []
    for path in shipped_scenes().values():
        waiting = [json.loads(path.read_text(encoding="utf-8"))] if each.key else []
        while waiting:
            entry = waiting.pop()
            inner = list(entry.values()) if isinstance(entry, dict) else entry
            waiting += [value for value in inner if isinstance(value, (dict, list))]
            if isinstance(entry, dict) and each.key in entry:
                value = entry[each.key]
                found += [json.dumps(one, ensure_ascii=False)
                          for one in (value if isinstance(value, list) else
                                      [value, *value.values()] if isinstance(value, dict) else ())
                          if isinstance(one, dict) and one.keys() <= keys
                          and one.get("type", "") == each.tag]
    short = [text for text in found if len(text) <= ONE_LINE]
    text = max(short, key=lambda each: (len(json.loads(each)), -len(each))) if short else \
        min(found, key=len, default="")
    return text if len(text) <= ONE_LINE else json.dumps(
        json.loads(text), indent=2, ensure_ascii=False)


def _limit_lines() -> list[str]:
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.reference import docstrings

    described = docstrings(Limits)
    return ["Limits of a scene; --limit NAME=VALUE changes one.", "", *_definitions([
        (f"  {each.name}", f"{each.default}. {' '.join(described[each.name].split())}")
        for each in fields(Limits)])]


def _layer_lines() -> list[str]:
    from sandbox.scene.layers import LAYERS

    return ["Layers of pictures; --show of 'sandbox render' and view.show select them.", "",
            *_definitions([(f"  {name}", ("" if layer.default else "(not by default) ")
                            + _plain(layer.about)) for name, layer in LAYERS.items()])]


def _quantity_lines(rows: list[tuple[str, str, str]]) -> list[str]:
    return _definitions([(f"  {name}", _plain(f"[{unit}] {about}" if unit != "1" else about))
                         for name, unit, about in rows])


def _definitions(rows: list[tuple[str, str]]) -> list[str]:
    """Terms with wrapped texts beside them."""
    formatter = click.HelpFormatter(max_width=WIDTH)
    formatter.write_dl(rows, col_max=26)
    return formatter.getvalue().rstrip("\n").splitlines()


def _wrapped(text: str) -> list[str]:
    formatter = click.HelpFormatter(max_width=WIDTH)
    return click.formatting.wrap_text(_plain(text), formatter.width).splitlines()


def _summary(each: _Element) -> str:
    from sandbox.scene.reference import summary

    return _plain(summary(each.model))


def _plain(text: str) -> str:
    """Markdown as plain text: links by their words."""
    return re.sub(r"\[([^\]]+)\]\([^)]+\)", r"\1", text).replace("`", "")
