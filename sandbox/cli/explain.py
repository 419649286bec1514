"""``sandbox explain``: the reference of scenes in the terminal."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import fields
from typing import Any, NamedTuple, get_args

import click

from sandbox.audit.audit import CHECKS, advice_on
from sandbox.cli.console import Console
from sandbox.cli.options import title_of
from sandbox.codes import CODES
from sandbox.elements.element import NAMED, tag_of
from sandbox.scene import reference
from sandbox.scene.document import Scene, registered
from sandbox.scene.layers import LAYERS
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.limits import Limits
from sandbox.values.expressions import CONSTANTS, FUNCTIONS
from sandbox.values.spec import Spec
from sandbox.wording import meant

WIDTH = 100  # of the text, in characters, or that of the terminal if it is narrower
ONE_LINE = 90  # characters of an example on one line
TABLES = ("limits", "layers", "functions")  # topics that are no element
EVERYDAY = {
    "play": "backlash", "hinge": "pin", "revolute": "pin", "slider": "slot", "prismatic": "slot",
    "cord": "tendons", "cable": "tendons", "string": "tendons", "pulley": "guides",
    "wheel": "guides", "wire": "tendons", "damper": "springs", "spring": "springs",
    "torsion spring": "rotary", "clamp": "weld", "axle": "pin", "bearing": "pin",
    "joint": "joints", "drive": "drives", "weight": "mass", "phalanx": "finger",
    "phalange": "finger", "grasp": "held", "grip": "held", "object": "role",
    "differential": "rocker_tree", "contact": "contacts", "contact force": "normal",
    "end stop": "stop", "endstop": "stop", "stopper": "stop", "expectation": "expect"}
"""Common words, and the names that scenes have for them."""


class _Element(NamedTuple):
    """An element of a scene, and where it is written."""

    topic: str  # heading of the reference
    name: str  # such as ``drives.motor`` or ``tendons.guides``
    key: str  # under which it stands; empty if there are several
    tag: str  # its ``type``, or empty
    model: type[Spec]

    def names(self) -> set[str]:
        parts = self.name.split(".")
        ends = {".".join(parts[i:]) for i in range(len(parts))}
        return (ends | {self.key, self.model.__name__.lower()}) - {""}

    def field_names(self) -> set[str]:
        return {field.alias or key for key, field in self.model.model_fields.items()}


def explain(names: tuple[str, ...]) -> None:
    """Print the explanations of names, or all names by topic."""
    blocks = [_explained(name) for name in names] or [_overview()]
    Console().say(*[line for block in blocks for line in ("", *block)][1:])


def _explained(name: str) -> list[str]:
    word = name.strip().lower()
    word = EVERYDAY.get(word, word)
    models, quantities, scenes = [*elements()], [*reference.quantity_rows()], shipped_scenes()
    found = [each for each in models if word in each.names()]
    found = [each for each in found if each.name == word] or found
    blocks = [_element_lines(found[0]) if len(found) == 1 else
              _definitions((each.name, reference.summary(each.model)) for each in found)]
    blocks.append(_quantities((row.name, row.unit, f"{row.about} ({row.owner})")
                              for row in quantities
                              if word in (row.name, f"{row.element}.{row.name}")))
    if word in TABLES or word in FUNCTIONS:
        blocks.append(_table("functions" if word in FUNCTIONS else word))
    if word in CODES:
        about, page = CODES[word]
        blocks.append(_definitions([(word, f"{about} See docs/{page}.")]))
    if word in CHECKS:
        advice = advice_on(word)
        blocks.append(_definitions([(word, f"A consistency check: {CHECKS[word].asks} If it warns: "
                                     f"{advice.means}. What to do: {advice.do}.")]))
    owners = [each.name for each in models if word in each.field_names()]
    if owners and not found:
        blocks.append([f"{word} is a field of {', '.join(owners)}. 'sandbox explain {owners[0]}' "
                       "prints it."])
    if word in scenes:
        blocks.append([f"{word} is a shipped scene: {title_of(scenes[word])}. 'sandbox run {word}' "
                       "runs it."])
    if not any(blocks):
        known = [*TABLES, *(each for element in models for each in sorted(element.names())),
                 *(row.name for row in quantities), *FUNCTIONS, *EVERYDAY, *CODES, *CHECKS]
        raise click.BadParameter(f"there is no element or quantity {name!r}.{meant(word, known)} "
                                 "'sandbox explain' lists them.", param_hint="NAME")
    return [line for block in blocks if block for line in ("", *block)][1:]


def _overview() -> list[str]:
    groups: dict[str, list[str]] = {}
    for each in elements():
        groups.setdefault(each.topic, []).append(each.name)
    for row in reference.quantity_rows():
        owner = row.owner if row.owner == "object" else row.element or "released connection"
        groups.setdefault(f"{owner.capitalize()} quantities", []).append(row.name)
    return [*_definitions((group, ", ".join(names)) for group, names in groups.items()),
            "", f"Also: {', '.join(TABLES)}, fields, scenes and codes of messages. "
            "'sandbox explain NAME' prints one."]


def elements() -> Iterator[_Element]:
    """All elements, in the order of the reference."""
    places: dict[type[Spec], tuple[str, str]] = {Scene: ("scene", "")}
    waiting: list[type[Spec]] = [Scene]
    for model in waiting:  # the outermost place of each model
        above = "" if model is Scene else f"{places[model][0]}."
        for name, field in model.model_fields.items():
            key = field.alias or name
            for used in _models(field.annotation):
                if used not in places:
                    places[used] = (f"{above}{key}.{tag_of(used)}".rstrip("."), key)
                    waiting.append(used)
    topics = {**reference.ELEMENTS, **reference.PARTS, "Your own": registered()}
    for topic, models in topics.items():
        for model in models:
            place = (re.sub(r"(?<=[a-z])(?=[A-Z])", "_", model.__name__).lower(), "")
            if topic != reference.VALUES:
                place = places.get(model, place)
            yield _Element(topic, *place, tag_of(model), model)


def _models(annotation: Any) -> Iterator[type[Spec]]:
    if isinstance(annotation, type) and issubclass(annotation, Spec):
        yield annotation
    for inner in get_args(annotation):
        yield from _models(inner)


def _element_lines(each: _Element) -> list[str]:
    width = click.HelpFormatter(max_width=WIDTH).width
    names = {one.model.__name__: one.name for one in elements()}
    lines = click.formatting.wrap_text(_plain(f"{each.name}: {reference.about(each.model)}"), width,
                                       preserve_paragraphs=True).splitlines()
    lines += ["", "Fields", *_definitions((f"  {row.key}", "; ".join(filter(None, (
        _type(row.type, names), row.default if row.default in ("", "required", "as below") else
        f"default {row.default}"))) + f". {row.meaning}")
        for row in reference.field_rows(each.model))]
    if text := example(each):
        lines += ["", "Example", *(f"  {line}" for line in text.splitlines())]
    one = NAMED[each.key].one if each.key in NAMED and each.name.startswith(each.key) else ""
    recorded = []
    for row in reference.quantity_rows():
        if one and row.element == one and (not reference.kinds_of(one) or any(
                kind.split()[0] == each.tag for kind in reference.recorded_by(one, row.name))):
            # of units such as ``N m (pin); N (slot)`` that of this kind
            unit = next((unit for unit, kinds in re.findall(r"([^;(]+) \(([^)]*)\)", row.unit)
                         if each.tag in kinds.split(", ")), row.unit).strip()
            recorded.append((row.name, unit, row.about + (
                " (of an object)" if row.owner == "object" else "")))
    return [*lines, *(["", "Quantities", *_quantities(recorded)] if recorded else [])]


def example(each: _Element) -> str:
    """The shipped entry with the most keys on one line, or the shortest; empty for none."""
    keys, found = each.field_names(), dict[str, dict[str, Any]]()
    waiting = [("", json.loads(path.read_text(encoding="utf-8")))
               for path in shipped_scenes().values()] if each.key else []
    for key, value in waiting:
        if isinstance(value, list):
            waiting += [(key, entry) for entry in value]
        elif isinstance(value, dict):
            waiting += value.items()
            if key == each.key:
                waiting += [(key, entry) for entry in value.values() if isinstance(entry, dict)]
                if value.keys() <= keys and value.get("type", "") == each.tag:
                    found[json.dumps(value, ensure_ascii=False)] = value
    short = [text for text in found if len(text) <= ONE_LINE]
    if short or not found:
        return max(short, key=lambda text: (len(found[text]), -len(text)), default="")
    return json.dumps(found[min(found, key=len)], indent=2, ensure_ascii=False)


def _table(word: str) -> list[str]:
    if word == "limits":
        described = reference.docstrings(Limits)
        title, rows = "Limits of a scene; --limit NAME=VALUE changes one.", {
            each.name: f"{each.default}. {' '.join(described[each.name].split())}"
            for each in fields(Limits)}
    elif word == "layers":
        title = "Layers of pictures; --show of 'sandbox render' and view.show select them."
        rows = {name: ("" if layer.default else "(not by default) ") + layer.about
                for name, layer in LAYERS.items()}
    else:
        arguments = {1: "x", 2: "y, x", 3: "x, low, high", None: "a, b, …"}
        title = "Functions of expressions, as in '=2 * sin(pi * t)'; scenes add tables."
        rows = {"functions": ", ".join(f"{name}({arguments[each.arguments]})"
                                       for name, each in FUNCTIONS.items()),
                "constants": ", ".join(CONSTANTS),
                "choice": "a if condition else b; and, or, not, <, <=, >, >=, ==, !="}
    return [title, "", *_definitions((f"  {name}", text) for name, text in rows.items())]


def _quantities(rows: Iterable[tuple[str, str, str]]) -> list[str]:
    return _definitions((f"  {name}", f"[{unit}] {about}" if unit != "1" else about)
                        for name, unit, about in rows)


def _definitions(rows: Iterable[tuple[str, str]]) -> list[str]:
    formatter = click.HelpFormatter(max_width=WIDTH)
    if plain := [(term, _plain(text)) for term, text in rows]:
        formatter.write_dl(plain, col_max=26)
    return formatter.getvalue().rstrip("\n").splitlines()


def _type(text: str, names: dict[str, str]) -> str:
    """A type as JSON has it: objects, with the name that explains them, instead of classes."""
    text = re.sub(r"\[(\w+)\]\([^)]+#\w+\)", lambda link: (
        f"object ({names.get(link[1], f'{link[1]}s')})"), text)
    return text.replace(") or object (", ", ").replace("list of object", "list of objects")


def _plain(text: str) -> str:
    """Markdown as plain text: links by their words."""
    return re.sub(r"\[([^\]]+)\]\([^)]+\)", r"\1", text).replace("`", "")
