"""Reference texts of the docs, made from the program: elements, quantities, codes, gallery.

The site build puts them in place of marks such as ``<!-- generated: quantities -->``.
``python docs/make_reference.py`` writes ``scenes/scene.schema.json``.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import sandbox.mechanics as mechanics_package
from sandbox.audit.audit import ADVICE, CHECKS
from sandbox.codes import CODES
from sandbox.elements.arrays import ARRAYS
from sandbox.elements.element import tag_of
from sandbox.elements.quantities import BOND_QUANTITIES, LIVE
from sandbox.scene import settings
from sandbox.scene.document import Scene
from sandbox.scene.layers import LAYERS
from sandbox.scene.library import folder_of, scene_topics, shipped_scenes
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.reference import (
    ELEMENTS,
    GUIDED,
    PARTS,
    about,
    field_rows,
    markdown,
    owners,
    quantity_rows,
    scene_schema,
    summary,
)
from sandbox.values.spec import Spec
from sandbox.values.units import RANGES, units_of

DOCS = Path(__file__).parent
SCHEMA = DOCS.parent / "scenes" / "scene.schema.json"


PAGES = {"elements.md": ELEMENTS, "parts.md": PARTS}
MARK = re.compile(r"^<!-- generated: (\w+) -->.*$", re.MULTILINE)
"""Where a page has a generated text."""
COLUMNS = 3
"""Of the gallery."""
ENOUGH = 45
"""Characters: a shorter first sentence of a scene is shown with the next one."""
TOPICS = scene_topics()
TOLD = {folder: f"{folder}.md" for folder in ("hands", "mechanisms")}
"""Folders of scenes that have a page, and which."""


def table(*heads: str, rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """A table in Markdown."""
    yield f"| {' | '.join(heads)} |"
    yield "|---" * len(heads) + "|"
    for cells in rows:
        yield f"| {' | '.join(cells)} |"


def _plain(text: str) -> str:
    """A docstring as Markdown of a table's cell."""
    return markdown(text).replace("|", "\\|")


def fields(model: type[Spec]) -> Iterator[str]:
    """The table of a model's fields."""
    return table("key", "what", "default", "meaning", rows=(
        (f"`{row.key}`", row.type, row.default, _plain(row.meaning))
        for row in field_rows(model)))


def quantities() -> Iterator[str]:
    """The table of the quantities that a run records."""
    return table("of a", "quantity", "unit", "what", rows=(
        (row.owner, f"`{row.name}`", row.unit, _plain(row.about)) for row in quantity_rows()))


def readable() -> Iterator[str]:
    """The table of what controllers and events can read."""
    rows = []
    for element, names in LIVE.items():
        having = {name: owners(element, name).partition(": ")[2] for name in names}
        words = [f"`{name}`" + (f" ({tags})" if tags else "") for name, tags in having.items()]
        rows.append(("pair of bodies" if element == "pair" else element, ", ".join(words)
                     if element != "meter" else "itself, if all that it reads can be read"))
    rows += [(holder, f"`{name}`") for name, holder in GUIDED.values()]
    rows.append(("joint, spring, tendon that can be released",
                 ", ".join(f"`{name}`" for name in BOND_QUANTITIES)))
    return table("of a", "what can be read", rows=rows)


def arrays() -> Iterator[str]:
    """The table of a recording's arrays."""
    return table("array", "shape", "unit", "what", rows=(
        (f"`{row.name}`", ", ".join(map(str, row.axes)), row.unit or "whole number",
         _plain(row.about)) for row in ARRAYS))


def layers() -> Iterator[str]:
    """The table of the layers of pictures."""
    return table("layer", "shown", "for selected bodies", "content", rows=(
        (f"`{name}`", "always" if layer.default else "on request",
         "yes" if layer.per_body else "", _plain(layer.about)) for name, layer in LAYERS.items()))


def asks() -> Iterator[str]:
    """The table of the checks and their questions."""
    return table("check", "question", rows=(
        (f"`{name}`", _plain(check.asks)) for name, check in CHECKS.items()))


def advice() -> Iterator[str]:
    """The table of warnings, their meaning and their remedy."""
    return table("warning", "meaning", "what to do", rows=(
        (", ".join(f"`{name}`" for name in each.figures) or "any other check", each.means, each.do)
        for each in ADVICE))


