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
    loads: tuple[tuple[tuple[int, int], ...], ...]
    """The same of the three parts of each load; -1 where it has none."""
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
    parts = [law.programs if law is not None else (None, None, None) for law in model.loads.law]
    programs = [*own.values(), *(part for each in parts for part in each if part is not None)]
    steps, ends = step_table(programs)
    places = iter(zip(ends[len(own):-1].tolist(), ends[len(own) + 1:].tolist(), strict=True))
    return LawTables(
        steps, *curve_tables(list(model.mechanism.functions.values())),
        stack_for(programs, SLOPES), np.zeros((NAMES, 1 + SLOPES)),
        {i: (int(ends[n]), int(ends[n + 1])) for n, i in enumerate(own)},
        tuple(tuple((-1, -1) if part is None else next(places) for part in each)
              for each in parts),
        frozenset(i for i in own if (law := model.springs.law[i]) and law.of_rate),
        responses(model))
