"""Compiled code must be thrown away when any of its sources changes."""

from __future__ import annotations

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
