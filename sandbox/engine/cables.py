"""Cables over guides: their lengths, how these change with the bodies, and their tables.

A guide is a circle of radius 0 or more. Walking along direction u with left
normal n, a circle whose centre lies right of the path has sign s = +1, left
s = -1; the cord touches it at p = c + s r n, and n . (c2 - c1) = s1 r1 - s2 r2
for a stretch between two circles. Every stretch pulls its two bodies at these
points, which also gives a wound-on end its torque s r T. A wheel that would have to hold
the cord back, for it lies on it by less than no angle, is left out: there the cord is off it.

Tables have whole cables as the model has them, then the spans of those that guides hold.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from sandbox.elements.element import GRAZE
from sandbox.engine import records
from sandbox.engine.element_tables import PlacedBodies, Rows
from sandbox.engine.kernel import kernel
from sandbox.engine.stiffness import cord_responses, stiff_cords
from sandbox.model.tendons import CordSpan, lifted_at_start, spans_of
from sandbox.numeric import Array, Records

ASIDE = -math.pi / 2
"""Where the angle of a cord that begins off its wheel is counted from [rad]: it is above - pi."""


@kernel
def _near(angle: float, last: float) -> float:
    return angle + 2 * math.pi * math.floor((last - angle) / (2 * math.pi) + 0.5)


@kernel
def measure(
    cord: Any, guides: Records, pose: Array, start: bool,
) -> float:
    """Length of a tendon [m] at ``pose`` [nb, 3]; fills its J. ``start``: count turns anew."""
    length = _along(cord, guides, pose, start)
    if cord["lifts"] and not start:
        for _ in range(2 * (cord["last"] - cord["first"])):
            if not _lay(cord, guides, pose):
                break
            length = _along(cord, guides, pose, start)
    return length


@kernel
def _along(
    cord: Any, guides: Records, pose: Array, start: bool,
) -> float:
    """The length over the guides that the cord lies on, as :func:`measure` has it."""
    length = 0.0
    first, last = cord["first"], cord["last"]
    for i in range(first, last):
        guides[i]["jx"] = guides[i]["jy"] = guides[i]["jt"] = 0.0
    angle_in = angle_out = 0.0
    i = first
    while i < last - 1:
        j = i + 1
        while guides[j]["lifted"]:  # the last one never is
            j += 1
        a, b = guides[i], guides[j]
        ra, rb = a["radius"], b["radius"]
        straight, ux, uy, ax, ay, bx, by = _stretch(a, b, pose)
        nx, ny = -uy, ux
        length += straight
        a["jx"] -= ux
        a["jy"] -= uy
        a["jt"] -= (ax + ra * nx) * uy - (ay + ra * ny) * ux
        b["jx"] += ux
        b["jy"] += uy
        b["jt"] += (bx + rb * nx) * uy - (by + rb * ny) * ux
        angle = math.atan2(ny, nx)
        if i == first:
            angle_out = angle
            if ra != 0.0 and not cord["closed"]:
                length -= ra * _unwound(angle - pose[a["body"], 2], a, start)
        elif ra != 0.0:
            length += abs(ra) * _wrapped(a, angle_in - angle, start)
        if rb != 0.0 and j == last - 1:
            length += (abs(rb) * _wrapped(b, angle - angle_out, start)
                       if cord["closed"]
                       else rb * _unwound(angle - pose[b["body"], 2], b, start))
        angle_in = angle
        i = j
    return length


@kernel
def _stretch(
    a: Any, b: Any, pose: Array,
) -> tuple[float, float, float, float, float, float, float]:
    """Length of the cord between two guides [m], its direction; the guides from their centres."""
    qa, qb = pose[a["body"]], pose[b["body"]]
    ca, sa, cb, sb = math.cos(qa[2]), math.sin(qa[2]), math.cos(qb[2]), math.sin(qb[2])
    ax, ay = ca * a["x"] - sa * a["y"], sa * a["x"] + ca * a["y"]
    bx, by = cb * b["x"] - sb * b["y"], sb * b["x"] + cb * b["y"]
    dx, dy = qb[0] + bx - qa[0] - ax, qb[1] + by - qa[1] - ay
    offset = a["radius"] - b["radius"]
    distance = math.hypot(dx, dy)
    straight = math.sqrt(max(distance * distance - offset * offset, 1e-24))
    square = straight * straight + offset * offset
    ux, uy = (straight * dx + offset * dy) / square, (straight * dy - offset * dx) / square
    return straight, ux, uy, ax, ay, bx, by


@kernel
def _lay(cord: Any, guides: Records, pose: Array) -> bool:
    """Take the cord off the wheel that it would have to push from, or lay it on one; whether so.

    The angle by which it lies on a wheel goes on below 0 where it is off, as if it were on: it is
    back on where that is above 0 again. One that comes round an end of the cord to its other side
    is a whole turn away from that. Of several the one that is furthest from right is changed.
    """
    worst, which, before = 0.0, -1, cord["first"]
    for i in range(cord["first"] + 1, cord["last"] - 1):
        if not guides[i]["lifts"]:
            before = i
            continue
        if not guides[i]["lifted"]:
            before = i
            wrong = -guides[i]["wrap"] - GRAZE
        else:
            after = i + 1
            while guides[after]["lifted"]:
                after += 1
            on, off = _stretch(guides[before], guides[i], pose), _stretch(
                guides[i], guides[after], pose)
            turn = math.atan2(on[1], -on[2]) - math.atan2(off[1], -off[2])
            wrong = _wrapped(guides[i], turn, False)
        if wrong > worst:
            worst, which = wrong, i
    if which >= 0:
        guides[which]["lifted"] = 1 - guides[which]["lifted"]
    return which >= 0


@kernel
def _wrapped(guide: Any, turn: float, start: bool) -> float:
    """The angle by which a cord lies on a wheel [rad] over which its direction turns by so much."""
    wrap = turn if guide["radius"] > 0 else -turn
    # a cord that just touches its wheel must not go once round it by rounding
    wrap = ((wrap + GRAZE) % (2 * math.pi) - GRAZE + 2 * math.pi * guide["turns"] if start
            else _near(wrap, guide["wrap"]))
    guide["wrap"] = wrap
    return wrap


@kernel
def _unwound(angle: float, guide: Any, start: bool) -> float:
    """How far the point where a wound cord leaves its wheel has gone since t = 0 [rad]."""
    psi = angle if start else _near(angle, guide["wrap"])
    guide["wrap"] = psi
    if start:
        guide["wrap0"] = psi
    return float(psi - guide["wrap0"])


@kernel
def wound_up(cord: Any, guides: Records) -> float:
    """How much of a cord the wheels at its ends have wound up since t = 0 [m], as last measured."""
    first, last = cord["first"], cord["last"] - 1
    return float(guides[last]["radius"] * (guides[last]["wrap"] - guides[last]["wrap0"])
                 - guides[first]["radius"] * (guides[first]["wrap"] - guides[first]["wrap0"]))


LEAST = 1e-3
"""Of what is in a span at t = 0: so short, and stiff, it may become."""

DRAG = 1e-7
"""Of a loop, as a share of what its stiffness does in a step."""


class CordTables(NamedTuple):
    """CORD, GUIDE and what belongs to them, spans behind whole cords; SLIP."""

    cords: Records
    guides: Records
    slips: Records
    drag: Array  # Of the slips of loops [N s^2/m], 0 of others
    sums: list[tuple[int, int]]
    """Rows of the spans on either side of each guide that holds a cord; where a drive pulls it that
    of the span before, twice."""


def cord_tables(places: PlacedBodies, h: float, rows: Rows) -> CordTables:
    """Tables of all tendons; their rows are added."""
    tendons = places.model.tendons
    spans = [span for cord in range(len(tendons.name)) for span in spans_of(tendons, cord)]
    whole = len(tendons.name)
    path = np.array([*range(len(tendons.guide_body)), *(g for span in spans for g in span.guides)],
                    dtype=np.int64)
    body = tendons.guide_body[path]
    guides = np.zeros(len(path), records.GUIDE)
    guides["body"], guides["radius"] = places.number[body], tendons.guide_radius[path]
    guides["turns"], guides["lifts"] = tendons.guide_turns[path], np.isin(path, tendons.wheels)
    guides["x"], guides["y"] = (tendons.guide_at[path] - places.model.bodies.centre[body]).T
    cords = whole + len(spans)
    found = CordTables(
        np.zeros(cords, records.CORD), guides, np.zeros(len(tendons.grips), records.SLIP),
        np.zeros(len(tendons.grips)), [])
    found.cords["active"] = 1
    off = lifted_at_start(places.model)[path]
    guides["lifted"], guides["wrap"] = off, np.where(off, ASIDE, 0.0)
    for name in ("row", "drive", "stiffener", "whole", "into", "out_of"):
        found.cords[name] = -1
    responses, stiff = cord_responses(places.model), stiff_cords(places.model, h)
    found.cords["response"][:whole] = responses
    for e, cord in enumerate(found.cords[:whole]):
        cord["first"], cord["last"] = tendons.first[e], tendons.first[e + 1]
        cord["closed"], cord["drive"] = tendons.closed[e], tendons.drive[e]
        cord["lifts"] = guides["lifts"][cord["first"]:cord["last"]].any()
        cord["stiffener"] = tendons.stiffener[e]
        found.cords[e]["k"], cord["c"] = tendons.stiffness[e], tendons.damping[e]
        length = _measured(places, found, e)
        rest = length if np.isnan(tendons.rest[e]) else tendons.rest[e]
        if not np.isnan(tendons.pretension[e]):
            rest = length - tendons.pretension[e] / tendons.stiffness[e]
        found.cords[e]["rest"] = rest + tendons.slack[e]
        if len(tendons.gripped(e)):
            cord["kind"] = records.GRIPPED
            continue
        cord["kind"] = (records.PULL if cord["drive"] >= 0 else records.STIFF if stiff[e]
                        else records.DAMPED if cord["c"] > 0 else records.ELASTIC)
        if cord["kind"] in (records.STIFF, records.DAMPED) and cord["response"] > 0:
            _add_row(found, rows, e, [])
    _add_spans(places, found, spans, rows, h)
    return found


def _measured(places: PlacedBodies, found: CordTables, e: int) -> float:
    length = measure(found.cords[e], found.guides, places.pose, True)
    found.cords[e]["length"] = length
    return float(length)


def _add_row(found: CordTables, rows: Rows, e: int, slides: list[int]) -> None:
    """The row of a cord: entries of its bodies, then of what slips into it and out of it."""
    cord = found.cords[e]
    bodies = sorted(set(found.guides["body"][cord["first"]:cord["last"]].tolist()))
    cord["row"], cord["entry"] = rows.add(*bodies, *slides)
    cord["entries"] = len(bodies)
    for n in range(cord["first"], cord["last"]):
        found.guides[n]["entry"] = cord["entry"] + bodies.index(found.guides[n]["body"])


def _add_spans(
    places: PlacedBodies, found: CordTables, spans: list[CordSpan], rows: Rows, h: float,
) -> None:
    """The spans behind the whole cords, and what slips between them."""
    tendons, bodies = places.model.tendons, len(places.inverse_mass)
    whole, guide = len(tendons.name), len(tendons.guide_body)
    for e, span in enumerate(spans, start=whole):
        cord, own = found.cords[e], found.cords[span.tendon]
        cord["first"], cord["last"] = guide, guide + len(span.guides)
        guide += len(span.guides)
        cord["lifts"] = found.guides["lifts"][cord["first"]:cord["last"]].any()
        cord["whole"] = span.tendon
        if own["spans_end"] == 0:
            own["spans"] = e
        own["spans_end"] = e + 1
        _measured(places, found, e)
        rest = found.cords[span.tendon]["rest"]
        found.cords[e]["k"] = found.cords[span.tendon]["k"] * rest
        cord["c"] = own["c"] * rest
        if span.out_of < 0 and own["drive"] >= 0:
            cord["kind"], cord["drive"] = records.PULL, own["drive"]
            continue
        slides = [bodies + slip for slip in (span.into, span.out_of) if slip >= 0]
        _add_row(found, rows, e, slides)
        entry = cord["entry"] + cord["entries"]
        if span.into >= 0:
            cord["into"], entry = entry, entry + 1
        if span.out_of >= 0:
            cord["out_of"] = entry
    stiff = stiff_cords(places.model, h)
    for e in np.flatnonzero(found.cords["kind"] == records.GRIPPED).tolist():
        own, length = found.cords[e], float(found.cords[e]["length"])
        part = slice(int(own["spans"]), int(own["spans_end"]))
        # what is in a span at t = 0 is stretched like the whole, or its share of the slack; what
        # lies on wheels that hold the cord is stretched, too, but does not hang
        lengths, rest = found.cords["length"][part], float(found.cords[e]["rest"])
        inside = lengths * (
            rest / length if rest <= length else 1 + (rest - length) / lengths.sum())
        found.cords["rest"][part] = found.cords["inside"][part] = inside
        found.cords["least"][part] = LEAST * inside
        # all spans are solved alike: at the step's end if one of them is too stiff
        largest = (found.cords["k"][part] / inside).max()
        quick = h * h * largest * own["response"] > records.SOFT
        of_row = found.cords["row"][part] >= 0
        kind = records.STIFF if stiff[e] or quick else records.EVEN
        found.cords["kind"][part][of_row] = kind
        if own["closed"]:
            found.drag[places.model.tendons.gripped(e)] = DRAG * h * h * largest
    count = len(tendons.grips)
    before = {span.out_of: e for e, span in enumerate(spans, start=whole)}
    after = {span.into: e for e, span in enumerate(spans, start=whole)}
    for k, slip in enumerate(found.slips):
        slip["before"], slip["after"] = before[k], after[k]
        slip["cord"] = found.cords[before[k]]["whole"]
        slip["guide"], slip["friction"] = tendons.grips[k], tendons.friction[k]
        path = tendons.guides(int(slip["cord"]))
        first = tendons.closed[slip["cord"]] and slip["guide"] == path.start
        slip["twin"] = path.stop - 1 if first else -1
        slip["slide"], slip["sum"] = bodies + k, bodies + count + k
        one, two = (int(found.cords[e]["row"]) for e in (before[k], after[k]))
        found.sums.append((one, two if two >= 0 else one))
