"""Sensitivity: the influence of each path on each result, by SALib.

Morris' screening (Technometrics 33 (1991) 161; μ* of Campolongo et al., Environ. Model. Softw. 22
(2007) 1509) for many paths and few runs; Sobol's indices (Math. Comput. Simul. 55 (2001) 271;
Saltelli et al., Comput. Phys. Commun. 181 (2010) 259) for shares of the variance.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.errors import SandboxError, optional
from sandbox.figure.style import shown_as
from sandbox.figure.sweeps import InfluenceBars, draw_influences
from sandbox.numeric import Array
from sandbox.search.session import FOUND, RefusedError, Result, Session, main_failure, results
from sandbox.sweeps.options import MAX_SEED, SensitivitySearch
from sandbox.sweeps.spec import TAILS, Distribution

MEASURES: dict[str, dict[str, tuple[str, str]]] = {
    "sobol": {"first": ("S1", "S1_conf"), "total": ("ST", "ST_conf")},
    "morris": {"mu_star": ("mu_star", "mu_star_conf"), "sigma": ("sigma", "")}}
"""SALib's names of value and interval of each measure: ``first`` is the share of the variance by a
path alone, ``total`` with interactions, ``mu_star`` the mean size of the change over the path's
range, ``sigma`` its standard deviation."""
RANKED = {"sobol": "total", "morris": "mu_star"}  # the measure by which paths are ordered
WORDS = {
    "first": "by itself", "total": "with all that it does together with others",
    "mu_star": "mean size of the change (mu_star)",
    "sigma": "how much it differs from place to place (sigma)"}
LEVELS = 4  # of Morris' grid
CHECKED = 32  # points that are repeated at half the step
SAME = 0.05  # of the standard deviation of a result: change at half the step that is accepted


@dataclass(frozen=True)
class Influence:
    """The influence of a path on a result."""

    path: str
    values: Mapping[str, float]  # by measure
    halves: Mapping[str, float]  # half of the 95 % interval by bootstrap, where there is one


@dataclass(frozen=True, repr=False)
class Sensitivity(Result):
    """The influences of all paths on all results."""

    method: str
    influences: Mapping[str, tuple[Influence, ...]]
    """By result, the most influential path first; empty for a result that never changes."""
    left_out: int  #: runs that could not be used, since one of their group had no answer

    def _lines(self) -> list[str]:
        lines = []
        for name, influences in self.influences.items():
            lines.append(f"{name}:" if influences else f"{name} never changes")
            lines += ["  " + "  ".join([each.path, *(
                f"{word} {value:.3f}" + (f" ± {each.halves[word]:.3f}" if word in each.halves
                                         else "") for word, value in each.values.items())])
                      for each in influences]
        if self.left_out:
            lines.append(f"{self.left_out} of {self.runs} runs are left out: one of their group "
                         "had no answer")
        return lines


def find_sensitivity(session: Session, options: SensitivitySearch) -> Sensitivity:
    """The influence of each path on each result."""
    method, count, paths, names = options.method, options.count, session.paths, [*session.job.keep]
    if len(paths) < 2:
        raise RefusedError("influences need two paths or more")
    if not names:
        raise RefusedError("nothing is kept: add a quantity to keep, as the scene has no "
                           "expectations")
    size = len(paths) + (2 if method == "sobol" else 1)
    session.check_runs(count * size)
    problem = {"num_vars": len(paths), "names": list(paths), "bounds": [[0.0, 1.0]] * len(paths)}
    given: dict[str, Any] = {"seed": options.seed or MAX_SEED}  # SALib takes 0 for none
    given |= {"calc_second_order": False} if method == "sobol" else {"num_levels": LEVELS}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sampler, analyzer = optional(f"SALib.sample.{method}"), optional(f"SALib.analyze.{method}")
        sample = sampler.sample(problem, count, **given)
    quantiles = sample.copy()
    if method == "morris":  # its grid has the ends, where a distribution may be infinite
        for path in session.of_kind(Distribution):
            column = paths.index(path)
            quantiles[:, column] = TAILS[0] + (TAILS[1] - TAILS[0]) * sample[:, column]
    rows = session.rows(quantiles)
    values = results(rows, names)
    sound = np.repeat(np.isfinite(values).all(axis=1).reshape(-1, size).all(axis=1), size)
    if sound.sum() < 4 * size:
        raise SandboxError(f"too few runs have an answer: {int(sound.sum())} of {len(values)} "
                           f"can be used{main_failure(rows)}", code="no-answer")
    influences = dict.fromkeys(names, tuple[Influence, ...]())
    for name, result in zip(names, values[sound].T, strict=True):
        if np.ptp(result) <= 1e-12 * np.abs(result).max(initial=0.0):
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            measured = analyzer.analyze(
                problem, *[sample[sound]] * (method == "morris"), result.copy(), **given)
        found = [Influence(path, *({word: float(measured[keys[part]][k]) for word, keys
                                    in MEASURES[method].items() if keys[part]} for part in (0, 1)))
                 for k, path in enumerate(paths)]
        influences[name] = tuple(sorted(found, key=lambda each: -each.values[RANKED[method]]))
    same, detail = _check(session, quantiles, values)
    answer = Sensitivity(method, influences, int((~sound).sum()), runs=len(values), certified=same,
                         certificate=detail)
    session.write(answer)
    if session.out:
        _draw(session.out, session, answer)
    return answer


def _check(session: Session, quantiles: Array, values: Array) -> tuple[bool, str]:
    places = np.unique(np.linspace(0, len(quantiles) - 1, CHECKED).astype(int))
    again = results(session.rows(quantiles[places], halved=True), session.job.keep)
    before, spread = values[places], np.nanstd(values, axis=0)
    both = np.isfinite(before) & np.isfinite(again) & (spread > 0)
    change = np.sqrt(np.mean(np.where(
        both, (again - before) / np.maximum(spread, 1e-300), 0.0) ** 2, axis=0))
    worst = float(change.max())
    alike = bool((np.isfinite(before) == np.isfinite(again)).all())
    return alike and worst <= SAME, (
        f"{len(places)} of the runs change by {100 * worst:.2g} % of the spread of the results"
        + ("" if alike else ", and some have an answer at one step only"))


def _draw(folder: Path, session: Session, found: Sensitivity) -> None:
    measures, panels = MEASURES[found.method], []
    for name, many in found.influences.items():
        factor, label = 1.0, "share of the variance"
        if found.method == "morris":
            how = shown_as(session.units[name], np.array([each.values["mu_star"] for each in many]))
            factor, label = how.factor, f"change over a path's range [{how.unit or '1'}]"
        values, halves = ({word: factor * np.array([getattr(each, part)[word] for each in many])
                           for word in measures if many and word in getattr(many[0], part)}
                          for part in ("values", "halves"))
        panels.append(InfluenceBars(name, [each.path for each in many], values, halves, label))
    draw_influences(folder / FOUND, panels, {word: WORDS[word] for word in measures},
                    f"{session.plan.name}: influence of the paths")
