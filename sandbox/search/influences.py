"""What matters: how much of what is kept of runs comes from which path.

Morris' screening (Technometrics 33 (1991) 161; μ* of Campolongo et al., Environ. Model. Softw. 22
(2007) 1509) for many paths and few runs; Sobol's indices (Math. Comput. Simul. 55 (2001) 271;
Saltelli et al., Comput. Phys. Commun. 181 (2010) 259) for shares of the variance. SALib has both.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.draw.figure.searches import InfluenceBars, draw_influences
from sandbox.draw.figure.style import shown_as
from sandbox.errors import SandboxError
from sandbox.numeric import Array
from sandbox.search.asking import FOUND, Asking, Where, affordable, asking
from sandbox.search.criteria import RefusedError, value_of, why_nothing
from sandbox.search.question import TAILS, Question
from sandbox.sweeps.searching import MOST_SEED, powers_around
from sandbox.wording import or_near, quoted, told_of

METHODS = {"sobol": ("first", "total"), "morris": ("mu_star", "sigma")}
"""What each method tells of a path. ``first``: the share of the variance that the path makes by
itself, ``total``: with all that it does together with others. ``mu_star``: the mean size of what
is changed by the path's whole range, ``sigma``: how much this differs from place to place."""
WORDS = {
    "first": "by itself", "total": "with all that it does together with others",
    "mu_star": "mean size of the change (mu_star)",
    "sigma": "how much it differs from place to place (sigma)"}
LEVELS = 4
"""Of Morris' grid."""
CERTIFIED = 32
"""So many of the points are run again at half the step."""
SAME = 0.05
"""Of the standard deviation of what is kept: how much half the step may change."""


@dataclass(frozen=True)
class Influence:
    """What a path does to something that is kept."""

    path: str
    values: Mapping[str, float]
    """By the words of :data:`METHODS`."""
    halves: Mapping[str, float]
    """Half of the 95 % interval of those that have one, by bootstrap."""


@dataclass(frozen=True)
class Sensitivity:
    """What matters for what."""

    method: str
    influences: Mapping[str, tuple[Influence, ...]]
    """By what is kept, the most influential path first; empty of what never changes."""
    runs: int
    left_out: int
    """Runs that could not be used since one of their group had no answer."""
    certified: bool
    certificate: str

    def __repr__(self) -> str:
        return told_of(self, self.lines)

    @property
    def lines(self) -> list[str]:
        """What was found, for a person."""
        told = []
        for name, influences in self.influences.items():
            told.append(f"{name}:" if influences else f"{name} never changes")
            told += ["  " + "  ".join([each.path, *(
                f"{word} {value:.3f}" + (f" ± {each.halves[word]:.3f}" if word in each.halves
                                         else "") for word, value in each.values.items())])
                     for each in influences]
        if self.left_out:
            told.append(f"{self.left_out} of {self.runs} runs are left out: one of their group had "
                        "no answer")
        return [*told, f"half the step: {'the same' if self.certified else 'NOT the same'}; "
                       f"{self.certificate}"]


