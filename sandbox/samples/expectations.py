"""The verdict on a scene's ``expect`` list: one for every quantity that an entry names.

Statistics are taken over the samples of a window, both ends included. ``last
w`` seconds are counted back from the last sample. The value at an instant lies on the straight
line of the two samples about it. An expectation holds only if
there is a number that lies in its range: an unknown quantity, an empty window,
a sample without a value, or a window that the run did not reach the end of,
fail with a reason.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from sandbox.elements.quantities import GRASP, NOT_HELD, is_count, is_yes_no
from sandbox.model.catalogue import Source, UnknownQuantityError
from sandbox.numeric import Array, Flags
from sandbox.samples.grasps import STIFFNESS
from sandbox.samples.samples import Samples
from sandbox.scene.settings import ROUNDING, WITHIN, Expect, Looked
from sandbox.wording import is_pattern

WHOLE = ("min", "max", "final")
"""Statistics that are a whole number of whole numbers."""


@dataclass(frozen=True, repr=False)
class Verdict:
    """What became of an expectation of one quantity."""

    quantity: str
    """A concrete name; the pattern itself where it fits nothing."""
    statistic: str
    """``mean``, ``min``, ``max``, ``std`` (of the population), ``final`` or ``at 0.5 s``."""
    low: float
    """Least value that passes; minus infinity where open."""
    high: float
    value: float
    """nan where there is none."""
    ok: bool
    unit: str = ""
    because: str = ""
    """Where the range comes from, in the scene's words."""
    reason: str = ""
    """Why it failed, where the value alone does not tell."""

    def __repr__(self) -> str:
        unit = "" if self.unit in ("", "1") else f" {self.unit}"
        said = "; ".join(each for each in (
            self.allowed, self.reason, "pass" if self.ok else "FAIL") if each)
        return f"<Verdict: {self.quantity} {self.statistic} {self.value:.6g}{unit}; {said}>"

    @property
    def allowed(self) -> str:
        """The range in words: ``at most 3``, ``2.9 to 3.1``; empty where anything passes."""
        low, high = math.isfinite(self.low), math.isfinite(self.high)
        if low and high:
            if self.low == self.high:
                return f"{self.low:.6g}"
            return f"{self.low:.6g} to {self.high:.6g}"
        return f"at least {self.low:.6g}" if low else f"at most {self.high:.6g}" if high else ""


def verdicts(run: Samples) -> list[Verdict]:
    """The verdicts on a run, in the order of its scene's ``expect`` list.

    A run that an event stopped ends with that event's verdict.
    """
    return [*(verdict for expect in run.mechanism.expect for verdict in _judge(run, expect)),
            *_stopped(run)]


def _stopped(run: Samples) -> list[Verdict]:
    stop = run.info.stopped
    if stop is None:
        return []
    failed = stop.verdict == "fail"
    return [Verdict(
        stop.event, "stop", -math.inf, math.inf, stop.time, not failed, unit="s",
        because=stop.because, reason=stop.because if failed else "")]


def _judge(run: Samples, expect: Expect) -> list[Verdict]:
    low, high, wrong = _range(expect)
    blank = Verdict(expect.quantity, expect.statistic, low, high, math.nan, False,
                    because=expect.because, reason=wrong)
    names = run.match(expect.quantity)
    if not names:
        return [replace(blank, reason=_missing(run, expect.quantity))]
    chosen, unreached = window(run, expect)
    return [_measure(run, _named(run, blank, name, expect), expect, chosen, unreached)
            for name in names]


def _named(run: Samples, blank: Verdict, name: str, expect: Expect) -> Verdict:
    """A verdict to come on a quantity; of what is 1 or 0 the default range has no width.

    Nor has that of a count, where it holds no other whole number.
    """
    found, source = replace(blank, quantity=name, unit=run.unit(name)), run.catalogue.find(name)
    if expect.value is None or expect.within != WITHIN:
        return found
    alone = found.high - found.low < 1 and expect.statistic in WHOLE and float(
        expect.value).is_integer()
    if is_yes_no(source.kind, source.quantity) or (
            alone and is_count(source.kind, source.quantity)):
        return replace(found, low=expect.value, high=expect.value)
    return found


