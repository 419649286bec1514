"""Lines, chambers and valves as arrays: names become numbers, what is left open is filled in."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from sandbox.elements.element import NO_POINT
from sandbox.model.model import NONE, Drives, Lines, Valves

if TYPE_CHECKING:
    from sandbox.model.compile import Scope

NAN = math.nan


def compile_lines(scope: Scope, drives: Drives) -> Lines:
    """The lines of a mechanism whose references are right."""
    lines = scope.mechanism.lines
    chambers = [chamber.columns(scope) for line in lines for chamber in line.chambers]
    volume = np.array([line.volume_at(scope.world) for line in lines], dtype=float)
    given = {int(drives.target[i]): i for i in drives.giving("pressure").tolist()
             if drives.resistance[i] == 0.0}

    def column(key: str, default: Any) -> Any:
        return np.array([chamber.get(key, default) for chamber in chambers],
                        dtype=np.array(default).dtype).reshape(-1, *np.shape(default))

    return Lines(
        name=tuple(line.name for line in lines),
        first=np.cumsum([0, *(len(line.chambers) for line in lines)], dtype=np.int64),
        bodies=column("bodies", (NONE, NONE)), anchor=column("anchor", (NO_POINT, NO_POINT)),
        joint=column("joint", NONE), gain=column("gain", NAN), start=column("start", NAN),
        volume=volume,
        compliance=np.array([line.compliance(v)
                             for line, v in zip(lines, volume, strict=True)], dtype=float),
        gas=np.array([NAN if line.gas is None else line.gas for line in lines], dtype=float),
        pressure=np.array([line.pressure for line in lines], dtype=float),
        least=np.array([line.least for line in lines], dtype=float),
        most=np.array([math.inf if line.relief is None else line.relief for line in lines],
                      dtype=float),
        drive=np.array([given.get(i, NONE) for i in range(len(lines))], dtype=np.int64))


def compile_valves(scope: Scope, drives: Drives) -> Valves:
    """The valves of a mechanism whose references are right."""
    valves, names = scope.mechanism.valves, scope.names
    setters = {int(drives.target[i]): i for i in drives.giving("opening").tolist()}
    return Valves(
        name=tuple(valve.name for valve in valves),
        lines=np.array([[NONE if line is None else names.line[line] for line in (valve.a, valve.b)]
                        for valve in valves], dtype=np.int64).reshape(-1, 2),
        resistance=np.array([valve.resistance for valve in valves], dtype=float),
        orifice=np.array([valve.orifice for valve in valves], dtype=float),
        one_way=np.array([valve.one_way for valve in valves], dtype=np.bool_),
        drive=np.array([setters.get(i, NONE) for i in range(len(valves))], dtype=np.int64))
