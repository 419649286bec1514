"""Compiled code must be thrown away when any of its sources changes."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest
from numba.core import caching

from sandbox.engine import advance, fingerprint, kernel, native

FOLDER = Path(fingerprint.__file__).parent
SOURCES = {path.name: path.read_text() for path in sorted(FOLDER.glob("*.py"))}
COMPILERS = ("kernel", "inlined", "kept_on_disk", "njit", "jit", "cfunc", "intrinsic")


def test_the_fingerprint_follows_every_byte_of_every_file(tmp_path: Path):
    first, second = tmp_path / "a.py", tmp_path / "b.py"
    first.write_text("x = 1")
    second.write_text("y = 2")
    before = fingerprint._hash(first, second)
    second.write_text("y = 3")
    assert fingerprint._hash(first, second) != before
    assert fingerprint._hash(second, first) != fingerprint._hash(first, second)


def test_what_is_kept_is_keyed_by_it():
    """Numba's cache key holds what a function's enclosing scope gives it, and its own file."""
    for entry in (advance.advance, advance.list_now):
        cells = [cell.cell_contents for cell in entry.py_func.__closure__]
        assert fingerprint.KERNELS in cells


def test_what_cannot_be_kept_is_compiled_all_the_same(monkeypatch: pytest.MonkeyPatch):
    """A read-only installation of a user without a home; a test's own user may write anywhere."""
    def more(x: int) -> int:
        return x + 1

    assert kernel.can_keep(kernel.kept_on_disk(more))
    monkeypatch.setattr(caching.CacheImpl, "_locator_classes", [])
    compiled = kernel.kept_on_disk(more)
    assert compiled(1) == 2
    assert not kernel.can_keep(compiled)


def test_the_fingerprint_covers_every_file_with_compiled_code():
    compiled = {name for name, text in SOURCES.items()
                if any(f"@{one}" in text or f"{one}(" in text for one in COMPILERS)}
    assert compiled <= set(fingerprint._FILES)


def test_the_fingerprint_covers_what_compiled_code_takes_from_elsewhere():
    """Functions, constants and records: of all modules of the package that such a file imports."""
    covered = {f"sandbox.engine.{Path(name).stem}" for name in fingerprint._FILES} | {
        "sandbox.kinds.elements", "sandbox.model.programs"}
    beside = {"sandbox.numeric", "sandbox.engine.fingerprint"}  # annotations; the key itself
    for name in fingerprint._FILES:
        for node in ast.walk(ast.parse(SOURCES[name])):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("sandbox"):
                modules = ([f"{node.module}.{one.name}" for one in node.names]
                           if node.module == "sandbox.engine" else [node.module])
                assert set(modules) <= covered | beside, f"{name}: {modules}"


def decorators(function: ast.FunctionDef) -> list[str]:
    return [ast.unparse(one) for one in function.decorator_list]


def compiled_by(function: ast.FunctionDef) -> list[str]:
    return [text for text in decorators(function) if text.split("(")[0] in COMPILERS]


def kept_carelessly(source: str) -> list[str]:
    """Kept functions that take something from elsewhere, or from their own file, without the key.

    That is: not from an enclosing function that is given the fingerprint. Annotations count for
    nothing: the types of arguments are a part of what Numba keys.
    """
    tree = ast.parse(source)
    found = []
    keyed = {inner for outer in tree.body if isinstance(outer, ast.FunctionDef)
             and [one.arg for one in outer.args.args] == ["sources"] for inner in ast.walk(outer)}
    own = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    others = {alias.asname or alias.name for node in tree.body if isinstance(node, ast.ImportFrom)
              and (node.module or "").startswith("sandbox") for alias in node.names}
    for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
        if not (function.name == "note" or any(
                text == "kept_on_disk" or "cache=True" in text for text in compiled_by(function))):
            continue
        names = {node.id for statement in function.body for node in ast.walk(statement)
                 if isinstance(node, ast.Name)}
        if function in keyed:
            if "sources" not in names:
                found.append(f"{function.name}: does not read its key")
            continue
        found += [f"{function.name}: {name}" for name in sorted(names & (others | own))]
    return found


