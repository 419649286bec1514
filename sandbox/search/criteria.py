"""What must hold of a run: ``moved < 1 mm``, of what is kept of it, or its scene's expectations."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from sandbox.errors import SandboxError
from sandbox.scene.values.units import Measured, dimension_of, parse_quantity
from sandbox.sweeps.job import DONE, SweepRow
from sandbox.wording import WrongValueError, listed, near, quoted

_RELATION = re.compile(r"\s*(.+?)\s*(<=|>=|<|>)\s*(\S.*?)\s*")


@dataclass(frozen=True)
class Condition:
    """A number kept of each run that must be less or more than a limit."""

    name: str
    below: bool
    limit: float
    """[SI]."""
    text: str
    """As it was written."""

    def excess(self, value: float) -> float:
        """How far a value is on the wrong side, [SI]; negative on the right one."""
        return value - self.limit if self.below else self.limit - value


def conditions(texts: Iterable[str], kept: Mapping[str, str]) -> tuple[Condition, ...]:
    """Conditions from their words.

    Args:
        texts: such as ``"moved < 1 mm"``.
        kept: names of what is kept, and their SI units.

    Raises:
        SandboxError: no condition, a name that is not kept, or a unit of something else.
    """
    return tuple(_condition(text, kept) for text in texts)


def _condition(text: str, kept: Mapping[str, str]) -> Condition:
    match = _RELATION.fullmatch(text)
    if match is None:
        raise SandboxError(f"{quoted(text)} is no condition (allowed: \"moved < 1 mm\" of what is "
                           "kept, with <, <=, > or >=)")
    name, relation, written = match.groups()
    known_name(name, kept)
    try:
        limit = parse_quantity(written, None)
    except WrongValueError as error:
        raise SandboxError(f"{quoted(text)}: {error}") from None
    unit = kept[name]
    if isinstance(limit, Measured) and unit and dimension_of(limit.unit) != dimension_of(unit):
        raise SandboxError(f"{quoted(text)}: {name} is in {unit}, and {quoted(limit.unit)} is a "
                           f"unit of {dimension_of(limit.unit)}")
    return Condition(name, relation in ("<", "<="), float(limit), text)


def known_name(name: str, kept: Mapping[str, str]) -> None:
    """See that something is kept under a name.

    Raises:
        SandboxError: it is not, with a near miss.
    """
    if name not in kept:
        hint = near(name, kept)
        raise SandboxError(f"no run keeps {quoted(name)}{f'; did you mean {hint}?' if hint else ''}"
                           f" (kept: {listed(list(kept)) or 'nothing'})")


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
