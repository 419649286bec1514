"""All verification cases, and the report of them: a table, plots and the numbers."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.draw.figure.panels import save_panels
from sandbox.verification.cases import CASES, Case
from sandbox.verification.cases.case import CaseResult, carry_out
from sandbox.verification.writing import anchor, cell, check_data, each, versions

INDEX, NUMBERS = "index.md", "results.json"
ABLE = """# Verification

After this page you can say how near sandbox comes to a closed form that you know: find the case
that is most like your mechanism, and read what it compares and how far off it is.
"""
SHOWN = "free_closing", """
The picture is one of these cases: a finger closes freely for 0.06 s. Lines are an integration of
its three angles that the engine has no part in, circles are the engine. Below is the largest
difference, at three steps: half the step leaves a quarter of the error.
"""
"""The case whose picture stands at the top, and what it shows."""
HEAD = """
Every case holds the engine against something that it has no part in: an equation of the paper, a
closed form, an independent integration. Each says its equation, what is run, what is compared, how
far it may be off and why that much. This page is written by `sandbox verify`; the test suite runs
the same cases.

The table names all cases. Its fourth column is the largest error of a case as a share of what is
allowed: 100 % is the limit. The equations are those of *An Underactuated Multi-finger Grasping
Device*, in the form that `sandbox.mechanics` has them, with its misprints put right. Problems that
others posed have a page of their own: [published benchmarks](benchmarks.md).
"""


def verify(
    cases: Sequence[Case] = CASES, *, progress: Callable[[float], None] | None = None,
) -> list[CaseResult]:
    """Carry out cases, in order."""
    return each(cases, carry_out, progress)


def write_report(results: Sequence[CaseResult], directory: Path) -> list[str]:
    """Write the table, the plots and the numbers; the files' names.

    Raises:
        OutputError: they cannot be written.
    """
    files = []
    for result in results:
        if result.panels:
            save_panels(directory / picture(result.case), result.panels)
            files.append(picture(result.case))
    for name, text in ((INDEX, report(results)), (NUMBERS, numbers(results))):
        write_atomic(directory / name, text)
    return [INDEX, NUMBERS, *files]


def picture(case: Case) -> str:
    """File name of a case's plot."""
    return f"{case.name}.png"


def conclusion(results: Sequence[CaseResult]) -> str:
    """One sentence."""
    passed, missing = sum(r.ok for r in results), sum(bool(r.missing) for r in results)
    text = f"{passed} of {len(results)} cases hold"
    return text + (f"; {missing} could not be computed." if missing else ".")


def numbers(results: Sequence[CaseResult]) -> str:
    """All numbers as JSON."""
    data = {"versions": versions(), "cases": [result_data(result) for result in results]}
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def result_data(result: CaseResult) -> dict[str, Any]:
    """A result as JSON data; what is no number is null."""
    case = result.case
    return {"name": case.name, "title": case.title, "equations": case.equations,
            "mechanism": case.mechanism, "compares": case.compares, "ok": result.ok,
            "missing": result.missing, "checks": [check_data(check) for check in result.checks]}


def report(results: Sequence[CaseResult]) -> str:
    """The page, as Markdown."""
    named = ", ".join(f"{name} {number}" for name, number in versions().items())
    lines = [_opening(results), f"**{conclusion(results)}** ({named})", "",
             "| case | equation | checks | nearest to its limit | verdict |",
             "|---|---|---|---|---|"]
    for result in results:
        title = result.case.title
        lines.append(f"| [{title}](#{anchor(title)}) | {cell(result.case.equations)} | "
                     f"{len(result.checks)} | {_worst(result)} | {_verdict(result)} |")
    for result in results:
        lines += ["", *_section(result)]
    return "\n".join(lines) + "\n"


def _opening(results: Sequence[CaseResult]) -> str:
    """What stands above the table; the picture only where its case was computed."""
    name, words = SHOWN
    shown = [f"\n![{r.case.title}]({picture(r.case)})\n{words}"
             for r in results if r.panels and r.case.name == name]
    return "".join([ABLE, *shown, HEAD])


def _section(result: CaseResult) -> list[str]:
    case = result.case
    lines = [f"## {case.title}", "", f"**{case.equations}**  ", f"Run: {case.mechanism}.  ",
             f"Compared: {case.compares}."]
    if result.missing:
        return [*lines, "", result.missing]
    lines += ["", "| what | unit | expected | engine | off by | allowed | why so much | |",
              "|---|---|---|---|---|---|---|---|"]
    lines += [f"| {cell(c.what)} | {'' if c.unit == '1' else c.unit} | {c.expected:.6g} | "
              f"{c.found:.6g} | {c.off:.1e} | {c.allowed:.1e} | {cell(c.why)} | "
              f"{'pass' if c.ok else '**FAIL**'} |" for c in result.checks]
    if result.panels:
        lines += ["", f"![{case.title}]({picture(case)})"]
    return lines


def _worst(result: CaseResult) -> str:
    used = [c.off / c.allowed if c.allowed else math.inf * c.off for c in result.checks]
    if not used or not np.isfinite(used).all():
        return "–"
    return f"{100 * max(used):.0f} %" if max(used) > 0.01 else "< 1 %"


def _verdict(result: CaseResult) -> str:
    return result.missing or ("pass" if result.ok else "**FAIL**")
