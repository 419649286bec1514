"""What a robustness map says: shares that hold, cells, boundaries, its certificate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sandbox.numeric import Array, Integers
from sandbox.sweeps.table import SweepTable
from sandbox.wording import percent, told_of

MOST = 60
"""Letters of a closed form that is written out in a line."""


@dataclass(frozen=True)
class Agreement:
    """Of a closed form with the runs."""

    differs: float
    """Share of what is decided in which its sign is not the answer."""
    passed: int
    """Crossed edges that it changes its sign on, the right way."""
    crossed: int
    """All crossed edges: between neighbours of which one holds and the other does not."""


@dataclass(frozen=True)
class RobustnessSheet:
    """The map for one value of the list, or the only one."""

    at: str
    """That value, as it was written; empty without a list."""
    share: float
    """Of the map in which it holds; undecided cells count by their corners."""
    low: float
    """If no undecided cell held, ..."""
    high: float
    """... and if all did."""
    silent: float
    """Share in which no run has an answer."""
    cells: tuple[tuple[float | str, ...], ...]
    """From and to along each range [SI], and ``holds``, ``does not hold``, ``undecided`` or ``no
    answer``."""
    boundary: tuple[Array, ...]
    """Polylines [n, 2] in SI between what holds and what does not; over one range the two ends
    [2, 1] of each bracket."""
    agreement: Agreement | None
    """With the closed form, if one was given."""
    states: Integers
    """[side] or [side, side], of evenly divided ranges: ``sandbox.search.cells``' numbers."""
    ways: tuple[Array, ...]
    """The borders of these divisions along each range [SI], [side + 1]."""
    form: Array | None
    """The closed form there, [side + 1] or [side + 1, side + 1]."""

    def __repr__(self) -> str:
        at = f" at {self.at}" if self.at else ""
        return f"<RobustnessSheet{at}: {percent(self.share)} holds, {len(self.cells)} cells>"

    def data(self) -> dict[str, Any]:
        """What of it goes into a file."""
        return {"at": self.at, "share": self.share, "low": self.low, "high": self.high,
                "silent": self.silent, "boundary": list(self.boundary), "cells": self.cells,
                "agreement": None if self.agreement is None else vars(self.agreement)}


@dataclass(frozen=True)
class RobustnessFound:
    """Where in a range, or in the square of two, something holds."""

    paths: tuple[str, ...]
    """Those with ranges."""
    units: tuple[str, ...]
    """SI; empty for none."""
    listed: str
    """The path that each sheet has a value of; empty without."""
    condition: str
    sheets: tuple[RobustnessSheet, ...]
    runs: int
    silent: int
    """Runs without an answer."""
    certified: bool
    """Whether the boundary is the same at half the step, to a cell."""
    certificate: str
    closed_form: str
    remarks: tuple[str, ...]
    title: str
    table: SweepTable

    @property
    def share(self) -> float:
        """Of all maps together that holds."""
        return sum(sheet.share for sheet in self.sheets) / len(self.sheets)

    def __repr__(self) -> str:
        return told_of(self, self.lines)

    @property
    def lines(self) -> list[str]:
        """What was found, for a person."""
        side = self.sheets[0].states.shape[0]
        dense = len(self.sheets) * (side + 1) ** len(self.paths)
        cost = f"{self.runs} runs, a grid as fine has {dense}"
        if len(self.sheets) == 1:
            told = [f"{self.condition} {self._of(self.sheets[0])}; {cost}"]
        else:
            told = [f"{self.condition}, for each {self.listed} ({cost}):"]
            told += [f"  {sheet.at}: {self._of(sheet)}" for sheet in self.sheets]
        return [*told, *self.remarks,
                f"half the step: {'the same' if self.certified else 'NOT the same'}; "
                f"{self.certificate}"]

    def _of(self, sheet: RobustnessSheet) -> str:
        """One sheet in words."""
        if sheet.low == 1:
            return "holds everywhere in the map"
        if sheet.silent == 1:
            return "has no answer anywhere in the map"
        if sheet.high == 0 == sheet.silent:
            return "holds nowhere in the map"
        text = f"holds in {_percent(sheet.share)} of the map ({_percent(sheet.low)} to " \
               f"{_percent(sheet.high)})"
        if sheet.silent:
            text += f", {_percent(sheet.silent)} has no answer"
        if len(self.paths) == 1:
            unit = f" {self.units[0]}".rstrip()
            text += ", changes between " + ", ".join(
                f"{line[0, 0]:.6g} and {line[-1, 0]:.6g}{unit}" for line in sheet.boundary)
        if sheet.agreement:
            what = self.closed_form if len(self.closed_form) <= MOST else "the closed form"
            text += (f"; {what} differs in {_percent(sheet.agreement.differs)} of what "
                     f"is decided and goes between the two runs of {sheet.agreement.passed} of "
                     f"{sheet.agreement.crossed} places of the boundary")
        return text

    def data(self) -> Mapping[str, Any]:
        """What of it goes into a file."""
        return {"paths": self.paths, "units": self.units, "listed": self.listed,
                "condition": self.condition, "sheets": [sheet.data() for sheet in self.sheets],
                "share": self.share, "runs": self.runs, "silent": self.silent,
                "certified": self.certified, "certificate": self.certificate,
                "closed_form": self.closed_form, "remarks": self.remarks}


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %"
