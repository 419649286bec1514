"""Programs of laws, and the scene's tables, as flat tables for the compiled step."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from sandbox.engine.stiffness import responses
from sandbox.model.model import Model
from sandbox.model.programs import curve_tables, stack_for, step_table
from sandbox.numeric import Array, Records

SLOPES = 3
"""By how many variables a law has slopes."""
NAMES = 16
"""Most that a law reads."""


class LawTables(NamedTuple):
    """The programs of laws, and where those of springs are."""

    steps: Records
    """STEP"""
    curves: Records
    """CURVE"""
    knots: Records
    """KNOT"""
    stack: Array
    """Room for what a program works with."""
    read: Array
    """Room for what it reads."""
    springs: dict[int, tuple[int, int]]
    """First step of each law by the spring's number, and where it ends."""
    of_rate: frozenset[int]
    """Springs whose law hangs on the rate."""
    responses: Array
    """Of the springs, [ns]."""

    def of(self, spring: int) -> dict[str, Any]:
        """What a spring's table has of its law."""
        first, last = self.springs.get(spring, (-1, -1))
        return {"code": first, "code_end": last, "of_rate": spring in self.of_rate,
                "response": self.responses[spring]}


def law_tables(model: Model) -> LawTables:
    """The laws of a model."""
    own = {i: law.program for i, law in enumerate(model.springs.law) if law is not None}
    steps, ends = step_table(list(own.values()))
    return LawTables(
        steps, *curve_tables(list(model.mechanism.functions.values())),
        stack_for(list(own.values()), SLOPES), np.zeros((NAMES, 1 + SLOPES)),
        {i: (int(ends[n]), int(ends[n + 1])) for n, i in enumerate(own)},
        frozenset(i for i in own if (law := model.springs.law[i]) and law.of_rate),
        responses(model))
