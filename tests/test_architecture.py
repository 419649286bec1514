"""The house's rules: imports run one way, engines stay in their rooms, only the CLI prints.

The rules are read off the source, so that a new module is held to them the
moment it exists.
"""

from __future__ import annotations

import ast
import importlib
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin

import pytest

import sandbox

PACKAGE = Path(sandbox.__file__).parent
TESTS = Path(__file__).parent

FLOORS = {
    "errors": 0, "wording": 0, "numeric": 0, "upper": 0, "pages": 0, "comma": 0,
    "kinds": 1, "whole_files": 1,
    "scene": 2, "mechanics": 2,
    "model": 3, "control": 3, "build": 3,
    "samples": 4,
    "audit": 5,
    "recording": 6,
    "draw": 7, "engine": 7, "export": 7,
    "equilibria": 8, "study": 8, "show": 8, "notebook": 8, "sweeps": 8,
    "paper": 9, "gym": 9, "search": 9,
    "verification": 10, "findings": 10,
    "cli": 11,
}
"""A module imports from its own package and from the floors below it."""
ROOMS = {"pymunk": "engine", "numba": "engine", "pygame": "draw", "matplotlib": "draw",
         "imageio": "draw", "PIL": "draw", "click": "cli",
         "websockets": "show", "gymnasium": "gym"}
"""The one package that may import a library."""
UPWARDS = "upper"
"""The one module that may load upper floors by their names, besides the front."""
FRONT = {"__init__", "__main__"}
"""The package's own front: above every floor."""
LONGEST_FUNCTION = 60
LONGEST_FILE = 450


def sources() -> list[Path]:
    return sorted(PACKAGE.rglob("*.py"))


def room_of(path: Path) -> str:
    """``engine`` for sandbox/engine/world.py, ``errors`` for sandbox/errors.py."""
    inside = path.relative_to(PACKAGE)
    return inside.parts[0] if len(inside.parts) > 1 else inside.stem


