"""The docs are tested: commands and Python blocks run, scenes load, links resolve.

A ``console`` block has commands (``$ sandbox ...``, with ``# exits 2`` for another exit code than
0; a backslash at the end of a line continues it) and below each of them parts of its output; ``…``
stands for anything. The blocks of a page run in order in one directory. A ``json scene`` block is a
whole scene, written to ``scene.json``; ``tests/golden`` simulates it with its expectations. One
that diverges on purpose is ``json scene diverges``. ``json broken`` is written to ``broken.json``,
``json study`` to ``study.json``. A ``json piece`` must occur in the next whole scene of its page. A
``sh`` block has commands that are too slow or too particular to run here.
"""

from __future__ import annotations

import importlib.util
import json
import re
import shlex
import sys
from dataclasses import fields
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from sandbox.cli.console import COMPILE_TIME
from sandbox.cli.entry import invoke
from sandbox.cli.failures import Exit
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.limits import Limits
from sandbox.scene.schema import descriptions, scene_schema
from sandbox.values.messages import fields_page

from .golden.scenes import WHOLE
from .test_architecture import FLOORS

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted(page for page in (ROOT / "docs").rglob("*.md")
                                     if page.name != "validation.md")]
BLOCK = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
KINDS = {"console", *WHOLE, "json piece", "json broken", "json study", "python", "sh"}
RUN_ELSEWHERE = {
    'python3 -m venv .venv && .venv/bin/pip install . && '
    '.venv/bin/sandbox run scenes/adaptive_grasp.json': ".ci/run",
    'python3 -m venv .venv && .venv/bin/pip install ".[test]" && .venv/bin/pytest -n 2': ".ci/run",
    'python3 -m venv .venv && .venv/bin/pip install -e ".[dev]"': ".ci/run, but not editable",
    "git clone REPOSITORY sandbox && cd sandbox": "whoever has the project has done it",
    ".venv/bin/pytest -n 2 tests/scene": ".ci/run",
    ".venv/bin/pytest -n 2": ".ci/run",
    ".venv/bin/pytest -n 2 -m nightly": "every night",
    ".venv/bin/pytest -q tests/test_architecture.py tests/web/test_packing.py tests/export "
    "tests/scene/test_schema.py": ".ci/run",
    ".ci/release 0.2.0": "by hand",
    ".venv/bin/ruff check . && .venv/bin/mypy": "developers",
    "python -m tests.golden check": "tests/golden/test_golden.py, scene by scene",
    "python -m benchmarks": "tests/test_benchmarks.py, quickly",
    **{f"python -m benchmarks --only {name} --draw docs": "tests/test_benchmarks.py, quickly"
       for name in ("work_precision", "plain_pymunk")},
    "python -m tests.scenes.holding": "tests/scenes/test_hands.py, some of the starts",
    "python -m tests.fuzz --count 200": "tests/fuzz/test_fuzz.py, a share of the inputs",
    "python -m tests.fuzz --recordings --count 200": "tests/fuzz/test_fuzz.py, a share of them",
    "dask scheduler --port 8786 &": "tests/sweeps/test_cluster.py, with a scheduler of its own",
    "dask worker tcp://127.0.0.1:8786 --nworkers 4 --nthreads 1 &": "tests/sweeps/test_cluster.py",
    "sandbox search fit docs/studies/identification.json --data measured.csv":
        "tests/search/test_command.py",
    "python docs/make_reference.py": "tests/scene/test_schema.py",
    "python docs/make_gallery.py": "test_the_gallery_holds_what_the_docs_show",
    ".ci/run": "the project's checks",
    **{f"python docs/studies/{path.stem}.py --out renders/gallery": "tests/test_studies.py, quickly"
       for path in (ROOT / "docs" / "studies").glob("*.py")},
    'sandbox search threshold held_disc --vary "drives[pushed].value=0.5 N:2 N" --keep "x=disc.x" '
    '--keep "y=disc.y" --keep "way==hypot(x, y)" --where "way < 0.2 mm" --within "0.01 N" --set '
    '"expect=[]" --set run.duration=0.4s --set "drives[pushed].direction=[0,1]"':
        "the same along x, above it",
}
"""Every command of a ``sh`` block, and where it is run."""

GENERATED = ROOT / "docs" / "validation.md"
"""Page that the site build writes."""
MEASURED = {*(ROOT / "docs").glob("work_precision_*.png"), *(ROOT / "docs").glob("pymunk_*.png")}
"""Pictures that ``python -m benchmarks --draw docs`` makes."""


