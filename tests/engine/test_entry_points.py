"""Compilation on demand: cached code is never out of date, and is found again when it is not."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from numba.core import caching

from sandbox.engine import entry_points
from sandbox.engine import kernel as kernels
from sandbox.engine.compiling import processors
from sandbox.engine.entry_points import CalledFromPython
from sandbox.engine.kernel import kernel
from sandbox.engine.source_hash import source_hash

STEP = 1


@kernel
def inner(x: int) -> int:
    return x + STEP


def outer(x: int) -> int:
    return inner(x) + inner(2)


PROGRAM = """from __future__ import annotations
import os, sys
from numba.core import caching
from sandbox.engine.entry_points import CalledFromPython
import outside

def f(x: int) -> int:
    return outside.inner(x)

if "kill" in sys.argv:
    caching.IndexDataCacheFile._save_data = lambda *a: os._exit(9)
one = CalledFromPython(f)
print(one(1), outside.inner(1), len(one.compiled.stats.cache_hits))
"""
KERNEL = """
from sandbox.engine.kernel import kernel

@kernel
def inner(x: int) -> int:
    return x + {}
"""


class Program:
    """A compiled function in a folder of its own, run by new processes."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        (folder / "program.py").write_text(PROGRAM)

    def edit(self, number: int) -> None:
        (self.folder / "outside.py").write_text(KERNEL.format(number))

    def start(self, *words: str) -> subprocess.Popen[str]:
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(self.folder / "cache"),
                       "PYTHONDONTWRITEBYTECODE": "1",
                       "PYTHONPATH": os.pathsep.join(filter(None, [
                           str(self.folder), str(Path(entry_points.__file__).parents[2])]))}
        return subprocess.Popen([sys.executable, str(self.folder / "program.py"), *words],
                                env=environment, stdout=subprocess.PIPE, text=True)

    def run(self, *words: str) -> tuple[int, ...]:
        """What compiled code and Python compute, and whether the code was in the cache."""
        with self.start(*words) as process:
            return tuple(map(int, process.communicate()[0].split()))


def test_cached_code_is_never_out_of_date(tmp_path: Path):
    """Numba alone gives 2 after the second edit: the index is written before the data."""
    program = Program(tmp_path)
    program.edit(1)
    assert program.run() == (2, 2, 0)
    program.edit(100)
    assert program.run("kill") == ()
    assert program.run()[:2] == (101, 101)
    program.edit(1)
    assert program.run() == (2, 2, 1), "the code of the first version is found again"


@pytest.mark.nightly
def test_two_processes_with_different_sources_share_a_cache(tmp_path: Path):
    """With Numba alone both may save under the same number, and one loads the other's code."""
    programs = []
    for number in (1, 2):
        (tmp_path / str(number)).mkdir()
        program = Program(tmp_path / str(number))
        program.edit(number)
        (program.folder / "cache").symlink_to(tmp_path / "cache")
        programs.append(program)
    (tmp_path / "cache").mkdir()
    started = [program.start() for program in programs]
    for process in started:
        process.communicate()
    assert [program.run() for program in programs] == [(2, 2, 1), (3, 3, 1)]


FIRST_RUN = """
import sandbox
from sandbox.engine import entry_points

if {alone}:
    entry_points._PROCESSES = 1
run = sandbox.simulate("four_bar")
made = [one.compiled for one in entry_points._entry_points.values() if "compiled" in vars(one)]
loaded = sum(bool(one.cache_hits) for one in made)
print(float(run.arrays["body_pose"].sum()).hex(), loaded, len(made))
"""


@pytest.mark.nightly
@pytest.mark.skipif(processors() == 1, reason="one process compiles everything")
def test_processes_share_the_compilation_of_a_first_run(tmp_path: Path):
    found = []
    for alone in (True, False):
        done = subprocess.run(
            [sys.executable, "-c", FIRST_RUN.format(alone=alone)], check=True, text=True,
            stdout=subprocess.PIPE,
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / str(alone))})
        result, loaded, count = done.stdout.split()
        found.append((result, int(loaded) / int(count)))
    (alone_result, none), (result, share) = found
    assert result == alone_result
    assert none == 0.0
    assert 0.4 < share < 0.8


def test_this_process_does_its_part_where_no_other_may_start(monkeypatch: pytest.MonkeyPatch):
    def refuse(*_words: object, **_options: object) -> None:
        raise BlockingIOError("Resource temporarily unavailable")

    wanted = [SimpleNamespace(name=f"entry_{i}") for i in range(10)]
    monkeypatch.setattr(entry_points, "_missing", list)
    monkeypatch.setattr(entry_points, "subprocess", SimpleNamespace(Popen=refuse, DEVNULL=-3))
    monkeypatch.setattr(entry_points, "processors", lambda: 2)
    monkeypatch.setattr("multiprocessing.parent_process", lambda: None)
    with entry_points._other_processes(wanted) as (others, own):
        assert others == []
        assert own == wanted[::2]


def test_without_entry_points_nothing_is_missing():
    """As with NUMBA_BOUNDSCHECK=1, which makes kernels of them."""
    assert entry_points._missing([]) == []


def other_version(**changes: object) -> str:
    """The hash of ``outer`` after changes of what ``inner`` is made of."""
    source_hash.__globals__["_describe"].cache_clear()
    code, scope = inner.py_func.__code__, dict(globals(), **changes)
    if "code" in changes:
        scratch: dict[str, object] = {}
        exec(str(changes["code"]), scope, scratch)
        code = scratch["inner"].__code__
    copy = kernel(type(outer)(code, scope, "inner"))
    copy.py_func.__qualname__ = "inner"
    scope["inner"] = copy
    return source_hash(type(outer)(outer.__code__, scope, "outer"))


def test_the_source_hash_covers_called_functions_and_constants():
    same = other_version()
    assert other_version(code="def inner(x):\n\n    # a comment\n    return x + STEP") == same
    assert other_version(code="def inner(x):\n    'Add.'\n    return x + STEP") == same
    slices = [other_version(code=f"def inner(x):\n    'Add.'\n    return x[{part}]")
              for part in ("1:", ":1")]
    assert slices[0] != slices[1]
    different = [other_version(STEP=2), other_version(STEP=1.0),
                 other_version(code="def inner(x):\n    return x - STEP"),
                 other_version(code="def inner(x, y=1):\n    return x + STEP")]
    assert len({same, *different}) == 5
    with pytest.raises(TypeError, match="cannot use"):
        other_version(STEP=object())


def test_code_is_compiled_where_nothing_can_be_cached(monkeypatch: pytest.MonkeyPatch):
    """A read-only installation of a user without a home."""
    assert CalledFromPython(outer).cached
    monkeypatch.setattr(caching.CacheImpl, "_locator_classes", [])
    compiled = CalledFromPython(outer)
    assert compiled(1) == 5
    assert not compiled.cached


def test_documented_interfaces_of_numba_suffice(monkeypatch: pytest.MonkeyPatch):
    def changed() -> None:
        raise ImportError

    kernels._tested_compilers.cache_clear()
    monkeypatch.setattr(kernels, "_make_compilers", changed)
    monkeypatch.setattr(caching.CacheImpl, "_locator_classes", [])
    with kernels.fast_compilation():
        assert kernels.kernel_options() == {}
        assert CalledFromPython(outer)(1) == 5
    kernels._tested_compilers.cache_clear()
