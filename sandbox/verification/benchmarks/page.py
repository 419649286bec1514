"""The page of the benchmarks: a table of all, their digits, errors, orders and times."""

from __future__ import annotations

import json
import platform
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.draw.figure.panels import Curve, Panel, save_panels
from sandbox.study.orders import EXACT
from sandbox.verification.benchmarks import BENCHMARKS, Benchmark
from sandbox.verification.benchmarks.benchmark import BenchmarkRuns, carry_out, spoken
from sandbox.verification.writing import anchor, as_number, cell, check_data, each, versions

PAGE, NUMBERS, PICTURE = "benchmarks.md", "benchmarks.json", "benchmarks.png"
ABLE = """# Published benchmarks

After this page you can compare sandbox with another program: on problems that others posed and
whose digits they published, it says what error is left at which step, and in what time.
"""
SHOWN = """
Each line is such a problem of smooth motion, computed at three steps. To the left the step is
finer: half the step leaves a quarter of the error. The dashed line is what is allowed.
"""
"""What is said of the picture."""
HEAD = """
Each problem is built as a scene and held against published digits or closed forms. This page is
written by `sandbox verify`; the test suite runs the same scenes at some of the steps, and with a
planted fault in each, which has to be noticed.

Poses of a run belong to the middle of its steps; they are read at the instants of the digits by the
cubic of the four nearest samples. An error is the largest of all digits of its kind. Allowed is
scale · (h · rate)^order: the rate is the fastest in the mechanism, the scale how far what is
compared has gone, or what its phase has lost, so that the tolerance is the problem's own and not
fitted. The order is log(e₁/e₂) / log(h₁/h₂) of two steps. A blow, a slip or a turn falls somewhere
in its step, so that what follows is known to first order; such errors do not fall evenly, and a
dash stands for their order. Times are CPU times of the steps alone, compiled, without samples, the
least of up to five runs. All settings but the step are the defaults.
"""


def measure(
    benchmarks: Sequence[Benchmark] = BENCHMARKS, *,
    progress: Callable[[float], None] | None = None,
) -> list[BenchmarkRuns]:
    """Carry benchmarks out at the steps of their page, timed, in order."""
    return each(benchmarks, partial(carry_out, timed=True), progress)


def write_page(results: Sequence[BenchmarkRuns], directory: Path) -> list[str]:
    """Write the page, its picture and its numbers; the files' names.

    Raises:
        OutputError: they cannot be written.
    """
    panel = picture(results)
    if panel.curves:
        save_panels(directory / PICTURE, [panel])
    for name, text in ((PAGE, page(results)), (NUMBERS, numbers(results))):
        write_atomic(directory / name, text)
    return [PAGE, NUMBERS, *([PICTURE] if panel.curves else [])]


def conclusion(results: Sequence[BenchmarkRuns]) -> str:
    """One sentence."""
    return f"{sum(r.ok for r in results)} of {len(results)} benchmarks hold."


def numbers(results: Sequence[BenchmarkRuns]) -> str:
    """All numbers as JSON."""
    data = {"versions": versions(), "benchmarks": [result_data(result) for result in results]}
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def result_data(result: BenchmarkRuns) -> dict[str, Any]:
    """A result as JSON data."""
    benchmark = result.benchmark
    return {"name": benchmark.name, "title": benchmark.title, "ok": result.ok,
            "steps": list(result.steps), "seconds": [as_number(s) for s in result.seconds],
            "checks": [check_data(check) for check in result.checks]}


def picture(results: Sequence[BenchmarkRuns]) -> Panel:
    """Errors over their scale against the step over the fastest motion, of what is smooth."""
    curves, reach = [], [np.inf, 0.0]
    for result in results:
        one = result.benchmark.criteria[0]
        if not result.benchmark.drawn:
            continue
        x = one.rate * np.array(result.steps)
        curves.append(Curve(result.benchmark.drawn, x, np.array(result.errors[0]) / one.scale,
                            "joined"))
        reach = [min(reach[0], x.min()), max(reach[1], x.max())]
    if curves:
        ends = np.array(reach)
        curves.append(Curve("allowed: (h · rate)²", ends, ends**2, "dashed"))
    return Panel("Error of smooth motion", "step · fastest rate [1]", "error / scale [1]", curves,
                 scale="log")


def page(results: Sequence[BenchmarkRuns]) -> str:
    """The page, as Markdown."""
    named = ", ".join(f"{name} {number}" for name, number in versions().items())
    shown = f"\n![Error against step]({PICTURE})\n{SHOWN}" if picture(results).curves else ""
    lines = [f"{ABLE}{shown}{HEAD}",
             f"**{conclusion(results)}** ({named}, {platform.machine()})", "",
             "| benchmark | what | finest step | error | order | CPU time | verdict |",
             "|---|---|---|---|---|---|---|"]
    for result in results:
        title = result.benchmark.title
        first, last = f"[{title}](#{anchor(title)})", "pass" if result.ok else "**FAIL**"
        rest = [f"{cell(one.what)} | {spoken(result.steps[-1])} | "
                f"{_size(result.errors[i][-1], 1)} {_unit(one.unit)} | {_order(result, i)[-1]}"
                for i, one in enumerate(result.benchmark.criteria)]
        lines += [f"| {first} | {rest[0]} | {_time(result, -1)} | {last} |",
                  *(f"| | {row} | | |" for row in rest[1:])]
    for result in results:
        lines += ["", *_section(result)]
    return "\n".join(lines) + "\n"


def _section(result: BenchmarkRuns) -> list[str]:
    benchmark, steps = result.benchmark, [spoken(step) for step in result.steps]
    fault = ", ".join(f"`{path}` = {value:g}" for path, value in benchmark.fault.items())
    lines = [f"## {benchmark.title}", "", f"{benchmark.problem}  ",
             f"Source: {benchmark.source}  ", f"Not as in the source: {benchmark.differs}  ",
             f"A fault that the tests notice: {fault}.", "",
             f"| error at h = | {' | '.join(steps)} | order | allowed at {steps[-1]} | "
             "why so much |",
             "|---|" + len(steps) * "---|" + "---|---|---|"]
    for i, one in enumerate(benchmark.criteria):
        errors = " | ".join(_size(error, 2) for error in result.errors[i])
        lines.append(f"| {cell(one.what)} [{_unit(one.unit) or '1'}] | {errors} | "
                     f"{', '.join(dict.fromkeys(_order(result, i)))} | "
                     f"{one.allowed(result.steps[-1]):.1e} | {cell(one.why)} |")
    times = " | ".join(_time(result, i) for i in range(len(steps)))
    lines += [f"| CPU time | {times} | | | |", "",
              f"| | unit | reference | engine at {steps[-1]} |", "|---|---|---|---|"]
    for one, found in zip(benchmark.criteria, result.found, strict=True):
        lines += [f"| {cell(digit.what)} | {_unit(one.unit)} | {digit.expected:.12g} | "
                  f"{value:.9g} |" for digit, value in zip(one.digits, found, strict=True)]
    return lines


def _size(error: float, digits: int) -> str:
    return f"{error:.{digits}e}" if np.isfinite(error) else "diverges"


def _order(result: BenchmarkRuns, i: int) -> list[str]:
    one = result.benchmark.criteria[i]
    if one.order in (EXACT, None) or not one.steady:
        return ["exact" if one.order == EXACT else "–"]
    return [f"{order:.2f}" for order in result.orders(i)]


def _time(result: BenchmarkRuns, i: int) -> str:
    spent = result.seconds[i] if result.seconds else np.nan
    return spoken(spent) if np.isfinite(spent) else "–"


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit
