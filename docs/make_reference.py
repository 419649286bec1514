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
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import WithJsonSchema
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

import sandbox.mechanics as mechanics_package
from sandbox.audit.words import ADVICE, ASKS
from sandbox.kinds.arrays import ARRAYS
from sandbox.kinds.elements import DRIVES, JOINTS, SPRINGS, DriveKind, JointKind, SpringKind
from sandbox.kinds.layers import LAYERS
from sandbox.kinds.quantities import GRASP, LIVE, NUMBERED, QUANTITIES, TIED
from sandbox.scene.document import Assembly, Scene
from sandbox.scene.elements import (
    bodies,
    controllers,
    drives,
    events,
    fluids,
    joints,
    loads,
    settings,
    springs,
    tendons,
)
from sandbox.scene.elements.spec import Spec
from sandbox.scene.library import folder_of, shipped_scenes, wholes
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.parts import finger, section, trees
from sandbox.scene.parts import per_joint as lists
from sandbox.scene.schema import descriptions, scene_schema
from sandbox.scene.values import colours, numbers, planes, shown, signals, tables
from sandbox.scene.values.ranges import ANY, RANGES
from sandbox.scene.values.units import units_of

DOCS = Path(__file__).parent
SCHEMA = DOCS.parent / "scenes" / "scene.schema.json"


def members(union: Any) -> list[type[Spec]]:
    """The models of a discriminated union such as ``Joint``, in its order."""
    return list(get_args(get_args(union)[0]))


PAGES: dict[str, dict[str, list[type[Spec]]]] = {
    "elements.md": {
        "The scene": [Scene, settings.Run, settings.View, settings.Trace,
                      settings.ShownMeter],
        "Bodies": [bodies.Body, *members(bodies.WrittenShape), signals.Path, bodies.Material,
                   settings.ContactRule],
        "Joints": members(joints.Joint),
        "Springs": members(springs.Spring),
        "Tendons": [tendons.Tendon, tendons.Guide],
        "Fluid": [fluids.Line, *members(fluids.Chamber), fluids.Valve],
        "Loads": members(loads.Load),
        "Drives": members(drives.Drive),
        "Values over time": [signals.Ramp, signals.Table, signals.Formula, signals.Constant],
        "Tables": [tables.NamedTable],
        "Controllers": [*members(controllers.Controller), controllers.FingerGeometry],
        "Events": [events.Event],
        "Readings and expectations": [settings.Meter, settings.Expect, settings.Group],
    },
    "parts.md": {
        "Finger": [finger.Finger, finger.FingerSprings, finger.FingerTendon],
        "Trees": [trees.RockerTree, trees.PulleyTree, trees.Leaf],
        "Section": [section.Section],
        "Assembly": [Assembly],
    },
}
BEGIN, END = "<!-- reference: begin {} (docs/make_reference.py) -->", "<!-- reference: end -->"
KINDS: Mapping[str, Mapping[str, JointKind | SpringKind | DriveKind]] = {
    "joint": JOINTS, "spring": SPRINGS, "drive": DRIVES}
SIGNALS = (signals.ForceSignal, signals.TorqueSignal, signals.LengthSignal, signals.AngleSignal,
           signals.SpeedSignal, signals.FlowSignal, signals.PressureSignal, signals.ShareSignal,
           signals.StiffnessSignal, signals.Signal)
ONE_FOR_ALL = (lists.Stiffnesses, lists.Dampings, lists.RotaryDampings, lists.Coordinates,
               lists.Angles, lists.Points, lists.Limits)
"""Lists that one value may stand for."""
CHOICES = {
    bodies.BodyShape: "[shape](elements.md#bodies)", joints.Joint: "[joint](elements.md#joints)",
    springs.Spring: "[spring](elements.md#springs)", drives.Drive: "[drive](elements.md#drives)",
    fluids.Chamber: "[chamber](elements.md#fluid)", loads.Load: "[load](elements.md#loads)",
    controllers.Controller: "[controller](elements.md#controllers)"}
"""Unions with a name of their own, and where their kinds stand."""


