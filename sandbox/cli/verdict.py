"""How the verdicts on a scene's expectations are told."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

from sandbox.audit.words import ASKS, advice_on
from sandbox.cli.console import table
from sandbox.cli.failures import see

if TYPE_CHECKING:
    from sandbox.audit.audit import Figure
    from sandbox.samples.expectations import Verdict


MOST_ROWS = 12
"""Expectations that are all shown; of more those that hold are counted only."""


def expectation_table(judged: list[Verdict]) -> list[str]:
    """A short table of the verdicts, reasons of failures below, and their count.

    Of more than :data:`MOST_ROWS` those that fail have rows; of what holds the count is enough.
    """
    failed = [v for v in judged if not v.ok]
    shown = judged if len(judged) <= MOST_ROWS else failed
    rows = [
        [v.quantity, v.statistic, _number(v.value), v.allowed, "" if v.unit == "1" else v.unit,
         "pass" if v.ok else "FAIL"]
        for v in shown
    ]
    lines = table(["expectation of", "", "value", "range", "unit", ""], rows,
                  right="<<>") if rows else []
    lines += [f"FAIL {v.quantity}: {v.reason}" for v in failed if v.reason]
    where = "" if shown is judged else "; run.json has them all"
    count = f"{len(judged) - len(failed)} of {len(judged)} expectations hold"
    lines.append(f"{count}{where}")
    lines += see(["expectation-failed"] if failed else [])
    return lines


AUDIT_PAGE = "docs/audit.md"
"""Where every line of the audit is explained."""


def audit_lines(audited: list[Figure], *, whole: bool) -> list[str]:
    """The audit in a line, after what asks for a look; as a table where that is asked for."""
    if whole:
        return audit_table(audited)
    looks = _looks(audited)
    page = f", {AUDIT_PAGE} explains them" if looks else ""
    return [*looks, f"{_count(audited)}; --audit shows them{page}"]


def audit_table(audited: list[Figure]) -> list[str]:
    """A table of an audit's figures; of those that ask for a look what it means, what to do."""
    rows = [
        [f.name, _short(f.value), _short(f.threshold), f.unit, f.verdict, ASKS.get(f.name, "")]
        for f in audited if f.verdict != "not computed"
    ]
    lines = table(["audit", "value", "at most", "unit", "", "it asks:"], rows, right="<>><<<")
    lines += _looks(audited)
    without = [f.name for f in audited if f.verdict == "not computed"]
    if without:
        lines.append(f"not computed, since the scene has none of it or the run kept too little "
                     f"(run.json says which): {', '.join(without)}")
    lines.append(f"{_count(audited)}; {AUDIT_PAGE} explains them")
    return lines


def _looks(audited: list[Figure]) -> list[str]:
    lines = []
    for each in (f for f in audited if f.verdict == "look"):
        advice = advice_on(each.name)
        found = f"{_short(each.value)} {each.unit}".rstrip()
        lines += [f"look {each.name} ({found}, at most {_short(each.threshold)}): {each.why}",
                  f"  it means: {advice.means}",
                  f"  what to do: {advice.do}"]
    return lines


def _count(audited: list[Figure]) -> str:
    computed = [f for f in audited if f.verdict != "not computed"]
    passed = sum(f.verdict == "pass" for f in computed)
    looks = f", {len(computed) - passed} to look at" if passed < len(computed) else ""
    return f"audit: {passed} of {len(computed)} figures pass{looks}"


def _short(value: float) -> str:
    return f"{value:.2g}" if math.isfinite(value) else "-"


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.6g}"


def verdict_data(verdict: Verdict) -> dict[str, Any]:
    """A verdict as JSON data; what is infinite or has no value is null."""
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in dataclasses.asdict(verdict).items()
    }
