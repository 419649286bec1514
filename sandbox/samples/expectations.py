"""The verdict on a scene's ``expect`` list: one for every quantity that an entry names.

Statistics are taken over the samples of a window, both ends included. ``last w`` seconds are
counted back from the last sample. The value at an instant is interpolated between two samples. An
unknown quantity, an empty window, a sample without a value, or a window whose end the run did not
reach, fail with a reason.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from sandbox.elements.quantities import GRASP, NOT_HELD, row_of
from sandbox.model.catalogue import Source, UnknownQuantityError
from sandbox.numeric import Array
from sandbox.samples.grasps import STIFFNESS
from sandbox.samples.samples import Samples
from sandbox.scene.settings import ROUNDING, WITHIN, Expect, Looked

WHOLE = ("min", "max", "final")  # Statistics that are a whole number of whole numbers


@dataclass(frozen=True)
class Verdict:
    """The result of an expectation of one quantity."""

    quantity: str  # A concrete name; the pattern itself where it fits nothing
    statistic: str
    """``mean``, ``min``, ``max``, ``std`` (of the population), ``final`` or ``at 0.5 s``."""
    low: float  # Least value that passes; minus infinity where open
    high: float
    value: float  # nan where there is none
    ok: bool
    unit: str = ""
    because: str = ""  # Where the range comes from, in the scene's words
    reason: str = ""  # Why it failed, where the value alone does not tell

    @property
    def allowed(self) -> str:
        """The range in words: ``at most 3``, ``2.9 to 3.1``; empty where anything passes."""
        low, high = (f"{end:.6g}" if math.isfinite(end) else "" for end in (self.low, self.high))
        if low and high:
            return low if self.low == self.high else f"{low} to {high}"
        return f"at least {low}" if low else f"at most {high}" if high else ""


def verdicts(run: Samples) -> list[Verdict]:
    """The verdicts on a run: of its scene's ``expect`` list, then of the event that stopped it."""
    found = [verdict for expect in run.mechanism.expect for verdict in _judge(run, expect)]
    if stop := run.info.stopped:
        found.append(Verdict(
            stop.event, "stop", -math.inf, math.inf, stop.time, stop.verdict == "pass", unit="s",
            because=stop.because, reason=stop.because if stop.verdict == "fail" else ""))
    return found


def _judge(run: Samples, expect: Expect) -> Iterator[Verdict]:
    low, high = expect.range()
    blank = Verdict(expect.quantity, expect.statistic, low, high, math.nan, False,
                    because=expect.because)
    names, catalogue = run.match(blank.quantity), run.catalogue
    if not names:
        yield replace(blank, reason=str(UnknownQuantityError(
            blank.quantity, catalogue.near(blank.quantity), catalogue.lacking(blank.quantity))))
    chosen, unreached = window(run, expect)
    for name in names:
        source = catalogue.find(name)
        found, row = replace(blank, quantity=name, unit=source.unit), row_of(
            source.kind, source.quantity)
        # the default range has no width for 1 or 0, and for counts if it holds no other
        if expect.value is not None and expect.within == WITHIN and (row.yes_no or (
                row.count and high - low < 1 and expect.statistic in WHOLE
                and float(expect.value).is_integer())):
            found = replace(found, low=expect.value, high=expect.value)
        value, reason = measured(run, name, expect, chosen)
        if not reason:
            reason = unreached
            if value < found.low and source.quantity == "held" and not reason and (
                    because := _not_held(run, source, _looked_at(run, expect, chosen))):
                reason = f"{NOT_HELD}{because}"
            found = replace(found, ok=found.low <= value <= found.high and not unreached)
        yield replace(found, value=value, reason=reason)


def measured(run: Samples, quantity: str, spec: Looked, chosen: slice) -> tuple[float, str]:
    """The :func:`number_of` a quantity over samples; nan and the reason if it has none."""
    looked = _looked_at(run, spec, chosen)
    if looked.stop <= looked.start:
        return math.nan, "no sample lies in the window"
    values = run.within(quantity, looked)
    if not (lacking := np.isnan(values)).any():
        return number_of(spec, run.time[looked], values), ""
    lacks = (f"{np.count_nonzero(lacking)} of {len(lacking)} samples have no value"
            if len(lacking) > 1 else "the last sample has no value")
    source = run.catalogue.find(quantity)
    if source.kind != "body" or source.quantity not in GRASP:
        return math.nan, lacks
    because, when = _not_held(run, source, looked), GRASP[source.quantity].nothing
    if source.quantity in STIFFNESS:
        when = NOT_HELD if because else run.grasp(source.index).no_stiffness
    return math.nan, f"{lacks}: {when} then{because}" if when else lacks


def _looked_at(run: Samples, spec: Looked, chosen: slice) -> slice:
    """The samples that a statistic is taken of; empty where the window is."""
    start, stop, _ = chosen.indices(len(run))
    return slice(stop - 1, stop) if spec.key == "final" and stop > start else slice(start, stop)


def _not_held(run: Samples, source: Source, looked: slice) -> str:
    """Why an object is not held in the first such sample of a window; empty of other quantities."""
    if source.kind != "body" or source.quantity not in GRASP or not GRASP[source.quantity].of_free:
        return ""
    grasp = run.grasp(source.index)
    lost = looked.start + np.flatnonzero(~grasp.held[looked])
    return f", first at {run.time[lost[0]]:.6g} s: {grasp.why_not(int(lost[0]))}" \
        if len(lost) else ""


def number_of(spec: Looked, time: Array, values: Array) -> float:
    """The statistic of the values [n] at the instants ``time`` [n], n > 0."""
    if spec.at is not None:
        if len(time) == 1:
            return float(values[0])
        share = (spec.at - time[0]) / (time[1] - time[0])
        return float((1 - share) * values[0] + share * values[1])
    if spec.key == "final":
        return float(values[-1])
    with np.errstate(invalid="ignore"):  # of what is infinite there is no deviation
        return float(getattr(np, spec.key)(values))


def window(run: Samples, expect: Looked) -> tuple[slice, str]:
    """The samples of a window, and a reason if the run stopped before its end."""
    time, end = run.time, expect.over[1] if expect.at is None else expect.at
    if not len(time):
        return slice(0, 0), ""
    chosen = among(time, expect)
    if beyond := expect.past_end(run.mechanism.run.duration):
        return chosen, beyond
    stop = run.info.stopped
    if stop and end is not None and end > stop.time + ROUNDING:
        return chosen, f"the event {stop.event} stopped the run before {end:g} s"
    if not run.complete and (end is None or end > time[-1]):
        return chosen, f"the run stopped at {time[-1]:.6g} s, before its end"
    return chosen, ""


def among(time: Array, expect: Looked) -> slice:
    """The samples at instants [n], n > 0, in a window; the two beside ``at``, or at the ends."""
    if expect.at is not None:
        first = max(min(int(np.searchsorted(time, expect.at)), len(time) - 1) - 1, 0)
        return slice(first, first + 2)
    start, end = expect.over
    if end is None and math.copysign(1.0, start) < 0:
        start += float(time[-1])
    first = int(np.searchsorted(time, start - ROUNDING, side="left"))
    last = len(time) if end is None else int(np.searchsorted(time, end + ROUNDING, side="right"))
    return slice(first, last)