def kind(annotation: Any, metadata: tuple[Any, ...] = ()) -> str:
    """What may be written for a field: ``length [m], > 0``."""
    for signal in SIGNALS:
        schema = get_args(signal)[-1]
        if schema in metadata:
            unit = f" [{units_of(schema.dimension)[0]}]" if schema.dimension else ""
            return f"value over time{unit}"
    if planes.SCHEMA in metadata:
        return planes.WORDS.replace("\"all\"", "`\"all\"`")
    if colours.SCHEMA in metadata:
        return "colour"
    if shown.SCHEMA in metadata:
        return shown.WORDS
    if metadata and any(set(get_args(alias)[1:]) <= set(metadata) for alias in ONE_FOR_ALL):
        return f"one for all, or {kind(annotation)}"
    if get_origin(annotation) is Annotated:
        inner, *more = get_args(annotation)
        return next((name for union, name in CHOICES.items() if union == annotation),
                    kind(inner, (*more, *metadata)))
    if get_origin(annotation) in (Union, UnionType):
        return " or ".join(_once(kind(option, metadata)
                                 for option in get_args(annotation) if option is not NoneType))
    if get_origin(annotation) is Literal:
        return ", ".join(f'`{_json(value)}`' for value in get_args(annotation))
    if get_origin(annotation) in (tuple, dict):
        return _collection(annotation)
    if annotation is float:
        return _number(metadata)
    if isinstance(annotation, type) and issubclass(annotation, Spec):
        return f"[{annotation.__name__}]({_page_of(annotation)}#{annotation.__name__.lower()})"
    return {str: _text(metadata), int: "whole number", bool: "true or false"}.get(
        annotation, "any")


def _page_of(model: type[Spec]) -> str:
    return next((page for page, groups in PAGES.items()
                 for models in groups.values() if model in models), "")


def _once(words: Iterator[str]) -> list[str]:
    return list(dict.fromkeys(words))


def _collection(annotation: Any) -> str:
    items = get_args(annotation)
    if get_origin(annotation) is dict:
        return f"object of name: {kind(items[1])}"
    if annotation == numbers.Point:
        return "point [x, y] [m]"
    if items[-1] is Ellipsis:
        return f"list of {kind(items[0])}"
    words = _once(kind(item) for item in items)
    return f"[{', '.join(words)}]" if len(words) > 1 else f"{len(items)} × {words[0]}"


def _number(metadata: tuple[Any, ...]) -> str:
    word = "number"
    for entry in metadata:
        if isinstance(entry, WithJsonSchema):
            text = (entry.json_schema or {}).get("description", "")
            if match := re.match(r"A (.+?) in (.+?);", text):
                word = f"{match[1]} [{match[2]}]"
    if numbers.POSITIVE in metadata or any(getattr(each, "gt", None) == 0 for each in metadata):
        return f"{word}, > 0"
    if numbers.AT_MOST_ONE in metadata:
        return f"{word}, 0 to 1"
    return f"{word}, ≥ 0" if numbers.NOT_NEGATIVE in metadata else word


def _text(metadata: tuple[Any, ...]) -> str:
    named = any(getattr(entry, "pattern", None) == numbers.NAME
                for part in metadata
                for entry in [part, *getattr(part, "metadata", ())])
    return "name" if named else "text"


def _json(value: Any) -> str:
    return f'"{value}"' if isinstance(value, str) else str(value)


def default(field: FieldInfo) -> str:
    """A field's default as a table says it; required fields say so."""
    if field.is_required():
        return "required"
    value = field.get_default(call_default_factory=True)
    if value is PydanticUndefined or value is None or value in ((), {}, ""):
        return ""
    if isinstance(value, Spec):
        return "as below"
    return f"`{_default_text(value)}`"


