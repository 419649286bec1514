"""The best: least or most of what is kept of a run, of one thing or several, under conditions.

Optuna's samplers choose points in batches of a fixed size, from a seed, and are told the rows: the
same search asks for the same points again, so that one that was stopped, or is to go on for
longer, finds what it did in the log.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any, get_args

import numpy as np

from sandbox.draw.figure.searches import draw_front
from sandbox.draw.figure.sweeps import SweepColumn
from sandbox.errors import SandboxError
from sandbox.numeric import Array, Flags
from sandbox.search.asking import FOUND, Asking, Where, affordable, asking
from sandbox.search.criteria import (
    Condition,
    RefusedError,
    conditions,
    known_name,
    value_of,
    why_nothing,
)
from sandbox.search.question import Question
from sandbox.sweeps.job import DONE, SweepRow
from sandbox.sweeps.points import number_of
from sandbox.sweeps.searching import Sampler
from sandbox.wording import or_near, quoted, told_of

SEVERAL = ("nsga2", "tpe", "gp", "random")
"""Samplers of several objectives."""
PACKAGES = {"cmaes": "cmaes", "gp": "torch"}
"""What a sampler needs besides optuna."""
BATCH = 10
"""Runs that are asked for at a time, however many workers there are."""
WIDE = 0.3
"""Standard deviation of CMA-ES' first points, in ranges: a solution is somewhere in them (Hansen,
The CMA Evolution Strategy: A Tutorial, 2016)."""
CERTIFIED = 5
"""The best so many are run again at half the step."""
SAME, ALIKE = 0.05, 1e-3
"""Of the standard deviation of all runs that hold: how much half the step may change a value, and
by how much one may be behind another and count as good."""
ROUNDING = 1e-9
"""Of the largest value: runs that differ by less have no spread."""


@dataclass(frozen=True)
class Choice:
    """One point that was run."""

    values: Mapping[str, float | str]
    """What its paths were given, SI or text."""
    objectives: Mapping[str, float]
    """SI."""
    excess: float
    """How far beyond the limits of conditions it is, as shares of these; 0 or less if all hold."""
    halved: Mapping[str, float]
    """The objectives at half the step, of those that were run again."""


@dataclass(frozen=True)
class Chosen:
    """The best of a search, or those of which none is better in all that was asked for."""

    best: tuple[Choice, ...]
    goals: Mapping[str, str]
    """``least`` or ``most``, by what is kept."""
    units: Mapping[str, str]
    """SI, of paths and objectives."""
    runs: int
    failed: int
    """Runs without an answer."""
    certified: bool
    certificate: str
    history: Array
    """Objectives of all runs in their order, [n, objectives]; nan where a condition or a run
    failed."""

    def __repr__(self) -> str:
        return told_of(self, self.lines)

    @property
    def lines(self) -> list[str]:
        """What was found, for a person."""
        told = []
        if len(self.goals) > 1:
            told.append(f"{len(self.best)} of {self.runs} runs of which none is better in all:")
        for each in self.best:
            told.append("  ".join([self._said(each.objectives), "at", self._said(each.values)]))
        if self.failed:
            told.append(f"{self.failed} of {self.runs} runs had no answer")
        return [*told, f"half the step: {'the same' if self.certified else 'NOT the same'}; "
                       f"{self.certificate}"]

    def _said(self, values: Mapping[str, float | str]) -> str:
        return ", ".join(f"{name} = {value:.6g} {self.units.get(name, '')}".rstrip()
                         if isinstance(value, float) else f"{name} = {value}"
                         for name, value in values.items())


def find_best(
    question: Question, goals: Mapping[str, str], where: Sequence[str] = (), *,
    sampler: str = "", runs: int = 200, seed: int = 0, place: Where | None = None,
) -> Chosen:
    """The best points under conditions.

    Args:
        question: paths with ranges or lists.
        goals: ``least`` or ``most``, by what is kept.
        where: conditions such as ``"slip < 1 mm"``.
        sampler: how points are chosen; CMA-ES by default, TPE where there are lists or
            conditions, NSGA-II for several goals.
        runs: how many in all.
        seed: of the sampler.
        place: where it runs and what it leaves behind.

    Raises:
        RefusedError: no goal, or a sampler that does not fit.
        SandboxError: nothing that holds was found, or a package that is not installed.
    """
    if question.space.random:
        raise RefusedError(f"{quoted(question.space.random[0])} has a distribution: the best is "
                           "looked for over ranges and lists")
    if not goals:
        raise RefusedError("say what is to be least or most, of what is kept")
    for name in goals:
        known_name(name, question.kept)
    wanted = conditions(where, question.kept)
    affordable(question, runs, seed)
    study = _study(question, goals, sampler or _usual(question, goals, wanted), seed)
    place = place or Where()
    with asking(question, place) as work:
        race = _Race(work, study, list(goals), [goals[name] == "least" for name in goals], wanted)
        race.go(runs)
        found = race.chosen(goals)
        if place.out:
            work.leave(place.out, "best", {
                **vars(found), "best": [vars(each) for each in found.best]},
                least=[name for name, goal in goals.items() if goal == "least"],
                most=[name for name, goal in goals.items() if goal == "most"],
                wanted=wanted, where=where, sampler=sampler, runs=runs, seed=seed)
            if len(goals) > 1:
                columns = [SweepColumn(name, question.kept[name], found.history[:, k])
                           for k, name in enumerate(goals)]
                draw_front(place.out / FOUND, columns, goals, _answers(found),
                           f"{question.name}: {len(found.best)} of {found.runs} runs of which "
                           "none is better in all")
    return found


def _answers(found: Chosen) -> Flags:
    """Which runs have the numbers of an answer, [n]."""
    told = np.array([[each.objectives[name] for name in found.goals] for each in found.best])
    return np.asarray((found.history[:, None] == told[None]).all(axis=2).any(axis=1))


def goals_of(least: Sequence[str], most: Sequence[str]) -> dict[str, str]:
    """``least`` or ``most``, by what is kept.

    Raises:
        RefusedError: one is to be both.
    """
    if both := sorted(set(least) & set(most)):
        raise RefusedError(f"{quoted(both[0])} cannot be least and most at once")
    return {**dict.fromkeys(least, "least"), **dict.fromkeys(most, "most")}


def _usual(
    question: Question, goals: Mapping[str, str], wanted: tuple[Condition, ...],
) -> Sampler:
    """The sampler where none is said.

    CMA-ES knows of conditions only that some points are behind all others: where the best lies at
    a limit it draws its points together too early, as TPE does not.
    """
    if len(goals) > 1:
        return "nsga2"
    if wanted or question.space.lists or len(question.space.paths) == 1:
        return "tpe"
    return "cmaes"


def _study(question: Question, goals: Mapping[str, str], sampler: str, seed: int) -> Any:
    """Optuna's study.

    Raises:
        RefusedError: no such sampler, or one that does not fit.
        SandboxError: optuna is not installed.
    """
    several, lists = len(goals) > 1, question.space.lists
    known = get_args(Sampler)
    if sampler not in known:
        raise RefusedError(f"there is no sampler {quoted(sampler)}{or_near(sampler, known)} "
                           f"({', '.join(known)})")
    if sampler == "cmaes" and (several or lists):
        raise RefusedError("cmaes looks for one goal over ranges; "
                           f"{', '.join(SEVERAL)} take {'several' if several else 'lists'}")
    try:
        optuna: Any = import_module("optuna")
        if sampler in PACKAGES:
            import_module(PACKAGES[sampler])
    except ImportError as error:
        raise SandboxError(f"the sampler {sampler} needs {error.name}: pip install "
                           + ("torch" if sampler == "gp" else "'sandbox-mechanics[studies]'")
                           , code="missing-package") from None
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    kinds: dict[str, Callable[[], Any]] = {
        "cmaes": lambda: optuna.samplers.CmaEsSampler(
            seed=seed, popsize=BATCH, sigma0=WIDE),
        "tpe": lambda: optuna.samplers.TPESampler(seed=seed, multivariate=True),
        "gp": lambda: optuna.samplers.GPSampler(seed=seed),
        "nsga2": lambda: optuna.samplers.NSGAIISampler(seed=seed, population_size=2 * BATCH),
        "random": lambda: optuna.samplers.RandomSampler(seed=seed)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that some of it is experimental
        return optuna.create_study(directions=["minimize"] * len(goals), sampler=kinds[sampler]())


class _Race:
    """Optuna's study and the rows that it is told; all goals are made least."""

    def __init__(
        self, work: Asking, study: Any, names: list[str], least: list[bool],
        wanted: tuple[Condition, ...],
    ) -> None:
        self._work, self._study, self._names, self._wanted = work, study, names, wanted
        self._signs = np.where(least, 1.0, -1.0)
        self._ranked = type(study.sampler).__name__ == "CmaEsSampler"
        self.shares = np.empty((0, len(work.question.space.paths)))
        self.costs = np.empty((0, len(names)))
        """Signed so that less is better; nan of a run without an answer."""
        self.excess = np.empty(0)
        self._mute: list[SweepRow] = []
        """Runs without an answer."""

    def go(self, runs: int) -> None:
        """Ask, run and tell until there are so many."""
        while len(self.costs) < runs:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                trials = [self._study.ask() for _ in range(min(BATCH, runs - len(self.costs)))]
                shares = np.array([[self._share(trial, path) for path in self._space.paths]
                                   for trial in trials])
            rows = self._work.rows(shares)
            costs, excess = self._judged(rows)
            self._mute += [row for row, cost in zip(rows, costs, strict=True)
                           if np.isnan(cost).any()]
            self.shares = np.vstack([self.shares, shares])
            self.costs = np.vstack([self.costs, costs])
            self.excess = np.append(self.excess, excess)
            self._tell(trials, costs, excess)

    @property
    def _space(self) -> Any:
        return self._work.question.space

    def _share(self, trial: Any, path: str) -> float:
        if path not in self._space.lists:
            return float(trial.suggest_float(path, 0.0, 1.0))
        count = len(self._space.over[path])
        place = trial.suggest_categorical(path, list(range(count)))
        return (int(place) + 0.5) / count

    def _judged(self, rows: Sequence[SweepRow]) -> tuple[Array, Array]:
        costs = np.array([[value_of(row, name) for name in self._names] for row in rows])
        excess = np.array([max((each.excess(value_of(row, each.name)) / (abs(each.limit) or 1.0)
                                for each in self._wanted), default=0.0) for row in rows])
        bad = np.array([row.status != DONE for row in rows]) | np.isnan(costs).any(axis=1) | \
            np.isnan(excess)
        costs[bad], excess[bad] = np.nan, np.inf
        return costs * self._signs, excess

    def _tell(self, trials: Sequence[Any], costs: Array, excess: Array) -> None:
        state = import_module("optuna").trial.TrialState
        worst = np.nanmax(np.where(self.excess[:, None] <= 0, self.costs, np.nan), initial=-1e300) \
            if self._ranked else 0.0
        for trial, cost, beyond in zip(trials, costs, excess, strict=True):
            if np.isnan(cost).any():
                self._study.tell(trial, state=state.FAIL)
            elif self._ranked:  # behind all that hold, in the order of how far beyond (Deb, 2000)
                self._study.tell(trial, float(cost[0]) if beyond <= 0 else
                                 max(worst, 0.0) + 1.0 + float(beyond))
            else:
                if self._wanted:
                    trial.set_constraint("conditions", float(beyond))
                self._study.tell(trial, cost.tolist())

    def chosen(self, goals: Mapping[str, str]) -> Chosen:
        """The best, certified.

        Raises:
            SandboxError: no run holds.
        """
        sound = np.flatnonzero(self.excess <= 0)
        if not len(sound):
            beyond = float(self.excess.min())
            raise SandboxError(
                f"no run of {len(self.excess)} meets all conditions; the nearest is beyond one by "
                f"{100 * beyond:.3g} % of its limit" if math.isfinite(beyond) else
                f"no run of {len(self.excess)} has an answer{why_nothing(self._mute)}",
                code="no-answer")
        single = len(self._names) == 1
        order = sound[np.argsort(self.costs[sound, 0], kind="stable")]
        _, first = np.unique(self.shares[order], axis=0, return_index=True)
        order = order[np.sort(first)]
        best = order[:1] if single else order[_front(self.costs[order])]
        again = order[:CERTIFIED] if single else best
        costs, excess = self._judged(self._work.rows(self.shares[again], halved=True))
        spread = np.maximum(np.std(self.costs[sound], axis=0),
                            ROUNDING * np.abs(self.costs[sound]).max(axis=0))
        certified, certificate = _same((self.costs[again], costs), excess, spread, single=single)
        halved = dict(zip(again.tolist(), (costs * self._signs).tolist(), strict=True))
        space = self._space
        choices = tuple(Choice(
            {path: value if isinstance(value, float) else str(value) for path, value in
             self._written(place).items()},
            dict(zip(self._names, (self.costs[place] * self._signs).tolist(), strict=True)),
            float(self.excess[place]),
            dict(zip(self._names, halved[int(place)], strict=True))) for place in best)
        history = np.where(self.excess[:, None] <= 0, self.costs * self._signs, np.nan)
        units = {**space.units, **self._work.question.kept}
        return Chosen(choices, dict(goals), units, len(self.costs),
                      int(np.isnan(self.costs[:, 0]).sum()), certified, certificate, history)

    def _written(self, place: int) -> dict[str, float | str]:
        point, = self._space.points(self.shares[place][None])
        return {path: number_of(value) for path, value in point.items()}


