"""Tables of cords: whole ones as the model has them, then the spans of those that guides hold."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.engine.network import ASIDE, measure
from sandbox.engine.plan import PlacedBodies, Rows
from sandbox.engine.records import (
    CORD,
    CORD_RESULT,
    CORD_STATE,
    DAMPED,
    ELASTIC,
    EVEN,
    GRIPPED,
    GUIDE,
    GUIDE_RESULT,
    GUIDE_STATE,
    PULL,
    SLIP,
    SOFT,
    STIFF,
)
from sandbox.engine.stiffness import cord_responses, stiff_cords
from sandbox.model.tendons import CordSpan, lifted_at_start, spans_of
from sandbox.numeric import Array, Integers, Records

LEAST = 1e-3
"""Of what is in a span at t = 0: so short, and stiff, it may become."""

DRAG = 1e-7
"""Of a loop, as a share of what its stiffness does in a step."""


class CordTables(NamedTuple):
    """CORD, GUIDE and what belongs to them, spans behind whole cords; SLIP."""

    constants: Records
    state: Records
    result: Records
    guides: Records
    guide_state: Records
    guide_result: Records
    slips: Records
    drag: Array
    """Of the slips of loops [N s^2/m], 0 of others."""
    sums: list[tuple[int, int]]
    """Rows of the spans on either side of each guide that holds a cord; where a drive pulls it that
    of the span before, twice."""


def cord_tables(places: PlacedBodies, h: float, rows: Rows) -> CordTables:
    """Tables of all tendons; their rows are added."""
    tendons = places.model.tendons
    spans = [span for cord in range(len(tendons.name)) for span in spans_of(tendons, cord)]
    whole = len(tendons.name)
    path = [*range(len(tendons.guide_body)), *(g for span in spans for g in span.guides)]
    guides = _guides(places, np.array(path, dtype=np.int64))
    found = CordTables(
        np.zeros(whole + len(spans), CORD), np.zeros(whole + len(spans), CORD_STATE),
        np.zeros(whole + len(spans), CORD_RESULT), guides, np.zeros(len(path), GUIDE_STATE),
        np.zeros(len(path), GUIDE_RESULT), np.zeros(len(tendons.grips), SLIP),
        np.zeros(len(tendons.grips)), [])
    found.state["active"] = 1
    off = lifted_at_start(places.model)[path]
    found.guide_state["lifted"], found.guide_state["wrap"] = off, np.where(off, ASIDE, 0.0)
    for name in ("row", "drive", "stiffener", "whole", "into", "out_of"):
        found.constants[name] = -1
    responses, stiff = cord_responses(places.model), stiff_cords(places.model, h)
    found.constants["response"][:whole] = responses
    for e, cord in enumerate(found.constants[:whole]):
        cord["first"], cord["last"] = tendons.first[e], tendons.first[e + 1]
        cord["closed"], cord["drive"] = tendons.closed[e], tendons.drive[e]
        cord["lifts"] = guides["lifts"][cord["first"]:cord["last"]].any()
        cord["stiffener"] = tendons.stiffener[e]
        found.state[e]["k"], cord["c"] = tendons.stiffness[e], tendons.damping[e]
        length = _measured(places, found, e)
        rest = length if np.isnan(tendons.rest[e]) else tendons.rest[e]
        if not np.isnan(tendons.pretension[e]):
            rest = length - tendons.pretension[e] / tendons.stiffness[e]
        found.state[e]["rest"] = rest + tendons.slack[e]
        if len(tendons.gripped(e)):
            cord["kind"] = GRIPPED
            continue
        cord["kind"] = (PULL if cord["drive"] >= 0 else STIFF if stiff[e]
                        else DAMPED if cord["c"] > 0 else ELASTIC)
        if cord["kind"] in (STIFF, DAMPED) and cord["response"] > 0:
            _add_row(found, rows, e, [])
    _add_spans(places, found, spans, rows, h)
    return found


def _guides(places: PlacedBodies, path: Integers) -> Records:
    tendons = places.model.tendons
    body = tendons.guide_body[path]
    guides = np.zeros(len(path), GUIDE)
    guides["body"], guides["radius"] = places.number[body], tendons.guide_radius[path]
    guides["turns"] = tendons.guide_turns[path]
    guides["lifts"] = np.isin(path, tendons.wheels)
    guides["x"], guides["y"] = (tendons.guide_at[path] - places.model.bodies.centre[body]).T
    return guides


def _measured(places: PlacedBodies, found: CordTables, e: int) -> float:
    """The length of a cord at t = 0 [m], from which its turns are counted."""
    length = measure(found.constants[e], found.guides, found.guide_state,
                             found.guide_result, places.pose, True)
    found.result[e]["length"] = length
    return float(length)


def _add_row(found: CordTables, rows: Rows, e: int, slides: list[int]) -> None:
    """The row of a cord: entries of its bodies, then of what slips into it and out of it."""
    cord = found.constants[e]
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
        cord, own = found.constants[e], found.constants[span.tendon]
        cord["first"], cord["last"] = guide, guide + len(span.guides)
        guide += len(span.guides)
        cord["lifts"] = found.guides["lifts"][cord["first"]:cord["last"]].any()
        cord["whole"] = span.tendon
        if own["spans_end"] == 0:
            own["spans"] = e
        own["spans_end"] = e + 1
        _measured(places, found, e)
        rest = found.state[span.tendon]["rest"]
        found.state[e]["k"] = found.state[span.tendon]["k"] * rest
        cord["c"] = own["c"] * rest
        if span.out_of < 0 and own["drive"] >= 0:
            cord["kind"], cord["drive"] = PULL, own["drive"]
            continue
        slides = [bodies + slip for slip in (span.into, span.out_of) if slip >= 0]
        _add_row(found, rows, e, slides)
        entry = cord["entry"] + cord["entries"]
        if span.into >= 0:
            cord["into"], entry = entry, entry + 1
        if span.out_of >= 0:
            cord["out_of"] = entry
    _fill(found)
    _choose_kinds(places, found, h)
    _add_slips(places, found, spans)


def _fill(found: CordTables) -> None:
    """Put into each span what is there at t = 0: stretched like the whole, or its share of slack.

    What lies on wheels that hold the cord is stretched, too, but does not hang.
    """
    for e in np.flatnonzero(found.constants["kind"] == GRIPPED):
        own, whole = found.constants[e], float(found.result[e]["length"])
        spans = slice(int(own["spans"]), int(own["spans_end"]))
        length, rest = found.result["length"][spans], float(found.state[e]["rest"])
        inside = length * (rest / whole if rest <= whole else 1 + (rest - whole) / length.sum())
        found.state["rest"][spans] = found.state["inside"][spans] = inside
        found.constants["least"][spans] = LEAST * inside


def _choose_kinds(places: PlacedBodies, found: CordTables, h: float) -> None:
    """All spans of a cord are solved alike: at the step's end if one of them is too stiff."""
    stiff = stiff_cords(places.model, h)
    for e in np.flatnonzero(found.constants["kind"] == GRIPPED):
        own = found.constants[e]
        spans = slice(int(own["spans"]), int(own["spans_end"]))
        largest = (found.state["k"][spans] / found.state["rest"][spans]).max()
        quick = h * h * largest * own["response"] > SOFT
        of_row = found.constants["row"][spans] >= 0
        found.constants["kind"][spans][of_row] = STIFF if stiff[e] or quick else EVEN
        if own["closed"]:
            found.drag[places.model.tendons.gripped(int(e))] = DRAG * h * h * largest


def _add_slips(places: PlacedBodies, found: CordTables, spans: list[CordSpan]) -> None:
    tendons, bodies = places.model.tendons, len(places.inverse_mass)
    whole, count = len(tendons.name), len(tendons.grips)
    before = {span.out_of: e for e, span in enumerate(spans, start=whole)}
    after = {span.into: e for e, span in enumerate(spans, start=whole)}
    for k, slip in enumerate(found.slips):
        slip["before"], slip["after"] = before[k], after[k]
        slip["cord"] = found.constants[before[k]]["whole"]
        slip["guide"], slip["friction"] = tendons.grips[k], tendons.friction[k]
        path = tendons.guides(int(slip["cord"]))
        first = tendons.closed[slip["cord"]] and slip["guide"] == path.start
        slip["twin"] = path.stop - 1 if first else -1
        slip["slide"], slip["sum"] = bodies + k, bodies + count + k
        one, two = (int(found.constants[e]["row"]) for e in (before[k], after[k]))
        found.sums.append((one, two if two >= 0 else one))
