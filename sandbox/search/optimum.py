"""Optimisation: values of paths that minimise or maximise results, under conditions.

Optuna's samplers choose points in batches of a fixed size, from a seed. A search that is resumed
requests the same points again and finds their rows in the log, so it ends as if it had never been
stopped; more runs continue it.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any, get_args

import numpy as np

from sandbox.errors import SandboxError
from sandbox.figure.sweeps import SweepColumn, draw_front
from sandbox.numeric import Array
from sandbox.search.question import Question
from sandbox.search.session import (
    FOUND,
    Condition,
    RefusedError,
    Session,
    Where,
    check_effort,
    check_result,
    main_failure,
    open_session,
    parse_conditions,
    step_check,
    value_of,
)
from sandbox.sweeps.job import DONE, SweepRow
from sandbox.sweeps.points import number_of
from sandbox.sweeps.spec import Sampler
from sandbox.sweeps.vary import Distribution
from sandbox.wording import or_near, quoted, told_of

SEVERAL = ("nsga2", "tpe", "gp", "random")
"""Samplers of several goals."""
PACKAGES = {"cmaes": "cmaes", "gp": "torch"}
"""What a sampler needs besides optuna."""
BATCH = 10
"""Runs per batch, independent of the number of workers."""
SIGMA = 0.3
"""Standard deviation of the first points of CMA-ES, in ranges (Hansen, The CMA Evolution
Strategy: A Tutorial, 2016)."""
CHECKED = 5
"""The best so many runs are repeated at half the step."""
SAME, ALIKE = 0.05, 1e-3
"""Of the standard deviation of all runs that meet the conditions: change of a value at half the
step that is accepted, and distance to another run that counts as equal."""
ROUNDING = 1e-9
"""Of the largest value: smaller spreads are rounding."""


@dataclass(frozen=True)
class Choice:
    """One run of an optimisation."""

    values: Mapping[str, float | str]
    """Of its paths, SI or text."""
    objectives: Mapping[str, float]
    """SI."""
    excess: float
    """Distance beyond the limits of conditions, relative to these; 0 or less if all hold."""
    halved: Mapping[str, float]
    """The objectives at half the step."""


@dataclass(frozen=True)
class Chosen:
    """The best run, or the Pareto front of several goals."""

    best: tuple[Choice, ...]
    goals: Mapping[str, str]
    """``least`` or ``most``, by result."""
    units: Mapping[str, str]
    """SI, of paths and objectives."""
    runs: int
    failed: int
    """Runs without an answer."""
    certified: bool
    """Whether the result is the same at half the step."""
    certificate: str
    """Details of this check."""
    history: Array
    """Objectives of all runs in their order, [n, objectives]; nan where a condition or a run
    failed."""

    def __repr__(self) -> str:
        return told_of(self, self.lines)

    @property
    def lines(self) -> list[str]:
        """The result in words."""
        lines = []
        if len(self.goals) > 1:
            lines.append(f"{len(self.best)} of {self.runs} runs of which none is better in all:")
        lines += [f"{self._text(each.objectives)}  at  {self._text(each.values)}"
                  for each in self.best]
        if self.failed:
            lines.append(f"{self.failed} of {self.runs} runs had no answer")
        return [*lines, step_check(self.certified, self.certificate)]

    def _text(self, values: Mapping[str, float | str]) -> str:
        return ", ".join(f"{name} = {value:.6g} {self.units.get(name, '')}".rstrip()
                         if isinstance(value, float) else f"{name} = {value}"
                         for name, value in values.items())


def find_best(
    question: Question, *, least: Sequence[str] = (), most: Sequence[str] = (),
    where: Sequence[str] = (), sampler: str | None = None, runs: int = 200, seed: int = 0,
    place: Where | None = None,
) -> Chosen:
    """The best points under conditions.

    Args:
        question: paths with ranges or lists.
        least: results to minimise.
        most: results to maximise.
        where: conditions such as ``"slip < 1 mm"``.
        sampler: of Optuna; by default CMA-ES, TPE where there are lists or conditions, NSGA-II
            for several goals.
        runs: number of runs.
        seed: of the sampler.
        place: where it runs, and where its files go.

    Raises:
        RefusedError: no goal, or a sampler that does not fit.
        SandboxError: no run meets the conditions, or a package is not installed.
    """
    if random := question.space.of_kind(Distribution):
        raise RefusedError(f"{quoted(random[0])} has a distribution: the best is looked for over "
                           "ranges and lists")
    goals = {**dict.fromkeys(least, "least"), **dict.fromkeys(most, "most")}
    if not goals:
        raise RefusedError("give a quantity to minimise or maximise")
    if both := sorted(set(least) & set(most)):
        raise RefusedError(f"{quoted(both[0])} cannot be minimised and maximised at once")
    for name in goals:
        check_result(name, question.kept)
    wanted = parse_conditions(where, question.kept)
    check_effort(question, runs, seed)
    study = _study(question, len(goals), sampler or _default(question, goals, wanted), seed)
    place = place or Where()
    with open_session(question, place) as session:
        trials = _Trials(session, study, goals, wanted)
        trials.run(runs)
        found = trials.chosen()
        if place.out:
            session.write(place.out, "best", {
                **vars(found), "best": [vars(each) for each in found.best]}, wanted=wanted,
                least=least, most=most, where=where, sampler=sampler, runs=runs, seed=seed)
            if len(goals) > 1:
                front = np.array([[*each.objectives.values()] for each in found.best])
                draw_front(
                    place.out / FOUND,
                    [SweepColumn(name, question.kept[name], found.history[:, k])
                     for k, name in enumerate(goals)], goals,
                    (found.history[:, None] == front[None]).all(axis=2).any(axis=1),
                    f"{question.name}: {len(found.best)} of {found.runs} runs of which none is "
                    "better in all")
    return found


def _default(
    question: Question, goals: Mapping[str, str], wanted: tuple[Condition, ...],
) -> Sampler:
    """The default sampler.

    CMA-ES only ranks points that violate conditions behind all others: where the best lies at a
    limit, its distribution collapses too early, as that of TPE does not.
    """
    if len(goals) > 1:
        return "nsga2"
    single = len(question.space.paths) == 1
    return "tpe" if wanted or single or question.space.of_kind(tuple) else "cmaes"


def _study(question: Question, goals: int, sampler: str, seed: int) -> Any:
    """Optuna's study.

    Raises:
        RefusedError: an unknown sampler, or one that does not fit.
        SandboxError: optuna is not installed.
    """
    known = get_args(Sampler)
    if sampler not in known:
        raise RefusedError(f"there is no sampler {quoted(sampler)}{or_near(sampler, known)} "
                           f"({', '.join(known)})")
    if sampler == "cmaes" and (goals > 1 or question.space.of_kind(tuple)):
        raise RefusedError("cmaes looks for one goal over ranges; "
                           f"{', '.join(SEVERAL)} take {'several' if goals > 1 else 'lists'}")
    try:
        optuna: Any = import_module("optuna")
        if sampler in PACKAGES:
            import_module(PACKAGES[sampler])
    except ImportError as error:
        raise SandboxError(f"the sampler {sampler} needs {error.name}: pip install "
                           + ("torch" if sampler == "gp" else "'sandbox-mechanics[studies]'")
                           , code="missing-package") from None
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    make: dict[str, Callable[[], Any]] = {
        "cmaes": lambda: optuna.samplers.CmaEsSampler(seed=seed, popsize=BATCH, sigma0=SIGMA),
        "tpe": lambda: optuna.samplers.TPESampler(seed=seed, multivariate=True),
        "gp": lambda: optuna.samplers.GPSampler(seed=seed),
        "nsga2": lambda: optuna.samplers.NSGAIISampler(seed=seed, population_size=2 * BATCH),
        "random": lambda: optuna.samplers.RandomSampler(seed=seed)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # some samplers are experimental
        return optuna.create_study(directions=["minimize"] * goals, sampler=make[sampler]())


class _Trials:
    """Optuna's trials and their runs; goals to maximise have their sign changed."""

    def __init__(
        self, session: Session, study: Any, goals: Mapping[str, str],
        wanted: tuple[Condition, ...],
    ) -> None:
        self._session, self._study, self._goals, self._wanted = session, study, goals, wanted
        self._space = session.question.space
        self._signs = np.array([1.0 if goal == "least" else -1.0 for goal in goals.values()])
        self._ranked = type(study.sampler).__name__ == "CmaEsSampler"
        self._quantiles = np.empty((0, len(self._space.paths)))
        self._costs = np.empty((0, len(goals)))
        """Less is better; nan for a run without an answer."""
        self._excess = np.empty(0)
        self._failed: list[SweepRow] = []

    def run(self, runs: int) -> None:
        """Ask for points, run them and report the results, until there are so many."""
        while len(self._costs) < runs:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                trials = [self._study.ask() for _ in range(min(BATCH, runs - len(self._costs)))]
                quantiles = np.array([[self._suggest(trial, path) for path in self._space.paths]
                                      for trial in trials])
            rows = self._session.rows(quantiles)
            costs, excess = self._judge(rows)
            self._failed += [row for row, cost in zip(rows, costs, strict=True)
                             if np.isnan(cost).any()]
            self._quantiles = np.vstack([self._quantiles, quantiles])
            self._costs = np.vstack([self._costs, costs])
            self._excess = np.append(self._excess, excess)
            self._tell(trials, costs, excess)

    def _suggest(self, trial: Any, path: str) -> float:
        values = self._space.over[path]
        if not isinstance(values, tuple):
            return float(trial.suggest_float(path, 0.0, 1.0))
        place = trial.suggest_categorical(path, list(range(len(values))))
        return (int(place) + 0.5) / len(values)

    def _judge(self, rows: Sequence[SweepRow]) -> tuple[Array, Array]:
        """Costs [n, goals], and relative distances beyond the conditions [n]."""
        costs = np.array([[value_of(row, name) for name in self._goals] for row in rows])
        excess = np.array([max((each.excess(value_of(row, each.name)) / (abs(each.limit) or 1.0)
                                for each in self._wanted), default=0.0) for row in rows])
        bad = np.array([row.status != DONE for row in rows]) | np.isnan(costs).any(axis=1) | \
            np.isnan(excess)
        costs[bad], excess[bad] = np.nan, np.inf
        return costs * self._signs, excess

    def _tell(self, trials: Sequence[Any], costs: Array, excess: Array) -> None:
        failed = import_module("optuna").trial.TrialState.FAIL
        worst = np.nanmax(np.where(self._excess[:, None] <= 0, self._costs, np.nan),
                          initial=0.0) if self._ranked else 0.0
        for trial, cost, beyond in zip(trials, costs, excess, strict=True):
            if np.isnan(cost).any():
                self._study.tell(trial, state=failed)
            elif self._ranked:  # behind all that hold, ordered by the distance (Deb, 2000)
                self._study.tell(trial, float(cost[0]) if beyond <= 0 else
                                 float(worst) + 1.0 + float(beyond))
            else:
                if self._wanted:
                    trial.set_constraint("conditions", float(beyond))
                self._study.tell(trial, cost.tolist())

    def chosen(self) -> Chosen:
        """The best runs, repeated at half the step.

        Raises:
            SandboxError: no run meets all conditions.
        """
        sound = np.flatnonzero(self._excess <= 0)
        if not len(sound):
            beyond = float(self._excess.min())
            raise SandboxError(
                f"no run of {len(self._excess)} meets all conditions; the nearest is beyond one by "
                f"{100 * beyond:.3g} % of its limit" if math.isfinite(beyond) else
                f"no run of {len(self._excess)} has an answer{main_failure(self._failed)}",
                code="no-answer")
        single = len(self._goals) == 1
        order = sound[np.argsort(self._costs[sound, 0], kind="stable")]
        _, first = np.unique(self._quantiles[order], axis=0, return_index=True)
        order = order[np.sort(first)]
        best = order[:1] if single else order[_front(self._costs[order])]
        again = order[:CHECKED] if single else best
        costs, excess = self._judge(self._session.rows(self._quantiles[again], halved=True))
        spread = np.maximum(np.std(self._costs[sound], axis=0),
                            ROUNDING * np.abs(self._costs[sound]).max(axis=0))
        same, detail = _compare(self._costs[again] / np.maximum(spread, 1e-300),
                                costs / np.maximum(spread, 1e-300), excess, single=single)
        points = self._space.points(self._quantiles[best])
        choices = tuple(Choice(
            {path: value if isinstance(value := number_of(written), float) else str(value)
             for path, written in point.items()},
            dict(zip(self._goals, (self._costs[run] * self._signs).tolist(), strict=True)),
            float(self._excess[run]),
            dict(zip(self._goals, (cost * self._signs).tolist(), strict=True)))
            for run, point, cost in zip(best, points, costs, strict=False))
        history = np.where(self._excess[:, None] <= 0, self._costs * self._signs, np.nan)
        return Chosen(choices, dict(self._goals),
                      {**self._space.units, **self._session.question.kept}, len(self._costs),
                      len(self._failed), same, detail, history)


