"""Mutation test: the near tests must find small faults in a copy of the sources.

The sample is random but reproducible: a fault depends on the seed and its line, not on the rest of
the sources. ``MUTANTS=50 MUTANTS_SEED=2 pytest -s -m nightly tests/test_mutants.py`` tries others.
"""

from __future__ import annotations

import ast
import copy
import faulthandler
import itertools
import math
import os
import random
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import pytest

import sandbox

PACKAGE, ROOT = Path(sandbox.__file__).parent, Path(__file__).parents[1]
COUNT, SEED = int(os.environ.get("MUTANTS", "12")), os.environ.get("MUTANTS_SEED", "1")
SHARE = 0.7  # killed of larger samples; some mutants are equivalent to the original
SIGMAS = 3  # binomial standard deviations by which a sample may be below that
GOLDEN = {"engine", "model", "scene", "samples", "mechanics", "control", "audit"}
VERIFIED = {"equilibria", "mechanics"}
TIME, MEMORY = 900, 6 * 2**30  # limits [s], [bytes]; a mutant that exceeds them is killed
OUT_OF_TIME = "time limit"
OPPOSITES: dict[type[ast.AST], type[ast.AST]] = {
    ast.Lt: ast.GtE, ast.Gt: ast.LtE, ast.Eq: ast.NotEq, ast.In: ast.NotIn, ast.Is: ast.IsNot,
    ast.Add: ast.Sub, ast.Mult: ast.Div, ast.And: ast.Or}
OPPOSITES |= {new: old for old, new in OPPOSITES.items()}
FIELDS_LEFT_OUT = {"annotation", "returns", "decorator_list"}
NODES_LEFT_OUT = (ast.Raise, ast.Assert, ast.JoinedStr)
NO_NUMBERS = (ast.JoinedStr, ast.List, ast.Tuple, ast.Dict, ast.Set, ast.ListComp)


class Mutant(NamedTuple):
    """A replacement of the bytes from ``start`` to ``end`` of a file of the package."""

    file: str
    line: int
    start: int
    end: int
    text: str

    def apply(self, source: bytes) -> bytes:
        return source[:self.start] + self.text.encode() + source[self.end:]

    def show(self) -> str:
        source = (PACKAGE / self.file).read_bytes()
        source = source[:source.find(b"\n", self.end)]
        first = source.rfind(b"\n", 0, self.start) + 1
        before, after = (" ".join(text[first:].decode().split())
                         for text in (source, self.apply(source)))
        return f"{self.file}:{self.line}\n  - {before}\n  + {after}"


def executed(node: ast.AST) -> Iterator[ast.AST]:
    """The nodes below that do something: no annotations, decorators, errors and messages."""
    yield node
    for name, value in ast.iter_fields(node):
        for child in value if isinstance(value, list) else [value]:
            if (isinstance(child, ast.AST) and name not in FIELDS_LEFT_OUT
                    and not isinstance(child, NODES_LEFT_OUT)
                    and getattr(child, "arg", "") != "strict"):
                yield from executed(child)


def fault(node: ast.AST) -> ast.AST | None:
    """A wrong version of a node, if there is one."""
    wrong = copy.copy(node)
    match wrong:
        case ast.UnaryOp(op=ast.Not() | ast.USub()):
            return wrong.operand
        case ast.Compare(ops=[first, *others]):
            wrong.ops = [OPPOSITES[type(first)](), *others]
        case ast.BinOp(op=op) | ast.AugAssign(op=op) | ast.BoolOp(op=op) if type(op) in OPPOSITES:
            if any(isinstance(part, NO_NUMBERS) or isinstance(getattr(part, "value", 0), str)
                   for part in ast.iter_child_nodes(node)):
                return None
            wrong.op = OPPOSITES[type(op)]()
        case ast.Constant(value=bool() | int() | float() as value) if not 0 < value < 1e-100:
            wrong.value = {bool: not value, int: value + 1, float: value * 1.1 or 1.0}[type(value)]
        case _:
            return None
    return wrong


