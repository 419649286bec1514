"""Parts of lines of fluid: hoses, cylinders and vanes, valves, pumps."""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.model.model import NONE
from sandbox.picture.points import PointPool
from sandbox.picture.run_data import RunData
from sandbox.show.drawing import Tube, ports_of, tubes_of
from sandbox.show.points import Part, point, short


def fluid_parts(run: RunData) -> list[Part]:
    """All of them. A port is where a hose meets a chamber: a vane's point, or a cylinder."""
    model, pool = run.model, PointPool()
    lines, joints = model.lines, model.joints
    if not lines.name:
        return []
    tubes = tubes_of(run, pool)
    vanes = [(int(lines.of[n]), pool.add(
        int(lines.bodies[n, 1]), joints.anchor[lines.joint[n], 1]).start)
        for n in np.flatnonzero(lines.joint != NONE).tolist()]
    ports = ports_of(model, tubes, vanes)
    pool.close()

    def cylinder(tube: Tube) -> Part:
        return {"line": tube.line, "a": point(*pool.place(tube.a)), "b": point(*pool.place(tube.b)),
                "tube": short(tube.tube), "longest": short(tube.longest), "end": short(tube.end),
                "slope": short(tube.slope), "pulls": tube.pulls}

    def port(tube: Tube | None, vane: int) -> Any:
        return {"at": point(*pool.place(vane))} if tube is None else cylinder(tube)

    every = [[port(tube, vane) for tube, vane in of] for of in ports]
    found: list[Part] = [{"k": "hose", "l": "tendons", "n": lines.name[i], "line": i, "ports": of}
                         for i, of in enumerate(every)]
    found += [{"k": "tube", "l": "tendons", "n": lines.name[tube.line], **cylinder(tube)}
              for tube in tubes]
    found += [{"k": "vane", "l": "tendons", "n": lines.name[line], "line": line,
               "at": point(*pool.place(at))} for line, at in vanes]
    pairs = model.valves.lines.tolist()
    found += [{"k": "valve", "l": "tendons", "n": model.valves.name[v], "v": v, "ends": pair,
               "ports": every, "pairs": pairs} for v, pair in enumerate(pairs)]
    return [*found, *_pumps(run, every, pairs)]


def _pumps(run: RunData, ports: list[Any], pairs: list[Any]) -> list[Part]:
    drives, beside = run.model.drives, dict[int, int]()
    found: list[Part] = []
    for d in drives.giving("flow", "pressure").tolist():
        line = int(drives.target[d])
        beside[line] = beside.get(line, -1) + 1
        found.append({"k": "pump", "l": "drives", "n": drives.name[d], "d": d, "line": line,
                      "unit": drives.kind[d].unit, "beside": beside[line], "ports": ports,
                      "pairs": pairs})
    return found
