"""What a verification case is: an equation, a mechanism, a comparison, how far off it may be."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from sandbox.draw.figure.panels import Panel
from sandbox.study.independent import NotComputed

__all__ = ["Case", "CaseResult", "Check", "Findings", "NotComputed", "carry_out"]


@dataclass(frozen=True)
class Check:
    """One number of the engine held against one that it has no part in."""

    what: str
    unit: str
    expected: float
    found: float
    allowed: float
    """Largest difference that passes, in the unit."""
    why: str
    """Where ``allowed`` comes from."""

    @property
    def off(self) -> float:
        """Size of the difference."""
        return abs(self.found - self.expected)

    @property
    def ok(self) -> bool:
        """Whether it is within what is allowed; never for what is no number."""
        return bool(math.isfinite(self.off) and self.off <= self.allowed)


@dataclass(frozen=True)
class Findings:
    """What a case measured, and pictures of it."""

    checks: Sequence[Check]
    panels: Sequence[Panel] = ()


@dataclass(frozen=True)
class Case:
    """A verification case."""

    name: str
    title: str
    equations: str
    mechanism: str
    """The scene or mechanism that the engine runs."""
    compares: str
    """What is held against what."""
    measure: Callable[[], Findings]


@dataclass(frozen=True)
class CaseResult:
    """What came of a case."""

    case: Case
    checks: Sequence[Check] = ()
    panels: Sequence[Panel] = field(default=(), compare=False)
    missing: str = ""
    """Why it could not be computed; empty if it was."""

    @property
    def ok(self) -> bool:
        """Whether it was computed and every check holds."""
        return not self.missing and bool(self.checks) and all(c.ok for c in self.checks)


def carry_out(case: Case) -> CaseResult:
    """Carry a case out; what cannot be computed here says why."""
    try:
        findings = case.measure()
    except NotComputed as error:
        return CaseResult(case, missing=f"not computed: {error}")
    return CaseResult(case, findings.checks, findings.panels)
