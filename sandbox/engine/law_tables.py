"""Tables of laws (programs of springs and loads) and of loads, those of one body side by side."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from sandbox.engine.plan import PlacedBodies, Rows
from sandbox.engine.records import LOAD, LOADED
from sandbox.engine.stiffness import responses
from sandbox.model.laws import MOVED
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


ROWS = ("row", "row_y", "row_turn")


class LoadTables(NamedTuple):
    """The loads of a model."""

    loads: Records
    """LOAD, [nk]."""
    loaded: Records
    """LOADED, of each body that has loads."""
    sides: Array
    """Of what liquids lift, from the centres of mass, [k, 5]."""


def load_tables(places: PlacedBodies, laws: LawTables, rows: Rows) -> LoadTables:
    """Tables of loads; a body whose loads depend on its motion has three rows."""
    model, given = places.model, places.model.loads
    on = places.number[given.body]
    order = np.argsort(on, kind="stable")
    loads = np.zeros(len(order), LOAD)
    for row, i in zip(loads, order.tolist(), strict=True):
        for key, value in _load(places, laws, i).items():
            row[key] = value
    bodies, first = np.unique(on[order], return_index=True)
    loaded = np.zeros(len(bodies), LOADED)
    loaded["body"], loaded["first"] = bodies, first
    loaded["last"] = [*first[1:], len(order)]
    for name in ROWS:
        loaded[name] = -1
    for row in loaded:
        own = order[row["first"]:row["last"]].tolist()
        if any(law is not None and law.names & MOVED for law in (given.law[i] for i in own)):
            row["row"], row["entry"] = rows.add(int(row["body"]))
            row["row_y"], _ = rows.add(int(row["body"]))
            row["row_turn"], _ = rows.add(int(row["body"]))
    return LoadTables(loads, loaded, _from_centres(model))


def _load(places: PlacedBodies, laws: LawTables, i: int) -> dict[str, Any]:
    """The fields of a load, by the model's number."""
    loads, bodies = places.model.loads, places.model.bodies
    body, law = int(loads.body[i]), loads.law[i]
    x, y = places.local(body, loads.at[i])
    row: dict[str, Any] = {
        "number": i, "body": places.number[body], "x": x, "y": y, "turning": loads.turning[i],
        "scale": bodies.mass[body] if loads.per_mass[i] else 1.0,
        "mass": bodies.mass[body], "inertia": bodies.inertia[body],
        "timed": law is not None and "t" in law.names,
        "first": loads.first[i], "last": loads.first[i + 1],
        "level": loads.level[i], "lift": loads.lift[i]}
    for axis, part in zip("xyt", laws.loads[i], strict=True):
        row[f"{axis}_code"], row[f"{axis}_end"] = part
    return row


def _from_centres(model: Model) -> Array:
    """All sides from their bodies' centres of mass."""
    loads, sides = model.loads, model.loads.sides.copy()
    centre = np.repeat(model.bodies.centre[loads.body], np.diff(loads.first), axis=0)
    sides[:, :2] -= centre
    straight = sides[:, 4] == 0.0
    sides[straight, 2:4] -= centre[straight]
    return sides