def imports_of(path: Path) -> Iterator[tuple[str, int, bool]]:
    """Module, line and whether only type checkers see it, for each import of a file."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for_types = {
        id(node) for test in ast.walk(tree)
        if isinstance(test, ast.If) and "TYPE_CHECKING" in ast.unparse(test.test)
        for child in test.body for node in ast.walk(child)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name, node.lineno, id(node) in for_types
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: write absolute imports"
            yield node.module or "", node.lineno, id(node) in for_types
            if node.module == "sandbox":
                for alias in node.names:
                    yield f"sandbox.{alias.name}", node.lineno, id(node) in for_types


def faults_of(path: Path, room: str) -> list[str]:
    """What a file of ``room`` imports against the rules."""
    faults = []
    for module, line, for_types in imports_of(path):
        parts = module.split(".")
        owner = ROOMS.get(parts[0])
        if owner is not None and owner != room:
            faults.append(f"{path}:{line}: {parts[0]} belongs to sandbox/{owner}/")
        if parts[0] == "sandbox" and len(parts) > 1 and parts[1] not in {*FLOORS, "__version__"}:
            # the front loads what it names from any floor, where nobody would see it
            faults.append(f"{path}:{line}: {room} must not import {module} from the front")
        if parts[0] != "sandbox" or len(parts) == 1 or parts[1] == room or for_types:
            continue
        if parts[1] in FLOORS and FLOORS[parts[1]] >= FLOORS[room]:
            faults.append(f"{path}:{line}: {room} must not import {module}")
    return faults


def test_every_module_has_a_floor():
    rooms = {room_of(path) for path in sources()} - FRONT
    assert rooms <= set(FLOORS)
    assert {"scene", "engine", "draw", "recording", "cli"} <= rooms


@pytest.mark.parametrize("path", [p for p in sources() if room_of(p) not in FRONT],
                         ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_run_one_way(path):
    assert faults_of(path, room_of(path)) == []


@pytest.mark.parametrize(("text", "room"), [
    ("from sandbox.engine.world import World\n", "recording"),
    ("import sandbox.draw.film.camera\n", "engine"),
    ("from sandbox import cli\n", "scene"),
    ("from sandbox import simulate\n", "study"),
    ("def f():\n    import pymunk\n", "draw"),
    ("from pygame import Surface\n", "cli"),
])
def test_the_rules_can_be_broken(tmp_path, text, room):
    path = tmp_path / "module.py"
    path.write_text(text)
    assert len(faults_of(path, room)) == 1


def named_above(path: Path, room: str) -> list[str]:
    """Modules of upper floors whose names stand in a file as texts, to be loaded later."""
    modules = {module_of(each): room_of(each) for each in sources()}
    return [f"{path}:{node.lineno}: {room} must not name {node.value}"
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.Constant) and isinstance(node.value, str)
            and modules.get(node.value, room) not in {room, *FRONT}
            and FLOORS[modules[node.value]] >= FLOORS[room]]


@pytest.mark.parametrize("path", [p for p in sources() if room_of(p) not in {*FRONT, UPWARDS}],
                         ids=lambda p: str(p.relative_to(PACKAGE)))
def test_nothing_is_loaded_upwards_by_its_name(path):
    assert named_above(path, room_of(path)) == []


def test_what_is_loaded_upwards_is_found(tmp_path):
    path = tmp_path / "module.py"
    path.write_text('import_module("sandbox.draw.figure.signals")\n')
    assert len(named_above(path, "recording")) == 1
    assert named_above(path, "cli") == []
    assert len(named_above(PACKAGE / f"{UPWARDS}.py", UPWARDS)) > 3


@pytest.mark.parametrize("room", ["samples", "audit"])
def test_a_room_that_reads_the_model_knows_no_kind_by_its_class(room):
    """What a new joint, spring or drive keeps or gives stands in tables; here nothing is added."""
    specs = {f"sandbox.scene.elements.{kind}" for kind in ("joints", "springs", "drives")}
    assert [f"{path}:{line}" for path in sources() if room_of(path) == room
            for module, line, _ in imports_of(path) if module in specs] == []


def module_of(path: Path) -> str:
    """``sandbox.engine.world`` for sandbox/engine/world.py, ``sandbox.draw`` for its front."""
    parts = [PACKAGE.name, *path.relative_to(PACKAGE).with_suffix("").parts]
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports_between(files: Iterable[Path], name: Callable[[Path], str]) -> dict[str, set[str]]:
    """Of every module the modules that it imports, inside functions too, for types not."""
    modules = {name(path): path for path in files}
    found: dict[str, set[str]] = {}
    for module, path in modules.items():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for_types = {line for _, line, only in imports_of(path) if only}
        wanted = set()
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.lineno not in for_types:
                wanted |= {f"{node.module}.{alias.name}" for alias in node.names}
                if any(f"{node.module}.{alias.name}" not in modules for alias in node.names):
                    wanted.add(node.module or "")
            elif isinstance(node, ast.Import) and node.lineno not in for_types:
                wanted |= {alias.name for alias in node.names}
        found[module] = (wanted & modules.keys()) - {module}
    return found


def rings(imports: dict[str, set[str]]) -> list[list[str]]:
    """Modules that import each other, directly or through others; each ring once."""
    def reached(start: str) -> set[str]:
        seen, waiting = set[str](), [start]
        while waiting:
            for module in imports[waiting.pop()] - seen:
                seen.add(module)
                waiting.append(module)
        return seen

    reach = {module: reached(module) for module in imports}
    found = {tuple(sorted(m for m in reach[module] if module in reach[m]))
             for module in imports if module in reach[module]}
    return [list(ring) for ring in sorted(found)]


def test_no_module_imports_itself_by_way_of_others():
    assert rings(imports_between(sources(), module_of)) == []


def test_a_ring_is_found(tmp_path):
    (tmp_path / "a.py").write_text("def f():\n    from b import g\n")
    (tmp_path / "b.py").write_text("import c\n")
    (tmp_path / "c.py").write_text("from a import f\nimport d\n")
    (tmp_path / "d.py").write_text(
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from c import f\n")
    assert rings(imports_between(tmp_path.glob("*.py"), lambda path: path.stem)) == [
        ["a", "b", "c"]]


@pytest.mark.parametrize("path", [p for p in sources() if room_of(p) != "cli"],
                         ids=lambda p: str(p.relative_to(PACKAGE)))
def test_only_the_command_line_prints(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    prints = [node.lineno for node in ast.walk(tree)
              if (isinstance(node, ast.Call) and ast.unparse(node.func) == "print")
              or (isinstance(node, ast.Attribute)
                  and ast.unparse(node) in {"sys.stdout", "sys.stderr"})]
    assert prints == []


def test_functions_and_files_stay_short():
    long = []
    for path in sources():
        text = path.read_text(encoding="utf-8")
        if (lines := text.count("\n")) > LONGEST_FILE:
            long.append(f"{path}: {lines} lines")
        long += [
            f"{path}:{node.lineno}: {node.name}: {node.end_lineno - node.lineno + 1} lines"
            for node in ast.walk(ast.parse(text))
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
            and node.end_lineno is not None
            and node.end_lineno - node.lineno + 1 > LONGEST_FUNCTION
        ]
    assert long == []


SHARED = {
    "Array": "numeric.py", "Integers": "numeric.py", "Flags": "numeric.py",
    "Records": "numeric.py", "RIGID": "scene/elements/tendons.py",
    "GRAZE": "kinds/elements.py", "LEAST_RADIUS": "kinds/elements.py"}
"""Types and constants that several rooms need, and the one home of each."""


def test_what_several_rooms_need_stands_once():
    homes = [(name.id, str(path.relative_to(PACKAGE))) for path in sources()
             for node in ast.parse(path.read_text(encoding="utf-8")).body
             if isinstance(node, ast.Assign | ast.AnnAssign)
             for name in ast.walk(node) if isinstance(name, ast.Name)
             and isinstance(name.ctx, ast.Store) and name.id in SHARED]
    assert sorted(homes) == sorted(SHARED.items())


def test_nothing_evaluates_text_as_python():
    calls = [f"{path}:{node.lineno}" for path in sources()
             for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
             if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
             and node.func.id in {"eval", "exec", "__import__"}]
    assert calls == []


# --- closed unions: a new kind names every place that does not know it yet


def members(union: Any) -> list[Any]:
    """The models of a discriminated union such as ``Joint``."""
    inner = get_args(union)[0] if get_origin(union) is Annotated else union
    found: list[Any] = []
    for kind in get_args(inner):
        found += [kind] if isinstance(kind, type) else members(kind)
    return found


def names_in(*relative: str) -> set[str]:
    """Every name that the source of some files or packages uses; importing is not using."""
    names: set[str] = set()
    for place in relative:
        path = PACKAGE / place
        for file in [path] if path.suffix else sorted(path.rglob("*.py")):
            tree = ast.parse(file.read_text(encoding="utf-8"))
            names |= {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)}
    return names


def unions() -> dict[str, list[Any]]:
    from sandbox.scene.document import Part
    from sandbox.scene.elements.bodies import Shape
    from sandbox.scene.elements.controllers import Controller
    from sandbox.scene.elements.drives import Drive
    from sandbox.scene.elements.joints import Joint
    from sandbox.scene.elements.loads import Load
    from sandbox.scene.elements.springs import Spring

    return {"Shape": members(Shape), "Joint": members(Joint), "Spring": members(Spring),
            "Load": members(Load), "Drive": members(Drive), "Controller": members(Controller),
            "Part": members(Part)}


def kinds() -> dict[str, list[str]]:
    """Class names of the members of every union."""
    return {union: [model.__name__ for model in models] for union, models in unions().items()}


def tags(union: str) -> list[str]:
    """What ``type`` says of every member of a union."""
    return [get_args(model.model_fields["type"].annotation)[0] for model in unions()[union]]


PLACES = {
    "Shape": [("engine/world.py",), ("draw",), ("export",), ("scene/geometry.py",)],
    "Joint": [("model/compile.py",)],
    "Spring": [("model/compile.py",)],
    "Load": [("model/loads.py",)],
    "Drive": [("model/compile.py",)],
    "Controller": [("control/build.py",)],
    "Part": [("scene/expand.py",)],
}
"""Files that together have to know every kind of a union."""
TABLES = (
    ("draw/film/joints.py", "JOINTS", "Joint"), ("draw/film/drives.py", "DRIVES", "Drive"),
    ("kinds/elements.py", "JOINTS", "Joint"), ("kinds/elements.py", "SPRINGS", "Spring"),
    ("kinds/elements.py", "DRIVES", "Drive"),
)
"""What a room does for every kind: file, its table from a kind's tag, and the union."""
MODEL_ROOMS = ("draw", "paper", "study", "samples", "audit", "recording", "engine", "export",
               "control", "cli")