def _front(costs: Array) -> Array:
    """Indices of the Pareto front of costs [n, goals]."""
    return np.array([k for k, cost in enumerate(costs)
                     if not ((costs <= cost).all(axis=1) & (costs < cost).any(axis=1)).any()])


def _compare(before: Array, after: Array, excess: Array, *, single: bool) -> tuple[bool, str]:
    """Whether the best runs are the best at half the step, too, and details.

    Args:
        before: their costs, relative to the spread of all, [n, goals], the best first.
        after: the same at half the step.
        excess: at half the step, [n].
        single: whether there is one goal.
    """
    if not (excess <= 0).all():
        return False, (f"{int((~(excess <= 0)).sum())} of the best {len(excess)} fail a condition "
                       "or have no answer there")
    change = float(np.abs(after - before).max())
    detail = f"values change by up to {100 * change:.2g} % of the spread of all that hold"
    if single:
        first = int(np.argmin(after[:, 0]))
        best = float(after[0, 0] - after[first, 0]) <= ALIKE
        return best and change <= SAME, (
            f"of the best {len(before)} "
            + ("the first is best there, too" if best else f"the {first + 1}. is best there")
            + f"; {detail}")
    kept = len(_front(after))
    return kept == len(before) and change <= SAME, (
        f"{kept} of {len(before)} are such there, too; {detail}")
