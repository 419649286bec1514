"""Lines, chambers and valves as arrays: names become numbers, what is left open is filled in."""

from __future__ import annotations

import math

import numpy as np

from sandbox.elements.fluids import Chamber, Cylinder, Line, Valve
from sandbox.elements.kinds import ATMOSPHERE
from sandbox.model.model import NONE, Drives, Joints, Lines, Names, Valves
from sandbox.numeric import Integers
from sandbox.scene.fluids import length_of, volume_of
from sandbox.scene.geometry import Vec
from sandbox.scene.mechanism import Mechanism

OIL = 1.4e9
"""Modulus of oil with a little air in it [Pa]."""
NAN = math.nan


def compile_lines(mechanism: Mechanism, names: Names, joints: Joints, drives: Drives) -> Lines:
    """The lines of a mechanism whose references are right.

    Args:
        mechanism: what they are of.
        names: of its elements.
        joints: its joints.
        drives: its drives.
    """
    lines, bodies = mechanism.lines, {body.name: body for body in mechanism.bodies}
    chambers = [chamber for line in lines for chamber in line.chambers]
    numbers = [_bodies(chamber, names, joints.bodies) for chamber in chambers]
    volume = np.array([volume_of(line, bodies) for line in lines], dtype=float)
    given = {int(drives.target[i]): i for i in drives.giving("pressure").tolist()
             if drives.resistance[i] == 0.0}
    return Lines(
        name=tuple(line.name for line in lines),
        first=np.cumsum([0, *(len(line.chambers) for line in lines)], dtype=np.int64),
        bodies=np.array(numbers, dtype=np.int64).reshape(-1, 2),
        anchor=np.array([_points(chamber) for chamber in chambers], dtype=float).reshape(-1, 2, 2),
        joint=np.array([NONE if isinstance(chamber, Cylinder) else names.joint[chamber.joint]
                        for chamber in chambers], dtype=np.int64),
        gain=np.array([_gain(chamber) for chamber in chambers], dtype=float),
        start=np.array([length_of(chamber, bodies) if isinstance(chamber, Cylinder)
                        else joints.start[names.joint[chamber.joint]] for chamber in chambers],
                       dtype=float),
        volume=volume,
        compliance=np.array([_compliance(line, v)
                             for line, v in zip(lines, volume, strict=True)], dtype=float),
        gas=np.array([NAN if line.gas is None else line.gas for line in lines], dtype=float),
        pressure=np.array([line.pressure for line in lines], dtype=float),
        least=np.array([line.least for line in lines], dtype=float),
        most=np.array([math.inf if line.relief is None else line.relief for line in lines],
                      dtype=float),
        drive=np.array([given.get(i, NONE) for i in range(len(lines))], dtype=np.int64))


def compile_valves(mechanism: Mechanism, names: Names, drives: Drives) -> Valves:
    """The valves of a mechanism whose references are right."""
    valves = mechanism.valves
    setters = {int(drives.target[i]): i for i in drives.giving("opening").tolist()}
    return Valves(
        name=tuple(valve.name for valve in valves),
        lines=np.array([[NONE if line is None else names.line[line] for line in (valve.a, valve.b)]
                        for valve in valves], dtype=np.int64).reshape(-1, 2),
        resistance=np.array([valve.resistance for valve in valves], dtype=float),
        orifice=np.array([_orifice(valve) for valve in valves], dtype=float),
        one_way=np.array([valve.one_way for valve in valves], dtype=np.bool_),
        drive=np.array([setters.get(i, NONE) for i in range(len(valves))], dtype=np.int64))


def _bodies(chamber: Chamber, names: Names, hinges: Integers) -> tuple[int, int]:
    if isinstance(chamber, Cylinder):
        return names.body[chamber.a], names.body[chamber.b]
    a, b = hinges[names.joint[chamber.joint]].tolist()
    return int(a), int(b)


def _points(chamber: Chamber) -> tuple[Vec, Vec]:
    if isinstance(chamber, Cylinder):
        return chamber.on_a, chamber.on_b
    return (NAN, NAN), (NAN, NAN)


def _gain(chamber: Chamber) -> float:
    if isinstance(chamber, Cylinder):
        return -chamber.area if chamber.pulls else chamber.area
    return chamber.displacement


def _compliance(line: Line, volume: float) -> float:
    if line.gas is not None:
        return volume / (line.gas * (line.pressure + ATMOSPHERE))
    return volume / (OIL if line.modulus is None else line.modulus)


def _orifice(valve: Valve) -> float:
    if valve.area is None:
        return 0.0
    return valve.density / 2 / (valve.discharge * valve.area) ** 2
