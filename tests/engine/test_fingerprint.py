"""Compiled code must be thrown away when any of its sources changes."""

from __future__ import annotations

import ast
from pathlib import Path

from sandbox.engine import advance, fingerprint, forces


def test_the_fingerprint_follows_every_byte_of_every_file(tmp_path: Path):
    first, second = tmp_path / "a.py", tmp_path / "b.py"
    first.write_text("x = 1")
    second.write_text("y = 2")
    before = fingerprint._hash(first, second)
    second.write_text("y = 3")
    assert fingerprint._hash(first, second) != before
    assert fingerprint._hash(second, first) != fingerprint._hash(first, second)


def test_kernels_that_call_other_files_are_keyed_by_it():
    """Numba's cache key holds what a function's enclosing scope gives it, and its own file."""
    for kernel in (advance.advance, forces.apply_forces):
        cells = [cell.cell_contents for cell in kernel.py_func.__closure__]
        assert fingerprint.KERNELS in cells


def test_the_fingerprint_covers_every_file_with_compiled_code():
    folder = Path(fingerprint.__file__).parent
    compiled = {
        path.name for path in folder.glob("*.py")
        if "@njit" in path.read_text() or "@intrinsic" in path.read_text()
        or "intrinsic(" in path.read_text()
    }
    assert compiled <= set(fingerprint._FILES)


def taken_from_elsewhere(source: str) -> list[str]:
    """Compiled functions that are kept by their own file alone, and what they take from others.

    Those with an enclosing scope read the fingerprint, those put in line are kept with their
    callers. Annotations count for nothing: the types of arguments are a part of what Numba keys.
    """
    tree = ast.parse(source)
    others = {alias.asname or alias.name for node in tree.body if isinstance(node, ast.ImportFrom)
              and (node.module or "").startswith("sandbox") for alias in node.names}
    found = []
    for function in tree.body:
        if not isinstance(function, ast.FunctionDef) or not any(
                "njit" in (text := ast.unparse(one)) and "inline" not in text
                for one in function.decorator_list):
            continue
        names = {node.id for statement in function.body for node in ast.walk(statement)
                 if isinstance(node, ast.Name)}
        found += [f"{function.name}: {name}" for name in sorted(names & others)]
    return found


def test_no_kernel_is_kept_while_what_it_takes_from_elsewhere_changes():
    folder = Path(fingerprint.__file__).parent
    assert [f"{path.name}: {fault}" for path in sorted(folder.glob("*.py"))
            for fault in taken_from_elsewhere(path.read_text())] == []


def test_a_kernel_that_would_be_kept_is_found():
    source = ("from sandbox.engine.forces import apply_forces\n"
              "@njit(cache=True)\ndef step(x: apply_forces):\n    apply_forces(x)\n"
              "@njit(cache=True, inline='always')\ndef other(x):\n    apply_forces(x)\n")
    assert taken_from_elsewhere(source) == ["step: apply_forces"]
