"""What must hold of a run: ``moved < 1 mm``, of what is kept of it, or its scene's expectations."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from sandbox.errors import SandboxError
from sandbox.numeric import Array
from sandbox.scene.values.units import parse_quantity, unfit
from sandbox.sweeps.job import DONE, SweepRow
from sandbox.sweeps.table import SweepTable
from sandbox.wording import WrongValueError, listed, or_near, quoted

Number = TypeVar("Number", float, Array)
_RELATION = re.compile(r"\s*(.+?)\s*(<=|>=|<|>)\s*(\S.*?)\s*")


class RefusedError(SandboxError):
    """What a search is asked for cannot be looked for; known before anything runs."""

    code = "bad-search"


@dataclass(frozen=True)
class Condition:
    """A number kept of each run that must be less or more than a limit."""

    name: str
    below: bool
    limit: float
    """[SI]."""
    text: str
    """As it was written."""

    def excess(self, value: Number) -> Number:
        """How far a value is on the wrong side, [SI]; negative on the right one."""
        return value - self.limit if self.below else self.limit - value


def conditions(texts: Iterable[str], kept: Mapping[str, str]) -> tuple[Condition, ...]:
    """Conditions from their words.

    Args:
        texts: such as ``"moved < 1 mm"``.
        kept: names of what is kept, and their SI units.

    Raises:
        RefusedError: no condition, a name that is not kept, or a unit of something else.
    """
    return tuple(_condition(text, kept) for text in texts)


def _condition(text: str, kept: Mapping[str, str]) -> Condition:
    match = _RELATION.fullmatch(text)
    if match is None:
        raise RefusedError(f"{quoted(text)} is no condition (allowed: \"moved < 1 mm\" of what is "
                           "kept, with <, <=, > or >=)")
    name, relation, written = match.groups()
    known_name(name, kept)
    try:
        limit = parse_quantity(written, None)
    except WrongValueError as error:
        raise RefusedError(f"{quoted(text)}: {error}") from None
    measures_as(limit, kept[name], f"{quoted(text)}: {name}")
    return Condition(name, relation in ("<", "<="), float(limit), text)


def measures_as(value: float, unit: str, what: str) -> None:
    """See that a number with a unit is of what ``what`` is in, SI; any is if that has no unit.

    Raises:
        RefusedError: it is a unit of something else.
    """
    if wrong := unfit(value, unit):
        raise RefusedError(f"{what} is in {unit}, and {wrong}")


def known_name(name: str, kept: Mapping[str, str]) -> None:
    """See that something is kept under a name.

    Raises:
        RefusedError: it is not, with a near miss.
    """
    if name not in kept:
        raise RefusedError(f"no run keeps {quoted(name)}{or_near(name, kept)} "
                           f"(kept: {listed(list(kept)) or 'nothing'})")


def value_of(row: SweepRow, name: str) -> float:
    """A number kept of a run; nan if it has none."""
    value = row.kept.get(name)
    return math.nan if value is None else value


def why_none(row: SweepRow) -> str:
    """Why a run has no answer, in a few words."""
    return f"{row.status}: {row.reason}" if row.status != DONE else row.reason


def why_nothing(rows: Iterable[SweepRow]) -> str:
    """Why most of these runs have no answer, to stand behind it; empty if all have one."""
    reasons = Counter(filter(None, map(why_none, rows)))
    return f": {reasons.most_common(1)[0][0]}" if reasons else ""


def held(table: SweepTable, wanted: tuple[Condition, ...]) -> Array:
    """What :func:`holds` says of all runs of a table, [n]: 1, 0, nan where it is not known."""
    if not wanted:
        return table.holds
    margins = [each.excess(table.kept[each.name]) for each in wanted]
    worst = np.max(margins, axis=0)
    return np.where(table.done & np.isfinite(worst), worst <= 0, np.nan)


def holds(row: SweepRow, wanted: tuple[Condition, ...]) -> bool | None:
    """Whether all conditions hold of a run, or without any what its scene expects.

    None where it has no answer.
    """
    if row.status != DONE:
        return None
    if not wanted:
        return row.holds
    margins = [each.excess(value_of(row, each.name)) for each in wanted]
    return None if any(map(math.isnan, margins)) else all(margin <= 0 for margin in margins)
