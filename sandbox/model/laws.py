"""Laws of springs and loads: expressions of a stretch or of a body's motion, as programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.elements.loads import MOTION, LoadSpec
from sandbox.elements.springs import Spring
from sandbox.model import programs as op
from sandbox.model.programs import Program, compile_expression
from sandbox.numeric import Array
from sandbox.values.expressions import Expression, parse_expression
from sandbox.values.tables import Tables
from sandbox.wording import WrongValueError

STRETCH, RATE, STIFFNESS = 0, 1, 2  # inputs of a law's program
FULL = ("pull", "above")


@dataclass(frozen=True)
class SpringLaw:
    """The law of one spring."""

    own: Expression | None  # of stretch and rate; None for k s
    names: tuple[str, ...]  # of stretch and rate in it
    damping: float  # [N s/m, N m s/rad]
    side: int  # +1 if it acts only while stretched, -1 only while compressed; 0 always
    program: Program
    tables: Tables

    @property
    def of_rate(self) -> bool:
        """Whether it depends on the rate."""
        return self.damping > 0 or (self.own is not None and self.names[RATE] in self.own.names)

    def force(self, stretch: Array, rate: Array, stiffness: Array | float = 0.0) -> Array:
        """The force [N, N m] at stretches and rates [n]; nan where it has no value."""
        found = stiffness * stretch
        if self.own is not None:
            read = {self.names[STRETCH]: stretch, self.names[RATE]: rate, **self.tables}
            try:
                found = np.broadcast_to(self.own.evaluate(read, finite=False), np.shape(stretch))
            except WrongValueError:  # an exponent that is too large at one of them
                found = np.full(np.shape(stretch), np.nan)
        found = found + self.damping * rate
        if self.side:
            some = self.side * stretch > 0
            found = np.where(some, self.side * np.maximum(self.side * found, 0.0), 0.0)
        return np.asarray(found, dtype=float)

    def slopes(self, stretch: Array, stiffness: float = 0.0) -> Array:
        """dF/ds at rest between neighbours of rising stretches, [n - 1]."""
        with np.errstate(all="ignore"):
            found: Array = np.diff(self.force(stretch, np.zeros(len(stretch)), stiffness))
            return found / np.diff(stretch)


def law_of(spring: Spring, order: Sequence[str], tables: Tables) -> SpringLaw | None:
    """The law of a spring, None of a linear one; programs number tables in their ``order``."""
    text, names, damping = spring.law, spring.OWN, float(spring.damping)
    if text is None and spring.only is None:
        return None
    own = None if text is None else parse_expression(text)
    side = 0 if spring.only is None else 1 if spring.only in FULL else -1
    steps, depth = compile_expression(own, names, order) if own is not None else (
        ((op.NAME, STIFFNESS), (op.NAME, STRETCH), (op.MUL, 0)), 2)
    if damping:
        steps += ((op.NUMBER, damping), (op.NAME, RATE), (op.MUL, 0), (op.ADD, 0))
    if side:
        compare, bound = (op.GT, op.MAX) if side > 0 else (op.LT, op.MIN)
        zero = op.NUMBER, 0.0
        steps = ((op.NAME, STRETCH), zero, (compare, 0), (op.DROP, 0), *steps,
                 zero, (bound, 0), zero, (op.SELECT, 0))
    return SpringLaw(own, names, damping, side, Program(steps, depth + 3), tables)


MOVED = frozenset(MOTION) - {"t", "mass", "inertia"}  # these change in a step, besides the time


@dataclass(frozen=True)
class LoadLaw:
    """The law of one load: components of its force, and its torque; None for 0."""

    parts: tuple[Expression | None, ...]  # [3]
    programs: tuple[Program | None, ...]  # [3]
    tables: Tables

    @property
    def names(self) -> frozenset[str]:
        """What it reads."""
        return frozenset[str]().union(*(part.names for part in self.parts if part is not None))

    def at(self, motion: Mapping[str, Array]) -> Array:
        """Its three numbers [3, n] for a motion [n] under each of its names; nan for no value."""
        found = np.zeros((3, *np.shape(motion["x"])))
        for row, part in zip(found, self.parts, strict=True):
            if part is not None:
                try:
                    row[...] = part.evaluate({**motion, **self.tables}, finite=False)
                except WrongValueError:  # an exponent that is too large at one of them
                    row[...] = np.nan
        return found


def law_of_load(load: LoadSpec, order: Sequence[str], tables: Tables) -> LoadLaw | None:
    """The law of a load, None of one without; programs number tables in their ``order``."""
    if (texts := load.laws()) is None:
        return None
    parts = tuple(None if text is None else parse_expression(text) for text in texts)
    return LoadLaw(parts, tuple(None if part is None else compile_expression(part, MOTION, order)
                                for part in parts), tables)