@pytest.mark.parametrize("name", SOURCES)
def test_nothing_is_kept_while_what_it_takes_from_elsewhere_changes(name: str):
    assert kept_carelessly(SOURCES[name]) == []


def test_what_would_be_kept_carelessly_is_found():
    source = ("from sandbox.engine.forces import act\n"
              "@njit(cache=True)\ndef step(x: act):\n    act(x)\n"
              "@kernel\ndef other(x):\n    act(x)\n"
              "@njit(cache=True)\ndef third(x):\n    other(x)\n"
              "def _compiled(sources):\n"
              "    @njit(cache=True)\n    def good(x):\n        assert sources\n        act(x)\n"
              "    @njit(cache=True)\n    def bad(x):\n        act(x)\n    return good, bad\n")
    assert kept_carelessly(source) == [
        "step: act", "third: other", "bad: does not read its key"]


def called_from_python(source: str, kernels: set[str]) -> list[str]:
    """Kernels that plain functions call, which would compile them anew in every process."""
    tree = ast.parse(source)
    found = []
    known = {alias.asname or alias.name for node in tree.body if isinstance(node, ast.ImportFrom)
             and (node.module or "").startswith("sandbox.engine") for alias in node.names}
    known |= {node.name for node in tree.body if isinstance(node, ast.FunctionDef)
              and compiled_by(node)}
    compiled = {inner for function in ast.walk(tree) if isinstance(function, ast.FunctionDef)
                and compiled_by(function) for inner in ast.walk(function)}
    for node in ast.walk(tree):
        if node not in compiled and isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            found += [node.func.id] * (node.func.id in kernels & known)
    return found


def test_python_calls_only_what_is_kept():
    kernels = {function.name for text in SOURCES.values() for function in ast.parse(text).body
               if isinstance(function, ast.FunctionDef) and compiled_by(function)}
    assert {"solve", "list_contacts", "measure"} <= kernels
    package = FOLDER.parent
    assert {str(path.relative_to(package)): names for path in package.rglob("*.py")
            if (names := called_from_python(path.read_text(), kernels))} == {}
    bad = "from sandbox.engine.solve import solve\ndef f():\n    solve(1)\n    solve.py_func(1)\n"
    assert called_from_python(bad, kernels) == ["solve"]


def test_tables_are_made_without_compiling_anything():
    """What Python calls by its ``py_func`` calls no other kernel in turn; wound cords used to."""
    scene = Path(__file__).parents[2] / "scenes" / "pulley_differential.json"
    script = (
        "import sandbox\n"
        "from numba.core import event\n"
        "from sandbox.engine.advance import advance\n"
        "class Told(event.Listener):\n"
        "    def on_start(self, what):\n"
        "        function = what.data['dispatcher'].py_func\n"  # the callback may be compiled here
        "        print(*[function] * function.__module__.startswith('sandbox'))\n"
        "    def on_end(self, what): pass\n"
        "event.register('numba:compile', Told())\n"
        f"sandbox.Simulation(sandbox.load_scene({str(scene)!r}))\n")
    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=600,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}, cwd=root)
    assert done.stdout.split() == []


def test_where_pymunk_keeps_its_contacts_is_a_part_of_the_key():
    """Of another pymunk, with other structs, the kept callback would read somewhere else."""
    cells = [cell.cell_contents for cell in native._note()._pyfunc.__closure__]
    for struct, fields in (("cpArbiter", ("a", "b", "count", "contacts", "n", "processCollision")),
                           ("cpContact", ("r1", "r2", "hash"))):
        assert {native.ffi.offsetof(f"struct {struct}", name) for name in fields} <= set(cells)
    assert native.ffi.sizeof("struct cpContact") in cells
