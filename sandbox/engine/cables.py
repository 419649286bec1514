"""Cables over guides: their lengths, how these change with the bodies, and their tables.

A guide is a circle of radius 0 or more. Walking along direction u with left
normal n, a circle whose centre lies right of the path has sign s = +1, left
s = -1; the tendon touches it at p = c + s r n, and n . (c2 - c1) = s1 r1 - s2 r2
for a stretch between two circles. Every stretch pulls its two bodies at these
points, which also gives a wound-on end its torque s r T. A wheel that would have to hold
the tendon back, for it lies on it by less than no angle, is left out: there the tendon is off it.

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
from sandbox.engine.stiffness import cable_responses, stiff_cables
from sandbox.model.tendons import CableSpan, lifted_at_start, spans_of
from sandbox.numeric import Array, Records

ASIDE = -math.pi / 2
"""Where the angle of a tendon that begins off its wheel is counted from [rad]: it is above - pi."""


@kernel
def _near(angle: float, last: float) -> float:
    return angle + 2 * math.pi * math.floor((last - angle) / (2 * math.pi) + 0.5)


@kernel
def measure(
    cable: Any, guides: Records, pose: Array, start: bool,
) -> float:
    """Length of a tendon [m] at ``pose`` [nb, 3]; fills its J. ``start``: count turns anew."""
    length = _along(cable, guides, pose, start)
    if cable["lifts"] and not start:
        for _ in range(2 * (cable["last"] - cable["first"])):
            if not _lay(cable, guides, pose):
                break
            length = _along(cable, guides, pose, start)
    return length


@kernel
def _along(
    cable: Any, guides: Records, pose: Array, start: bool,
) -> float:
    """The length over the guides that the tendon lies on, as :func:`measure` has it."""
    length = 0.0
    first, last = cable["first"], cable["last"]
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
            if ra != 0.0 and not cable["closed"]:
                length -= ra * _unwound(angle - pose[a["body"], 2], a, start)
        elif ra != 0.0:
            length += abs(ra) * _wrapped(a, angle_in - angle, start)
        if rb != 0.0 and j == last - 1:
            length += (abs(rb) * _wrapped(b, angle - angle_out, start)
                       if cable["closed"]
                       else rb * _unwound(angle - pose[b["body"], 2], b, start))
        angle_in = angle
        i = j
    return length


@kernel
def _stretch(
    a: Any, b: Any, pose: Array,
) -> tuple[float, float, float, float, float, float, float]:
    """Length of the tendon between two guides [m], its direction; the guides from their centres."""
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
def _lay(cable: Any, guides: Records, pose: Array) -> bool:
    """Take the tendon off the wheel that it would have to push from, or lay it on one; whether so.

    The angle by which it lies on a wheel goes on below 0 where it is off, as if it were on: it is
    back on where that is above 0 again. One that comes round an end of the tendon to its other side
    is a whole turn away from that. Of several the one that is furthest from right is changed.
    """
    worst, which, before = 0.0, -1, cable["first"]
    for i in range(cable["first"] + 1, cable["last"] - 1):
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
    """The angle of contact of a tendon on a wheel [rad] whose direction turns by ``turn``."""
    wrap = turn if guide["radius"] > 0 else -turn
    # a tendon that just touches its wheel must not go once round it by rounding
    wrap = ((wrap + GRAZE) % (2 * math.pi) - GRAZE + 2 * math.pi * guide["turns"] if start
            else _near(wrap, guide["wrap"]))
    guide["wrap"] = wrap
    return wrap


@kernel
def _unwound(angle: float, guide: Any, start: bool) -> float:
    """How far the point where a wound tendon leaves its wheel has gone since t = 0 [rad]."""
    psi = angle if start else _near(angle, guide["wrap"])
    guide["wrap"] = psi
    if start:
        guide["wrap0"] = psi
    return float(psi - guide["wrap0"])


@kernel
def wound_up(cable: Any, guides: Records) -> float:
    """The length of a tendon that the wheels at its ends have wound up since t = 0 [m]."""
    first, last = cable["first"], cable["last"] - 1
    return float(guides[last]["radius"] * (guides[last]["wrap"] - guides[last]["wrap0"])
                 - guides[first]["radius"] * (guides[first]["wrap"] - guides[first]["wrap0"]))


LEAST = 1e-3
"""Of what is in a span at t = 0: so short, and stiff, it may become."""

DRAG = 1e-7
"""Of a loop, as a share of what its stiffness does in a step."""


class CableTables(NamedTuple):
    """CABLE, GUIDE and what belongs to them, spans behind whole tendons; SLIP."""

    cables: Records
    guides: Records
    slips: Records
    drag: Array  # Of the slips of loops [N s^2/m], 0 of others
    sums: list[tuple[int, int]]
    """Rows of the spans on either side of each guide that holds a tendon; where a drive pulls it,
    that of the span before, twice."""


def cable_tables(places: PlacedBodies, h: float, rows: Rows) -> CableTables:
    """Tables of all tendons; their rows are added."""
    tendons = places.model.tendons
    spans = [span for cable in range(len(tendons.name)) for span in spans_of(tendons, cable)]
    whole = len(tendons.name)
    path = np.array([*range(len(tendons.guide_body)), *(g for span in spans for g in span.guides)],
                    dtype=np.int64)
    body = tendons.guide_body[path]
    guides = np.zeros(len(path), records.GUIDE)
    guides["body"], guides["radius"] = places.number[body], tendons.guide_radius[path]
    guides["turns"], guides["lifts"] = tendons.guide_turns[path], np.isin(path, tendons.wheels)
    guides["x"], guides["y"] = (tendons.guide_at[path] - places.model.bodies.centre[body]).T
    cables = whole + len(spans)
    found = CableTables(
        np.zeros(cables, records.CABLE), guides, np.zeros(len(tendons.grips), records.SLIP),
        np.zeros(len(tendons.grips)), [])
    found.cables["active"] = 1
    off = lifted_at_start(places.model)[path]
    guides["lifted"], guides["wrap"] = off, np.where(off, ASIDE, 0.0)
    for name in ("row", "drive", "stiffener", "whole", "into", "out_of"):
        found.cables[name] = -1
    responses, stiff = cable_responses(places.model), stiff_cables(places.model, h)
    found.cables["response"][:whole] = responses
    for e, cable in enumerate(found.cables[:whole]):
        cable["first"], cable["last"] = tendons.first[e], tendons.first[e + 1]
        cable["closed"], cable["drive"] = tendons.closed[e], tendons.drive[e]
        cable["lifts"] = guides["lifts"][cable["first"]:cable["last"]].any()
        cable["stiffener"] = tendons.stiffener[e]
        found.cables[e]["k"], cable["c"] = tendons.stiffness[e], tendons.damping[e]
        length = _measured(places, found, e)
        rest = length if np.isnan(tendons.rest[e]) else tendons.rest[e]
        if not np.isnan(tendons.pretension[e]):
            rest = length - tendons.pretension[e] / tendons.stiffness[e]
        found.cables[e]["rest"] = rest + tendons.slack[e]
        if len(tendons.gripped(e)):
            cable["kind"] = records.GRIPPED
            continue
        cable["kind"] = (records.PULL if cable["drive"] >= 0 else records.STIFF if stiff[e]
                        else records.DAMPED if cable["c"] > 0 else records.ELASTIC)
        if cable["kind"] in (records.STIFF, records.DAMPED) and cable["response"] > 0:
            _add_row(found, rows, e, [])
    _add_spans(places, found, spans, rows, h)
    return found


def _measured(places: PlacedBodies, found: CableTables, e: int) -> float:
    length = measure(found.cables[e], found.guides, places.pose, True)
    found.cables[e]["length"] = length
    return float(length)


def _add_row(found: CableTables, rows: Rows, e: int, slides: list[int]) -> None:
    """The row of a tendon: entries of its bodies, then of what slips into it and out of it."""
    cable = found.cables[e]
    bodies = sorted(set(found.guides["body"][cable["first"]:cable["last"]].tolist()))
    cable["row"], cable["entry"] = rows.add(*bodies, *slides)
    cable["entries"] = len(bodies)
    for n in range(cable["first"], cable["last"]):
        found.guides[n]["entry"] = cable["entry"] + bodies.index(found.guides[n]["body"])


def _add_spans(
    places: PlacedBodies, found: CableTables, spans: list[CableSpan], rows: Rows, h: float,
) -> None:
    """The spans behind the whole tendons, and what slips between them."""
    tendons, bodies = places.model.tendons, len(places.inverse_mass)
    whole, guide = len(tendons.name), len(tendons.guide_body)
    for e, span in enumerate(spans, start=whole):
        cable, own = found.cables[e], found.cables[span.tendon]
        cable["first"], cable["last"] = guide, guide + len(span.guides)
        guide += len(span.guides)
        cable["lifts"] = found.guides["lifts"][cable["first"]:cable["last"]].any()
        cable["whole"] = span.tendon
        if own["spans_end"] == 0:
            own["spans"] = e
        own["spans_end"] = e + 1
        _measured(places, found, e)
        rest = found.cables[span.tendon]["rest"]
        found.cables[e]["k"] = found.cables[span.tendon]["k"] * rest
        cable["c"] = own["c"] * rest
        if span.out_of < 0 and own["drive"] >= 0:
            cable["kind"], cable["drive"] = records.PULL, own["drive"]
            continue
        slides = [bodies + slip for slip in (span.into, span.out_of) if slip >= 0]
        _add_row(found, rows, e, slides)
        entry = cable["entry"] + cable["entries"]
        if span.into >= 0:
            cable["into"], entry = entry, entry + 1
        if span.out_of >= 0:
            cable["out_of"] = entry
    stiff = stiff_cables(places.model, h)
    for e in np.flatnonzero(found.cables["kind"] == records.GRIPPED).tolist():
        own, length = found.cables[e], float(found.cables[e]["length"])
        part = slice(int(own["spans"]), int(own["spans_end"]))
        # what is in a span at t = 0 is stretched like the whole, or its share of the slack; what
        # lies on wheels that hold the tendon is stretched, too, but does not hang
        lengths, rest = found.cables["length"][part], float(found.cables[e]["rest"])
        inside = lengths * (
            rest / length if rest <= length else 1 + (rest - length) / lengths.sum())
        found.cables["rest"][part] = found.cables["inside"][part] = inside
        found.cables["least"][part] = LEAST * inside
        # all spans are solved alike: at the step's end if one of them is too stiff
        largest = (found.cables["k"][part] / inside).max()
        quick = h * h * largest * own["response"] > records.SOFT
        of_row = found.cables["row"][part] >= 0
        kind = records.STIFF if stiff[e] or quick else records.EVEN
        found.cables["kind"][part][of_row] = kind
        if own["closed"]:
            found.drag[places.model.tendons.gripped(e)] = DRAG * h * h * largest
    count = len(tendons.grips)
    before = {span.out_of: e for e, span in enumerate(spans, start=whole)}
    after = {span.into: e for e, span in enumerate(spans, start=whole)}
    for k, slip in enumerate(found.slips):
        slip["before"], slip["after"] = before[k], after[k]
        slip["cable"] = found.cables[before[k]]["whole"]
        slip["guide"], slip["friction"] = tendons.grips[k], tendons.friction[k]
        path = tendons.guides(int(slip["cable"]))
        first = tendons.closed[slip["cable"]] and slip["guide"] == path.start
        slip["twin"] = path.stop - 1 if first else -1
        slip["slide"], slip["sum"] = bodies + k, bodies + count + k
        one, two = (int(found.cables[e]["row"]) for e in (before[k], after[k]))
        found.sums.append((one, two if two >= 0 else one))