def find_sensitivity(
    question: Question, *, method: str = "sobol", count: int = 64, seed: int = 0,
    place: Where | None = None,
) -> Sensitivity:
    """What matters for all that is kept.

    Args:
        question: two paths or more, with ranges, distributions or lists.
        method: ``sobol`` or ``morris``.
        count: of Sobol's base points, a power of 2: ``count (paths + 2)`` runs; of Morris'
            trajectories: ``count (paths + 1)`` runs.
        seed: of the points and of the bootstrap.
        place: where it runs and what it leaves behind.

    Raises:
        RefusedError: no such method, a count that it cannot take, or nothing kept.
        SandboxError: SALib is not installed, or too few runs have an answer.
    """
    paths = question.space.paths
    _sound(question, method, count)
    size = len(paths) + (2 if method == "sobol" else 1)
    affordable(question, count * size, seed)
    seed = seed or MOST_SEED  # SALib takes 0 for none, and draws as chance has it
    salib = _salib(method)
    problem = {"num_vars": len(paths), "names": list(paths), "bounds": [[0.0, 1.0]] * len(paths)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if method == "sobol":
            shares = salib[0].sample(problem, count, calc_second_order=False, seed=seed)
        else:
            shares = salib[0].sample(problem, count, num_levels=LEVELS, seed=seed)
    with asking(question, place or Where()) as work:
        names = list(question.kept)
        rows = work.rows(_inside(question, shares, method))
        values = np.array([[value_of(row, name) for name in names] for row in rows])
        sound = np.repeat(np.isfinite(values).all(axis=1).reshape(-1, size).all(axis=1), size)
        if sound.sum() < 4 * size:
            raise SandboxError(f"too few runs have an answer: {int(sound.sum())} of {len(values)} "
                               f"can be used{why_nothing(rows)}", code="no-answer")
        influences = {name: _influences(salib[1], problem, method, shares[sound],
                                        values[sound, k], seed) for k, name in enumerate(names)}
        certified, certificate = _certified(work, _inside(question, shares, method), values)
        found = Sensitivity(method, influences, len(values), int((~sound).sum()), certified,
                            certificate)
        if place and place.out:
            work.leave(place.out, "sensitivity", {**vars(found), "influences": {
                name: [vars(each) for each in many] for name, many in influences.items()}},
                       method=method, count=count, seed=seed % MOST_SEED)
            _draw(place.out / FOUND, found, question)
    return found


def _sound(question: Question, method: str, count: int) -> None:
    """Refuse what cannot be asked."""
    if method not in METHODS:
        raise RefusedError(f"there is no method {quoted(method)}{or_near(method, METHODS)} "
                           f"({', '.join(METHODS)})")
    if len(question.space.paths) < 2:
        raise RefusedError("what matters is asked of two paths or more")
    if not question.kept:
        raise RefusedError("say what is kept: the scene expects nothing")
    if method == "sobol" and (powers := powers_around(count)):
        raise RefusedError(f"Sobol's points are a power of 2, not {count} (allowed: "
                           f"{powers[0]}, {powers[1]})")
    if count < 4:
        raise RefusedError(f"the count is 4 or more, not {count}")


def _draw(file: Path, found: Sensitivity, question: Question) -> None:
    """A figure of bars, those of each that is kept in a panel."""
    measures = METHODS[found.method]
    panels = []
    for name, many in found.influences.items():
        unit = question.kept[name]
        factor, label = 1.0, "share of the variance"
        if found.method == "morris":
            how = shown_as(unit, np.array([each.values["mu_star"] for each in many]))
            factor, label = how.factor, f"change over a path's range [{how.unit or '1'}]"
        panels.append(InfluenceBars(
            name, [each.path for each in many],
            {word: factor * np.array([each.values[word] for each in many]) for word in measures},
            {word: factor * np.array([each.halves[word] for each in many]) for word in measures
             if many and word in many[0].halves}, label))
    draw_influences(file, panels, {word: WORDS[word] for word in measures},
                    f"{question.name}: what matters")


def _salib(method: str) -> tuple[Any, Any]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return (import_module(f"SALib.sample.{method}"),
                    import_module(f"SALib.analyze.{method}"))
    except ImportError:
        raise SandboxError("what matters needs SALib: pip install 'sandbox-mechanics[studies]'"
                           , code="missing-package") from None


def _inside(question: Question, shares: Array, method: str) -> Array:
    """Morris' grid reaches the ends, of which distributions may have none."""
    if method == "sobol":
        return shares
    found = shares.copy()
    for path in question.space.random:
        column = question.space.paths.index(path)
        found[:, column] = TAILS[0] + (TAILS[1] - TAILS[0]) * shares[:, column]
    return found


def _influences(
    analyze: Any, problem: Mapping[str, Any], method: str, shares: Array, values: Array, seed: int,
) -> tuple[Influence, ...]:
    if np.ptp(values) <= 1e-12 * np.abs(values).max(initial=0.0):
        return ()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if method == "sobol":
            told = analyze.analyze(problem, values, calc_second_order=False, seed=seed)
            columns = {"first": ("S1", "S1_conf"), "total": ("ST", "ST_conf")}
        else:
            told = analyze.analyze(problem, shares, values, num_levels=LEVELS, seed=seed)
            columns = {"mu_star": ("mu_star", "mu_star_conf"), "sigma": ("sigma", "")}
    found = [Influence(
        path, {word: float(told[key][k]) for word, (key, _) in columns.items()},
        {word: float(told[half][k]) for word, (_, half) in columns.items() if half})
        for k, path in enumerate(problem["names"])]
    ranked = METHODS[method][1 if method == "sobol" else 0]
    return tuple(sorted(found, key=lambda each: -each.values[ranked]))


def _certified(work: Asking, shares: Array, values: Array) -> tuple[bool, str]:
    places = np.unique(np.linspace(0, len(shares) - 1, CERTIFIED).astype(int))
    again = work.values(list(work.question.kept), shares[places], halved=True)
    spread = np.maximum(np.nanstd(values, axis=0), 1e-300)
    before = values[places]
    both = np.isfinite(before) & np.isfinite(again)
    change = np.sqrt(np.mean(np.where(both, (again - before) / spread, 0.0) ** 2, axis=0))
    change = np.where(np.nanstd(values, axis=0) > 0, change, 0.0)
    worst = float(change.max())
    alike = bool((np.isfinite(before) == np.isfinite(again)).all())
    return alike and worst <= SAME, (
        f"{len(places)} of the runs change by {100 * worst:.2g} % of the spread of what is kept"
        + ("" if alike else ", and some have an answer at one step only"))
