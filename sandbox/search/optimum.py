"""Optimisation: values of paths that minimise or maximise results, under conditions.

Optuna's samplers choose points in batches of a fixed size, from a seed. A search that is resumed
requests the same points again and finds their rows in the log, so it ends as if it had never been
stopped; more runs continue it.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.errors import SandboxError, optional
from sandbox.figure.sweeps import SweepColumn, draw_front
from sandbox.numeric import Array
from sandbox.search.session import FOUND, RefusedError, Result, Session, main_failure, results
from sandbox.sweeps.job import DONE, SweepRow
from sandbox.sweeps.options import BestSearch
from sandbox.sweeps.spec import Distribution, number_of
from sandbox.wording import quoted

PACKAGES = {"cmaes": ("cmaes",), "gp": ("torch", "torch")}  # what samplers need besides optuna
BATCH = 10  # runs per batch, independent of the number of workers
SAMPLERS: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    # sigma0: as in Hansen, The CMA Evolution Strategy: A Tutorial, 2016, in ranges
    "cmaes": ("CmaEs", {"popsize": BATCH, "sigma0": 0.3}), "tpe": ("TPE", {"multivariate": True}),
    "gp": ("GP", {}), "nsga2": ("NSGAII", {"population_size": 2 * BATCH}), "random": ("Random", {}),
}  # Optuna's class and its arguments
CHECKED = 5  # the best so many runs are repeated at half the step
SAME = 0.05  # of the standard deviation of all that hold: accepted change at half the step
ALIKE = 1e-3  # of the same: distance to another run that counts as equal
ROUNDING = 1e-9  # of the largest value: smaller spreads are rounding


@dataclass(frozen=True)
class Choice:
    """One run of an optimisation."""

    values: Mapping[str, float | str]  # of its paths, SI or text
    objectives: Mapping[str, float]  # SI
    excess: float  # distance beyond the limits of conditions, relative to these
    halved: Mapping[str, float]  # the objectives at half the step


@dataclass(frozen=True, repr=False)
class Chosen(Result):
    """The best run, or the Pareto front of several goals."""

    best: tuple[Choice, ...]
    goals: Mapping[str, str]  #: ``least`` or ``most``, by result
    units: Mapping[str, str]  #: SI, of paths and objectives
    failed: int  #: runs without an answer
    history: Array
    """Objectives of all runs, [n, objectives]; nan where a condition or a run failed."""

    def _lines(self) -> list[str]:
        lines = []
        if len(self.goals) > 1:
            lines.append(f"{len(self.best)} of {self.runs} runs of which none is better in all:")
        lines += [f"{self._text(each.objectives)}  at  {self._text(each.values)}"
                  for each in self.best]
        if self.failed:
            lines.append(f"{self.failed} of {self.runs} runs had no answer")
        return lines

    def _text(self, values: Mapping[str, float | str]) -> str:
        return ", ".join(f"{name} = {value:.6g} {self.units.get(name, '')}".rstrip()
                         if isinstance(value, float) else f"{name} = {value}"
                         for name, value in values.items())


def find_best(session: Session, options: BestSearch) -> Chosen:
    """The best points under conditions.

    By default one goal over several ranges has the sampler CMA-ES. It only ranks points that
    violate conditions behind all others: where the best lies at a limit, its distribution collapses
    too early, as that of TPE does not.
    """
    for path in session.of_kind(Distribution):
        raise RefusedError(f"{quoted(path)} has a distribution: an optimisation varies ranges and "
                           "lists")
    trials = _Trials(session, options)
    goals, wanted, lists = trials.goals, trials.wanted, bool(session.of_kind(tuple))
    sampler = options.sampler or (
        "nsga2" if len(goals) > 1 else
        "tpe" if wanted or lists or len(session.paths) == 1 else "cmaes")
    if sampler == "cmaes" and (len(goals) > 1 or lists):
        raise RefusedError("cmaes optimises one goal over ranges; nsga2, tpe, gp, random take "
                           + ("several" if len(goals) > 1 else "lists"))
    session.check_runs(options.runs)
    trials.run(_study(sampler, len(goals), options.seed), options.runs, ranked=sampler == "cmaes")
    found = trials.chosen()
    session.write(found, wanted)
    if session.out and len(goals) > 1:
        front = np.array([[*each.objectives.values()] for each in found.best])
        draw_front(
            session.out / FOUND,
            [SweepColumn(name, session.units[name], found.history[:, k])
             for k, name in enumerate(goals)], goals,
            (found.history[:, None] == front[None]).all(axis=2).any(axis=1),
            f"{session.plan.name}: {len(found.best)} of {found.runs} runs of which none is "
            "better in all")
    return found


def _study(sampler: str, goals: int, seed: int) -> Any:
    optuna = optional("optuna")
    if sampler in PACKAGES:
        optional(*PACKAGES[sampler])
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    name, more = SAMPLERS[sampler]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # some samplers are experimental
        return optuna.create_study(directions=["minimize"] * goals, sampler=getattr(
            optuna.samplers, f"{name}Sampler")(seed=seed, **more))


class _Trials:
    """The points of an optimisation and their runs; goals to maximise have their sign changed."""

    def __init__(self, session: Session, options: BestSearch) -> None:
        self.session, self.goals = session, dict[str, str]()
        for kind in ("least", "most"):
            for k, name in enumerate(getattr(options, kind)):
                session.check_result(name, kind, k)
                self.goals[name] = kind
        self.wanted = session.conditions(options.where)
        self.signs = np.array([1.0 if goal == "least" else -1.0 for goal in self.goals.values()])
        self.quantiles = np.empty((0, len(session.paths)))
        self.costs = np.empty((0, len(self.goals)))  # nan for a run without an answer
        self.excess = np.empty(0)
        self.rows: list[SweepRow] = []

    def run(self, study: Any, runs: int, *, ranked: bool) -> None:
        failed = optional("optuna").trial.TrialState.FAIL
        while len(self.costs) < runs:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                trials = [study.ask() for _ in range(min(BATCH, runs - len(self.costs)))]
                # of a list the middle of the part of a value
                quantiles = np.array([[
                    (trial.suggest_categorical(path, range(len(values))) + 0.5) / len(values)
                    if isinstance(values, tuple) else trial.suggest_float(path, 0.0, 1.0)
                    for path, values in self.session.over.items()] for trial in trials])
            rows = self.session.rows(quantiles)
            costs, excess = self.judge(rows)
            self.rows += rows
            self.quantiles = np.vstack([self.quantiles, quantiles])
            self.costs = np.vstack([self.costs, costs])
            self.excess = np.append(self.excess, excess)
            worst = float(np.max(self.costs[self.excess <= 0], initial=0.0))
            for trial, cost, beyond in zip(trials, costs.tolist(), excess.tolist(), strict=True):
                if math.isnan(cost[0]):
                    study.tell(trial, state=failed)
                elif ranked:  # behind all that hold, ordered by the distance (Deb, 2000)
                    study.tell(trial, cost[0] if beyond <= 0 else worst + 1.0 + beyond)
                else:
                    if self.wanted:
                        trial.set_constraint("conditions", beyond)
                    study.tell(trial, cost)

    def judge(self, rows: Sequence[SweepRow]) -> tuple[Array, Array]:
        """Costs [n, goals], and relative distances beyond the conditions [n]."""
        costs, excess = results(rows, self.goals), np.zeros(len(rows))
        if self.wanted:
            excess = np.max([each.excess(rows) / (abs(each.limit) or 1.0)
                             for each in self.wanted], axis=0)
        bad = np.array([row.status != DONE for row in rows]) | np.isnan(costs).any(axis=1) | \
            np.isnan(excess)
        costs[bad], excess[bad] = np.nan, np.inf
        return costs * self.signs, excess

    def chosen(self) -> Chosen:
        """The best runs, repeated at half the step."""
        sound = np.flatnonzero(self.excess <= 0)
        if not len(sound):
            beyond = float(self.excess.min())
            raise SandboxError(
                f"no run of {len(self.excess)} meets all conditions; the nearest is beyond one by "
                f"{100 * beyond:.3g} % of its limit" if math.isfinite(beyond) else
                f"no run of {len(self.excess)} has an answer{main_failure(self.rows)}",
                code="no-answer")
        single, session = len(self.goals) == 1, self.session
        order = sound[np.argsort(self.costs[sound, 0], kind="stable")]
        _, first = np.unique(self.quantiles[order], axis=0, return_index=True)
        order = order[np.sort(first)]
        best = order[:1] if single else order[_front(self.costs[order])]
        again = order[:CHECKED] if single else best
        costs, excess = self.judge(session.rows(self.quantiles[again], halved=True))
        spread = np.maximum(np.maximum(
            np.std(self.costs[sound], axis=0),
            ROUNDING * np.abs(self.costs[sound]).max(axis=0)), 1e-300)
        same, detail = _compare(self.costs[again] / spread, costs / spread, excess, single=single)

        def named(values: Array) -> dict[str, float]:
            return dict(zip(self.goals, (values * self.signs).tolist(), strict=True))

        choices = tuple(Choice(
            {path: number_of(written) for path, written in point.items()},
            named(self.costs[run]), float(self.excess[run]), named(cost))
            for run, point, cost in zip(best, session.points(self.quantiles[best]), costs,
                                        strict=False))
        history = np.where(self.excess[:, None] <= 0, self.costs * self.signs, np.nan)
        return Chosen(choices, self.goals, session.units, int(np.isnan(self.costs[:, 0]).sum()),
                      history, runs=len(self.costs), certified=same, certificate=detail)


def _front(costs: Array) -> Array:
    """Indices of the Pareto front of costs [n, goals]."""
    return np.array([k for k, cost in enumerate(costs)
                     if not ((costs <= cost).all(axis=1) & (costs < cost).any(axis=1)).any()])


def _compare(before: Array, after: Array, excess: Array, *, single: bool) -> tuple[bool, str]:
    """Whether the best are the best at half the step, too; costs relative to their spread."""
    if beyond := int((~(excess <= 0)).sum()):
        return False, (f"{beyond} of the best {len(excess)} fail a condition or have no answer "
                       "there")
    change = float(np.abs(after - before).max())
    if single:
        best = float(after[0, 0] - after.min()) <= ALIKE
        which = f"of the best {len(before)} the first is {'' if best else 'not '}the best there"
    else:
        kept = len(_front(after))
        best, which = kept == len(before), f"{kept} of {len(before)} are such there, too"
    return best and change <= SAME, (
        f"{which}; values change by up to {100 * change:.2g} % of the spread of all that hold")
