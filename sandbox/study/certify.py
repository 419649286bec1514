"""How far a scene's expected quantities can be trusted: the run again, and finer.

Three runs (:mod:`sandbox.study.repeats`) give each expected quantity three values, whose changes
are judged against what the scene allows (:mod:`sandbox.study.convergence`). The largest and the
smallest value are those of each run's own steps. Other statistics are taken over the scene's
samples, at whose instants all three are read (:mod:`sandbox.study.refine`).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sandbox.engine.clock import make_clock
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import Verdict, among, number_of, verdicts, window
from sandbox.samples.outcome import Status
from sandbox.scene.elements.settings import Expect
from sandbox.scene.mechanism import Mechanism
from sandbox.study.certificate import Certificate, Diverged, Look
from sandbox.study.convergence import Kind, Sizes, Trust, judge
from sandbox.study.refine import at_instants
from sandbox.study.repeats import LABELS, Progress, Repeat, looks, repeats
from sandbox.study.sizes import SceneSizes, usual

PEAKS = ("max", "min")


def unfit(mechanism: Mechanism) -> str:
    """Why a mechanism cannot be certified; empty if it can."""
    run = mechanism.run
    if not mechanism.expect:
        return "the scene expects nothing, so there is nothing to certify"
    if any(event.stop for event in mechanism.events):
        return "an event may stop the run, at another time for every step"
    if run.duration < 4 * run.step:
        return f"a run of {run.duration:g} s has fewer than four steps of {run.step:g} s"
    return ""


def certify(
    mechanism: Mechanism, *, progress: Progress | None = None,
) -> Certificate:
    """Run a mechanism three times and judge each of its expectations.

    Args:
        mechanism: with at least one expectation.
        progress: called now and then with the fraction done, 0 to 1.

    Raises:
        ValueError: a mechanism that expects nothing or that an event may stop, or a run of
            fewer than four steps.
        Interrupted: Ctrl-C.
    """
    if reason := unfit(mechanism):
        raise ValueError(reason)
    found = repeats(mechanism, progress or (lambda _: None))
    step = mechanism.run.step
    return Certificate(
        (step, step / 2, step / 4),
        tuple(_Comparison(mechanism, found).judged()),
        tuple(Look(where, figure) for figure, where in looks(found)),
        tuple(_diverged(repeat) for repeat in found
              if repeat.recording.info.status is Status.DIVERGED))


def _diverged(repeat: Repeat) -> Diverged:
    """What is to be said of a run that ran away; the engine's advice, a finer step, is left out."""
    run = repeat.recording
    return Diverged(repeat.label, float(run.time[-1]) if len(run) else 0.0,
                    run.info.reason.partition("; ")[0])


class _Comparison:
    """The three runs of a mechanism, laid over each other."""

    def __init__(self, mechanism: Mechanism, found: list[Repeat]) -> None:
        self._mechanism = mechanism
        self._runs = [repeat.recording for repeat in found]
        self._sizes = SceneSizes([run for run in self._runs if run.complete])
        run = mechanism.run
        clock = make_clock(run.duration, run.step, run.sample_rate)
        self._every = clock.every
        self._instants = clock.force_time(clock.sample_step(np.arange(clock.samples)))
        """Of the scene's own samples [s]."""
        base = self._runs[0]
        self._base = base.pick(np.arange(self._every - 1, len(base), self._every))
        """The run at h as the scene samples it."""

    def judged(self) -> list[Trust]:
        """Of every expectation, in order; of every quantity that its pattern fits."""
        return [self._trust(verdict, expect) for expect in self._mechanism.expect
                for verdict in verdicts(self._expecting(expect))]

    def _expecting(self, expect: Expect) -> Recording:
        alone = self._mechanism.model_copy(update={"expect": (expect,)})
        base = self._base
        return Recording(alone, base.arrays, base.info, catalogue=base.catalogue)

    def _trust(self, verdict: Verdict, expect: Expect) -> Trust:
        if verdict.quantity not in self._base or math.isnan(verdict.low):
            return judge(verdict, (math.nan,) * 3, Sizes(0.0, 0.0, 0.0))
        series = [self._series(run, verdict, expect) for run in self._runs]
        time = self._instants[among(self._instants, expect)]
        values = [number_of(expect, time, one) if len(one) else math.nan for one in series]
        own = min((max(abs(value), usual(one)) for value, one
                   in zip(values, series, strict=True) if math.isfinite(value)), default=0.0)
        sizes = Sizes(max((float(np.abs(one).max()) for one in series if len(one)), default=0.0),
                      own, max(own, self._sizes.of_unit(verdict.unit)))
        trust = judge(_between_samples(verdict, values[0]), (values[0], values[1], values[2]),
                      sizes, given=expect.value is not None)
        return self._without_value(trust)

    def _series(self, run: Recording, verdict: Verdict, expect: Expect) -> Array:
        """What a statistic is taken of; empty if the run did not come to the window's end."""
        chosen, unreached = window(run, expect)
        if unreached or not len(run):
            return np.empty(0)
        if verdict.statistic in PEAKS:
            return run.within(verdict.quantity, chosen)
        values = run[verdict.quantity]
        wanted = among(self._instants, expect)
        if run.info.step == self._runs[0].info.step:
            return values[self._every - 1::self._every][wanted]
        return at_instants(run.time, values, self._instants[wanted])

    def _without_value(self, trust: Trust) -> Trust:
        """Why a quantity has no value, where a run that diverged is the reason."""
        missing = [label for label, value in zip(LABELS, trust.values, strict=True)
                   if not math.isfinite(value)]
        gone = [label for label, run in zip(LABELS, self._runs, strict=True)
                if run.info.status is Status.DIVERGED and label in missing]
        if gone:
            return replace(trust, kind=Kind.DIVERGES, reason=(
                f"the simulation diverged at {', '.join(gone)}, before the window ended"))
        if missing and not trust.reason:
            return replace(trust, reason=f"it has no value at {', '.join(missing)}")
        return trust


def _between_samples(verdict: Verdict, value: float) -> Verdict:
    """A verdict on a peak, from all steps and not the scene's samples alone."""
    if verdict.statistic not in PEAKS or not math.isfinite(value):
        return verdict
    inside = verdict.low <= value <= verdict.high
    reason = verdict.reason
    if verdict.ok and not inside:
        reason = f"between two samples of the scene it is {value:.6g}, outside its range"
    return replace(verdict, value=value, ok=verdict.ok and inside, reason=reason)
