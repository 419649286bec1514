"""The layers of the package, read off its imports; and that every element type is complete."""

from __future__ import annotations

import ast
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path
from typing import Annotated, Any, NamedTuple, get_args, get_origin

import sandbox
from sandbox.elements.element import tag_of
from sandbox.elements.loads import Load
from sandbox.elements.registry import KINDS, Drive, Joint
from sandbox.elements.springs import Spring
from sandbox.scene.expand import expand
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.load import load_scene

PACKAGE = Path(sandbox.__file__).parent
FLOORS = {
    "errors": 0, "wording": 0, "numeric": 0, "codes": -1,
    "atomic_files": 1, "values": 1, "mechanics": 1,
    "elements": 2,
    "scene": 3,
    "model": 4, "build": 4,
    "samples": 5,
    "audit": 6,
    "recording": 7,
    "figure": 8, "engine": 8,
    "export": 9, "picture": 9, "convergence": 9, "equilibria": 9, "sweeps": 9,
    "web": 10, "notebook": 10, "gym": 10, "search": 10,
    "cli": 12,
}
"""The layer of each package: it imports from itself and from the layers below."""
OWNERS = {"pymunk": "engine", "numba": "engine", "pygame": "picture",
          "matplotlib": "figure picture", "imageio": "picture", "PIL": "picture", "click": "cli",
          "websockets": "web", "gymnasium": "gym"}
"""The packages that may import a library."""
SHOWING = ("_repr_html_", "plot", "picture", "film", "page")
"""Methods of scenes and recordings that import the layers which draw them."""
FRONT = {"__init__", "__main__"}
"""Above every layer."""


class Import(NamedTuple):
    """One import of a module: ``import module`` or ``from module import names``."""

    line: int
    module: str
    names: tuple[str, ...]
    exempt: bool
    """Under ``TYPE_CHECKING``, or in a function that shows a scene or a run."""

    @property
    def loaded(self) -> set[str]:
        """What it loads, if that are modules."""
        return {f"{self.module}.{name}" for name in self.names} or {self.module}


def imports(text: str) -> list[Import]:
    """All imports of a source, those inside functions too."""
    tree = ast.parse(text)
    exempt = {id(node) for block in ast.walk(tree)
              if (isinstance(block, ast.If) and "TYPE_CHECKING" in ast.unparse(block.test))
              or (isinstance(block, ast.FunctionDef) and block.name in SHOWING)
              for child in block.body for node in ast.walk(child)}
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += [Import(node.lineno, alias.name, (), id(node) in exempt)
                      for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            found.append(Import(node.lineno, str(node.module),
                                (*(alias.name for alias in node.names),), id(node) in exempt))
    return found


@cache
def modules() -> dict[str, list[Import]]:
    """The imports of every module of the package by its name."""
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = [PACKAGE.name, *path.relative_to(PACKAGE).with_suffix("").parts]
        name = ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 2 else parts)
        found[name] = imports(path.read_text(encoding="utf-8"))
    return found


def package_of(module: str) -> str:
    return module.split(".")[1]


def faults(package: str, found: list[Import]) -> list[str]:
    """The imports of a module that its layer forbids."""
    wrong = []
    for line, module, names, exempt in found:
        top, *rest = module.split(".")
        if package not in OWNERS.get(top, package).split():
            wrong.append(f"{line}: {top} belongs to sandbox/{OWNERS[top]}")
        for below in (rest[:1] or names if top == "sandbox" else []):
            if below not in {*FLOORS, "__version__"}:
                wrong.append(f"{line}: {below} is a name of the front")
            elif below != package and not exempt and FLOORS.get(below, -1) >= FLOORS[package]:
                wrong.append(f"{line}: sandbox.{below} is no lower layer")
    return wrong


def test_imports_go_to_lower_layers() -> None:
    found = {name: faults(package_of(name), each) for name, each in modules().items()
             if package_of(name) not in FRONT}
    assert {name: each for name, each in found.items() if each} == {}


def test_there_are_no_import_cycles() -> None:
    graph = {name: {one if one in modules() else each.module
                    for each in found if not each.exempt for one in each.loaded}
             & (modules().keys() - {name}) for name, found in modules().items()}
    assert sum(map(len, graph.values())) > 500
    TopologicalSorter(graph).prepare()  # names a cycle in its error


def tags(union: Any) -> list[str]:
    """What ``type`` says of every member of a discriminated union."""
    inner = get_args(union)[0] if get_origin(union) is Annotated else union
    return [tag for kind in get_args(inner) for tag in (
        [get_args(kind.model_fields["type"].annotation)[0]] if isinstance(kind, type)
        else tags(kind))]


def test_every_element_type_is_shown_by_a_scene() -> None:
    scenes = [expand(load_scene(path)) for path in shipped_scenes().values()]
    for field, union in (("joints", Joint), ("springs", Spring), ("loads", Load),
                         ("drives", Drive)):
        shown = {element.type for scene in scenes for element in getattr(scene, field)}
        assert set(tags(union)) - shown == set(), f"no scene in scenes/ shows these {field}"


MADE_OF_ELEMENTS = ("sandbox.scene.parts.", "sandbox.scene.played")
"""Modules that make elements, by their classes."""


def test_no_other_package_names_a_kind_of_element() -> None:
    classes = {kind.__name__ for kinds in KINDS.values() for kind in kinds.values() if tag_of(kind)}
    found: dict[str, list[str]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        room, module = path.relative_to(PACKAGE).parts[0], path.relative_to(PACKAGE.parent)
        name = ".".join(module.with_suffix("").parts)
        if room in ("elements", "build.py") or name.startswith(MADE_OF_ELEMENTS):
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom):
                found.setdefault(room, []).extend(
                    f"{module}:{node.lineno} {alias.name}" for alias in node.names
                    if alias.name in classes and str(node.module).startswith("sandbox.elements"))
            if isinstance(node, ast.Subscript | ast.Compare):
                key = node.slice if isinstance(node, ast.Subscript) else node.left
                if isinstance(key, ast.Attribute) and key.attr == "type":
                    found.setdefault(room, []).append(f"{module}:{node.lineno} .type")
    assert [place for places in found.values() for place in places] == []