def ranges() -> Iterator[str]:
    """The table of the ranges of numbers."""
    rows = [(dimension, "1" if dimension == "ratio" else units_of(dimension)[0],
             f"{span.minimum:g}", f"{span.maximum:g}") for dimension, span in RANGES.items()
            if dimension is not None]
    rows.append(("any other, such as a parameter or a gain", "", "", f"{RANGES[None].maximum:g}"))
    return table("numbers of", "unit", "least of a size", "most of a magnitude", rows=rows)


def mechanisms() -> Iterator[str]:
    """The scenes of ``scenes/mechanisms``: picture, what they show, what is expected and why."""
    for name, scene in _scenes("mechanisms").items():
        yield from _shown(name, scene)


def hands() -> Iterator[str]:
    """The scenes of ``scenes/hands``: those that are whole, then those that they include.

    In the order of the paper's figures, as their ``about`` names them; then what is not of it.
    """
    scenes = _scenes("hands")
    figures = {name: _figure(scenes[name]["about"]) for name in wholes("hands")}
    whole = sorted(figures, key=lambda name: (not figures[name], figures[name], name))
    yield from ("| figure | scene | |", "|---|---|---|")
    for name in whole:
        title = scenes[name]["title"]
        yield f"| {figures[name]} | `{name}` | [{title}](#{_anchor(title)}) |"
    yield ""
    for name in whole:
        yield from _shown(name, scenes[name])
    yield from ("### What they are made of", "", "| `include` | |", "|---|---|")
    for name, scene in scenes.items():
        if name not in whole:
            yield f"| `{name}` | {_cell(scene['about'])} |"


def wholes(folder: str) -> list[str]:
    """The shipped scenes of a folder that no other of them includes."""
    scenes = _scenes(folder)
    included = set(re.findall(r'"include": "([^"]+)"', json.dumps(scenes)))
    return [name for name in scenes if name not in included]


def _figure(about: str) -> str:
    """The paper's figure that a hand is after, such as ``2a-b``; nothing of others."""
    found = re.search(r"\bFigures? (\d[a-g]?(?:-[a-g])?)", about)
    return found[1] if found else ""


def _scenes(folder: str) -> dict[str, Any]:
    """What is written of each shipped scene of a folder, by name."""
    return {name: json.loads(path.read_text(encoding="utf-8"))
            for name, path in shipped_scenes().items() if folder_of(path) == folder}


def _shown(name: str, scene: Mapping[str, Any]) -> Iterator[str]:
    yield from (f"### {scene['title']}", "", f"`sandbox run {name}`", "",
                f"![{scene['title']}](../renders/gallery/{name}.png)", "",
                _cell(scene["about"]), "",
                "| expected | value | because |", "|---|---|---|")
    for expect in scene["expect"]:
        key = next((word for word in settings.STATISTICS if word in expect), "quantity")
        statistic = f"at {expect['at']}" if key == "quantity" else key
        yield (f"| {statistic} `{expect[key]}` | {_range(expect)} "
               f"| {_cell(expect['because'])} |")
    yield ""


def _anchor(title: str) -> str:
    """Where a heading is on its page, as GitHub has it."""
    return re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")


def _range(expect: Mapping[str, Any]) -> str:
    """What an expectation asks for, as its scene has it."""
    if "is" in expect:
        return f"`{_bare(expect['is'])}` ± {_bare(expect.get('within', '0.1 %'))}"
    if "between" in expect:
        low, high = expect["between"]
        return f"`{_bare(low)}` to `{_bare(high)}`"
    return ", ".join(f"{word} `{_bare(expect[word])}`" for word in ("above", "below")
                     if word in expect)


def _bare(value: Any) -> str:
    return str(value).removeprefix("=")


def _cell(text: str) -> str:
    """Text in a table, where a stroke would begin another cell and stars would be marks."""
    return text.replace("|", "\\|").replace("*", "\\*")


def equations() -> Iterator[str]:
    """The table of the paper's equations, as ``help(sandbox.mechanics)`` has it."""
    yield from (line for line in (mechanics_package.__doc__ or "").splitlines() if line[:1] == "|")


def index() -> Iterator[str]:
    """The table of all elements of a scene, group by group, each with what it is for."""
    yield "| element, and its `type` | what it is |"
    yield "|---|---|"
    for group, models in PAGES["elements.md"].items():
        yield f"| **[{group}](#{_anchor(group)})** | |"
        for model in models:
            name, tag = model.__name__, tag_of(model)
            kind_of = f" `{tag}`" if tag else ""
            yield f"| [{name}](#{name.lower()}){kind_of} | {summary(model)} |"


