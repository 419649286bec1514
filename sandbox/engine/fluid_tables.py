"""Lines, chambers, valves and pumps as flat tables, as :mod:`sandbox.engine.tables` has others."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from sandbox.elements.element import ATMOSPHERE
from sandbox.engine.records import CHAMBER, FLUID, PUMP, SOFT, VALVE
from sandbox.engine.stiffness import line_responses
from sandbox.model.model import Model
from sandbox.numeric import Array, Flags, Integers, Records


class Circuits(NamedTuple):
    """All tables of fluid; of every line the bodies of its entries."""

    fluids: Records
    chambers: Records
    valves: Records
    pumps: Records
    line_bodies: list[list[int]]
    meet: list[tuple[int, int]]
    """The two lines of every valve that is between two; in the order of these."""

    @property
    def between(self) -> Flags:
        """Which valves are between two lines."""
        return np.asarray((self.valves["a"] >= 0) & (self.valves["b"] >= 0))

    def add_rows(self, add: Callable[..., tuple[int, int]]) -> list[tuple[int, int]]:
        """A row for every line; those that meet at valves.

        ``add`` takes the bodies of a row and gives its number and first entry.
        """
        for i, bodies in enumerate(self.line_bodies):
            fluid = self.fluids[i]
            fluid["row"], entry = add(*bodies)
            for n in range(fluid["first"], fluid["last"]):
                for end in ("a", "b"):
                    self.chambers[n][f"entry_{end}"] = entry + bodies.index(self.chambers[n][end])
        rows = self.fluids["row"].tolist()
        return [(rows[a], rows[b]) for a, b in self.meet]

    def content(self) -> Array:
        """Content of the lines at t = 0 [m^3], by their pressures."""
        gas, start = self.fluids["gas"], self.fluids["start"]
        with np.errstate(divide="ignore"):
            of_gas = self.fluids["volume"] * (start / ATMOSPHERE + 1.0) ** (1.0 / gas)
        return np.where(gas > 0, of_gas, self.fluids["c"] * start)


def make_circuits(model: Model, h: float, number: Integers) -> Circuits:
    """The tables of a model's lines, valves and pumps.

    Args:
        model: the mechanism.
        h: the step [s].
        number: of every body of the model the number that pymunk has it by, [nb].
    """
    lines = model.lines
    chambers = _chambers(model, number)
    fluids = np.zeros(len(lines.name), FLUID)
    fluids["first"], fluids["last"] = lines.first[:-1], lines.first[1:]
    fluids["drive"], fluids["volume"], fluids["c"] = lines.drive, lines.volume, lines.compliance
    fluids["gas"], fluids["start"] = np.nan_to_num(lines.gas), lines.pressure
    fluids["least"], fluids["most"] = lines.least, lines.most
    fluids["response"] = line_responses(model)
    stiff = h * h * fluids["response"] > SOFT * lines.compliance
    fluids["ahead"], fluids["ratio"] = stiff, np.where(_beside(model, stiff), 1.5, 2.0)
    bodies = [sorted({int(body) for end in ("a", "b") for body in chambers[end][lines.chambers(i)]})
              for i in range(len(lines.name))]
    valves = np.zeros(len(model.valves.name), VALVE)
    valves["a"], valves["b"] = model.valves.lines.T
    valves["r"], valves["k"] = model.valves.resistance, model.valves.orifice
    valves["one_way"], valves["drive"] = model.valves.one_way, model.valves.drive
    valves["slot"] = -1
    meet = [(int(a), int(b)) for a, b in model.valves.lines if a >= 0 and b >= 0]
    return Circuits(fluids, chambers, valves, _pumps(model), bodies, meet)


def _chambers(model: Model, number: Integers) -> Records:
    lines, centre = model.lines, model.bodies.centre
    table = np.zeros(len(lines.gain), CHAMBER)
    for n, chamber in enumerate(table):
        a, b = lines.bodies[n]
        chamber["a"], chamber["b"] = number[a], number[b]
        chamber["gain"], chamber["start"] = lines.gain[n], lines.start[n]
        joint = int(lines.joint[n])
        if joint >= 0:
            sense, zero = model.joints.sense[joint], model.joints.zero[joint]
            chamber["turns"], chamber["gain"] = 1, sense * lines.gain[n]
            chamber["start"] = sense * (lines.start[n] + zero)
            continue
        chamber["ax"], chamber["ay"] = lines.anchor[n, 0] - centre[a]
        chamber["bx"], chamber["by"] = lines.anchor[n, 1] - centre[b]
    return table


def _pumps(model: Model) -> Records:
    drives = model.drives
    which = drives.giving("flow", "pressure")
    pumps = np.zeros(len(which), PUMP)
    pumps["drive"], pumps["line"] = which, drives.target[which]
    pumps["source"] = np.isfinite(drives.resistance[which])
    pumps["r"] = np.nan_to_num(drives.resistance[which])
    return pumps


def _beside(model: Model, stiff: Flags) -> Flags:
    """Lines that are stiff, and those that valves join to them."""
    stiff = stiff.copy()
    pairs = [(a, b) for a, b in model.valves.lines.tolist() if a >= 0 and b >= 0]
    for a, b in len(pairs) * pairs:
        stiff[a] = stiff[b] = stiff[a] or stiff[b]
    return stiff
