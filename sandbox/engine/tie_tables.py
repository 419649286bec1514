"""Tables of what may be let go, and what an event does to them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sandbox.engine.records import (
    BROKEN,
    CORDED,
    JOINED,
    NONE,
    SETTLED,
    SPRINGY,
    TIE,
    TIE_STATE,
)
from sandbox.model.model import Model
from sandbox.numeric import Records
from sandbox.samples.outcome import Happened

if TYPE_CHECKING:
    from sandbox.engine.tables import Tables

AGAIN = 8
"""So often one thing may break in the steps made in one go, and be told of each time."""
LEAST = 1024
"""Breaks for which there is room at least."""


def tie_table(model: Model, springs: Records, cords: Records) -> Records:
    """TIE, [nr]; spans of cords get the number of theirs."""
    ties = model.ties
    table = np.zeros(len(ties.name), TIE)
    table["breaks_at"], table["over"] = ties.breaks_at, ties.over
    table["as_is"], table["drive"] = ties.as_is, ties.drive
    for row in np.flatnonzero(springs["tie"] >= 0):
        table[springs["tie"][row]]["what"], table[springs["tie"][row]]["index"] = SPRINGY, row
    for what, numbers in ((JOINED, ties.joint), (CORDED, ties.tendon)):
        own = np.flatnonzero(numbers >= 0)
        table["what"][numbers[own]], table["index"][numbers[own]] = what, own
    whole = len(model.tendons.name)
    cords["tie"][:whole] = ties.tendon
    cords["tie"][whole:] = ties.tendon[cords["whole"][whole:]]
    return table


def tie_state(model: Model) -> Records:
    """TIE_STATE at t = 0, [nr]."""
    state = np.zeros(len(model.ties.name), TIE_STATE)
    state["held"], state["load"], state["age"] = model.ties.held, np.nan, SETTLED
    state["wish"], state["driven"] = NONE, model.ties.held
    return state


def room_for_breaks(model: Model) -> Records:
    """BROKEN, with room for what breaks in the steps that are made in one go.

    There nothing but a drive can take up anew what broke, and that so often is no mechanism; few
    have room for one in every step.
    """
    breaking = int(np.isfinite(model.ties.breaks_at).sum())
    return np.zeros(max(AGAIN * breaking, LEAST if breaking else 0), BROKEN)


def taken_breaks(tables: Tables, names: Sequence[str], before: int, h: float) -> list[Happened]:
    """What broke in the steps made since this was last asked, and when, in order of time.

    What breaks in the same step as another, and by what that leaves to it, does so no earlier: the
    others are asked again once the first is gone, and its load then jumped.

    Args:
        tables: the run's, which forgets it.
        names: of what may be let go, in the model's order.
        before: how many steps were made before these.
        h: the step [s].
    """
    made, broken = tables.state.made, tables.state.broken
    found: list[Happened] = []
    for one in broken[:made[2]]:
        time = (before + float(one["row"]) - 0.5 + float(one["when"])) * h
        found.append(Happened(names[one["tie"]], max(time, found[-1].time if found else time)))
    made[2] = 0
    return found


def hold(tables: Tables, tie: int, *, held: bool) -> None:
    """Let go of something, or take it up, with the next step.

    Args:
        tables: the run's, whose state is changed.
        tie: its number in the model's ties.
        held: whether it is to hold.
    """
    tables.state.ties[tie]["wish"], tables.state.standing[1] = held, 0
