"""Contacts at the instant of an impact, and the next pose that it leads to.

The pose of a step is that of its middle. A contact whose gap is still open there closes s later,
and its normal and arms are those of that instant. The velocities at s are

    v(s) = v_before + (1/2 + s / h) (v_free - v_before)

with v_free those at the end of a step without impacts. An impact at s that changes the velocities
by Δv leads the pose x back along the new path: the next pose is x - s Δv + h v.

Both surfaces are replaced by their circles of curvature (:mod:`sandbox.engine.narrow_phase`).
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.bounded import rate
from sandbox.engine.candidates import normal_row
from sandbox.engine.kernel import kernel
from sandbox.engine.narrow_phase import rotated

FLAT = 1e3  # a radius of curvature [m] from which a surface counts as flat
ITERATIONS = 3
TIME_TOLERANCE = 1e-6
"""Instants nearer to the pose than this share of the step are that of the pose."""


@kernel
def time_to_close(gap: float, speed: float, trend: float) -> float:
    """The instant at which gap + speed s + trend s² / 2 falls to 0; inf if it does not."""
    square = speed * speed - 2.0 * trend * gap
    if square >= 0.0 and speed < 0.0:
        return float(2.0 * gap / (math.sqrt(square) - speed))
    if square >= 0.0 and trend < 0.0:
        return float((speed + math.sqrt(square)) / -trend)
    return math.inf


@kernel
def meet(table: int, h: float, i: int, row: Any) -> float:
    """Bring contact ``i`` to the instant at which it closes; that instant, 0 if not in this step.

    ``row`` becomes its normal row. A contact that carried something in the last step, or
    overlapped, is closed.
    """
    t = at.found(table)[i]
    place_as_found(table, i)
    normal_row(h, at.touches(table), i, row)
    start, trend = _motion(table, h, row, 0.0)
    row["want"], row["trend"] = start, trend
    row["gap"], row["closing"], row["bend"] = max(t["gap"], 0.0), start, trend
    s = time_to_close(t["gap"], start, trend)
    if t["listed"] or (t["gap"] < 0.0 and not -h <= s < 0.0):
        return 0.0
    for _ in range(ITERATIONS):
        s = _within(h, s)
        _carry(table, h, i, s)
        normal_row(h, at.touches(table), i, row)
        row["want"], row["trend"] = _motion(table, h, row, 0.0)
        row["gap"] = t["gap"]
        if abs(s) < TIME_TOLERANCE * h:
            return s
        row["bend"] = (row["want"] + row["trend"] * s - start) / s
        s = time_to_close(t["gap"], start, row["bend"])
    return _within(h, s)


@kernel
def _within(h: float, s: float) -> float:
    """An instant of this step, which rounding may have put just outside; 0 for any other."""
    return min(max(s, -h), h) if abs(s) <= h * (1.0 + TIME_TOLERANCE) else 0.0


@kernel
def place_as_found(table: int, i: int) -> None:
    """Put contact ``i`` where it is at the pose."""
    t, now = at.found(table)[i], at.touches(table)[i]
    now["nx"], now["ny"] = t["nx"], t["ny"]
    now["ax"], now["ay"], now["bx"], now["by"] = t["ax"], t["ay"], t["bx"], t["by"]


@kernel
def _motion(table: int, h: float, row: Any, s: float) -> tuple[float, float]:
    """The rate of a row at the instant ``s``, and how it changes with s."""
    before, free = rate(row, at.before(table)), rate(row, at.velocity(table))
    return before + (0.5 + s / h) * (free - before), (free - before) / h


@kernel
def tangent_motion(table: int, h: float, row: Any, belt: float) -> None:
    """Rate and trend of a tangential row."""
    row["want"], row["trend"] = _motion(table, h, row, 0.0)
    row["want"] += belt


@kernel
def mean(table: int, h: float, s: float, b: int, j: int) -> float:
    """Component ``j`` of the velocity of a body from the pose to the instant ``s``."""
    before = at.before(table)[b, j]
    return float(before + (0.5 + 0.5 * s / h) * (at.velocity(table)[b, j] - before))


@kernel
def _carry(table: int, h: float, i: int, s: float) -> None:
    """Take normal and arms of contact ``i`` from the pose to the instant ``s``."""
    t, now = at.found(table)[i], at.touches(table)[i]
    ka, da, kb, db = t["ka"], t["da"], t["kb"], t["db"]
    a, b, nx, ny, gap = t["a"], t["b"], t["nx"], t["ny"], t["gap"]
    wa, wb = mean(table, h, s, a, 2), mean(table, h, s, b, 2)
    # arms of the surfaces' points, half a gap from the middle
    ax, ay = t["ax"] - gap / 2 * nx, t["ay"] - gap / 2 * ny
    bx, by = t["bx"] + gap / 2 * nx, t["by"] + gap / 2 * ny
    slide = (nx * (mean(table, h, s, b, 1) + wb * bx - mean(table, h, s, a, 1) - wa * ax)
             - ny * (mean(table, h, s, b, 0) - wb * by - mean(table, h, s, a, 0) + wa * ay))
    below = ka * db + kb * da + ka * kb * gap
    turn, along_a, along_b = wa, 0.0, 0.0
    if below > 0.0:
        turn = (ka * kb * slide + kb * da * wa + ka * db * wb) / below
        along_a = da * (kb * slide + db * (wb - wa) - kb * wa * gap) / below
        along_b = db * (ka * slide + da * (wa - wb) - ka * wb * gap) / below
    mx, my = rotated(nx, ny, turn * s)
    if abs(da) < FLAT * abs(ka) and abs(db) < FLAT * abs(kb):  # along the line of the centres
        ra, rb = da / ka, db / kb
        ox, oy = rotated(ax - ra * nx, ay - ra * ny, wa * s)
        px, py = rotated(bx + rb * nx, by + rb * ny, wb * s)
        ux = mean(table, h, s, b, 0) - mean(table, h, s, a, 0)
        uy = mean(table, h, s, b, 1) - mean(table, h, s, a, 1)
        mx, my = gap * nx + s * ux + px - ox + ax - bx, gap * ny + s * uy + py - oy + ay - by
        size = math.copysign(math.hypot(mx, my), ra + rb + gap)
        mx, my = mx / size, my / size
    now["nx"], now["ny"] = mx, my
    now["ax"], now["ay"] = _arm(ax, ay, nx, ny, mx, my, ka, da, wa * s, along_a * s)
    now["bx"], now["by"] = _arm(bx, by, -nx, -ny, -mx, -my, kb, db, wb * s, along_b * s)


@kernel
def _arm(
    x: float, y: float, nx: float, ny: float, mx: float, my: float, k: float, d: float,
    angle: float, along: float,
) -> tuple[float, float]:
    """An arm when its body has turned and the outer normal has become (mx, my).

    Of a flat surface the point has moved along it, by ``along`` [m].
    """
    if abs(d) < FLAT * abs(k):
        x, y = rotated(x - d / k * nx, y - d / k * ny, angle)
        return x + d / k * mx, y + d / k * my
    x, y = rotated(x, y, angle)
    return x - along * my, y + along * mx
