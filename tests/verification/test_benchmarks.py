"""Published benchmarks at steps that are quick to run, and with a fault planted in each."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

from sandbox.study.orders import EXACT
from sandbox.verification.benchmarks import BENCHMARKS, Benchmark
from sandbox.verification.benchmarks.benchmark import BenchmarkRuns, carry_out, spoken
from sandbox.verification.benchmarks.page import (
    ABLE,
    HEAD,
    NUMBERS,
    PAGE,
    PICTURE,
    SHOWN,
    page,
    picture,
    result_data,
)
from sandbox.verification.cases import CASES
from sandbox.verification.writing import anchor

KEPT = Path(__file__).parents[2] / "docs" / "verification"
TESTED = [pytest.param(one, id=one.name) for one in BENCHMARKS if one.tested]


@pytest.mark.parametrize("benchmark", TESTED)
def test_benchmark_holds(benchmark: Benchmark) -> None:
    result = carry_out(benchmark, benchmark.tested)
    assert result.checks
    assert [check for check in result.checks if not check.ok] == []


@pytest.mark.parametrize("benchmark", TESTED)
def test_a_fault_is_noticed(benchmark: Benchmark) -> None:
    """A mass or a length that is a hundredth off, say: at the finer of the tested steps."""
    assert benchmark.fault
    result = carry_out(benchmark, benchmark.tested[-1:], overrides=benchmark.fault)
    assert not result.ok


@pytest.mark.parametrize("benchmark", BENCHMARKS, ids=lambda one: one.name)
def test_each_says_what_it_is(benchmark: Benchmark) -> None:
    for said in (benchmark.problem, benchmark.source, benchmark.differs,
                 *(one.why for one in benchmark.criteria)):
        assert said
    assert len(benchmark.steps) == 3
    assert list(benchmark.steps) == sorted(benchmark.steps, reverse=True)
    assert not benchmark.drawn or benchmark.criteria[0].order == 2
    for one in benchmark.criteria:
        assert one.digits
        assert one.allowed(benchmark.steps[-1]) > 0
        assert one.floor > 0 or one.order != EXACT


def test_names_are_unique() -> None:
    names = [one.name for one in (*CASES, *BENCHMARKS)]
    assert len(set(names)) == len(names)
    assert len({one.title for one in BENCHMARKS}) == len(BENCHMARKS)


def test_kept_page_is_of_these_benchmarks() -> None:
    """Its numbers may differ in the last digits from machine to machine; its verdicts not."""
    kept = json.loads((KEPT / NUMBERS).read_text(encoding="utf-8"))["benchmarks"]
    assert [one["name"] for one in kept] == [one.name for one in BENCHMARKS], "run sandbox verify"
    assert all(one["ok"] for one in kept)
    assert [one["steps"] for one in kept] == [list(one.steps) for one in BENCHMARKS]
    text = (KEPT / PAGE).read_text(encoding="utf-8")
    assert text.startswith(
        f"{ABLE}\n![Error against step]({PICTURE})\n{SHOWN}{HEAD}\n**"), "run sandbox verify"
    heads = re.findall(r"^## (.+)$", text, re.MULTILINE)
    assert heads == [one.title for one in BENCHMARKS], "run sandbox verify"
    assert set(re.findall(r"\]\(#([^)]+)\)", text)) == {anchor(head) for head in heads}
    for name in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text):
        assert (KEPT / name).exists()


def runs(*errors: float) -> BenchmarkRuns:
    """The first benchmark as if it had come out so at its steps."""
    benchmark = BENCHMARKS[0]
    one = replace(benchmark.criteria[0], scale=1.0, rate=1e3)
    return BenchmarkRuns(replace(benchmark, criteria=(one,)), benchmark.steps, (errors,),
                         ([0.0] * len(one.digits),))


def test_too_large_an_error_fails_and_so_does_too_low_an_order() -> None:
    fine = runs(1e-1, 2.5e-2, 6.25e-3)
    assert fine.ok
    assert fine.orders(0) == pytest.approx([2.0, 2.0])
    assert not runs(4.1, 1.025, 0.25625).ok
    slow = runs(4e-2, 2e-2, 1e-2)
    assert [check.what.split()[0] for check in slow.checks if not check.ok] == ["order", "order"]
    assert "**FAIL**" in page([slow])
    nothing = runs(math.nan, 1e-3, 1e-4)
    assert not nothing.ok
    assert result_data(nothing)["checks"][0]["found"] is None


def test_what_is_exact_has_no_order() -> None:
    one = replace(runs(1e-9, 2e-9, 1e-9).benchmark.criteria[0], order=EXACT, floor=1e-8)
    found = runs(1e-9, 2e-9, 1e-9)
    exact = replace(found, benchmark=replace(found.benchmark, criteria=(one,)))
    assert exact.ok
    assert "| exact |" in page([exact])
    assert not picture([replace(exact, benchmark=replace(exact.benchmark, drawn=""))]).curves
    assert not replace(exact, errors=((1e-9, 2e-8, 1e-9),)).ok


@pytest.mark.parametrize(("seconds", "said"), [
    (1.2345, "1.23 s"), (0.25, "0.25 s"), (0.05, "50 ms"), (5e-4, "0.5 ms"), (5e-5, "50 µs"),
    (1e-6, "1 µs")])
def test_times_are_spoken(seconds: float, said: str) -> None:
    assert spoken(seconds) == said
