"""Paths of slots: where the pin is along a curve of quintic spans, and how far from it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sandbox.engine import memory as at
from sandbox.engine.coordinates import ahead
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.narrow_phase import descend, on_span
from sandbox.engine.records import JOINT_STATE
from sandbox.engine.world import span_table
from sandbox.model.joints import place_in_slot
from sandbox.model.model import Model
from sandbox.numeric import Records
from sandbox.scene.outlines import curves

ABSCISSAE, WEIGHTS = tuple(curves.ABSCISSAE.tolist()), tuple(curves.WEIGHTS.tolist())
"""Quadrature of the arc lengths of spans."""


@kernel
def on_path(spans: Records, start: int, x: float, y: float) -> Any:
    """The place nearest to the point (x, y) on the path of a slot, searched from a span on.

    An open path continues straight beyond its ends.

    Returns:
        Span, arc length [m], unit tangent, distance of the point to the left [m], curvature [1/m].
    """
    k, w, end = descend(spans, start, True, x, y)
    px, py, dx, dy, ddx, ddy = on_span(spans[k], w)
    speed = math.hypot(dx, dy)
    tx, ty = dx / speed, dy / speed
    place, bend = spans[k]["start"], (dx * ddy - dy * ddx) / speed ** 3
    for i in range(len(ABSCISSAE)):
        _, _, dx, dy, _, _ = on_span(spans[k], w * (ABSCISSAE[i] + 1.0) / 2.0)
        place += w / 2.0 * WEIGHTS[i] * math.hypot(dx, dy)
    if end:
        place += tx * (x - px) + ty * (y - py)
        bend = 0.0
    return k, place, tx, ty, tx * (y - py) - ty * (x - px), bend


@entry_point("paths")
def path_gap(table: int, h: float, k: int) -> float:
    """Distance [m] of the point of slot ``k`` to the left of its path one step on."""
    joint, body, velocity = at.joints(table)[k], at.body(table), at.velocity(table)
    xa, ya, _, ca, sa = ahead(h, body, velocity, joint["a"])
    xb, yb, _, cb, sb = ahead(h, body, velocity, joint["b"])
    qx = xb + cb * joint["bx"] - sb * joint["by"] - xa
    qy = yb + sb * joint["bx"] + cb * joint["by"] - ya
    return float(on_path(at.spans(table), at.joint_states(table)[k]["span"],
                         ca * qx + sa * qy, ca * qy - sa * qx)[4])


def add_paths(joints: Records, model: Model, spans: Records) -> tuple[Records, Records]:
    """Put the paths of slots into JOINT; the SPANs with theirs added, and JOINT_STATE at t = 0."""
    tables, states = [spans], np.zeros(len(joints), JOINT_STATE)
    for j, path in enumerate(model.joints.path):
        if path is None:
            continue
        first = sum(map(len, tables))
        x, y = model.bodies.centre[model.joints.bodies[j, 0]].tolist()
        table = span_table(path.nodes, (x, y), first, closed=path.closed)
        table["start"] = path.starts[:-1]
        tables.append(table)
        place = float(place_in_slot(model, j, model.bodies.pose).along)
        joints[j]["span"], joints[j]["span_end"] = first, first + len(table)
        joints[j]["around"] = path.length if path.closed else 0.0
        states[j]["place"] = place
        states[j]["span"] = first + np.searchsorted(path.starts[1:-1], place, side="right")
    return np.concatenate(tables), states
