"""Write what docs, schema and builders say of elements, quantities, arrays, from the program.

``python docs/make_reference.py`` writes; with ``--check`` it only tells whether
the files are as it would write them.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import sandbox.mechanics as mechanics_package
from sandbox.audit.words import ADVICE, ASKS
from sandbox.codes import CODES
from sandbox.elements.arrays import ARRAYS
from sandbox.elements.element import tag_of
from sandbox.elements.quantities import LIVE, TIED
from sandbox.scene import settings
from sandbox.scene.document import Scene
from sandbox.scene.layers import LAYERS
from sandbox.scene.library import folder_of, shipped_scenes, wholes
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
    summary,
)
from sandbox.scene.schema import scene_schema
from sandbox.values.spec import Spec
from sandbox.values.units import ANY, RANGES, units_of

DOCS = Path(__file__).parent
SCHEMA = DOCS.parent / "scenes" / "scene.schema.json"


PAGES = {"elements.md": ELEMENTS, "parts.md": PARTS}
BEGIN, END = "<!-- reference: begin {} (docs/make_reference.py) -->", "<!-- reference: end -->"


def rows(model: type[Spec]) -> Iterator[str]:
    """The table of a model's fields."""
    yield "| key | what | default | meaning |"
    yield "|---|---|---|---|"
    for row in field_rows(model):
        yield f"| `{row.key}` | {row.type} | {row.default} | {_plain(row.meaning)} |"


def _plain(text: str) -> str:
    """A docstring as Markdown of a table's cell."""
    return markdown(text).replace("|", "\\|")


def quantities() -> Iterator[str]:
    """The table of the quantities that a run records."""
    yield "| of a | quantity | unit | what |"
    yield "|---|---|---|---|"
    for row in quantity_rows():
        yield f"| {row.owner} | `{row.name}` | {row.unit} | {_plain(row.about)} |"


def readable() -> Iterator[str]:
    """The table of what controllers and events can read."""
    yield "| of a | what can be read |"
    yield "|---|---|"
    for element, names in LIVE.items():
        if element == "meter":
            yield "| meter | itself, if what it is made of can be read |"
            continue
        having = {name: owners(element, name).partition(": ")[2] for name in names}
        words = [f"`{name}`" + (f" ({tags})" if tags else "") for name, tags in having.items()]
        yield f"| {'pair of bodies' if element == 'pair' else element} | {', '.join(words)} |"
    for name, holder in GUIDED.values():
        yield f"| {holder} | `{name}` |"
    yield "| joint, spring, tendon that may be let go | " + ", ".join(f"`{n}`" for n in TIED) + " |"


def arrays() -> Iterator[str]:
    """The table of a recording's arrays."""
    yield "| array | shape | unit | what |"
    yield "|---|---|---|---|"
    for row in ARRAYS:
        unit = row.unit or "whole number"
        shape = ", ".join(str(axis) for axis in row.axes)
        yield f"| `{row.name}` | {shape} | {unit} | {_plain(row.about)} |"


def layers() -> Iterator[str]:
    """The table of the layers of pictures."""
    yield "| layer | shown | of some bodies | what |"
    yield "|---|---|---|---|"
    for name, layer in LAYERS.items():
        yield (f"| `{name}` | {'always' if layer.default else 'on wish'} "
               f"| {'yes' if layer.per_body else ''} | {_plain(layer.about)} |")


def asks() -> Iterator[str]:
    """The table of what the figures of the audit ask."""
    yield "| figure | asks |"
    yield "|---|---|"
    for name, asked in ASKS.items():
        yield f"| `{name}` | {_plain(asked)} |"


def advice() -> Iterator[str]:
    """What to think of a figure that asks for a look."""
    yield "| a look at | it means | what to do |"
    yield "|---|---|---|"
    for each in ADVICE:
        figures = ", ".join(f"`{name}`" for name in each.figures) or "any other figure"
        yield f"| {figures} | {each.means} | {each.do} |"


def ranges() -> Iterator[str]:
    """The table of the ranges of numbers."""
    yield "| numbers of | unit | least of a size | most of a magnitude |"
    yield "|---|---|---|---|"
    for dimension, span in RANGES.items():
        unit = "1" if dimension == "ratio" else units_of(dimension)[0]
        yield f"| {dimension} | {unit} | {span.least:g} | {span.most:g} |"
    yield f"| any other, such as a parameter or a gain | | | {ANY.most:g} |"


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
    yield "| code | meaning and remedy |"
    yield "|---|---|"
    for code, (meaning, page) in CODES.items():
        more = f" [More]({page})." if page else ""
        yield f'| <a id="{code}"></a>`{code}` | {meaning}{more} |'


TABLES: dict[str, dict[str, Callable[[], Iterable[str]]]] = {
    "scenes.md": {"layers": layers, "quantities": quantities},
    "elements.md": {"index": index},
    "audit.md": {"asks": asks, "advice": advice},
    "control.md": {"readable": readable},
    "files.md": {"arrays": arrays},
    "limits.md": {"ranges": ranges},
    "messages.md": {"codes": codes},
    "mechanisms.md": {"mechanisms": mechanisms},
    "hands.md": {"hands": hands},
    "api/mechanics/index.md": {"equations": equations},
}
"""Generated tables of a page besides those of its elements."""


def reference(page: str) -> str:
    """The tables of a page's elements."""
    lines: list[str] = []
    level = "##" if page == "elements.md" else "###"
    for heading, models in PAGES[page].items():
        lines += ["", f"{level} {heading}"]
        for model in models:
            lines += ["", f"{level}# {model.__name__}", "", about(model), "", *rows(model)]
    return "\n".join(lines).strip()


def generated(page: str) -> dict[str, str]:
    """All generated parts of a page by name."""
    parts = {name: "\n".join(table()) for name, table in TABLES.get(page, {}).items()}
    return parts | ({"elements": reference(page)} if page in PAGES else {})


def written(page: str) -> str:
    """The whole page with its generated parts made anew."""
    text = (DOCS / page).read_text(encoding="utf-8")
    for name, part in generated(page).items():
        begin = BEGIN.format(name)
        before, found, rest = text.partition(begin)
        _, ended, after = rest.partition(END)
        if not found or not ended:
            raise SystemExit(f"docs/{page} has no part {begin} ... {END}")
        text = f"{before}{begin}\n\n{part}\n\n{END}{after}"
    return text


def undescribed() -> set[str]:
    """Models of the scene that no page describes."""
    told = {model for page in PAGES.values() for models in page.values() for model in models}
    names = set(Scene.model_json_schema()["$defs"]) | {Scene.__name__}
    return names - {model.__name__ for model in told} - {Mechanism.__name__}


def main(words: list[str] | None = None) -> int:
    """Write or check all pages; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if outdated")
    check = parser.parse_args(words).check
    texts = {DOCS / page: written(page) for page in sorted({*PAGES, *TABLES})}
    texts[SCHEMA] = json.dumps(scene_schema(), indent=2, ensure_ascii=False) + "\n"
    outdated = [path for path, text in texts.items() if text != path.read_text(encoding="utf-8")]
    for path in outdated:
        if not check:
            path.write_text(texts[path], encoding="utf-8")
        sys.stdout.write(f"{path.name}: {'is outdated' if check else 'written'}\n")
    return 1 if check and outdated else 0


if __name__ == "__main__":
    sys.exit(main())
