"""Laws of loads: a force and a torque as programs of a body's motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.elements.loads import MOTION, LoadSpec
from sandbox.model.programs import Program, compile_expression
from sandbox.numeric import Array
from sandbox.values.expressions import Expression, parse_expression
from sandbox.values.tables import Tables
from sandbox.wording import WrongValueError

MOVED = frozenset(MOTION) - {"t", "mass", "inertia"}
"""What a step changes of what a law reads, apart from the time."""


@dataclass(frozen=True)
class LoadLaw:
    """The law of one load: components of its force, and its torque; None for 0."""

    parts: tuple[Expression | None, Expression | None, Expression | None]
    programs: tuple[Program | None, Program | None, Program | None]
    tables: Tables

    @property
    def names(self) -> frozenset[str]:
        """What it reads."""
        return frozenset[str]().union(*(part.names for part in self.parts if part is not None))

    def at(self, motion: Mapping[str, Array]) -> Array:
        """Its three numbers [3, n] for a motion [n] under each of its names; nan for no value."""
        count = np.shape(motion["x"])
        found = np.zeros((3, *count))
        for row, part in zip(found, self.parts, strict=True):
            if part is not None:
                try:
                    row[...] = part.evaluate({**motion, **self.tables}, finite=False)
                except WrongValueError:  # an exponent that is too large at one of them
                    row[...] = np.nan
        return found


def law_of_load(load: LoadSpec, order: Sequence[str], tables: Tables) -> LoadLaw | None:
    """The law of a load; None of one without.

    Args:
        load: as the scene has it.
        order: names of the scene's tables, in the order in which programs number them.
        tables: the same by their calls.
    """
    texts = load.laws()
    if texts is None:
        return None
    x, y, turn = (None if text is None else parse_expression(text) for text in texts)
    a, b, c = (None if part is None else compile_expression(part, MOTION, order)
               for part in (x, y, turn))
    return LoadLaw((x, y, turn), (a, b, c), tables)