"""Rooms that tell joints, springs, loads and drives apart by the model and their tables alone."""


def test_the_unions_are_read_whole():
    assert kinds()["Shape"] == ["Circle", "Box", "Polygon", "Capsule", "Polyline"]
    assert kinds()["Part"] == ["Finger", "RockerTree", "PulleyTree", "Section", "Assembly"]
    assert all(len(members) > 1 for members in kinds().values())


@pytest.mark.parametrize(("union", "places"),
                         [(union, places) for union, known in PLACES.items() for places in known])
def test_every_kind_is_known_where_it_has_to_be(union, places):
    known = names_in(*places)
    missing = [kind for kind in kinds()[union] if kind not in known]
    assert missing == [], f"{' and '.join(places)} must handle {', '.join(missing)}"


def test_a_missing_builder_is_named():
    assert "Rope" not in names_in("scene/elements/drives.py")


def table_faults(file: str, table: str, wanted: Iterable[str]) -> list[str]:
    """Kinds that a file's table has no row for, and rows for what is no kind."""
    wanted = set(wanted)
    rows = set(getattr(importlib.import_module(module_of(PACKAGE / file)), table))
    return [*(f"sandbox/{file}: {table} has no row for {kind!r}" for kind in sorted(wanted - rows)),
            *(f"sandbox/{file}: {table} has a row for {row!r}, which is no kind"
              for row in sorted(rows - wanted))]


