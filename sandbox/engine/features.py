"""Features of a scene that decide which entry points are compiled for it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sandbox.engine.records import GEAR, RACK, ROLL
from sandbox.engine.state import Constants


def _bounded(c: Constants) -> bool:
    return bool(len(c.limits) or len(c.motors) or len(c.slips) or len(c.rubs) or len(c.shapes))


FEATURES: dict[str, Callable[[Constants], bool]] = {
    "actions": lambda c: len(c.actions) > 0,
    "bounces": lambda c: bool((c.restitution > 0.0).any()),
    "bounded": _bounded,
    "cords": lambda c: len(c.cords) > 0,
    "curves": lambda c: len(c.spans) > 0,
    "fluids": lambda c: bool(len(c.fluids) or len(c.valves) or len(c.pumps)),
    "laws": lambda c: len(c.steps) > 0,
    "loads": lambda c: bool(len(c.loads) or len(c.loaded)),
    "motors": lambda c: len(c.motors) > 0,
    "rubs": lambda c: len(c.rubs) > 0,
    "shapes": lambda c: len(c.shapes) > 0,
    "slips": lambda c: bool(len(c.slips) or (c.cords["spans"] < c.cords["spans_end"]).any()),
    "springs": lambda c: len(c.springs) > 0,
    "static": lambda c: bool((c.static > 1.0).any() or (c.rubs["static"] > 1.0).any()),
    "teeth": lambda c: bool(np.isin(c.joints["keeps"], (GEAR, RACK, ROLL)).any()),
    "ties": lambda c: len(c.ties) > 0,
}
