"""Published benchmarks at steps that are quick to run, and with a fault planted in each."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from sandbox.verification.benchmarks import BENCHMARKS, Benchmark
from sandbox.verification.benchmarks.benchmark import BenchmarkRuns, carry_out
from sandbox.verification.benchmarks.page import (
    page,
    result_data,
)

TESTED = [pytest.param(one, id=one.name) for one in BENCHMARKS if one.tested]


@pytest.mark.parametrize("benchmark", TESTED)
def test_benchmark_holds(benchmark: Benchmark) -> None:
    result = carry_out(benchmark, benchmark.tested)
    assert result.checks
    assert [check for check in result.checks if not check.ok] == []


@pytest.mark.nightly
@pytest.mark.parametrize("benchmark", TESTED)
def test_a_fault_is_noticed(benchmark: Benchmark) -> None:
    """A mass or a length that is a hundredth off, say: at the finer of the tested steps."""
    assert benchmark.fault
    result = carry_out(benchmark, benchmark.tested[-1:], overrides=benchmark.fault)
    assert not result.ok


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