def blocks(page: Path) -> list[tuple[str, str]]:
    return BLOCK.findall(page.read_text(encoding="utf-8"))


@cache
def script(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


@cache
def whole(page: Path) -> str:
    """Text of a page with its generated tables, as the site shows it."""
    text: str = script("make_reference").filled(page.read_text(encoding="utf-8"))
    return text


def steps(text: str) -> list[tuple[list[str], int, list[str]]]:
    """Of a console block: the words of each command, its exit code, what it is to print."""
    found: list[tuple[list[str], int, list[str]]] = []
    for line in text.replace("\\\n", "").splitlines():
        if line.startswith("$ "):
            command, _, code = line[2:].partition("  # exits ")
            found.append((shlex.split(command), int(code or 0), []))
        elif line.strip():
            found[-1][2].append(line)
    return found


def fits(said: str, printed: str) -> bool:
    """Whether a line of the docs is somewhere in the output; white space counts for nothing."""
    pieces = [re.escape("".join(piece.split())) for piece in said.split("…")]
    return re.search(".*".join(pieces), "".join(printed.split())) is not None


def run_page(page: Path, capsys: Any) -> int:
    """Run everything on a page, in order; how many blocks there were."""
    found = blocks(page)
    for index, (kind, text) in enumerate(found):
        if kind == "json piece":
            whole = next((other for kind, other in found[index:] if kind in WHOLE), "")
            assert "".join(text.split()) in "".join(whole.split()), text
        elif kind in WHOLE:
            Path("scene.json").write_text(text, encoding="utf-8")
        elif kind == "json broken":
            Path("broken.json").write_text(text, encoding="utf-8")
        elif kind == "json study":
            Path("study.json").write_text(text, encoding="utf-8")
        elif kind == "python":
            exec(compile(text, str(page), "exec"), {"__name__": "__main__"})
        elif kind == "console":
            for words, code, expected in steps(text):
                assert words[0] == "sandbox", words
                capsys.readouterr()
                assert invoke(words[1:]) == code, (words, capsys.readouterr())
                printed = "".join(capsys.readouterr())
                assert [line for line in expected if not fits(line, printed)] == [], printed
    return len(found)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_what_a_page_says_is_so(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    run_page(page, capsys)


def test_a_wrong_claim_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    page = tmp_path / "page.md"
    for claim in ("console\n$ sandbox --version\nsandbox 99\n",
                  "console\n$ sandbox --version  # exits 2\n",
                  "console\n$ sandbox verzion\n",
                  'json piece\n"mass": 2\n```\n```json scene\n{"bodies": []}\n',
                  'json scene\n{"bodies": []}\n```\n```json piece\n"bodies"\n'):
        page.write_text(f"```{claim}```\n", encoding="utf-8")
        with pytest.raises(AssertionError):
            run_page(page, capsys)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_block_is_of_a_known_kind(page: Path) -> None:
    kinds = {kind for kind, _ in blocks(page)}
    assert {kind for kind in kinds if not kind.startswith("{")} <= KINDS  # those are for Sphinx
    for kind, text in blocks(page):
        if kind == "sh":
            assert set(text.splitlines()) <= set(RUN_ELSEWHERE)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", BLOCK.sub("", whole(page))):
        if target.startswith("http"):
            continue
        name, _, anchor = target.partition("#")
        other = (page.parent / name).resolve() if name else page
        if other == GENERATED:
            assert not anchor or anchor in {_anchor(case.title) for case in validation_cases()}
            continue
        assert other.exists(), target
        if anchor:
            heads = re.findall(r"^#+ (.+)$", whole(other), re.MULTILINE)
            assert anchor in {_anchor(head) for head in heads}, target


@cache
def validation_cases() -> list[Any]:
    generator = script("make_validation")
    return [case for module in generator.MODULES for case in generator.cases(module)]


def _anchor(head: str) -> str:
    return re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-")


def test_every_model_of_a_scene_is_described() -> None:
    reference = script("make_reference")
    assert reference.undescribed() == set()
    for page, groups in reference.PAGES.items():
        heads = {_anchor(head) for head in re.findall(
            r"^#+ (.+)$", whole(ROOT / "docs" / page), re.MULTILINE)}
        for model in (model for group in groups.values() for model in group):
            name, _, anchor = fields_page(model).removeprefix("docs/").partition("#")
            assert name == page, model
            assert anchor in heads, model


def test_every_field_of_every_element_is_told() -> None:
    """A sentence, in the table of its element and in the schema that editors show."""
    reference, schema = script("make_reference"), scene_schema()
    for model in (model for page in reference.PAGES.values() for group in page.values()
                  for model in group):
        shown = schema["$defs"].get(model.__name__, schema)["properties"]
        described = descriptions(model)
        for name, field in model.model_fields.items():
            said = described.get(name, "")
            assert len(said.split()) > 1, f"{model.__name__}.{name}"
            assert said.endswith("."), f"{model.__name__}.{name}"
            assert said in shown[field.alias or name]["description"], f"{model.__name__}.{name}"


def test_the_gallery_holds_what_the_docs_show() -> None:
    gallery = script("make_gallery")
    made = {gallery.FOLDER / name for name in gallery.PICTURES}
    shown = {
        (page.parent / target).resolve()
        for page in PAGES
        for target in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", whole(page))
    }
    assert shown == made | MEASURED
    assert all(path.exists() for path in MEASURED)
    kept = {path: path.stat().st_size for path in gallery.FOLDER.rglob("*") if path.is_file()}
    assert set(kept) == made, "run python docs/make_gallery.py"
    small = {path: size for path, size in kept.items() if path.parent.name == "scenes"}
    assert [path.name for path, size in small.items() if size > 20_000] == []
    assert max(kept.values()) < 1_000_000
    assert sum(kept.values()) - sum(small.values()) < 8_000_000


def test_every_scene_has_one_topic_and_is_in_the_gallery() -> None:
    reference = script("make_reference")
    grouped = [name for topic in reference.TOPICS for name in topic.scenes]
    assert sorted(grouped) == sorted(shipped_scenes()), "put it into scenes/topics.toml"
    text = whole(ROOT / "docs" / "gallery.md")
    assert [name for name in grouped if f"`sandbox run {name}`" not in text] == []
    assert set(script("make_gallery").HOW) <= set(grouped)


def test_the_gallery_has_the_first_sentence_of_a_scene() -> None:
    sentence = script("make_reference").sentence
    assert sentence("Figure 1a. One cord has one tension, so that each gets as much. And on.") == (
        "Figure 1a. One cord has one tension, so that each gets as much.")
    assert sentence("A disc.") == "A disc."


def test_every_generated_table_is_shown_once() -> None:
    reference = script("make_reference")
    marks = [mark for page in PAGES for mark in reference.MARK.findall(page.read_text("utf-8"))]
    assert sorted(marks) == sorted(reference.TABLES)


def test_the_limits_are_those_of_the_program() -> None:
    text = (ROOT / "docs" / "limits.md").read_text(encoding="utf-8")
    told = dict(re.findall(r"^\| `(\w+)` \| ([\d ]+) \|", text, re.MULTILINE))
    limits = {field.name: getattr(Limits(), field.name) for field in fields(Limits)}
    assert {name: int(value.replace(" ", "")) for name, value in told.items()} == limits


def test_the_exit_codes_are_those_of_the_program() -> None:
    text = (ROOT / "docs" / "limits.md").read_text(encoding="utf-8")
    told = {int(code) for code in re.findall(r"^\| (\d+) \|", text, re.MULTILINE)}
    assert told == {int(code) for code in Exit}


def test_the_units_are_those_of_the_program() -> None:
    from sandbox.values.units import UNITS

    text = (ROOT / "docs" / "scenes.md").read_text(encoding="utf-8")
    paragraph = text.partition("The units:")[2].partition("- an expression")[0]
    told = {word for group in re.split(r"[;,\n]", paragraph) for word in _units(group.strip())}
    assert told - {""} == {unit for unit in UNITS if unit.isascii()}


def _units(group: str) -> list[str]:
    """One unit, or several single words side by side."""
    from sandbox.values.units import UNITS

    return [group] if group in UNITS or not group else group.split()


def test_the_measures_of_a_grasp_are_explained() -> None:
    from sandbox.elements.quantities import GRASP

    text = (ROOT / "docs" / "grasp.md").read_text(encoding="utf-8")
    rows = text.partition("| quantity |")[2].partition("\n\n")[0]
    assert re.findall(r"^\| `(\w+)` \|", rows, re.MULTILINE) == list(GRASP)


def test_the_objects_of_hands_are_told_and_hung_up() -> None:
    scenes = shipped_scenes()
    objects = [name for name in scenes if name.startswith("object_")]
    text = (ROOT / "docs" / "hands.md").read_text(encoding="utf-8").partition("<!--")[0]
    assert objects
    assert [name for name in objects if f"`{name}`" not in text] == []
    hung = json.loads(scenes["objects"].read_text(encoding="utf-8"))["parts"]
    assert sorted(part["include"] for part in hung) == sorted(objects)


def test_every_kind_without_a_counterpart_is_told() -> None:
    text = (ROOT / "docs" / "export.md").read_text(encoding="utf-8")
    told = text.partition("## What has no counterpart")[2].partition("`--without")[0]
    from sandbox.elements.registry import KINDS as ALL

    facts = [kind.facts for kinds in ALL.values() for kind in kinds.values()
             if hasattr(kind, "facts")]
    without = {value for kind in facts for name, value in vars(kind).items()
               if name.startswith("mujoco") and value}
    assert len(without) > 4
    assert [each for each in without if each not in told] == []


def test_what_has_a_quantity_is_what_the_catalogue_gives_it() -> None:
    owners = script("make_reference").owners
    assert owners("body", "x") == "body"
    assert owners("joint", "reaction") == "joint"
    assert owners("joint", "stop") == "joint: pin with limits"
    assert owners("spring", "torque") == "spring: rotary"
    assert owners("drive", "work") == "drive except stiffness, opening, hold"
    assert owners("drive", "torque") == "drive: motor, brake, servo"


def test_the_head_of_the_contacts_is_that_of_the_file() -> None:
    from sandbox.recording.tables import contact_head

    assert f"`{contact_head()}`" in (ROOT / "docs" / "files.md").read_text(encoding="utf-8")


# --- packages, layers and the paths that pages name

PLACE = re.compile(r"`([\w.]+(?:/[\w.]*)+|\w+\.py)(?:: (\w+))?`")
GUIDES = ("extending.md", "contributing.md")
"""Pages whose places are looked up."""


def lost(text: str) -> list[str]:
    """Paths that lead nowhere, below sandbox/ or the project, and names that are not in them."""
    found = []
    for path, name in PLACE.findall(text):
        place = next((root / path for root in (ROOT / "sandbox", ROOT) if (root / path).exists()),
                     None)
        if place is None:
            found.append(path)
        elif name and not re.search(rf"\b{name}\b", place.read_text(encoding="utf-8")):
            found.append(f"{path}: {name}")
    return found


@pytest.mark.parametrize("page", GUIDES)
def test_every_place_is_where_a_page_says(page: str) -> None:
    text = BLOCK.sub("", (ROOT / "docs" / page).read_text(encoding="utf-8"))
    assert lost(text) == []


def test_a_lost_place_is_found() -> None:
    assert lost("`elements/registry.py: KINDS`, `errors.py`, `engine/`, `tests/test_docs.py`") == []
    assert lost("`elements/pedals.py`, `elements/registry.py: PEDALS`, `machine/`") == [
        "elements/pedals.py", "elements/registry.py: PEDALS", "machine/"]


def test_the_packages_and_layers_are_listed() -> None:
    text = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
    house = text.partition("## Packages")[2].partition("\n## ")[0]
    package = ROOT / "sandbox"
    rooms = {f"{path.parent.relative_to(package).as_posix()}/"
             for path in package.rglob("__init__.py") if path.parent != package}
    assert sorted(re.findall(r"^\| (?:… )?`([\w/]+/)` \|", house, re.MULTILINE)) == sorted(rooms)
    order, = re.findall(r"^`\w+`[^.]*<[^.]*\.$", house, re.MULTILINE)
    assert [re.findall(r"`(\w+)`", floor) for floor in order.split("<")] == [
        sorted(room for room in FLOORS if FLOORS[room] == level)
        for level in sorted(set(FLOORS.values()))]


def test_the_glossary_is_in_order() -> None:
    text = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")
    words = re.findall(r"^\| ([^|]+) \|", text, re.MULTILINE)[2:]
    assert words == sorted(set(words), key=str.casefold)


@pytest.mark.parametrize("page", ["README.md", "docs/start.md"])
def test_how_long_compiling_takes_is_told_as_the_program_tells_it(page: str) -> None:
    assert COMPILE_TIME in " ".join((ROOT / page).read_text(encoding="utf-8").split())