@pytest.mark.parametrize(("file", "table", "union"), TABLES)
def test_every_kind_has_its_row_in_a_rooms_table(file, table, union):
    assert table_faults(file, table, tags(union)) == []


def test_a_missing_row_is_named():
    assert table_faults("draw/film/joints.py", "JOINTS", [*tags("Joint")[1:], "toggle"]) == [
        "sandbox/draw/film/joints.py: JOINTS has no row for 'toggle'",
        "sandbox/draw/film/joints.py: JOINTS has a row for 'pin', which is no kind"]


def dispatches(path: Path) -> list[str]:
    """Where a file tells elements apart by class or by a comparison of tags."""
    known, found = kinds(), []
    classes = {*known["Joint"], *known["Spring"], *known["Load"], *known["Drive"]}
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        compared = [node.left, *node.comparators] if isinstance(node, ast.Compare) else []
        if (isinstance(node, ast.Name) and node.id in classes) or any(
                isinstance(side, ast.Attribute) and side.attr == "type" for side in compared):
            found.append(f"{path}:{node.lineno}: {ast.unparse(node)}")
    return found


@pytest.mark.parametrize("room", MODEL_ROOMS)
def test_a_room_is_told_by_the_model(room):
    files = [path for path in sources() if room_of(path) == room]
    assert [fault for path in files for fault in dispatches(path)] == []


def test_kinds_are_told_apart_in_few_places():
    """By class or tag: where names become numbers, and where a scene is checked; two a kind or so.

    At first they were 193 for 14 kinds.
    """
    found = [fault for path in sources() for fault in told_apart(path)]
    known = sum(len(kinds()[union]) for union in ("Joint", "Spring", "Drive"))
    assert len(found) < 2.5 * known, found


def told_apart(path: Path) -> list[str]:
    """``isinstance``, ``case`` and comparisons of ``type`` on joints, springs and drives."""
    known, found = kinds(), []
    classes = {*known["Joint"], *known["Spring"], *known["Drive"]}
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        asked = (node.cls if isinstance(node, ast.MatchClass) else
                 node.args[1] if isinstance(node, ast.Call)
                 and ast.unparse(node.func) == "isinstance" else None)
        compared = [node.left, *node.comparators] if isinstance(node, ast.Compare) else []
        compared += [node.subject] if isinstance(node, ast.Match) else []
        if (asked is not None and classes & {
                part.id for part in ast.walk(asked) if isinstance(part, ast.Name)}) or any(
                isinstance(side, ast.Attribute) and side.attr == "type" for side in compared):
            found.append(f"{path}:{node.lineno}")
    return found


def test_a_dispatch_is_found(tmp_path):
    path = tmp_path / "module.py"
    path.write_text("found = isinstance(joint, Pin)\nsame = drive.type == 'pull'\n")
    assert [fault.rpartition(":")[2] for fault in dispatches(path)] == [
        " drive.type == 'pull'", " Pin"]


def test_the_lists_are_those_of_a_mechanism():
    from sandbox.kinds.elements import LISTS
    from sandbox.scene.mechanism import Mechanism

    assert tuple(name for name, field in Mechanism.model_fields.items()
                 if get_origin(field.annotation) is tuple and name != "gravity") == LISTS


def rows_of(union: str) -> dict[str, Any]:
    """The kinds of a union that have a row."""
    from sandbox.kinds import elements

    return dict(getattr(elements, f"{union.upper()}S"))


