"""How the verdicts on a scene's expectations are told."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

from sandbox.cli.console import table

if TYPE_CHECKING:
    from sandbox.audit.audit import Figure
    from sandbox.samples.expectations import Verdict


def expectation_table(judged: list[Verdict]) -> list[str]:
    """A short table of the verdicts, reasons of failures below, and their count."""
    rows = [
        [v.quantity, v.statistic, _number(v.value), v.allowed, "" if v.unit == "1" else v.unit,
         "pass" if v.ok else "FAIL"]
        for v in judged
    ]
    lines = table(["expectation of", "", "value", "range", "unit", ""], rows, right="<<>")
    lines += [f"FAIL {v.quantity}: {v.reason}" for v in judged if not v.ok and v.reason]
    held = sum(v.ok for v in judged)
    lines.append(f"{held} of {len(judged)} expectations hold")
    return lines


AUDIT_PAGE = "docs/audit.md"
"""Where every line of the audit is explained."""


def audit_table(audited: list[Figure]) -> list[str]:
    """A short table of an audit's figures, and what to know of those that ask for a look."""
    rows = [
        [f.name, _short(f.value), _short(f.threshold), f.unit, f.verdict]
        for f in audited if f.verdict != "not computed"
    ]
    lines = table(["audit", "value", "at most", "unit", ""], rows, right="<>><")
    lines += [f"look {f.name}: {f.why}" for f in audited if f.verdict == "look"]
    without = [f.name for f in audited if f.verdict == "not computed"]
    if without:
        lines.append(f"not computed: {', '.join(without)} (run.json says why)")
    passed = sum(f.verdict == "pass" for f in audited)
    lines.append(f"{passed} of {len(rows)} figures pass; {AUDIT_PAGE} explains them")
    return lines


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
