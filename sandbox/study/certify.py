"""How far a scene's expected quantities can be trusted: the run again, finer and with more effort.

A quantity q that follows from the step h as q(h) = q_0 + C h^p shows its order
p and what is left of its error by three runs, at h, h/2 and h/4 (Richardson):

    p = log2( |q(h) - q(h/2)| / |q(h/2) - q(h/4)| )
    q(h) - q_0 = (q(h) - q(h/2)) / (1 - 2^-p)

A fourth run, with twice the iterations, shows what the contact solver has left.
Statistics are taken over the instants of the run at h for all four
(:mod:`sandbox.study.refine`).
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from multiprocessing import get_context
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import Verdict, statistic, verdicts, window
from sandbox.samples.outcome import Outcome
from sandbox.scene.mechanism import Mechanism
from sandbox.study.convergence import Trust, judge
from sandbox.study.refine import at_instants, refined

Progress = Callable[[float], None]
LONG = 1.0
"""A run that takes longer than this [s] has its refinements made in processes of their own."""


@dataclass(frozen=True)
class Certificate:
    """What became of every expectation of a scene."""

    steps: tuple[float, float, float]
    """h, h/2, h/4 [s]."""
    iterations: tuple[int, int]
    """Of the runs at h, and of the run with twice as many."""
    quantities: tuple[Trust, ...]
    """In the order of the scene's expectations."""

    @property
    def certified(self) -> bool:
        """Whether every expectation holds and would hold at any finer step."""
        return all(trust.certified for trust in self.quantities)

    @property
    def conclusion(self) -> str:
        """One plain sentence."""
        total = len(self.quantities)
        doubtful = [t for t in self.quantities if not t.certified]
        if doubtful:
            named = ", ".join(dict.fromkeys(t.quantity for t in doubtful))
            return (f"Not certified: {len(doubtful)} of {total} expectations cannot be relied on "
                    f"at this step: {named}.")
        settled = sum(t.settled for t in self.quantities)
        base = f"Certified at h = {1e3 * self.steps[0]:g} ms"
        if settled == total:
            return f"{base}: all {total} expected quantities have converged."
        return (f"{base}: {settled} of {total} expected quantities have converged; the other "
                f"{total - settled} depend on the way there but stay inside their ranges.")


def variants(mechanism: Mechanism) -> list[Mechanism]:
    """The four runs of a certificate: h, h/2, h/4, and h with twice the iterations."""
    return [mechanism, refined(mechanism, parts=2), refined(mechanism, parts=4),
            refined(mechanism, iterations=2)]


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
    """Run a mechanism four times and judge each of its expectations.

    Args:
        mechanism: with at least one expectation.
        progress: called now and then with the fraction done, 0 to 1.

    Raises:
        ValueError: a mechanism that expects nothing or that an event may stop, or a run of
            fewer than four steps.
        SimulationDiverged: one of the runs ran away.
        Interrupted: Ctrl-C.
    """
    if reason := unfit(mechanism):
        raise ValueError(reason)
    runs = _runs(variants(mechanism), progress or (lambda _: None))
    step, times = mechanism.run.step, mechanism.run.iterations
    return Certificate((step, step / 2, step / 4), (times, 2 * times),
                       tuple(_judged(mechanism, runs)))


def _runs(wanted: list[Mechanism], progress: Progress) -> list[Recording]:
    """All four, in order; the long ones side by side."""
    steps = np.array([m.run.duration / m.run.step for m in wanted])
    ends = np.cumsum(steps) / steps.sum()
    began = time.perf_counter()
    runs = [simulate(wanted[0], progress=_between(progress, 0.0, ends[0]))]
    if time.perf_counter() - began > LONG:
        return runs + _side_by_side(wanted[1:], _between(progress, ends[0], 1.0))
    return runs + [simulate(mechanism, progress=_between(progress, start, end))
                   for mechanism, start, end in zip(wanted[1:], ends, ends[1:], strict=False)]


def _between(progress: Progress, start: float, end: float) -> Progress:
    """Progress of one run of several, from fraction ``start`` to fraction ``end``."""
    return lambda fraction: progress(float(start + fraction * (end - start)))


def _side_by_side(wanted: list[Mechanism], progress: Progress) -> list[Recording]:
    steps = np.array([m.run.duration / m.run.step for m in wanted])
    done = 0.0
    found: dict[int, Recording] = {}
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        order = sorted(range(len(wanted)), key=lambda i: -steps[i])  # the longest first
        jobs = {pool.submit(_far, wanted[i]): i for i in order}
        for job in as_completed(jobs):
            i = jobs[job]
            arrays, info = job.result()
            found[i] = Recording(wanted[i], arrays, info)
            done += float(steps[i] / steps.sum())
            progress(done)
    return [found[i] for i in range(len(wanted))]


def _far(mechanism: Mechanism) -> tuple[dict[str, NDArray[Any]], Outcome]:
    """A run in another process: its arrays come back, what lives in files is copied."""
    run = simulate(mechanism)
    return {key: np.array(array) for key, array in run.arrays.items()}, run.info


def _judged(mechanism: Mechanism, runs: list[Recording]) -> list[Trust]:
    found = []
    for expect in mechanism.expect:
        alone = mechanism.model_copy(update={"expect": (expect,)})
        base = Recording(alone, runs[0].arrays, runs[0].info, catalogue=runs[0].catalogue)
        chosen, _ = window(base, expect)
        for verdict in verdicts(base):
            found.append(_trust(verdict, runs, chosen))
    return found


def _trust(verdict: Verdict, runs: list[Recording], chosen: slice) -> Trust:
    if not np.isfinite(verdict.value):
        return judge(verdict, (np.nan,) * 3, np.nan, 0.0)
    base, half, quarter, harder = runs
    instants = base.time[chosen]
    series = [base[verdict.quantity][chosen],
              *(at_instants(run.time, run[verdict.quantity], instants)
                for run in (half, quarter)),
              harder[verdict.quantity][chosen]]
    values = [statistic(verdict.statistic, one) for one in series]
    scale = float(np.abs(series[0]).max())
    return judge(replace(verdict, value=values[0]), (values[0], values[1], values[2]),
                 values[3], scale)
