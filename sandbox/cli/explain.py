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
    Console().say(*(_overview() if name is None else _explained(name)))


def _explained(name: str) -> list[str]:
    """The text about a name."""
    from sandbox.scene.reference import quantity_rows, summary

    word = name.strip().lower()
    if word in TABLES:
        return _table(word)
    all_elements, all_rows = list(elements()), list(quantity_rows())
    found = [each for each in all_elements if word in each.names()]
    found = [each for each in found if each.name == word] or found
    rows = [row for row in all_rows if word in (row.name, f"{row.element}.{row.name}")]
    if not found and not rows:
        owners = [each.name for each in all_elements
                  if word in {field.alias or key for key, field in each.model.model_fields.items()}]
        if owners:
            return [f"{word} is a field of {', '.join(owners)}. 'sandbox explain {owners[0]}' "
                    "prints it."]
        known = [*TABLES, *(each for element in all_elements for each in sorted(element.names())),
                 *(row.name for row in all_rows)]
        raise click.BadParameter(f"there is no element or quantity {name!r}.{meant(word, known)} "
                                 "'sandbox explain' lists them.", param_hint="NAME")
    lines = _element_lines(found[0]) if len(found) == 1 else \
        _definitions([(each.name, summary(each.model)) for each in found])
    about = _quantities([(row.name, row.unit, f"{row.about} ({row.owner})") for row in rows])
    return [*lines, *([""] if lines and about else []), *about]


def _overview() -> list[str]:
    """All elements and quantities by topic."""
    from sandbox.scene.reference import quantity_rows

    topics: dict[str, list[str]] = {}
    for each in elements():
        topics.setdefault(each.topic, []).append(each.name)
    quantities: dict[str, list[str]] = {}
    for row in quantity_rows():
        owner = row.owner if row.owner == "object" else row.element or "released connection"
        quantities.setdefault(f"  {owner}", []).append(row.name)
    return [*_definitions([(topic, ", ".join(names)) for topic, names in topics.items()]),
            "", "Quantities",
            *_definitions([(owner, ", ".join(names)) for owner, names in quantities.items()]),
            "", f"Also: {', '.join(TABLES)}. 'sandbox explain NAME' prints one."]


def elements() -> Iterator[_Element]:
    """All elements, in the order of the reference."""
    from sandbox.elements.element import tag_of
    from sandbox.scene.document import Scene, registered
    from sandbox.scene.reference import ELEMENTS, PARTS, VALUES

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
    for topic, models in {**ELEMENTS, **PARTS, "Your own": registered()}.items():
        for model in models:
            place = (re.sub(r"(?<=[a-z])(?=[A-Z])", "_", model.__name__).lower(), "")
            if topic != VALUES:
                place = places.get(model, place)
            yield _Element(topic, *place, tag_of(model), model)


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
    for paragraph in f"{each.name}: {about(each.model)}".split("\n\n"):
        lines += [*click.formatting.wrap_text(
            _plain(paragraph), click.HelpFormatter(max_width=WIDTH).width).splitlines(), ""]
    rows = []
    for row in field_rows(each.model):
        default = row.default if row.default in ("", "required", "as below") else \
            f"default {row.default}"
        rows.append((f"  {row.key}", f"{'; '.join(filter(None, (row.type, default)))}. "
                                     f"{row.meaning}"))
    lines += ["Fields", *_definitions(rows)]
    if text := example(each):
        lines += ["", "Example", *(f"  {line}" for line in text.splitlines())]
    one = NAMED[each.key].one if each.key in NAMED and each.name.startswith(each.key) else ""
    recorded = [row for row in quantity_rows() if one and row.element == one and (
        not kinds_of(one) or any(kind.split()[0] == each.tag
                                for kind in recorded_by(one, row.name)))]
    if recorded:
        lines += ["", "Quantities", *_quantities([
            (row.name, _unit_of(row.unit, each.tag),
             row.about + (" (of an object)" if row.owner == "object" else ""))
            for row in recorded])]
    return lines


def _unit_of(units: str, tag: str) -> str:
    """The unit for a kind of element, of units such as ``N m (pin); N (slot)``."""
    return next((unit for unit, kinds in re.findall(r"([^;(]+) \(([^)]*)\)", units)
                 if tag in kinds.split(", ")), units).strip()


def example(each: _Element) -> str:
    """An entry of this kind in the shipped scenes, as JSON; empty if there is none.

    Of those that fit on a line the one with the most keys, otherwise the shortest.
    """
    from sandbox.scene.library import shipped_scenes

    keys = {field.alias or name for name, field in each.model.model_fields.items()}
    found: list[dict[str, Any]] = []
    waiting = [json.loads(path.read_text(encoding="utf-8"))
               for path in shipped_scenes().values()] if each.key else []
    for entry in waiting:
        inner = entry
        if isinstance(entry, dict):
            value, inner = entry.get(each.key), list(entry.values())
            found += [one for one in (value if isinstance(value, list) else
                                      [value, *value.values()] if isinstance(value, dict) else ())
                      if isinstance(one, dict) and one.keys() <= keys
                      and one.get("type", "") == each.tag]
        waiting += [value for value in inner if isinstance(value, (dict, list))]
    texts = {json.dumps(one, ensure_ascii=False): one for one in found}
    short = [text for text in texts if len(text) <= ONE_LINE]
    if short or not texts:
        return max(short, key=lambda text: (len(texts[text]), -len(text)), default="")
    return json.dumps(texts[min(texts, key=len)], indent=2, ensure_ascii=False)


def _table(word: str) -> list[str]:
    """The limits of scenes, or the layers of pictures."""
    from sandbox.scene.layers import LAYERS
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.reference import docstrings

    if word == "limits":
        described = docstrings(Limits)
        return ["Limits of a scene; --limit NAME=VALUE changes one.", "", *_definitions([
            (f"  {each.name}", f"{each.default}. {' '.join(described[each.name].split())}")
            for each in fields(Limits)])]
    return ["Layers of pictures; --show of 'sandbox render' and view.show select them.", "",
            *_definitions([(f"  {name}", ("" if layer.default else "(not by default) ")
                            + layer.about) for name, layer in LAYERS.items()])]


def _quantities(rows: list[tuple[str, str, str]]) -> list[str]:
    return _definitions([(f"  {name}", f"[{unit}] {about}" if unit != "1" else about)
                         for name, unit, about in rows])


def _definitions(rows: list[tuple[str, str]]) -> list[str]:
    """Terms with wrapped texts beside them."""
    formatter = click.HelpFormatter(max_width=WIDTH)
    if rows:
        formatter.write_dl([(term, _plain(text)) for term, text in rows], col_max=26)
    return formatter.getvalue().rstrip("\n").splitlines()


def _plain(text: str) -> str:
    """Markdown as plain text: links by their words."""
    return re.sub(r"\[([^\]]+)\]\([^)]+\)", r"\1", text).replace("`", "")
