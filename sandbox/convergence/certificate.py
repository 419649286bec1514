"""The convergence check of a scene: runs at h, h/2 and h/4, verdicts on expectations, advice.

All runs are sampled at every step, to include peaks between the scene's samples. If a quantity
depends on the step as q(h) = q_0 + C h^p, three runs give its order p and its limit q_0, and with
them the error at h (Richardson extrapolation; P. J. Roache, *Verification and Validation in
Computational Science and Engineering*, 1998, chapter 5):

    p = log2( (q(h) - q(h/2)) / (q(h/2) - q(h/4)) )
    q_0 = q(h/4) - (q(h/2) - q(h/4)) / (2^p - 1)

Differences of unlike sign, or that hardly fall, give neither. An error counts as small if it is
a tenth of what the expectation allows (:func:`tolerance`).
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from multiprocessing import get_context
from typing import Any, NamedTuple

import numpy as np

from sandbox.audit.audit import Figure, audit
from sandbox.elements.controllers.controller import every
from sandbox.engine.inputs import make_clock
from sandbox.engine.simulate import simulate
from sandbox.errors import Problem, SceneError, SimulationDiverged
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import Verdict, among, number_of, verdicts, window
from sandbox.samples.outcome import Status
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import Expect

ROUNDING = 1e-9  # differences below this share of the quantity's size are rounding
SHARE = 0.1  # of a tolerance, that an error may take
WIDE = 0.1  # a range wider than this share of the quantity is no tolerance
SLIGHT = 1e-3  # smaller than this share of the largest quantity of its unit: no size of its own
MIN_ORDER = 0.5  # differences that fall more slowly show no limit
SCHEME_ORDER = 2.0  # of the engine; differences that fall faster do so by chance
MAX_HALVINGS = 7  # no step finer than h/128 is suggested


class Kind(StrEnum):
    """The verdict on a quantity."""

    EXACT = "exact to rounding"
    CONVERGED = "converged"
    WITHIN = "within its range"  # all runs are, and the last halving changes it by less than that
    STEP = "depends on the step"  # its limit is outside its range
    OPEN = "not converged"  # halving the step changes it by more than is allowed
    DIVERGES = "diverges"  # the changes grow as the step is halved
    FAILS = "fails"  # the expectation does not hold, or the quantity has no value


class Sizes(NamedTuple):
    """How large a quantity is, in its own unit."""

    peak: float  # largest absolute value over the window; rounding is relative to it
    own: float  # mean absolute value over the window
    scene: float  # that of the largest quantity of its unit in the scene, at least ``own``


@dataclass(frozen=True)
class Trust:
    """An expected quantity at three steps, and the verdict on it."""

    quantity: str
    statistic: str
    unit: str
    low: float  # lowest value that passes; minus infinity if there is none
    high: float
    values: tuple[float, float, float]  # at h, h/2, h/4; nan if the run ended before
    allowed: float = math.nan  # largest error of a quantity that has converged
    order: float = math.nan  # observed order of convergence; nan if the differences show none
    limit: float = math.nan  # extrapolated to a step of zero; nan if the differences show none
    error: float = math.nan  # estimated at h: the distance from the limit, or twice the spread
    kind: Kind = Kind.FAILS
    reason: str = ""  # numbers that explain the verdict
    finer: int = 0  # h divided by this would be fine enough; 0 if unknown or not needed

    @property
    def differences(self) -> tuple[float, float]:
        """Changes by the first and the second halving of the step."""
        return abs(self.values[1] - self.values[0]), abs(self.values[2] - self.values[1])

    @property
    def settled(self) -> bool:
        """Whether the value does not depend on the step."""
        return self.kind in (Kind.EXACT, Kind.CONVERGED)

    @property
    def certified(self) -> bool:
        """Whether the expectation can be relied on."""
        return self.settled or self.kind is Kind.WITHIN

    def margin(self, *values: float) -> float:
        """Smallest distance of values from an end of the range, negative outside."""
        return min(min(value - self.low, self.high - value) for value in values)


def judge(
    verdict: Verdict, values: tuple[float, float, float], sizes: Sizes, *, given: bool = False,
) -> Trust:
    """The verdict from three runs; ``given``: the range is a tolerance, not two bounds."""
    trust = Trust(verdict.quantity, verdict.statistic, verdict.unit, verdict.low, verdict.high,
                  values, reason=verdict.reason)
    if not np.isfinite(values).all():
        return trust
    noise, order, limit = max(ROUNDING * sizes.peak, np.finfo(float).tiny), math.nan, math.nan
    coarse, fine = values[0] - values[1], values[1] - values[2]
    if abs(fine) <= noise:
        limit = values[2]
    elif abs(coarse) > noise and coarse * fine >= 0 and math.log2(coarse / fine) >= MIN_ORDER:
        order = math.log2(coarse / fine)
        limit = values[2] - fine / (2 ** min(order, SCHEME_ORDER) - 1)
    error = (max(abs(values[0] - limit), abs(coarse)) if math.isfinite(limit) else
             2 * float(np.ptp(values)))
    trust = replace(trust, order=order, limit=limit, error=error,
                    allowed=SHARE * tolerance(verdict, values[2], sizes, given=given))
    trust = replace(trust, kind=_kind(trust, verdict.ok, sizes, noise))
    if trust.kind in (Kind.OPEN, Kind.FAILS) and trust.allowed > 0 and \
            trust.low <= limit <= trust.high:
        left = max(abs(values[2] - limit), noise)  # of the error at h/4
        falls = min(order, SCHEME_ORDER) if math.isfinite(order) else SCHEME_ORDER
        halvings = max(1, 2 + math.ceil(math.log2(left / trust.allowed) / falls))
        trust = replace(trust, finer=2**halvings if halvings <= MAX_HALVINGS else 0)
    text = "" if verdict.reason and trust.kind is Kind.FAILS else _reason(trust, verdict.allowed)
    return replace(trust, reason="; ".join(filter(None, (verdict.reason, text))))


def tolerance(verdict: Verdict, value: float, sizes: Sizes, *, given: bool) -> float:
    """Largest deviation that an expectation allows.

    A given tolerance (``is`` with ``within``) counts up to a tenth of the largest quantity of its
    unit in the scene. Two bounds allow half their distance, one bound the value's distance from
    it, but not more than a tenth of the quantity itself: wide bounds only catch nonsense.
    """
    half = (verdict.high - verdict.low) / 2
    if given:
        return min(half, WIDE * sizes.scene)
    if math.isinf(half):
        half = min(abs(value - verdict.low), abs(verdict.high - value))
    return min(half, WIDE * max(sizes.own, SLIGHT * sizes.scene))


def _kind(trust: Trust, met: bool, sizes: Sizes, noise: float) -> Kind:
    spread = float(np.ptp(trust.values))
    limit = trust.limit if math.isfinite(trust.limit) else trust.values[2]
    inside = trust.margin(*trust.values, limit) >= -noise
    if spread <= noise:
        return Kind.EXACT if met and inside else Kind.FAILS
    if trust.error <= trust.allowed:
        return Kind.FAILS if not met else Kind.CONVERGED if inside else Kind.STEP
    coarse, fine = trust.differences
    ahead = trust.margin(trust.values[2])
    narrow = ahead <= sizes.own or spread <= SHARE * WIDE * sizes.scene
    if met and inside and fine <= ahead + noise and narrow:
        return Kind.WITHIN
    if fine > 2**MIN_ORDER * coarse:
        return Kind.DIVERGES
    return Kind.OPEN if met else Kind.FAILS


def _reason(trust: Trust, range_: str) -> str:
    """Numbers that explain a verdict; empty if the table has them all."""
    def text(value: float) -> str:
        return f"{value:.2g}{'' if trust.unit in ('', '1') else f' {trust.unit}'}"

    halved = "halving the step changes it by {}, then by {}".format(*map(text, trust.differences))
    allowed = f"{text(trust.allowed)} is allowed"
    match trust.kind:
        case Kind.WITHIN:
            return f"{halved}, inside its range, but not by less than {text(trust.allowed)}"
        case Kind.STEP:
            inside = trust.margin(*trust.values) >= 0
            return (f"it tends to {trust.limit:.6g}" if inside else
                    f"at h/4 it is {trust.values[2]:.6g}") + ", outside its range"
        case Kind.OPEN:
            return (halved if math.isnan(trust.order) else f"{text(trust.error)} is left of its "
                    f"error and falls with order {trust.order:.1f}") + f"; {allowed}"
        case Kind.DIVERGES:
            return f"{halved}: the finer the step, the more; {allowed}"
        case Kind.FAILS:
            if trust.margin(trust.values[2]) >= 0:
                return "it is outside its range at h, but not at h/4"
            tends = f"it tends to {trust.limit:.6g}, " if math.isfinite(trust.limit) else "it is "
            return f"{tends}outside {range_}"
    return ""


Progress = Callable[[float], None]
LABELS = ("h", "h/2", "h/4")
LONG = 1.0  # if the run at h takes longer [s], the other two run in processes of their own


def refined(mechanism: Mechanism, parts: int) -> Mechanism:
    """The mechanism with a finer step, sampled at every step; controllers keep their rates."""
    run = mechanism.run
    step = run.step / parts
    rates: dict[str, Any] = {
        kind: tuple(each.model_copy(update={"rate": 1 / (every(each.rate, run.step) * run.step)})
                    for each in getattr(mechanism, kind)) for kind in ("controllers", "events")}
    return mechanism.model_copy(update={
        "run": run.model_copy(update={"step": step, "sample_rate": 1 / step}), **rates})


def _run(mechanism: Mechanism, progress: Progress | None = None) -> tuple[Recording, list[Figure]]:
    """A run, up to where it diverges, and its audit."""
    try:
        run = simulate(mechanism, progress=progress)
    except SimulationDiverged as error:
        if error.recording is None:
            raise
        run = error.recording
    return run, audit(run)


def at_instants(time: Array, values: Array, wanted: Array) -> Array:
    """``values`` [n] at evenly spaced ``time`` [n], n > 3, interpolated at the instants [m].

    Runs at h and h/2 have no instant in common. The cubic through the four nearest samples has an
    error of fourth order. Where they jump, as in an impact (the third difference is then as large
    as the second), the cubic is clipped to their range.
    """
    spacing = (time[-1] - time[0]) / (len(time) - 1)
    place = (wanted - time[0]) / spacing
    first = np.clip(np.floor(place).astype(int) - 1, 0, len(time) - 4)
    u = place - first
    near = values[first[:, None] + np.arange(4)]
    weights = np.stack([
        -(u - 1) * (u - 2) * (u - 3) / 6, u * (u - 2) * (u - 3) / 2,
        -u * (u - 1) * (u - 3) / 2, u * (u - 1) * (u - 2) / 6], axis=1)
    read = (weights * near).sum(axis=1)
    bend = np.abs(np.diff(near, n=2, axis=1)).max(axis=1)
    jumps = np.abs(np.diff(near, n=3, axis=1))[:, 0] > 0.5 * bend
    clipped = np.clip(read, near.min(axis=1), near.max(axis=1))
    return np.asarray(np.where(jumps & (u >= 0) & (u <= 3), clipped, read))


PEAKS = ("max", "min")
OF_THE_MECHANISM = ("contact.shared", "tendon.slack")  # figures not about accuracy
CAUSES = ("light bodies that carry heavy ones, springs too stiff for their masses, or chaotic "
          "motion ('sandbox check' finds some causes)")


class Look(NamedTuple):
    """A warning of the audit."""

    runs: tuple[str, ...]  # that have it, of LABELS
    figure: Figure  # of the run that exceeds the threshold most


class Diverged(NamedTuple):
    """A run that diverged."""

    run: str
    time: float  # of its last sample [s]
    reason: str


@dataclass(frozen=True)
class Certificate:
    """The verdicts on all expectations of a scene."""

    steps: tuple[float, float, float]  # h, h/2, h/4 [s]
    quantities: tuple[Trust, ...]  # in the order of the scene's expectations
    looks: tuple[Look, ...] = ()
    diverged: tuple[Diverged, ...] = ()

    @property
    def doubtful(self) -> list[Trust]:
        """The expectations that cannot be relied on."""
        return [trust for trust in self.quantities if not trust.certified]

    @property
    def objections(self) -> list[str]:
        """Audit figures with a warning that concerns the accuracy of the run at h."""
        return [look.figure.name for look in self.looks
                if "h" in look.runs and look.figure.name not in OF_THE_MECHANISM]

    @property
    def certified(self) -> bool:
        """Whether every expectation holds, would hold at any finer step, and the audit passes."""
        return not (self.doubtful or self.objections or self.diverged)

    @property
    def conclusion(self) -> str:
        """A summary in a sentence or two."""
        total, settled = len(self.quantities), sum(t.settled for t in self.quantities)
        if self.certified:
            names = ", ".join(look.figure.name for look in self.looks)
            which, rest = (f"all {total}", "") if settled == total else (
                f"{settled} of {total}", "; the others depend on the step but stay in their ranges")
            return (f"Certified at h = {1e3 * self.steps[0]:g} ms: {which} expected quantities "
                    f"have converged{rest}."
                    + (f" The consistency checks warn of {names}." if names else ""))
        named = ", ".join(dict.fromkeys(t.quantity for t in self.doubtful))
        why = {
            f"the simulation diverged at {', '.join(e.run for e in self.diverged)}": self.diverged,
            f"{len(self.doubtful)} of {total} expectations cannot be relied on at this step: "
            f"{named}": self.doubtful,
            f"the consistency checks at h warn of {', '.join(self.objections)}": self.objections}
        return f"Not certified: {'; '.join(text for text, found in why.items() if found)}."

    @property
    def advice(self) -> tuple[str, ...]:
        """What to change, a sentence each; empty if it is certified."""
        return tuple(self._advice())

    def _advice(self) -> Iterator[str]:
        finest = _at(self.steps[2])
        if self.diverged:
            yield f"Look for {CAUSES}." if any(each.run == "h/4" for each in self.diverged) else \
                f"The run at h/4 is complete: check convergence from there, {finest}."
        valued = [t for t in self.doubtful if not math.isnan(t.error)]
        grown = [t for t in valued if t.kind is Kind.DIVERGES]
        unsettled = [t for t in valued if t.kind is Kind.OPEN or (
            t.kind is Kind.FAILS and t.margin(t.values[2]) >= 0)]
        if grown and not self.objections and all(
                t.unit == "N" and t.statistic in (*PEAKS, "std") for t in grown):
            yield ("The peak force of an impact has no limit, because one step takes its momentum. "
                   f"If that of {grown[0].quantity} is one, expect a mean over a window instead.")
        elif grown:
            yield (f"Values that change more at finer steps point to {CAUSES}. Check a shorter "
                   f"time, or start from h/4, {finest}. If they grow there too, no step converges.")
        elif unsettled and all(t.finer for t in unsettled):
            finer = max(t.finer for t in unsettled)
            yield f"At these orders h/{finer} is sufficient: {_at(self.steps[0] / finer)}."
        elif unsettled:
            yield f"These three steps do not show which step would do. Start from h/4, {finest}."


def _at(step: float) -> str:
    return f"--set run.step={step:.6g}"


def unfit(mechanism: Mechanism) -> list[Problem]:
    """Why the convergence of a mechanism cannot be checked, if it cannot."""
    run = mechanism.run
    if not mechanism.expect:
        place, why = "$.expect", "the scene expects nothing, so there is nothing to certify"
    elif any(event.stop for event in mechanism.events):
        place, why = "$.events", "an event may stop the run, at another time for every step"
    elif run.duration < 4 * run.step:
        place = "$.run"
        why = f"a run of {run.duration:g} s has fewer than four steps of {run.step:g} s"
    else:
        return []
    return [Problem("nothing-to-certify", why, place)]


def certify(mechanism: Mechanism, *, progress: Progress | None = None) -> Certificate:
    """Simulate a mechanism at h, h/2 and h/4 and judge each of its expectations.

    ``progress`` is called with the fraction done, 0 to 1. SceneError if :func:`unfit` has a reason.
    """
    if problems := unfit(mechanism):
        raise SceneError(problems)
    report, step, began = progress or (lambda share: None), mechanism.run.step, time.perf_counter()
    first, half, quarter = (refined(mechanism, parts) for parts in (1, 2, 4))
    found = [_run(first, lambda share: report(share / 7))]
    if time.perf_counter() - began > LONG:
        with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
            found += pool.map(_run, (half, quarter))
    else:
        found += [_run(half, lambda share: report((1 + 2 * share) / 7)),
                  _run(quarter, lambda share: report((3 + 4 * share) / 7))]
    report(1.0)
    runs, figures = zip(*found, strict=True)
    return Certificate(
        (step, step / 2, step / 4), tuple(_judged(mechanism, runs)), tuple(_looks(figures)),
        tuple(Diverged(label, float(np.append(0.0, run.time)[-1]),
                       run.info.reason.partition("; ")[0])
              for label, run in zip(LABELS, runs, strict=True)
              if run.info.status is Status.DIVERGED))


def _looks(figures: Sequence[Sequence[Figure]]) -> Iterator[Look]:
    """Each audit figure with a warning: the runs it is in, and the run where it is worst."""
    for kind in zip(*figures, strict=True):
        warned = {label: figure for label, figure in zip(LABELS, kind, strict=True)
                  if figure.verdict == "look"}
        if warned:
            yield Look(tuple(warned), max(warned.values(), key=lambda figure: (
                figure.value / figure.threshold if figure.threshold else math.inf)))


def _judged(mechanism: Mechanism, runs: Sequence[Recording]) -> Iterator[Trust]:
    """The verdict on each quantity of each expectation, at the instants of the scene's samples."""
    run, first = mechanism.run, runs[0]
    clock = make_clock(run.duration, run.step, run.sample_rate)
    instants = clock.force_time(clock.sample_step(np.arange(clock.samples)))
    base = first.pick(np.arange(clock.every - 1, len(first), clock.every))
    largest = cache(lambda unit: scene_size([each for each in runs if each.complete], unit))

    def series(run: Recording, verdict: Verdict, expect: Expect) -> Array:
        """The samples of a statistic; none if the run ended before the window did."""
        chosen, unreached = window(run, expect)
        if unreached or not len(run):
            return np.empty(0)
        if verdict.statistic in PEAKS:
            return run.within(verdict.quantity, chosen)
        values, wanted = run[verdict.quantity], among(instants, expect)
        if run.info.step == first.info.step:
            return values[clock.every - 1::clock.every][wanted]
        return at_instants(run.time, values, instants[wanted])

    def trust_of(verdict: Verdict, expect: Expect) -> Trust:
        if verdict.quantity not in base or math.isnan(verdict.low):
            return judge(verdict, (math.nan,) * 3, Sizes(0.0, 0.0, 0.0))
        found = [series(each, verdict, expect) for each in runs]
        time = instants[among(instants, expect)]
        a, b, c = (number_of(expect, time, one) if len(one) else math.nan for one in found)
        own = min((max(abs(value), mean_size(one)) for value, one in zip(
            (a, b, c), found, strict=True) if math.isfinite(value)), default=0.0)
        peak = max((float(np.abs(one).max()) for one in found if len(one)), default=0.0)
        if verdict.statistic in PEAKS and verdict.ok and (a < verdict.low or a > verdict.high):
            verdict = replace(verdict, ok=False, reason=(
                f"between two samples of the scene it is {a:.6g}, outside its range"))
        trust = judge(verdict, (a, b, c), Sizes(peak, own, max(own, largest(verdict.unit))),
                      given=expect.value is not None)
        missing = {label: each.info.status for label, each, value in zip(
            LABELS, runs, trust.values, strict=True) if not math.isfinite(value)}
        if gone := [label for label, status in missing.items() if status is Status.DIVERGED]:
            return replace(trust, kind=Kind.DIVERGES, reason=(
                f"the simulation diverged at {', '.join(gone)}, before the window ended"))
        if missing and not trust.reason:
            return replace(trust, reason=f"it has no value at {', '.join(missing)}")
        return trust

    for expect in mechanism.expect:
        alone = mechanism.model_copy(update={"expect": (expect,)})
        for verdict in verdicts(Recording(alone, base.arrays, base.info, catalogue=base.catalogue)):
            yield trust_of(verdict, expect)


def scene_size(runs: Sequence[Recording], unit: str) -> float:
    """Size of the largest quantity of a unit in a scene: mean over time, minimum of the runs."""
    return min((max((mean_size(run[name]) for name in run.names() if run.unit(name) == unit),
                    default=0.0) for run in runs), default=0.0)


def mean_size(values: Array) -> float:
    """Mean absolute value of the finite values; 0 if there is none."""
    sizes = np.abs(values[np.isfinite(values)])
    return float(sizes.mean()) if len(sizes) else 0.0
