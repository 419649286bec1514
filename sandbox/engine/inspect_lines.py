"""Looks lines of fluid over: whether cylinders have a direction, and lines something to do."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.engine.inspect_words import STRAIGHT, error, look
from sandbox.errors import Problem
from sandbox.model.model import NONE, Model


def line_problems(model: Model) -> Iterator[Problem]:
    """Cylinders without a direction, which are errors; lines that move nothing and lead nowhere."""
    lines, drives = model.lines, model.drives
    fed = {int(drives.target[i]) for i in drives.giving("flow", "pressure")}
    for i, name in enumerate(lines.name):
        path, chambers = f"$.lines[{i}]", lines.chambers(i)
        for k, n in enumerate(range(chambers.start, chambers.stop)):
            if lines.joint[n] == NONE and lines.start[n] < STRAIGHT:
                yield error("coincident-points", f"{path}.chambers[{k}]", name,
                            f"the two points of its cylinder {k} coincide",
                            "move one of them: the force between has no direction")
        if model.bodies.free[lines.bodies[chambers]].any():
            continue
        joined = bool((model.valves.lines == i).any())
        if not joined:
            yield look("no-effect", path, name, "moves no body that can move freely",
                       "it presses on nothing")
        if not joined and i in fed and not np.isfinite(lines.most[i]):
            yield look("bad-fluid", path, name, "is pumped, has no relief and no way out",
                       "its pressure grows without end; give it a relief")