def _front(costs: Array) -> Array:
    """Places of points that no other is better than in all, [n, objectives]."""
    return np.array([k for k, cost in enumerate(costs)
                     if not ((costs <= cost).all(axis=1) & (costs < cost).any(axis=1)).any()])


def _same(
    both: tuple[Array, Array], excess: Array, spread: Array, *, single: bool,
) -> tuple[bool, str]:
    """Whether those that were best are so at half the step.

    Args:
        both: what is to be least of the best, at the step and at half of it, [n, goals].
        excess: at half the step, [n].
        spread: of all runs that hold, [goals]: what is a small share of it is no difference.
        single: whether there is one goal, and the best stand in their order.
    """
    if not (excess <= 0).all():
        return False, (f"{int((~(excess <= 0)).sum())} of the best {len(excess)} fail a condition "
                       "or have no answer there")
    before, after = (each / np.maximum(spread, 1e-300) for each in both)
    change = float(np.abs(after - before).max())
    told = f"values change by up to {100 * change:.2g} % of the spread of all that hold"
    if single:
        first = int(np.argmin(after[:, 0]))
        behind = float(after[0, 0] - after[first, 0])
        return behind <= ALIKE and change <= SAME, (
            f"of the best {len(before)} "
            + ("the first is best there, too" if behind <= ALIKE else
               f"the {first + 1}. is best there") + f"; {told}")
    kept = len(_front(after))
    return kept == len(before) and change <= SAME, (
        f"{kept} of {len(before)} are such there, too; {told}")