def mutants_of(path: Path) -> Iterator[Mutant]:
    source = path.read_bytes()
    starts = [0, *itertools.accumulate(map(len, source.splitlines(keepends=True)))]
    for node in executed(ast.parse(source)):
        if (wrong := fault(node)) is not None:
            text = ast.unparse(wrong)
            yield Mutant(path.relative_to(PACKAGE).as_posix(), node.lineno,
                         starts[node.lineno - 1] + node.col_offset,
                         starts[node.end_lineno - 1] + node.end_col_offset,
                         text if isinstance(node, ast.stmt) else f"({text})")


def near_tests(file: str) -> list[str]:
    """Tests of the same name first, then those of the package, then whole runs."""
    folder = (Path("tests") / file).parents[-3 if "/" in file else -2]
    tests = [folder / f"test_{Path(file).stem}.py", *([folder] if "/" in file else [])]
    tests += [Path("tests/verification")] * (folder.name in VERIFIED)
    tests += [Path("tests/golden/test_golden.py")] * (folder.name in GOLDEN)
    return [str(path) for path in tests if (ROOT / path).exists()]


def sample(count: int, seed: str) -> list[Mutant]:
    """Equally many of each package; the modules beside the packages count as one."""
    def draw(*place: str) -> float:
        return random.Random(f"{seed} {place}").random()

    packages: dict[str, list[tuple[float, Mutant]]] = {}
    for path in PACKAGE.rglob("*.py"):
        lines = path.read_bytes().splitlines()
        for each in mutants_of(path):
            if near_tests(each.file):
                package = each.file.split("/")[0] if "/" in each.file else ""
                key = draw(each.file, lines[each.line - 1].decode(), each.text)
                packages.setdefault(package, []).append((key, each))
    rounds = itertools.zip_longest(*(sorted(packages[name]) for name in sorted(packages, key=draw)))
    return [pick[1] for pick in itertools.chain(*rounds) if pick][:count]


def first_failure(tree: Path, tests: list[str]) -> str:
    """The test that fails first; empty if all pass."""
    done = subprocess.run(
        ["timeout", "--signal=KILL", str(TIME), "prlimit", f"--as={MEMORY}", sys.executable, "-m",
         "pytest", "-x", "-q", "--tb=no", "--hypothesis-seed=0", *tests],
        cwd=tree, capture_output=True, text=True, check=False, env={"PYTHONPATH": str(tree)} | {
            name: value for name, value in os.environ.items()
            if not name.startswith(("PYTEST", "PYTHONPATH", "NUMBA_CACHE"))})
    failed = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - |$)", done.stdout, re.MULTILINE)
    if done.returncode in (-9, 124, 137):
        return OUT_OF_TIME
    return "" if not done.returncode else failed[1] if failed else done.stdout + done.stderr


def judge(mutant: Mutant, folder: Path) -> str:
    """The test that kills a mutant, and passes without it; empty if none does."""
    tree = folder / f"{Path(mutant.file).stem}_{mutant.start}"
    shutil.copytree(ROOT, tree, ignore=shutil.ignore_patterns(".*", "sandbox", "renders"))
    shutil.copytree(PACKAGE, tree / "sandbox")  # with compiled code, found by its source hash
    path, tests = tree / "sandbox" / mutant.file, near_tests(mutant.file)
    path.write_bytes(mutant.apply(path.read_bytes()))
    killer = first_failure(tree, tests)
    if killer and killer != OUT_OF_TIME:
        shutil.copy2(PACKAGE / mutant.file, path)
        assert not first_failure(tree, ["--lf", *tests]), f"fails without a mutant: {killer}"
    shutil.rmtree(tree)
    return killer


@pytest.mark.nightly
def test_near_tests_kill_mutants(tmp_path: Path) -> None:
    faulthandler.cancel_dump_traceback_later()  # it may take more than two minutes
    mutants = sample(COUNT, SEED)
    with ThreadPoolExecutor(2) as pool:
        killers = list(pool.map(lambda mutant: judge(mutant, tmp_path), mutants))
    for mutant, killer in zip(mutants, killers, strict=True):
        print(f"{mutant.show()}\n  {killer or 'SURVIVED'}")
    deviation = math.sqrt(SHARE * (1 - SHARE) * len(mutants))
    assert sum(map(bool, killers)) >= SHARE * len(mutants) - SIGMAS * deviation