def test_the_engine_keeps_what_joints_keep():
    from sandbox.engine.tables import KEEPS
    from sandbox.engine.world import CONSTRAINTS

    keeps = {row.keeps for row in rows_of("Joint").values()}
    assert keeps <= set(CONSTRAINTS), "sandbox/engine/world.py: CONSTRAINTS"
    assert keeps <= set(KEEPS), "sandbox/engine/tables.py: KEEPS"


def test_the_engine_sets_what_pymunk_latches():
    """A drive without a row in kinds/elements.py may be one of those: it is asked for, too."""
    known = rows_of("Drive")
    asked = [kind for kind in tags("Drive") if kind not in known or known[kind].latched]
    assert table_faults("engine/inputs.py", "LATCHES", asked) == []


def test_the_engine_knows_what_drives_give():
    """A radius in inputs.py, what is of fluid in fluid_tables.py, all others in tables.py."""
    known = {"force", "torque", "push", "stiffness", "tension", "radius", "flow", "pressure",
             "opening", "surface", "hold"}
    assert {row.gives for row in rows_of("Drive").values()} <= known, "sandbox/engine/tables.py"


@pytest.mark.parametrize("union", ["Joint", "Spring", "Load", "Drive"])
def test_every_kind_is_shown_by_a_scene(union):
    from sandbox.scene.expand import expand
    from sandbox.scene.library import shipped_scenes
    from sandbox.scene.read.load import load_scene

    field = f"{union.lower()}s"
    shown = {element.type for path in shipped_scenes().values()
             for element in getattr(expand(load_scene(path)), field)}
    missing = [kind for kind in tags(union) if kind not in shown]
    assert missing == [], f"no scene in scenes/ shows {missing}"


def test_every_row_names_what_there_is():
    from sandbox.kinds.arrays import ARRAYS
    from sandbox.kinds.elements import DRIVES, JOINTS, NAMED, SPRINGS, TIES
    from sandbox.kinds.quantities import QUANTITIES

    arrays = {row.name for row in ARRAYS}
    assert {quantity.array for rows in QUANTITIES.values()
            for quantity in rows.values()} - {""} <= arrays
    assert {element for element in QUANTITIES if element != "pair"} < {
        row.one for row in NAMED.values()}
    for element, rows in (("joint", JOINTS), ("spring", SPRINGS), ("drive", DRIVES)):
        for row in rows.values():
            assert set(row.records) <= set(QUANTITIES[element])
    targets = [row.target for row in DRIVES.values()]
    targets += [target for row in SPRINGS.values() for target in row.targets]
    assert {target.among for target in targets} <= {*NAMED, TIES}


def test_every_limit_is_an_option():
    import dataclasses

    from sandbox.cli.options import LIMITS
    from sandbox.scene.read.limits import Limits

    assert list(LIMITS) == [field.name for field in dataclasses.fields(Limits)]


def shared_names(files: Iterable[Path]) -> dict[str, set[Path]]:
    """Classes, at the top of their modules, whose name stands in more than one place.

    An underscore before it makes no other name of it.
    """
    found: dict[str, list[Path]] = {}
    for path in files:
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef):
                found.setdefault(node.name.lstrip("_"), []).append(path)
    return {name: set(places) for name, places in found.items() if len(places) > 1}


def test_a_class_has_a_name_of_its_own():
    assert shared_names(sources()) == {}, "one word, one thing"


def test_a_shared_name_is_found(tmp_path):
    (tmp_path / "a.py").write_text("class Beam:\n    pass\n\nclass _Node:\n    pass\n")
    (tmp_path / "b.py").write_text("class Beam:\n    pass\n\nclass Node:\n    pass\n")
    both = {tmp_path / "a.py", tmp_path / "b.py"}
    assert shared_names(sorted(tmp_path.glob("*.py"))) == {"Beam": both, "Node": both}


def test_every_test_file_stands_where_its_subject_stands():
    """tests/engine/test_world.py tests sandbox/engine/world.py; the rest is about several."""
    rooms = {room_of(path) for path in sources()} - FRONT
    strays = [str(path.relative_to(TESTS)) for path in sorted(TESTS.rglob("test_*.py"))
              if path.parent != TESTS
              and path.relative_to(TESTS).parts[0] not in {
                  *rooms, "verification", "scenes", "browser", "hard", "fuzz", "growth"}]
    assert strays == []