def _measure(
    run: Samples, verdict: Verdict, expect: Expect, chosen: slice, unreached: str,
) -> Verdict:
    if verdict.reason:
        return verdict
    value, reason = measured(run, verdict.quantity, expect, chosen)
    if reason:
        return replace(verdict, reason=reason)
    ok = bool(verdict.low <= value <= verdict.high) and not unreached
    reason, source = unreached, run.catalogue.find(verdict.quantity)
    if not reason and value < verdict.low and source.quantity == "held" and (
            because := _not_held(run, source, _looked_at(run, expect, chosen))):
        reason = f"{NOT_HELD}{because}"
    return replace(verdict, value=value, ok=ok, reason=reason)


def measured(run: Samples, quantity: str, asked: Looked, chosen: slice) -> tuple[float, str]:
    """The :func:`number_of` a quantity over samples; nan and why if it has none.

    Raises:
        UnknownQuantityError: the run has no such quantity.
    """
    looked = _looked_at(run, asked, chosen)
    if looked.stop <= looked.start:
        return math.nan, "no sample lies in the window"
    values = run.within(quantity, looked)
    if np.isnan(values).any():
        source = run.catalogue.find(quantity)
        return math.nan, _no_value(run, source, looked, np.isnan(values))
    return number_of(asked, run.time[looked], values), ""


def _looked_at(run: Samples, asked: Looked, chosen: slice) -> slice:
    """The samples that a statistic is taken of; empty where the window is."""
    start, stop, _ = chosen.indices(len(run))
    return slice(stop - 1, stop) if asked.key == "final" and stop > start else slice(start, stop)


def _no_value(run: Samples, source: Source, looked: slice, lacking: Flags) -> str:
    """How many of the samples that are looked at have no value, and why: ``lacking``, [k]."""
    told = (f"{np.count_nonzero(lacking)} of {len(lacking)} samples have no value"
            if len(lacking) > 1 else "the last sample has no value")
    if source.kind != "body" or source.quantity not in GRASP:
        return told
    because = _not_held(run, source, looked)
    when = GRASP[source.quantity].nothing
    if source.quantity in STIFFNESS:
        when = NOT_HELD if because else run.grasp(source.index).no_stiffness
    return f"{told}: {when} then{because}" if when else told


def _not_held(run: Samples, source: Source, chosen: slice) -> str:
    """Why an object is not held in the first such sample of a window; empty of other quantities."""
    if source.kind != "body" or source.quantity not in GRASP or not GRASP[source.quantity].of_free:
        return ""
    grasp = run.grasp(source.index)
    lost = np.flatnonzero(~grasp.held[chosen])
    if not len(lost):
        return ""
    first = int(np.arange(len(run))[chosen][lost[0]])
    return f", first at {run.time[first]:.6g} s: {grasp.why_not(first)}"


def number_of(asked: Looked, time: Array, values: Array) -> float:
    """The number that is made of the values [n] of the instants ``time`` [n], n > 0."""
    if asked.at is not None:
        if len(time) == 1:
            return float(values[0])
        share = (asked.at - time[0]) / (time[1] - time[0])
        return float((1 - share) * values[0] + share * values[1])
    if asked.key == "final":
        return float(values[-1])
    with np.errstate(invalid="ignore"):  # of what is infinite there is no deviation
        return float(getattr(np, asked.key)(values))


def _range(expect: Expect) -> tuple[float, float, str]:
    try:
        return *expect.range(), ""
    except ValueError as error:
        return math.nan, math.nan, f"the range cannot be read: {error}"


def _missing(run: Samples, name: str) -> str:
    if is_pattern(name):
        near = run.catalogue.near(name)
        return "no quantity fits" + (f"; did you mean {near!r}?" if near else "")
    return str(UnknownQuantityError(name, run.catalogue.near(name), run.catalogue.lacking(name)))


def window(run: Samples, expect: Looked) -> tuple[slice, str]:
    """The samples of a window, and a reason if the run stopped short of its end."""
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
    """Which of the instants ``time`` [n], n > 0, rising, lie in an expectation's window.

    Of an expectation at an instant, the two about it: the first or last two beyond the ends.
    """
    if expect.at is not None:
        first = max(min(int(np.searchsorted(time, expect.at)), len(time) - 1) - 1, 0)
        return slice(first, first + 2)
    start, end = expect.over
    if end is None and math.copysign(1.0, start) < 0:
        start += float(time[-1])
    first = int(np.searchsorted(time, start - ROUNDING, side="left"))
    last = len(time) if end is None else int(np.searchsorted(time, end + ROUNDING, side="right"))
    return slice(first, last)