def codes() -> Iterator[str]:
    """All codes of diagnostics, each with an anchor."""
    return table("code", "meaning and remedy", rows=(
        (f'<a id="{code}"></a>`{code}`', meaning + (f" [More]({page})." if page else ""))
        for code, (meaning, page) in CODES.items()))


def ungrouped() -> list[str]:
    """Shipped scenes without a topic."""
    grouped = {name for topic in TOPICS for name in topic.scenes}
    return [name for name in shipped_scenes() if name not in grouped]


def sentence(about: str) -> str:
    """The first sentence of what a scene says of itself, and more while it is short."""
    ends = (match.end() for match in re.finditer(r"[.!?](?= [A-Z])", about))
    return about[:next((end for end in ends if end >= ENOUGH), len(about))]


def gallery() -> Iterator[str]:
    """All shipped scenes by topic, each with its picture, first sentence and command."""
    for topic in TOPICS:
        yield from (f"## {topic.title}", "", topic.about, "", *grid(topic.scenes), "")


def grid(names: Sequence[str]) -> Iterator[str]:
    """A table of cells, whose last row is filled up with empty ones."""
    yield "| " * COLUMNS + "|"
    yield "|---" * COLUMNS + "|"
    for first in range(0, len(names), COLUMNS):
        cells = [cell(name) for name in names[first:first + COLUMNS]]
        yield "| " + " | ".join(cells + [""] * (COLUMNS - len(cells))) + " |"


def cell(name: str) -> str:
    """Picture, title, sentence and command of a scene, one below the other."""
    path = shipped_scenes()[name]
    scene = json.loads(path.read_text(encoding="utf-8"))
    title = _escaped(scene["title"])
    folder = folder_of(path)
    shown = f"[{title}]({TOLD[folder]}#{_anchor(scene['title'])})" \
        if folder in TOLD and name in wholes(folder) else title
    return "<br>".join((f"![{title}](../renders/gallery/scenes/{name}.png)", f"**{shown}**",
                        _escaped(sentence(scene["about"])), f"`sandbox run {name}`"))


def _escaped(text: str) -> str:
    """Text in a table, without marks of Markdown."""
    return re.sub(r"([|*_])", r"\\\1", text)


def undescribed() -> set[str]:
    """Models of the scene that no page describes."""
    described = {model for groups in PAGES.values() for models in groups.values()
                 for model in models}
    names = set(Scene.model_json_schema()["$defs"]) | {Scene.__name__}
    return names - {model.__name__ for model in described} - {Mechanism.__name__}


def reference(groups: Mapping[str, Iterable[type[Spec]]], level: str) -> Iterator[str]:
    """The fields of all elements of some groups, below headings."""
    for heading, models in groups.items():
        yield from ("", f"{level} {heading}")
        for model in models:
            yield from ("", f"{level}# {model.__name__}", "", about(model), "", *fields(model))


TABLES: dict[str, Callable[[], Iterable[str]]] = {
    "advice": advice,
    "arrays": arrays,
    "asks": asks,
    "codes": codes,
    "elements": lambda: reference(ELEMENTS, "##"),
    "equations": equations,
    "gallery": gallery,
    "hands": hands,
    "index": index,
    "layers": layers,
    "mechanisms": mechanisms,
    "parts": lambda: reference(PARTS, "###"),
    "quantities": quantities,
    "ranges": ranges,
    "readable": readable,
}
"""Generated texts, by the name in a page's mark."""


def filled(text: str) -> str:
    """A page with its generated texts in place of their marks."""
    return MARK.sub(lambda mark: "\n".join(TABLES[mark[1]]()).strip(), text)


def main(words: list[str] | None = None) -> int:
    """Write or check the JSON Schema of scenes; the exit code."""
    parser = argparse.ArgumentParser(description="Write scenes/scene.schema.json.")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if outdated")
    check = parser.parse_args(words).check
    text = json.dumps(scene_schema(), indent=2, ensure_ascii=False) + "\n"
    outdated = text != SCHEMA.read_text(encoding="utf-8")
    if outdated and not check:
        SCHEMA.write_text(text, encoding="utf-8")
    if outdated:
        sys.stdout.write(f"{SCHEMA.name}: {'is outdated' if check else 'written'}\n")
    return 1 if check and outdated else 0


if __name__ == "__main__":
    sys.exit(main())