def _default_text(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return f"[{', '.join(_default_text(entry) for entry in value)}]"
    return f"{value:.6g}" if isinstance(value, (int, float)) else _json(value)


def rows(model: type[Spec]) -> Iterator[str]:
    """The table of a model's fields, those without a default first."""
    yield "| key | what | default | meaning |"
    yield "|---|---|---|---|"
    described = descriptions(model)
    fields = sorted(model.model_fields.items(),
                    key=lambda item: (item[0] != "type", not item[1].is_required()))
    for name, field in fields:
        metadata = tuple(field.metadata)
        said = " ".join(described.get(name, "").split())
        yield (f"| `{field.alias or name}` | {kind(field.annotation, metadata)} "
               f"| {default(field)} | {_plain(said)} |")


def _plain(text: str) -> str:
    """A docstring as Markdown: roles and double backquotes become single ones."""
    text = re.sub(r":\w+:`~?([^`]+)`", r"`\1`", text)
    return text.replace("``", "`").replace("|", "\\|")


def about(model: type[Spec]) -> str:
    """A model's docstring, one paragraph a line."""
    paragraphs = (model.__doc__ or "").strip().split("\n\n")
    return "\n\n".join(_plain(" ".join(paragraph.split())) for paragraph in paragraphs)


def owners(element: str, quantity: str) -> str:
    """The elements that have a quantity: ``joint``, ``drive: motor, brake``."""
    having = _having(element, quantity)
    kinds = KINDS.get(element, {})
    lacking = [tag for tag in kinds if tag not in having and f"{tag} with limits" not in having]
    whole = "pair of bodies" if element == "pair" else element
    if not lacking and not any(" " in word for word in having):
        return whole
    return f"{whole} except {', '.join(lacking)}" if 2 * len(lacking) < len(having) \
        else f"{whole}: {', '.join(having)}"


def _having(element: str, quantity: str) -> list[str]:
    """Tags of the kinds that record a quantity."""
    kinds = KINDS.get(element, {}).items()
    always = [tag for tag, kind in kinds if quantity in kind.records]
    for tag, kind in kinds:
        if isinstance(kind, JointKind):
            always += [f"{tag} with limits"] if quantity in kind.stopped else []
            always += [f"{tag} with backlash"] if quantity in kind.loose else []
            always += [f"{tag} with dry friction"] if quantity in kind.rubbed else []
    return always


def drive_units() -> str:
    """The units of the drives' values, each with its kinds."""
    units: dict[str, list[str]] = {}
    of_springs = " or ".join(kind.unit for kind in SPRINGS.values())
    for tag, kind in DRIVES.items():
        units.setdefault(kind.unit or of_springs, []).append(tag)
    return "; ".join(f"{unit} ({', '.join(tags)})" for unit, tags in units.items())


def joint_units(quantity: str) -> str:
    """The units of a quantity of joints that their kind says, each with its kind."""
    return "; ".join(f"{kind.rubs} ({tag})" for tag, kind in JOINTS.items()
                     if quantity in kind.rubbed)


GUIDED = {"tension": ("tension_0", "tendon that guides hold by friction"),
          "slip": ("slip_1", "tendon that guides hold by friction"),
          "lifted": ("lifted_1", "tendon that can lift off a wheel")}
"""Of what tendons have with a number each: one by name, and which tendons those are."""


def quantities() -> Iterator[str]:
    """The table of everything that a run can be asked for."""
    yield "| of a | quantity | unit | what |"
    yield "|---|---|---|---|"
    for element, names in QUANTITIES.items():
        for name, quantity in names.items():
            unit = quantity.unit or (drive_units() if element == "drive" else joint_units(name))
            yield f"| {owners(element, name)} | `{name}` | {unit} | {_plain(quantity.about)} |"
    for name, quantity in GRASP.items():
        yield f"| object | `{name}` | {quantity.unit} | {_plain(quantity.about)} |"
    for word, (name, holder) in GUIDED.items():
        quantity = NUMBERED[word]
        yield f"| {holder} | `{name}` | {quantity.unit} | {_plain(quantity.about)} |"
    for name, quantity in TIED.items():
        yield (f"| joint, spring, tendon | `{name}` | {quantity.unit} | {_plain(quantity.about)} |")


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
            name, tag = model.__name__, _tag(model)
            kind_of = f" `{tag}`" if tag else ""
            yield f"| [{name}](#{name.lower()}){kind_of} | {_first(about(model))} |"


def _tag(model: type[Spec]) -> str:
    """What stands in the ``type`` of an element, if there is one to choose."""
    field = model.model_fields.get("type")
    return str(get_args(field.annotation)[0]) if field else ""


def _first(text: str) -> str:
    """The first sentence of a text."""
    return re.split(r"(?<=\.) (?=[A-Z`])|\n", text)[0]


TABLES: dict[str, dict[str, Callable[[], Iterable[str]]]] = {
    "scenes.md": {"layers": layers, "quantities": quantities},
    "elements.md": {"index": index},
    "audit.md": {"asks": asks, "advice": advice},
    "control.md": {"readable": readable},
    "files.md": {"arrays": arrays},
    "limits.md": {"ranges": ranges},
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
